// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/soft_parts.hpp"

#include <cmath>

#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr double kSnapRadius = 1e-5;  // of both parts of the snap-fit [m]

// Its ramp rises along x, then it is flat, then it ends.
SimplicialComplex catch_of_snap_fit() {
  std::vector<Vec3> corners;
  for (const double z : {-SnapFit::kWide, SnapFit::kWide})
    for (const auto& [x, y] : {std::pair(0.0, 0.0),
                               {SnapFit::ramp(), SnapFit::kRise},
                               {SnapFit::ramp() + SnapFit::kFlat, SnapFit::kRise},
                               {SnapFit::ramp() + SnapFit::kFlat, 0.0}})
      corners.emplace_back(x, y, z);
  return make_complex(corners, {{0, 2, 1},
                                {0, 3, 2},
                                {4, 5, 6},
                                {4, 6, 7},
                                {0, 1, 5},
                                {0, 5, 4},
                                {1, 2, 6},
                                {1, 6, 5},
                                {2, 3, 7},
                                {2, 7, 6},
                                {3, 0, 4},
                                {3, 4, 7}});
}

}  // namespace

RingBetweenPlates::RingBetweenPlates(double young, double viscosity) {
  constexpr double kRadius = 5e-5;
  model.gravity = Vec3::Zero();
  model.contact_law.mu = 0;
  VolumeMesh mesh = make_cylinder_mesh(kThick / 2 - kRadius, 1, 8, 6, CellKind::hexes);
  for (Vec3& x : mesh.points) {
    const double angle = kPi / 2 * (x.z() + 0.5), out = kDiameter / 2 + x.x();
    x = {out * std::cos(angle), out * std::sin(angle), -x.y()};
  }
  SolidOptions options{
      .materials = {{.young = young, .poisson = 0.49, .density = 1100, .viscosity = viscosity}},
      .radius = kRadius};
  hold(mesh, options, {true, false, false}, [](const Vec3& x) { return x.x() < 1e-9; });
  hold(mesh, options, {false, true, false}, [](const Vec3& x) { return x.y() < 1e-9; });
  ring = add_solid(model, mesh, options);
  const ShapeId plate = add(model, prepare(dilate(make_plate(0.07, 0.07), 0)));
  for (BodyId& b : plates)
    b = add(model, RigidBody{.name = "plate", .shape = plate, .motion = DrivenMotion{}});
  state = rest_state(model);
  for (const std::size_t side : {0u, 1u}) pose(state, plates[side]).p.z() = (side == 0 ? -1 : 1) * kThick / 2;
}

void RingBetweenPlates::press_at(double speed) {
  for (const std::size_t side : {0u, 1u})
    linear_part(state.v, plates[side]).z() = (side == 0 ? 1 : -1) * speed;
}

SnapFit::SnapFit(double speed, double viscosity) {
  model.gravity = Vec3::Zero();
  model.contact_law.mu = kMu;
  VolumeMesh mesh = make_box_mesh({kLength, kHeight, kWide}, {80, 4, 1});
  for (Vec3& x : mesh.points) {
    x.x() += kLength / 2;
    const double deep = std::max(0.0, 1 - std::abs(x.x() - kPeak) / kHalf) * kTooth;
    x.y() -= deep * (0.5 - x.y() / kHeight);
  }
  SolidOptions options{
      .materials = {{.young = kYoung, .poisson = 0, .density = 1200, .viscosity = viscosity}},
      .radius = kSnapRadius};
  hold(mesh, options, {true, true, false}, [](const Vec3& x) { return x.x() < 1e-9; });
  hold(mesh, options, {false, false, true}, [](const Vec3&) { return true; });
  add_solid(model, mesh, options);
  caught = add(model, RigidBody{.name = "catch",
                                .shape = add(model, prepare(dilate(catch_of_snap_fit(), kSnapRadius))),
                                .motion = DrivenMotion{}});
  state = rest_state(model);
  const double ridge = -kHeight / 2 - kTooth - 2 * kSnapRadius;  // where the catch touches it from below
  pose(state, caught).p = {kPeak + 0.1e-3 - (kRise - kLift) / slope(), ridge - kRise + kLift, 0};
  linear_part(state.v, caught).x() = -speed;
}

double SnapFit::slope() {
  return std::tan(kPi / 6);
}
double SnapFit::ramp() {
  return kRise / slope();
}
double SnapFit::passed() const {
  return kPeak - pose(state, caught).p.x();
}

CookMembrane::CookMembrane(int side, CellKind cells, SolidOptions options, double force, double unit_size)
    : unit(unit_size) {
  VolumeMesh mesh = make_box_mesh(Vec3::Ones(), {side, side, 1}, cells);
  for (Vec3& x : mesh.points) {
    const double s = x.x() + 0.5, t = x.y() + 0.5;
    x = unit * Vec3(48 * s, 44 * s + t * (44 - 28 * s), x.z() * 48 / side);
  }
  const double near = 1e-9 * unit, right = 48 * unit;
  hold(mesh, options, {false, false, true}, [](const Vec3&) { return true; });
  hold(mesh, options, {true, true, true}, [=](const Vec3& x) { return x.x() < near; });
  scene = solid_scene(mesh, options);
  load = {.force = force * Vec3::UnitY(), .is_there = [=](const Vec3& x) { return x.x() > right - near; }};
  add(scene.model, scene.solid, load);
}

double CookMembrane::rise() const {
  const std::vector<Vec3> x = solid_places(scene.model, scene.state, scene.solid);
  double sum = 0, count = 0;
  for (const int p : points_where(*scene.solid.mesh, [&](const Vec3& at) {
         return load.is_there(at) && std::abs(at.y() - 52 * unit) < 1e-9 * unit;
       }))
    sum += x[std::size_t(p)].y() - 52 * unit, ++count;
  return sum / count;
}

CaseScene o_ring() {
  constexpr double kTime = 0.5;  // [s]
  RingBetweenPlates s(5e6, 1e3);
  s.press_at(RingBetweenPlates::kThick / 8 / kTime);
  return {.model = std::move(s.model), .state = std::move(s.state), .body = s.plates[1]};
}

CaseScene snap_fit() {
  SnapFit s(60e-3, 2e5);
  return {.model = std::move(s.model), .state = std::move(s.state), .body = s.caught};
}

CaseScene cook_panel() {
  constexpr double kUnit = 0.01, kRadius = 1e-3;
  CookMembrane s(12, CellKind::hexes,
                 {.name = "panel",
                  .materials = {{.young = 250e3, .poisson = 0.49, .density = 1000, .viscosity = 500}},
                  .radius = kRadius},
                 40, kUnit);
  s.scene.model.gravity = Vec3::Zero();
  const ShapeId plate = add(s.scene.model, prepare(dilate(make_plate(1, 1), kRadius)));
  RigidBody floor = fixed_body("floor", plate);
  floor.g_bs = {Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitX())), Vec3(0.24, -0.1, 0)};
  const BodyId body = add(s.scene.model, floor);
  return {.model = s.scene.model, .state = rest_state(s.scene.model), .body = body};
}

CaseScene rubber_ball() {
  constexpr double kRadius = 1e-3, kBall = 0.05;
  CaseScene s;
  s.model.contact_law.mu = 0.5;
  s.body = add(s.model, fixed_body("plate", add(s.model, prepare(dilate(make_plate(0.6, 0.6), kRadius)))));
  add_solid(s.model, make_ball_mesh(kBall, 8, CellKind::hexes),
            {.name = "ball",
             .materials = {{.young = 2e5, .poisson = 0.45, .density = 1000, .viscosity = 50}},
             .place = translation(0, 0, kBall + 2 * kRadius + 0.05),
             .radius = kRadius});
  s.state = rest_state(s.model);
  return s;
}

}  // namespace aussois
