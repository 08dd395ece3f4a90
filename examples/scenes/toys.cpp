// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/toys.hpp"

#include <cmath>

#include "geometry/primitives.hpp"

namespace aussois {
namespace {

RigidBody ball(const char* name, int shape, double mass, double radius) {
  return {
      .name = name, .shape = shape, .mass = mass, .inertia = 0.4 * mass * radius * radius * Mat3::Identity()};
}

CaseScene frictionless(double restitution) {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law = {.mu = 0, .restitution = restitution};
  return s;
}

int add_paper(Model& model) {
  const int sheet = add(model, prepare(dilate(make_plate(kPaperSide, kPaperSide), kPaperHalfThickness)));
  const double J = kPaperMass * kPaperSide * kPaperSide / 12;
  return add(
      model,
      RigidBody{
          .name = "paper", .shape = sheet, .mass = kPaperMass, .inertia = Vec3(J, J, 2 * J).asDiagonal()});
}

}  // namespace

CaseScene bullet_and_paper(double restitution, double gap) {
  CaseScene s = frictionless(restitution);
  add_paper(s.model);
  const int point = add(s.model, prepare(dilate(make_point(), kBulletRadius)));
  s.body = add(s.model, ball("bullet", point, kBulletMass, kBulletRadius));
  s.state = rest_state(s.model);
  pose(s.state, s.body).p.z() = kBulletRadius + kPaperHalfThickness + gap;
  twist(s.state, s.body)[2] = -kBulletSpeed;
  return s;
}

CaseScene bullet_on_edge(double restitution, double gap, double offset) {
  CaseScene s = bullet_and_paper(restitution, gap);
  pose(s.state, 0).R = rotation(Vec3::UnitY(), kPi / 2).R;
  pose(s.state, s.body).p += Vec3(offset, 0, kPaperSide / 2);
  return s;
}

CaseScene needle_and_sheet(double restitution, double angle) {
  constexpr double kLength = 0.1, kThickness = 5e-4, kMass = 1e-3, kTipSpeed = 500, kTooNear = 0.01;
  CaseScene s = frictionless(restitution);
  const int sheet = add(s.model, prepare(dilate(make_plate(kPaperSide, kPaperSide), kPaperHalfThickness)));
  const int needle = add(s.model, prepare(dilate(make_segment(kLength - 2 * kThickness), kThickness)));
  add(s.model, fixed_body("sheet", sheet));
  const double J = kMass * kLength * kLength / 12;
  s.body = add(s.model, RigidBody{.name = "needle",
                                  .shape = needle,
                                  .mass = kMass,
                                  .inertia = Vec3(kMass * kThickness * kThickness / 2, J, J).asDiagonal()});
  s.state = rest_state(s.model);
  pose(s.state, s.body).R = rotation(Vec3::UnitY(), angle).R;
  pose(s.state, s.body).p.z() = kLength / 2 - kTooNear;
  twist(s.state, s.body)[4] = kTipSpeed / (kLength / 2);
  return s;
}

CaseScene crossing_bullets(double miss, double distance) {
  CaseScene s = frictionless(1);
  const int point = add(s.model, prepare(dilate(make_point(), kBulletRadius)));
  add(s.model, ball("bullet", point, kBulletMass, kBulletRadius));
  s.body = add(s.model, ball("other bullet", point, kBulletMass, kBulletRadius));
  s.state = rest_state(s.model);
  pose(s.state, s.body).p = Vec3(2 * kBulletRadius + miss, 0, distance);
  twist(s.state, 0)[2] = kBulletSpeed;
  twist(s.state, s.body)[2] = -kBulletSpeed;
  return s;
}

}  // namespace aussois
