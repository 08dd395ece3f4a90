// SPDX-License-Identifier: Apache-2.0
// Everything that a step changes, and nothing else. A copy is a checkpoint.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/se3.hpp"
#include "mechanics/layout.hpp"
#include "mechanics/model.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {

struct State {
  double t = 0;       // [s]
  double h = 0;       // length of the last accepted step [s], 0 before the first: impulses scale with it
  double h_next = 0;  // next step that the step control would try [s]; 0: as large as the scheme allows
  // The placement() to which a certificate led: no bases touch there, and none is inside another (CA-21).
  // 0: none
  std::uint64_t apart = 0;
  PerBody<SE3> g{};  // g_wb of every body
  VecX q{};          // of all blocks of coordinates, in order
  VecX v{};          // six per body: v_G in the world [m/s], omega in the body [rad/s]; then the speeds of q
  std::vector<int> turns{};  // full turns of the joints' angles: three per joint, one per axis; empty: all
                             // zero (MJT-7)
  VecX r{};  // impulses of the last step on joint axes and gap functions [N s, N m s]; empty: none (MJT-12)
  VecX a{};  // accelerations that a scheme keeps from step to step, twice as many as v; empty: none
  VecX u{};  // inputs: what is set from outside between steps, and read by laws (Model::inputs)
  ContactMemory memory{};
};

/// Digest of the poses and coordinates, and of the pairs that may pass; never 0.
std::uint64_t placement(const Model& model, const State& state);
/// Whether a certificate may build on the one before: nothing was moved since, and no pair lost its
/// exemption.
bool is_proven_apart(const Model& model, const State& state);

/// Bodies at the world's origin and at rest, prescribed ones at the start of their path; q = 0, with carried
/// bodies where that puts them.
State rest_state(const Model& model);
/// Throws std::invalid_argument unless sizes fit the model, every number is finite, rotations are unit
/// quaternions (1e-6) and the memory is sorted by key, of bodies and features that the model has.
void validate(const Model& model, const State& state);

/// The part of it that every step checks: throws unless the model has all bodies and features of the memory.
void validate(const Model& model, const ContactMemory& memory);

SE3& pose(State& state, BodyId body);
const SE3& pose(const State& state, BodyId body);
Eigen::Ref<Vec6> twist(State& state, BodyId body);
Vec6 twist(const State& state, BodyId body);
/// Coordinates of a block and their speeds.
VecX coordinates(const Model& model, const State& state, BlockId block);
VecX speeds(const Model& model, const State& state, BlockId block);
/// A vector without its parts along the axes on which the point is held.
Vec3 without_held(const PointMass& point, Vec3 along);
/// The place of a point of a block with the coordinates q [m].
Vec3 point_place(const Coordinates& block, const VecX& q, std::size_t point);
/// The weight of a block's points [N], zero along held axes; all zero of a block without points.
VecX block_weight(const Model& model, BlockId block);
/// Evaluate the blocks and gap functions of a model. They throw std::invalid_argument naming a result of the
/// wrong size, with both sizes.
SparseMatrix block_mass(const Model& model, BlockId block, const VecX& q);
CoordinateForce block_force(const Model& model, BlockId block, double t, const VecX& q, const VecX& v);
GapRows gap_function(const Model& model, const State& state, GapId gap, double t);

/// 64-bit hash of all bits of the state: equal states have equal hashes, no matter what computed them; -0.0
/// differs from 0.0.
std::uint64_t hash(const State& state);

/// Slots, the entries of State::r: stops, dry friction and limited motor of every axis of every joint, three
/// axes each; then three rows per gap function.
enum class AxisRow { lower_stop, upper_stop, friction, motor };
struct AxisSlot {
  JointId joint{};
  int axis = 0;
  AxisRow row = AxisRow::lower_stop;
};
int slot_of(const AxisSlot& of);
/// The first of three.
int slot_of(const Model& model, GapId gap);
int row_count(const Model& model);
/// False for a gap function, and for none, a contact.
bool is_of_axis(const Model& model, std::optional<int> slot);
/// Inverts slot_of.
AxisSlot axis_slot(int slot);
/// None for an axis, and for none, a contact.
GapId gap_of(const Model& model, std::optional<int> slot);

/// Energy of the dynamic and carried bodies and the coordinates, held axes of points left out; `laws` is the
/// sum of the potentials of force laws, joint springs and coordinates at the state's own time (MEC-4).
struct Energy {
  double kinetic = 0, gravity = 0, laws = 0;  // [J]
  double total() const { return kinetic + gravity + laws; }
};
Energy energy(const Model& model, const State& state);

/// Linear momentum of the dynamic and carried bodies and of points, held axes left out [N s], and their
/// angular momentum about the world's origin [N m s].
struct Momentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  Momentum& operator+=(const Momentum& other) {
    linear += other.linear, angular += other.angular;
    return *this;
  }
};
inline Momentum operator-(const Momentum& a, const Momentum& b) {
  return {a.linear - b.linear, a.angular - b.angular};
}
Momentum momentum(const Model& model, const State& state);

}  // namespace aussois
