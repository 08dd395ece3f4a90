// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/solids.hpp"

#include <algorithm>
#include <utility>

#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "mechanics/sheet.hpp"

namespace aussois {

SolidScene solid_scene(const VolumeMesh& mesh, const SolidOptions& options) {
  SolidScene out;
  out.model.gravity = Vec3::Zero();
  out.solid = add_solid(out.model, mesh, options);
  out.state = rest_state(out.model);
  return out;
}

std::vector<int> points_where(const VolumeMesh& mesh, const std::function<bool(const Vec3&)>& is_there) {
  std::vector<int> out;
  for (int i = 0; i < std::ssize(mesh.points); ++i)
    if (is_there(mesh.points[std::size_t(i)])) out.push_back(i);
  return out;
}

void hold(const VolumeMesh& mesh, SolidOptions& options, const std::array<bool, 3>& axes,
          const std::function<bool(const Vec3&)>& is_there) {
  options.held.resize(mesh.points.size());
  for (const int point : points_where(mesh, is_there))
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (axes[axis]) options.held[std::size_t(point)][axis] = true;
}

void add(Model& model, const Solid& solid, const FaceLoad& load) {
  const std::vector<Vec3>& x = solid.mesh->points;
  std::vector<double> share(x.size(), 0);
  double area = 0;
  for (const std::array<int, 3>& t : boundary_triangles(*solid.mesh)) {
    if (!std::ranges::all_of(t, [&](int p) { return load.is_there(x[std::size_t(p)]); })) continue;
    const Vec3& o = x[std::size_t(t[0])];
    const double own = (x[std::size_t(t[1])] - o).cross(x[std::size_t(t[2])] - o).norm() / 2;
    area += own;
    for (const int p : t) share[std::size_t(p)] += own / 3;
  }
  for (double& s : share) s /= area;
  add(model, ForceLaw{.name = "dead load",
                      .add_to = [=, block = solid.points, factor = load.factor, force = load.force](
                                    const Model& m, const State&, double, GeneralisedForce& sum) {
                        const int first = first_speed(m, block);
                        for (std::size_t i = 0; i < share.size(); ++i)
                          sum.f.segment<3>(first + 3 * Eigen::Index(i)) += *factor * share[i] * force;
                      }});
}

void throw_solid(const Model& model, State& state, const Solid& solid, const Vec3& v) {
  const int first = first_speed(model, solid.points);
  for (std::size_t i = 0; i < solid.mesh->points.size(); ++i)
    state.v.segment<3>(first + 3 * Eigen::Index(i)) = v;
}

std::vector<Vec3> point_forces(const SolidScene& scene) {
  const GeneralisedForce force = total_force(scene.model, scene.state, scene.state.t);
  std::vector<Vec3> out;
  const int first = first_speed(scene.model, scene.solid.points);
  for (std::size_t i = 0; i < scene.solid.mesh->points.size(); ++i)
    out.push_back(force.f.segment<3>(first + 3 * Eigen::Index(i)));
  return out;
}

void place(SolidScene& scene, const std::function<Vec3(const Vec3&)>& to) {
  const int first = first_coordinate(scene.model, scene.solid.points);
  for (std::size_t i = 0; i < scene.solid.mesh->points.size(); ++i) {
    const Vec3& x = scene.solid.mesh->points[i];
    scene.state.q.segment<3>(first + 3 * Eigen::Index(i)) = to(x) - x;
  }
}

CaseScene soft_cubes() {
  constexpr double kSide = 0.1, kRadius = 1e-3;
  CaseScene s;
  s.model.contact_law.mu = 0.4;
  s.body = add(s.model, fixed_body("floor", add(s.model, prepare(dilate(make_plate(1, 1), kRadius)))));
  const VolumeMesh mesh = make_box_mesh(Vec3::Constant(kSide), {3, 3, 3});
  for (int k = 0; k < 4; ++k)
    add_solid(s.model, mesh,
              {.name = "cube " + std::to_string(k),
               .materials = {{.young = 1e5, .poisson = 0.45, .density = 1000, .viscosity = 100}},
               .place = translation(0.01 * k, 0.007 * (k % 2), 0.07 + 0.13 * k),
               .radius = kRadius});
  s.state = rest_state(s.model);
  return s;
}

CaseScene cloth_on_ball() {
  constexpr double kRadius = 2e-3;
  CaseScene s;
  s.model.contact_law.mu = 0.3;
  s.body = add(s.model, fixed_body("ball", add(s.model, prepare(dilate(make_sphere(0.1, 3), kRadius)))));
  add(s.model, RigidBody{.name = "floor",
                         .shape = add(s.model, prepare(dilate(make_plate(1, 1), kRadius))),
                         .g_bs = translation(0, 0, -0.12),
                         .motion = FixedMotion{}});
  add_sheet(s.model, make_plate(0.6, 0.6, 16, 16),
            {.name = "cloth",
             .material = {.young = 2e5, .poisson = 0.3, .density = 600},
             .thickness = 1e-3,
             .place = translation(0.02, 0.01, 0.11),
             .radius = kRadius,
             .touches_itself = true});
  s.state = rest_state(s.model);
  return s;
}

}  // namespace aussois
