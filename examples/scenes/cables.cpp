// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/cables.hpp"

#include <cmath>

#include "examples/scenes/beams.hpp"
#include "geometry/mass_properties.hpp"
#include "geometry/primitives.hpp"
#include "mechanics/cable.hpp"

namespace aussois {

CaseScene cable_on_peg() {
  constexpr double kRadius = 3e-3;
  CaseScene s;
  s.model.contact_law.mu = 0.4;
  const SimplicialComplex peg =
      transformed_complex(make_cylinder(0.03, 0.1, 48), rotation(Vec3::UnitX(), kPi / 2));
  add(s.model, fixed_body("peg", add(s.model, prepare(dilate(peg, 1e-3)))));
  const Cable cable = add_cable(
      s.model,
      {.nodes = frames_along(points_along({{-0.19, 0, 0.05}, {0.21, 0, 0.05}}, 41)),
       .section = beam_section(
           {.radius = kRadius, .young = 5e6, .poisson = 0.45, .density = 1200, .damping_time = 1e-2}),
       .radius = kRadius});
  s.state = rest_state(s.model);
  lay(cable, s.state);
  s.body = cable.nodes.back();
  return s;
}

CaseScene ball_on_rope() {
  constexpr double kRadius = 5e-3, kHalf = 0.6;
  CaseScene s;
  s.model.contact_law.mu = 0.3;
  const SimplicialComplex sphere = make_sphere(0.049, 2);
  const ShapeId shape = add(s.model, prepare(dilate(sphere, 1e-3)));
  s.body = add(s.model, solid_body("ball", shape, mass_properties(sphere, 900)));
  const Cable rope =
      add_cable(s.model, {.name = "rope",
                          .nodes = frames_along(points_along({{-kHalf, 0, 0}, {kHalf, 0, 0}}, 41)),
                          .section = beam_section({.radius = kRadius,
                                                   .young = 2e7,
                                                   .density = 1000,
                                                   .bending_stiffness = 2e-4,
                                                   .damping_time = 1e-2}),
                          .radius = kRadius});
  for (const BodyId end : {rope.nodes.front(), rope.nodes.back()}) s.model.bodies[end].motion = FixedMotion{};
  s.state = rest_state(s.model);
  lay(rope, s.state);
  pose(s.state, s.body).p = {0.05, 0, 0.15};
  return s;
}

CaseScene rope_coil() {
  constexpr double kRadius = 4e-3, kLength = 1;
  CaseScene s;
  s.model.contact_law.mu = 0.4;
  add(s.model, fixed_body("floor", add(s.model, prepare(dilate(make_plate(1, 1), 1e-3)))));
  const Cable rope = add_cable(
      s.model, {.name = "rope",
                .nodes = frames_along(points_along(
                    {{0, 0, 0.01 + kLength}, {0.002, 0.001, 0.01 + kLength / 2}, {0, 0, 0.01}}, 101)),
                .section = beam_section({.radius = kRadius,
                                         .young = 5e6,
                                         .density = 1100,
                                         .bending_stiffness = 4e-4,
                                         .damping_time = 2e-2}),
                .radius = kRadius,
                .touches_itself = true});
  s.state = rest_state(s.model);
  lay(rope, s.state);
  for (const BodyId node : rope.nodes) linear_part(s.state.v, node).z() = -0.3;
  s.body = rope.nodes.front();
  return s;
}

CaseScene knot() {
  constexpr double kRadius = 4e-3, kSize = 0.035;
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law.mu = 0.2;
  std::vector<Vec3> points;  // a trefoil cut open at the top of a lobe, with straight ends
  for (int i = 0; i <= 240; ++i) {
    const double t = kPi / 3 + 0.35 + (2 * kPi - 0.7) * i / 240;
    points.emplace_back(kSize * (std::sin(t) + 2 * std::sin(2 * t)) / 2,
                        kSize * (std::cos(t) - 2 * std::cos(2 * t)) / 2, -kSize / 2 * std::sin(3 * t));
  }
  const auto level = [](const Vec3& d) { return Vec3(d.x(), d.y(), 0).normalized(); };
  const Vec3 first = level(points[0] - points[1]), last = level(points[240] - points[239]);
  points.insert(points.begin(), points[0] + 0.12 * first);
  points.push_back(points.back() + 0.12 * last);
  const Cable rope = add_cable(s.model, {.name = "rope",
                                         .nodes = frames_along(points_along(points, 121)),
                                         .section = beam_section({.radius = kRadius,
                                                                  .young = 5e6,
                                                                  .density = 1100,
                                                                  .bending_stiffness = 2e-4,
                                                                  .damping_time = 5e-2}),
                                         .radius = kRadius,
                                         .touches_itself = true,
                                         .straight = true});
  for (const BodyId end : {rope.nodes.front(), rope.nodes.back()})
    s.model.bodies[end].motion = DrivenMotion{};
  s.state = rest_state(s.model);
  lay(rope, s.state);
  linear_part(s.state.v, rope.nodes.front()) = 0.05 * first;
  linear_part(s.state.v, rope.nodes.back()) = 0.05 * last;
  s.body = rope.nodes[rope.nodes.size() / 2];
  return s;
}

RopeOnPeg::RopeOnPeg() {
  constexpr double kTail = 0.05, kDilation = 1e-3, kDistance = kPeg + kDilation + kRope;
  model.gravity = Vec3::Zero();
  model.contact_law.mu = kMu;
  add(model, fixed_body("peg", add(model, prepare(dilate(make_cylinder(kPeg, 0.1, 96), kDilation)))));
  std::vector<Vec3> line{{kDistance, -kTail, 0}};
  for (int i = 0; i <= 4000; ++i)
    line.push_back(kDistance * Vec3(std::cos(kPi * i / 4000), std::sin(kPi * i / 4000), 0));
  line.emplace_back(-kDistance, -kTail, 0);
  const std::vector<Vec3> x = points_along(line, 121);
  std::vector<Vec3> loose;  // so that it is laid under a tension of 1 N
  for (const Vec3& p : x) loose.push_back((1 - 1 / kStiffness) * p);
  BeamSection section = section_of({.EA = kStiffness,
                                    .GA = kStiffness,
                                    .GJ = 1e-5,
                                    .EI = 1e-5,
                                    .mass = 1e-3,
                                    .about_x = 1e-8,
                                    .across = 1e-8});
  section.damping = 1e-2 * section.stiffness;
  rope =
      add_cable(model, {.name = "rope", .nodes = frames_along(loose), .section = section, .radius = kRope});
  model.bodies[rope.nodes.back()].motion = DrivenMotion{};
  add(model, DeadLoad{.body = rope.nodes.front(), .force = -Vec3::UnitY()});
  state = rest_state(model);
  lay(rope, state);
  for (std::size_t i = 0; i < x.size(); ++i) pose(state, rope.nodes[i]).p = x[i];
  linear_part(state.v, rope.nodes.back()) = -kSpeed * Vec3::UnitY();
}

CaseScene capstan() {
  RopeOnPeg s;
  return {.model = std::move(s.model), .state = std::move(s.state), .body = s.rope.nodes.back()};
}

CableInClips::CableInClips() {
  constexpr int kElements = 60, kSides = 16;
  model.gravity = Vec3::Zero();
  model.contact_law.mu = 0.3;
  clips = {{0.06, 0.012, 0}, {0.14, -0.012, 0}, {0.22, 0.012, 0}};
  std::vector<Vec3> circle;
  std::vector<std::array<int, 2>> wires;
  for (int i = 0; i < kSides; ++i) {
    const double a = 2 * kPi * i / kSides;
    circle.emplace_back(0, kRing * std::cos(a), kRing * std::sin(a));
    wires.push_back({i, (i + 1) % kSides});
  }
  const ShapeId ring = add(model, prepare(dilate(make_complex(circle, {}, wires), kWire)));
  for (const Vec3& at : clips) {
    RigidBody clip = fixed_body("clip", ring);
    clip.g_bs = translation(at.x(), at.y(), at.z());
    add(model, clip);
  }
  std::vector<Vec3> line{{-0.3, 0, 0}, {0, 0, 0}};
  line.insert(line.end(), clips.begin(), clips.end());
  line.insert(line.end(), {{0.28, 0, 0}, {0.3, 0, 0}});
  cable = add_cable(
      model, {.nodes = frames_along(points_along(line, kElements + 1)),
              .section = beam_section(
                  {.radius = kRadius, .young = 5e6, .poisson = 0.45, .density = 1200, .damping_time = 1e-2}),
              .radius = kRadius,
              .straight = true});
  model.bodies[cable.nodes.back()].motion = DrivenMotion{};
  state = rest_state(model);
  lay(cable, state);
  linear_part(state.v, cable.nodes.back()).x() = 0.2;
}

CaseScene cable_in_clips() {
  CableInClips s;
  return {.model = std::move(s.model), .state = std::move(s.state), .body = s.cable.nodes.front()};
}

}  // namespace aussois
