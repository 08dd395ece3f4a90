// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/toys.hpp"

#include <cmath>

#include "geometry/primitives.hpp"

namespace aussois {
namespace {

RigidBody ball(const char* name, ShapeId shape, double mass, double radius) {
  return {
      .name = name, .shape = shape, .mass = mass, .inertia = 0.4 * mass * radius * radius * Mat3::Identity()};
}

CaseScene frictionless(double restitution) {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law = {.mu = 0, .restitution = restitution};
  return s;
}

BodyId add_paper(Model& model) {
  const auto sheet = add(model, prepare(dilate(make_plate(kPaperSide, kPaperSide), kPaperHalfThickness)));
  const double J = kPaperMass * kPaperSide * kPaperSide / 12;
  return add(
      model,
      RigidBody{
          .name = "paper", .shape = sheet, .mass = kPaperMass, .inertia = Vec3(J, J, 2 * J).asDiagonal()});
}

constexpr double kPlateDilation = 1e-2;  // of the plate that tops and dimers stand on; its face is z = 0 [m]
constexpr double kTouching = 1e-14;      // overlap of what touches at the start [m]

CaseScene on_plate(const ContactLaw& law) {
  CaseScene s;
  s.model.contact_law = law;
  RigidBody plate = fixed_body("plate", add(s.model, prepare(dilate(make_plate(20, 20), kPlateDilation))));
  plate.g_bs = translation(0, 0, -kPlateDilation);
  add(s.model, plate);
  return s;
}

/// The gap of a body's point at `arm` from its centre of mass (world) above z = 0, with friction in space.
GapRows rows_above_plate(const State& state, BodyId body, const Vec3& arm, double gap) {
  const Mat3 R = pose(state, body).R.toRotationMatrix();
  Eigen::Matrix<double, 3, 6> J;
  J << Mat3::Identity(), -skew(arm) * R;
  GapRows out{.gap = gap, .J = MatX::Zero(3, state.v.size())};
  for (int row = 0; row < 3; ++row)  // the normal z first, then x and y
    out.J.row(row).segment<6>(first_velocity(body)) = J.row((row + 2) % 3);
  return out;
}

}  // namespace

CaseScene bullet_and_paper(double restitution, double gap) {
  CaseScene s = frictionless(restitution);
  add_paper(s.model);
  const auto point = add(s.model, prepare(dilate(make_point(), kBulletRadius)));
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
  const auto sheet = add(s.model, prepare(dilate(make_plate(kPaperSide, kPaperSide), kPaperHalfThickness)));
  const auto needle = add(s.model, prepare(dilate(make_segment(kLength - 2 * kThickness), kThickness)));
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
  const auto point = add(s.model, prepare(dilate(make_point(), kBulletRadius)));
  add(s.model, ball("bullet", point, kBulletMass, kBulletRadius));
  s.body = add(s.model, ball("other bullet", point, kBulletMass, kBulletRadius));
  s.state = rest_state(s.model);
  pose(s.state, s.body).p = Vec3(2 * kBulletRadius + miss, 0, distance);
  twist(s.state, 0)[2] = kBulletSpeed;
  twist(s.state, s.body)[2] = -kBulletSpeed;
  return s;
}

CaseScene tippe_top(double contensou_radius) {
  constexpr double kTilt = 0.1, kSpin = 180;
  const TippeTop top;
  CaseScene s = on_plate({.mu = top.mu, .contensou_radius = contensou_radius});
  const auto sphere = add(s.model, prepare(dilate(make_point(), top.R1)));
  s.body = add(s.model, RigidBody{.name = "top",
                                  .shape = sphere,
                                  .g_bs = translation(0, 0, top.a1),
                                  .mass = top.mass,
                                  .inertia = Vec3(top.I1, top.I1, top.I3).asDiagonal()});
  add(s.model, GapFunction{.name = "stem",
                           .evaluate =
                               [top, body = s.body](const Model&, const State& state, double) {
                                 const SE3& g = pose(state, body);
                                 const Vec3 centre = g.R * Vec3(0, 0, top.a2);
                                 return rows_above_plate(state, body, centre - Vec3(0, 0, top.R2),
                                                         g.p.z() + centre.z() - top.R2);
                               },
                           .law = {.mu = top.mu}});
  s.state = rest_state(s.model);
  pose(s.state, s.body).R = rotation(Vec3::UnitY(), kTilt).R;
  pose(s.state, s.body).p.z() = top.R1 - top.a1 * std::cos(kTilt) - kTouching;
  twist(s.state, s.body)[5] = kSpin;
  return s;
}

Vec3 lowest_point(const Rattleback& r, const Vec3& up) {
  const Vec3 scaled = r.semi_axes.cwiseProduct(up);
  return Vec3(0, 0, r.below) - r.semi_axes.cwiseProduct(scaled) / scaled.norm();
}

CaseScene rattleback(double spin) {
  constexpr double kTilt = 0.5 * kPi / 180;
  const Rattleback r;
  CaseScene s;
  s.body = add(s.model, RigidBody{.name = "rattleback", .mass = r.mass, .inertia = r.inertia});
  add(s.model, GapFunction{.name = "ellipsoid on plane",
                           .evaluate =
                               [r, body = s.body](const Model&, const State& state, double) {
                                 const SE3& g = pose(state, body);
                                 const Vec3 arm = g.R * lowest_point(r, g.R.conjugate() * Vec3::UnitZ());
                                 return rows_above_plate(state, body, arm, g.p.z() + arm.z());
                               },
                           .law = {.mu = r.mu}});
  s.state = rest_state(s.model);
  SE3& g = pose(s.state, s.body);
  g.R = (rotation(Vec3::UnitX(), kTilt) * rotation(Vec3::UnitY(), kTilt)).R;
  const Vec3 omega(0, 0, spin), arm = lowest_point(r, g.R.conjugate() * Vec3::UnitZ());
  g.p.z() = -(g.R * arm).z() - kTouching;
  twist(s.state, s.body) << g.R * arm.cross(omega), omega;  // the lowest point rests
  return s;
}

namespace {

/// From the centre of a disc to the lowest point of its rim (world): down along the disc, not along its axis.
Vec3 to_rim(const SE3& g, double radius) {
  const Vec3 axis = g.R * Vec3::UnitZ();
  return radius * (axis.z() * axis - Vec3::UnitZ()).normalized();
}

}  // namespace

CaseScene euler_disc(const EulerDisc& disc) {
  CaseScene s;
  const double across = disc.mass * disc.radius * disc.radius / 4;
  s.body = add(
      s.model,
      RigidBody{.name = "disc", .mass = disc.mass, .inertia = Vec3(across, across, 2 * across).asDiagonal()});
  add(s.model, GapFunction{.name = "rim on plane",
                           .evaluate =
                               [a = disc.radius, body = s.body](const Model&, const State& state, double) {
                                 const SE3& g = pose(state, body);
                                 const Vec3 arm = to_rim(g, a);
                                 return rows_above_plate(state, body, arm, g.p.z() + arm.z());
                               },
                           .law = {.mu = disc.mu}});
  if (disc.contour != 0 || disc.pivot != 0)
    s.model.forces.push_back(
        {.name = "losses",
         .add_to = [disc, body = s.body](const Model&, const State& state, double, GeneralisedForce& force) {
           const Mat3 R = pose(state, body).R.toRotationMatrix();
           const Vec3 axis = R.col(2), up = Vec3::UnitZ();
           const double round = (R * twist(state, body).tail<3>()).dot(up);
           // no moment about the vertical, `contour` about the axis (TOY-16)
           const Vec3 rolling = disc.contour / (1 - axis.z() * axis.z()) * (axis - axis.z() * up);
           const Vec3 moment = rolling - std::copysign(disc.pivot, round) * up;
           angular_part(force.f, body) += R.transpose() * moment;
         }});
  s.state = rest_state(s.model);
  SE3& g = pose(s.state, s.body);
  g.R = rotation(Vec3::UnitX(), disc.tilt).R;
  g.p.z() = disc.radius * std::sin(disc.tilt) - kTouching;
  const double W = std::sqrt(4 * kGravity / (disc.radius * std::sin(disc.tilt)));
  twist(s.state, s.body)[4] = W * std::sin(disc.tilt);  // about the diameter that ends at the contact
  return s;
}

double precession(const CaseScene& s, const State& state) {
  const Mat3 R = pose(state, s.body).R.toRotationMatrix();
  const Vec3 axis = R.col(2), omega = R * twist(state, s.body).tail<3>();
  return omega.cross(axis).dot(Vec3::UnitZ().cross(axis)) / axis.head<2>().squaredNorm();
}

namespace {

BodyId add_dimer(Model& model) {
  const Dimer d;
  const ShapeId shape =
      add(model, prepare(dilate(make_complex({Vec3(-d.half, 0, 0), Vec3(d.half, 0, 0)}, {}), d.radius)));
  const double own = 0.4 * d.radius * d.radius, far = d.half * d.half + own;
  return add(model, RigidBody{.name = "dimer",
                              .shape = shape,
                              .mass = d.mass,
                              .inertia = (d.mass * Vec3(own, far, far)).asDiagonal()});
}

}  // namespace

CaseScene dimer_drop() {
  const Dimer d;
  CaseScene s = on_plate({.mu = d.mu, .restitution = d.restitution});
  s.body = add_dimer(s.model);
  s.state = rest_state(s.model);
  pose(s.state, s.body) = {rotation(Vec3::UnitY(), -0.3).R, {0, 0, 0.02}};
  return s;
}

CaseScene dimer_on_vibrating_plate(double acceleration, double t_end) {
  constexpr double kRow = 1e-4;  // a chord is off by 1e-8 m at 1 g [s]
  const double W = 2 * kPi * 25, A = acceleration / (W * W);
  const Dimer d;
  CaseScene s = on_plate({.mu = d.mu, .restitution = d.restitution});
  Trajectory path;
  for (int k = 0; (k - 1) * kRow < t_end; ++k) {
    path.t.push_back(k * kRow);
    path.pose.push_back(translation(0, 0, A * std::sin(W * k * kRow)));
  }
  s.model.bodies[0].motion = PrescribedMotion{path};
  s.body = add_dimer(s.model);
  s.state = rest_state(s.model);
  pose(s.state, s.body).p.z() = 2.66e-3;
  twist(s.state, s.body)[4] = -5;
  return s;
}

Vec3 dimer_pose(const CaseScene& s, const State& state) {
  const SE3& g = pose(state, s.body);
  const Vec3 along = g.R * Vec3::UnitX();
  return {g.p.x(), g.p.z(), std::atan2(along.z(), along.x())};
}

CaseScene dimer_and_rod(double x, double height, double speed) {
  constexpr double kMass = 0.05;
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law = {.mu = 0.3, .restitution = 0};
  const auto balls =
      add(s.model,
          prepare(dilate(make_complex({Vec3(-kBallPlace, 0, 0), Vec3(kBallPlace, 0, 0)}, {}), kBallRadius)));
  const auto bar = add(s.model, prepare(dilate(make_segment(2 * kBallPlace), kBarRadius)));
  const auto rod = add(s.model, prepare(dilate(make_segment(kPushedRodLength), kPushedRodRadius)));
  add(s.model, fixed_body("balls", balls));
  add(s.model, fixed_body("bar", bar));
  const double J = kMass * kPushedRodLength * kPushedRodLength / 12;
  s.body =
      add(s.model,
          RigidBody{.name = "rod",
                    .shape = rod,
                    .mass = kMass,
                    .inertia = Vec3(kMass * kPushedRodRadius * kPushedRodRadius / 2, J, J).asDiagonal()});
  s.state = rest_state(s.model);
  pose(s.state, s.body) = {rotation(Vec3::UnitY(), kPi / 2).R,
                           {x, 0, kBarRadius + height + kPushedRodRadius + kPushedRodLength / 2}};
  twist(s.state, s.body)[2] = -speed;
  return s;
}

double axis_angle(const CaseScene& s, const State& state) {
  const Vec3 axis = pose(state, s.body).R * Vec3::UnitZ();
  return std::atan2(axis.head<2>().norm(), axis.z());
}

double stem_gap(const CaseScene& s, const State& state) {
  return s.model.gaps[0].evaluate(s.model, state, state.t).gap;
}

double jellett(const CaseScene& s, const State& state) {
  const TippeTop top;
  const SE3& g = pose(state, s.body);
  const Vec3 L = s.model.bodies[s.body].inertia * twist(state, s.body).tail<3>();
  return (g.R * L).dot(Vec3(0, 0, top.R1) - g.R * Vec3(0, 0, top.a1));
}

}  // namespace aussois
