// SPDX-License-Identifier: Apache-2.0
// Where velocities lead: poses move on straight lines and geodesics, coordinates on straight lines.
#pragma once

#include <string>

#include "geometry/named.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// A pose after a constant twist for a time (MJ-8); it keeps its bits if there is none.
SE3 retract(const SE3& g, const Vec6& twist, double time);
/// The state after moving its poses, coordinates and turns at the constant velocities `v`, laid out as
/// State::v, for a time (MJ-8); carried bodies go where the coordinates lead (TREE-1). The pose of a body
/// that does not move stays the same bit for bit. Time, velocities and memory are unchanged.
State retract(const Model& model, State state, const VecX& v, double time);

/// The constant twist that leads from one pose to the other in `time`.
Vec6 twist_between(const SE3& from, const SE3& to, double time);
/// The constant velocities, near `v`, that lead from the poses and coordinates of `state` to those of `end`;
/// `plain` has those that `v` leads to. A body that turns by more than half a turn still does so.
VecX velocity_between(const State& state, const State& plain, const State& end, VecX v, double time);

/// Gives a driven body the constant twist that leads it from its present pose to `target` in `time` [s], the
/// shorter way round. The body keeps this twist until it is led elsewhere. Throws std::invalid_argument
/// unless the body is driven, `target` is a valid pose and the time is positive.
void lead_body(const Model& model, State& state, BodyId body, const SE3& target, double time);

/// Velocities of the bodies that are not dynamic and of held axes of points, laid out as State::v; zero for
/// everything free. A prescribed body moves from its pose at t to that at t + h at constant speeds; a driven
/// one moves with its twist in the state, a held axis with its speed there.
VecX prescribed_velocity(const Model& model, const State& state, double h);

/// Poses after moving at the velocities `v`, laid out as State::v, for a time (MJ-8); prescribed bodies are
/// on their path.
PerBody<SE3> moved_poses(const Model& model, const State& state, const VecX& v, double time);
/// The state at the end of a path of constant velocities `v_path`, laid out as State::v (MJ-8), with
/// prescribed bodies on their path and with the velocities `v_end`; carried bodies follow the coordinates. It
/// remembers no contacts.
State state_after(const Model& model, const State& state, const VecX& v_path, const VecX& v_end, double h);

/// `v` with the constant twists that lead carried bodies in `time` where the coordinates do (TREE-1).
VecX with_carried(const Model& model, const State& state, VecX v, double time);

/// How a mean velocity moves a body over a step (LIE-1) to (LIE-3).
enum class GroupUpdate {
  exponential,  // R3 x SO(3): x + h v, R exp(h omega)
  cayley,  // R3 x SO(3): x + h v, R cay(h omega); with the gyroscopic midpoint exact in energy and momentum
  screw,   // SE(3): the end of the screw with the twist at the middle of the step
};
inline constexpr Named<GroupUpdate> kGroupUpdates[] = {{GroupUpdate::exponential, "exponential"},
                                                       {GroupUpdate::cayley, "cayley"},
                                                       {GroupUpdate::screw, "screw"}};
const char* to_string(GroupUpdate update);
/// The constant velocities (MJ-8) that reach the same poses as the update does with the mean velocities `v`,
/// those of carried bodies included. Both are laid out as State::v.
VecX path_velocity(GroupUpdate update, const Model& model, const State& state, const VecX& v, double h);

}  // namespace aussois
