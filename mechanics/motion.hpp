// SPDX-License-Identifier: Apache-2.0
// Where velocities lead: poses on straight lines and geodesics, coordinates on straight lines.
#pragma once

#include <string>

#include "mechanics/state.hpp"

namespace aussois {

/// The state with its poses, coordinates and turns after the constant velocities `v`, in the places of
/// State::v, for a time (MJ-8). A body that does not move keeps its bits; time, velocities and memory stay.
State retract(const Model& model, State state, const VecX& v, double time);

/// The constant twist that leads from one pose to the other in `time`.
Vec6 twist_between(const SE3& from, const SE3& to, double time);
/// The constant velocities, near `v`, that lead from the poses and coordinates of `state` to those of `end`;
/// `plain` are those that `v` leads to. A body that turns by more than half a turn goes on doing so.
VecX velocity_between(const State& state, const State& plain, const State& end, VecX v, double time);

/// Gives a driven body the constant twist that leads it from where it is to `target` in `time` [s], the
/// shorter way round; it goes on with it until it is led elsewhere. Throws std::invalid_argument unless the
/// body is driven, the pose one and the time positive.
void lead(const Model& model, State& state, int body, const SE3& target, double time);

/// Velocities of the bodies that are not dynamic, in the places of State::v; zero for all that is free. A
/// prescribed body moves from its pose at t to that at t + h at constant speeds, a driven one as the state
/// says.
VecX prescribed_velocity(const Model& model, const State& state, double h);

/// Poses after the velocities `v`, in the places of State::v, for a time (MJ-8); prescribed bodies on their
/// path.
std::vector<SE3> moved_poses(const Model& model, const State& state, const VecX& v, double time);
/// The state at the end of a path of constant velocities, in the places of State::v (MJ-8), prescribed bodies
/// on their path, with the velocities `v_end`; it remembers no contacts.
State state_after(const Model& model, const State& state, const VecX& v_path, const VecX& v_end, double h);

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
