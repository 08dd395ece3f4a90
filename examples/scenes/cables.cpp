// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/cables.hpp"

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

}  // namespace aussois
