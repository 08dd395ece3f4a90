// SPDX-License-Identifier: Apache-2.0
// Scenes of solids and sheets, and what the verification list is made of: a solid alone, and dead loads on
// its points.
#pragma once

#include <functional>
#include <memory>

#include "examples/scenes/cases.hpp"
#include "mechanics/solid.hpp"
#include "mechanics/state.hpp"

namespace aussois {

struct SolidScene {
  Model model{};
  State state{};
  Solid solid{};
};
/// Without gravity and without a surface, as it is laid.
SolidScene solid_scene(const VolumeMesh& mesh, const SolidOptions& options);

/// The points that `is_there` holds for [places where the mesh is laid].
std::vector<int> points_where(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& is_there);
/// Holds all points that `is_there` holds for along some axes, besides those held already.
void hold(const VolumeMesh& mesh, SolidOptions& options, const std::array<bool, 3>& axes,
          const std::function<bool(const Vec3&)>& is_there);

/// A load in the direction of a traction, spread over the faces whose corners `is_there` all holds for [N];
/// times a factor that may be set between steps.
struct FaceLoad {
  Vec3 force = Vec3::Zero();  // the sum [N]
  std::function<bool(const Vec3&)> is_there{};
  std::shared_ptr<double> factor = std::make_shared<double>(1);
};
void add(Model& model, const Solid& solid, const FaceLoad& load);

/// Gives all points of a solid one velocity [m/s].
void throw_solid(const Model& model, State& state, const Solid& solid, const Vec3& v);
/// What the solid gives to each point [N], held ones included.
std::vector<Vec3> point_forces(const SolidScene& scene);
/// Places the points where a map of the laid places leads them.
void place(SolidScene& scene, const std::function<Vec3(const Vec3&)>& to);

/// Four soft cubes of 10 cm fall onto each other; `body` is the floor.
CaseScene soft_cubes();
/// A square of cloth of 60 cm falls over a ball and folds onto itself; `body` is the ball.
CaseScene cloth_on_ball();

}  // namespace aussois
