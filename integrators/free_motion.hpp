// SPDX-License-Identifier: Apache-2.0
// What moves over one step of the theta scheme without contacts and joints, linearly implicit (MJ-4), (MJ-5).
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "mechanics/state.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {

/// Which rows of the problem belong to a body, six each; the coordinates come behind.
struct DofMap {
  std::vector<int> first{};  // per body: its first row, -1 if it is not dynamic
  int coordinates = 0;       // first row of the coordinates
  int rows = 0;
};
DofMap dof_map(const Model& model);
/// The row of an entry of State::v, -1 if its body is not dynamic.
int row_of(const DofMap& dofs, Eigen::Index velocity);

/// Velocities of the bodies that are not dynamic, in the places of State::v; zero for all that is free. A
/// prescribed body moves from its pose at t to that at t + h at constant speeds.
VecX prescribed_velocity(const Model& model, const State& state, double h);

/// Velocities in the places of State::v: the free ones from `v`, rows of the problem, the others from
/// `v_prescribed`.
VecX all_velocities(const DofMap& dofs, const VecX& v, const VecX& v_prescribed);
/// The opposite: the rows of the problem.
VecX free_velocities(const DofMap& dofs, const VecX& all);

/// Poses after the velocities `v`, in the places of State::v, for a time (MJ-8); prescribed bodies on their
/// path.
std::vector<SE3> moved_poses(const Model& model, const State& state, const VecX& v, double time);

/// J . v of a row, with v in the places of State::v.
double speed_along(const Joint& joint, const JointRow& row, const VecX& v);

/// What a spring and damper and an effort motor give along an axis of a joint: an impulse over a step
/// [N s, N m s], or a force [N, N m].
struct AxisImpulse {
  int joint = -1, axis = 0;
  JointRow row{};
  double motor = 0;
  double spring = 0;  // and damper, if the velocity does not change
  double D = 0;       // what it loses of J times the change of the velocity [N s^2/m, N m s^2]
};

/// Rows of the dynamic bodies and of the coordinates. M^ (v+ - v) = gravity + gyroscopic + laws + H r, where
/// what depends on v+ stands in M^.
struct FreeMotion {
  SparseMatrix M{};  // M^ = mass + gyroscopic_D + law_D
  VecX f{};          // momentum: M^ v_free = f [N s, N m s]
  VecX v{};          // velocity at the start of the step
  VecX v_free{};     // velocity at its end without contact; not a number if M is singular
  // M^-1; null if M is singular, or not summed up here
  std::shared_ptr<const MassInverse> inverse{};
  SparseMatrix mass{};
  VecX gravity{};                   // impulse over the step [N s]
  VecX gyroscopic{};                // h (-omega x J omega) at the start
  SparseMatrix gyroscopic_D{};      // h theta d(omega x J omega)/d omega
  VecX laws{};                      // h F - h^2 theta K v, forces of joint axes and coordinates included
  SparseMatrix law_D{};             // h theta C + h^2 theta^2 K
  std::vector<AxisImpulse> axes{};  // part of `laws` and `law_D`
  // How contact impulses turn while a fully implicit step converges (MJ-14); empty: they do not
  VecX turning{};
  SparseMatrix turning_D{};  // M^ has it too
  // Of schemes that know the motion between contacts before they ask for impulses; empty: none
  VecX joints{};     // impulse of the joints in that motion beside that of the solve
  VecX numerical{};  // what the scheme adds of its own
};

/// Made once and looked at by all attempts of a step; made in place, since Eigen's sparse matrices are copied
/// where others are moved.
using SharedMotion = std::shared_ptr<const FreeMotion>;

/// Adds springs, dampers and effort motors of the joints' axes at time t, with directions at the poses
/// `middle` (MJT-9), and tells them one by one.
std::vector<AxisImpulse> add_axis_forces(const Model& model, const State& state,
                                         const std::vector<SE3>& middle, double t, GeneralisedForce& force);
/// Impulses of forces that are these at the ends of a step.
std::vector<AxisImpulse> trapezoid(double h, std::vector<AxisImpulse> start,
                                   const std::vector<AxisImpulse>& end);

/// The last M^ of a scheme and its inverse. Where bodies do not turn, or are as round as balls and cubes, M^
/// stays as it is from step to step; else blocks of it do. It saves time and changes no result; who finds it
/// in use by another thread goes without.
struct MassScratch {
  std::mutex in_use{};
  SparseMatrix M{};
  std::shared_ptr<const MassInverse> inverse{};
};

/// M, f, v_free and the inverse from the velocity, the impulses and the matrices that they are the sums of.
void sum_up(FreeMotion& free, MassScratch* scratch = nullptr);
/// f and v_free alone: M and its inverse stand.
void sum_up_impulses(FreeMotion& free);

/// `theta` in [1/2, 1].
FreeMotion free_motion(const Model& model, const State& state, const DofMap& dofs, double h, double theta,
                       MassScratch* scratch = nullptr);

/// Where the gyroscopic torque of a step is taken (PMI-2), (PMI-3).
enum class GyroscopicTerm {
  start,     // S(J omega) at the start times the mean omega: linear, no work
  midpoint,  // at the mean omega: no work either; linearised about the mean with `v_guess` at the end
};
/// The same free motion at theta = 1/2 with its gyroscopic torque taken there. `v_guess`: rows of the
/// problem.
FreeMotion with_gyroscopic(const Model& model, const DofMap& dofs, double h, GyroscopicTerm term,
                           const VecX& v_guess, FreeMotion free);

/// All forces at a state and at its own time, rows of the problem; joint axes and coordinates included.
struct Forces {
  SparseMatrix mass{};                   // at the state's coordinates
  VecX gravity{}, gyroscopic{}, laws{};  // [N, N m]
  SparseMatrix K{}, C{};                 // -df/dq and -df/dv of the sum
  std::vector<AxisImpulse> axes{};       // part of `laws`
  VecX sum() const { return gravity + gyroscopic + laws; }
};
Forces forces_at(const Model& model, const State& state, const DofMap& dofs);

/// How a mean velocity moves a body over a step (LIE-1) to (LIE-3).
enum class GroupUpdate {
  exponential,  // R3 x SO(3): x + h v, R exp(h omega)
  cayley,  // R3 x SO(3): x + h v, R cay(h omega); with the gyroscopic midpoint exact in energy and momentum
  screw,   // SE(3): the end of the screw with the twist at the middle of the step
};
const char* to_string(GroupUpdate update);
/// By its name; throws std::invalid_argument naming the three.
GroupUpdate group_update(const std::string& name);
/// The constant velocities (MJ-8) that lead where the update leads with the mean velocities `v`, both in the
/// places of State::v.
VecX path_velocity(GroupUpdate update, const Model& model, const State& state, const VecX& v, double h);

}  // namespace aussois
