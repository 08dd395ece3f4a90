// SPDX-License-Identifier: Apache-2.0
// Finds what touches at a state, how it accelerates while it touches, and how it jumps when it collides, for
// the event-driven scheme (EVD-2) to (EVD-8).
#pragma once

#include "integrators/pose/joint_rows.hpp"
#include "integrators/pose/step_setting.hpp"

namespace aussois {

/// Scaled residual up to which accelerations are taken; EventDrivenOptions::tolerance is no larger [-].
inline constexpr double kAcceptedResidual = 1e-9;

/// One block of rows at a state: a contact, a gap function, or the stop or dry friction of a joint's axis.
struct Touch {
  std::optional<int> slot{};       // first entry in State::r; a contact has none
  ContactPoint point{};            // of a contact
  Mat3 frame = Mat3::Identity();   // of a contact: columns n, t1, t2, world
  Law law{};                       // limits of dry friction in N, N m
  double restitution = 0;          // [-]
  double gap = -kInf;              // [m, rad]; dry friction has none: it always touches
  MatX N{};                        // directions as columns, in the rows of Layout
  VecX u{};                        // N^T v plus what moves by itself [m/s, rad/s]
  VecX bias{};                     // u' = N^T v' + bias [m/s^2, rad/s^2] (EVD-3)
  bool kinematics_defined = true;  // false: parallel edges, bias is unknown
};

bool has_gap(const Touch& touch);
/// Speeds that friction acts on, in one unit (a Contensou row times its radius) [m/s]; empty: no friction.
VecX slip_of(const Touch& touch, const VecX& u);

/// All contacts within `threshold` [m], gap functions, stops and dry friction; sorted: contacts first.
std::vector<Touch> touches_at(const StepSetting& setting, const State& state, double threshold);

/// Mass, and all forces but those of touches, in the rows of Layout.
struct SmoothForces {
  SparseMatrix M{};
  VecX all{};                       // [N, N m]
  VecX laws{};                      // the part of `all` from force laws, axes and coordinates
  VecX applied{};                   // laws and gravity: all but the gyroscopic torque
  std::vector<AxisImpulse> axes{};  // part of `laws`, as forces
  Momentum turning{};               // rate of momentum while no speed changes, with trees [N, N m]
};
SmoothForces smooth_forces(const StepSetting& setting, const State& state);

/// How a touch takes part in the acceleration problem (EVD-4).
enum class FrictionState { none, sticks, slips };
struct ClosedTouch {
  Touch touch{};
  FrictionState friction = FrictionState::none;
  VecX along{};  // unit direction of slip_of while it slips
};

struct Accelerations {
  bool solved = false;
  SolveReport solve{};         // of forces at gaps and of friction
  VecX a{};                    // of the rows of Layout [m/s^2, rad/s^2]
  std::vector<VecX> force{};   // of every closed touch, in its rows [N, N m]
  std::vector<VecX> rate{};    // u' with the stabilisation of (EVD-5)
  std::vector<VecX> weight{};  // diagonal of W, to compare forces with accelerations [1/kg]
  VecX reaction{};             // of the joints [N, N m]
};
/// Solves for accelerations and forces at index one: gaps closed, friction and joints on the level of
/// accelerations (EVD-4), (EVD-5). `start` holds initial forces for the solver, or is empty.
Accelerations accelerations(const StepSetting& setting, const State& state, const SmoothForces& forces,
                            const std::vector<ClosedTouch>& closed, const std::vector<VecX>& start);

struct Collision {
  bool solved = false;
  SolveReport solve{};
  VecX v{};                     // after the collision, rows of Layout
  std::vector<VecX> impulse{};  // of every touch, in its rows [N s, N m s]
  VecX reaction{};              // of the joints [N s, N m s]
};
/// Newton's law with `restitution` per touch, Coulomb's law for the impulses (EVD-7). `push` is an additional
/// impulse in the rows of Layout (EVD-8), or empty.
Collision collide(const StepSetting& setting, const State& state, const std::vector<Touch>& touches,
                  const std::vector<double>& restitution, const VecX& push = VecX());

/// d/dt of f along the motion with constant velocities, by fourth-order differences (EVD-3).
VecX rate_along(const Model& model, const State& state, const std::function<VecX(const State&)>& f);

}  // namespace aussois
