// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/pressed_peg.hpp"

#include "examples/studies/peg_plate/peg.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr int kPeg = 0, kSides = 32;
constexpr double kPegDilation = 1e-4;  // of peg and plate [m]

}  // namespace

CaseScene pressed_peg() {
  const Peg peg;
  CaseScene out{.body = kPeg};
  Model& model = out.model;
  model.gravity = {0, 0, -kPegGravity};
  model.contact_law = {.mu = 0.15};
  const SimplicialComplex core =
      make_cylinder(peg.radius - kPegDilation, 2 * (peg.half_length - kPegDilation), kSides);
  const ShapeId shape = add(model, prepare(dilate(core, kPegDilation)));
  const auto plate = add(model, prepare(dilate(make_plate(0.2, 0.2), kPegDilation)));
  add(model, RigidBody{.name = "peg", .shape = shape, .mass = peg.mass, .inertia = peg.inertia.asDiagonal()});
  add(model, fixed_body("plate", plate));
  add(model, ForceLaw{.name = "robot", .add_to = [](const Model&, const State&, double, GeneralisedForce& f) {
                        const Vec3 force(1, 0, -20), at(4e-3, -3e-3, Peg().flange);
                        linear_part(f.f, kPeg) += force;
                        angular_part(f.f, kPeg) += at.cross(force);  // the peg stays upright
                      }});
  out.state = rest_state(model);
  pose(out.state, 1).p.z() = -kPegDilation;
  pose(out.state, kPeg).p.z() = peg.half_length;
  return out;
}

}  // namespace aussois
