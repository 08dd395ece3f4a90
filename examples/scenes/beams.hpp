// SPDX-License-Identifier: Apache-2.0
// Beams of the verification list: a cable with one end clamped, dead loads, and modes of small vibrations.
#pragma once

#include <memory>

#include "mechanics/cable.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// Stiffness along, across, of twist and of bending; mass and inertia about x and across, per length.
struct BeamNumbers {
  double EA = 1, GA = 1, GJ = 1, EI = 1;  // [N], [N m^2]
  double mass = 1, about_x = 1, across = 1;
};
BeamSection section_of(const BeamNumbers& numbers);

struct BeamScene {
  Model model{};
  State state{};
  Cable cable{};
  BodyId first() const { return cable.nodes.front(); }
  BodyId last() const { return cable.nodes.back(); }
};
/// Nodes as they are laid, without gravity; `clamped` fixes the first.
BeamScene beam_scene(const std::vector<SE3>& nodes, const BeamNumbers& numbers, bool clamped,
                     CableOptions options = {});
/// `elements` of equal length along a leg, or several, with frames that do not turn about their line.
std::vector<SE3> straight_nodes(const Vec3& from, const Vec3& to, int elements);
/// Straight legs of equal length from corner to corner, `per_leg` elements each, joined rigidly, without
/// gravity. The nodes have the axes of the world; the legs are attached to them turned.
BeamScene legs_scene(const std::vector<Vec3>& corners, int per_leg, const BeamSection& section);

/// A force and a moment that keep their directions in the world, times a factor of time that may also be set
/// between steps.
struct DeadLoad {
  BodyId body{};
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  // [N], [N m]
  std::shared_ptr<double> factor = std::make_shared<double>(1);
  std::function<double(double t)> course{};  // empty: 1
};
void add(Model& model, const DeadLoad& load);

/// Of small vibrations about the state, without its velocities: K x = omega^2 M x of the free rows.
struct Modes {
  VecX omega2{};  // ascending [rad^2/s^2]; negative where the state is not stable
  MatX shape{};   // columns, in the rows of Layout
};
Modes small_modes(const Model& model, const State& state);

}  // namespace aussois
