// SPDX-License-Identifier: Apache-2.0
// B8: Euler's disc, against its steady motion, the equations of rolling without slip with its losses, and the
// laws of its descent.
#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "examples/scenes/toys.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kGravity = 9.81, kTilt = 0.1;
const double kPrecession = std::sqrt(4 * kGravity / (EulerDisc{}.radius * std::sin(kTilt)));  // 102.38 rad/s
const double kTurn = 2 * kPi / kPrecession;

// Contacts in the middle of the step and the law of the mean velocity: no slip works nothing (MJ-10).
constexpr NormalLawOptions kMean{.law = NormalLaw::gap_over_step, .gamma = 0.5};

SchemeOptions options(double h, const NormalLawOptions& normal = {.law = NormalLaw::combined}) {
  return {.h = h,
          .theta = 0.5,
          .contacts = ContactsAt::midpoint,
          .normal = normal,
          .solver = {.tolerance = 1e-12}};
}

/// Largest relative changes, and the way of the centre [m].
struct Changes {
  double tilt = 0, precession = 0, energy = 0, way = 0;
};
Changes changes(const CaseScene& s, const std::string& name, const SchemeOptions& o, double t_end) {
  const double W = precession(s, s.state), E = energy(s.model, s.state).total(),
               tilt = axis_angle(s, s.state);
  Changes out;
  run_scene(s, name, o, t_end, [&](const State& state, const StepReport&) {
    out.tilt = std::max(out.tilt, std::abs(axis_angle(s, state) / tilt - 1));
    out.precession = std::max(out.precession, std::abs(precession(s, state) / W - 1));
    out.energy = std::max(out.energy, std::abs(energy(s.model, state).total() / E - 1));
    out.way = std::max(out.way, pose(state, s.body).p.head<2>().norm());
  });
  return out;
}

// (TOY-14), (TOY-15) of the scene itself.
TEST(EulerDisc, StartsInItsSteadyMotion) {
  const EulerDisc disc;
  const CaseScene s = euler_disc(disc);
  const double a = disc.radius, weight = disc.mass * kGravity;
  EXPECT_NEAR(kPrecession, 102.38, 5e-3);
  EXPECT_NEAR(precession(s, s.state), kPrecession, 1e-11);
  EXPECT_NEAR(energy(s.model, s.state).total(), 1.5 * weight * a * std::sin(kTilt), 1e-13);
  const Vec3 omega = pose(s.state, s.body).R * Vec3(twist(s.state, s.body).tail<3>());
  EXPECT_NEAR(omega.z(), kPrecession * std::pow(std::sin(kTilt), 2), 1e-12);
  EXPECT_LT(s.model.gaps[0].evaluate(s.model, s.state, 0).gap, 1e-13);
  EXPECT_LT((s.model.gaps[0].evaluate(s.model, s.state, 0).J * s.state.v).norm(), 1e-13);  // it rolls
}

TEST(EulerDisc, RollsTenTurnsToSecondOrderWithTheLawOfTheMeanVelocity) {
  const CaseScene s = euler_disc({});
  const Changes coarse = changes(s, "moreau_jean", options(2e-4, kMean), 10 * kTurn),
                fine = changes(s, "moreau_jean", options(5e-5, kMean), 10 * kTurn);
  EXPECT_LT(fine.tilt, 6e-6);
  EXPECT_LT(fine.precession, 1.1e-5);
  EXPECT_LT(fine.energy, 3e-6);
  EXPECT_LT(fine.way, 1.1e-8);
  EXPECT_NEAR(std::log(coarse.tilt / fine.tilt) / std::log(4), 2, 0.3);
  EXPECT_NEAR(std::log(coarse.precession / fine.precession) / std::log(4), 2, 0.15);
}

class EverySchemeAndDisc : public ::testing::TestWithParam<std::string> {};

// Laws of the last velocity, with the arms of another time, are of order one here as for the rattleback.
TEST_P(EverySchemeAndDisc, RollsTenTurns) {
  const CaseScene s = euler_disc({});
  if (GetParam() == "event_driven") {
    const Changes exact = changes(s, "event_driven", options(1e-2), 10 * kTurn);
    EXPECT_LT(std::max({exact.tilt, exact.precession, exact.energy}), 2e-6);
    return;
  }
  const Changes coarse = changes(s, GetParam(), options(1e-4), 10 * kTurn),
                fine = changes(s, GetParam(), options(5e-5), 10 * kTurn);
  const double bound = GetParam() == "d1_minus_linear"                                  ? 0.23
                       : GetParam() == "passive_midpoint"                               ? 0.11
                       : GetParam() == "moreau_jean" || GetParam() == "schatzman_paoli" ? 2.1e-3
                                                                                        : 0.065;
  EXPECT_LT(fine.tilt, bound);
  EXPECT_LT(fine.precession, std::max(bound / 2, 4.2e-3));
  EXPECT_LT(fine.way, 1e-4);
  EXPECT_NEAR(std::log2(coarse.tilt / fine.tilt), 1, 0.12);
}
INSTANTIATE_TEST_SUITE_P(Schemes, EverySchemeAndDisc, ::testing::ValuesIn(scheme_names()),
                         [](const auto& name) { return name.param; });

// Rolling without slip, of gamma (up) and omega in the body: (TOY-11) and (TOY-12) with the moments of the
// losses (TOY-16). That the first of them loses what its power says is checked below.
VecX rolling(const EulerDisc& disc, const VecX& y) {
  const Vec3 up = y.head<3>(), omega = y.tail<3>(), up_rate = up.cross(omega), axis = Vec3::UnitZ();
  const double a = disc.radius, m = disc.mass, level = up.head<2>().norm();
  const Vec3 flat(up.x(), up.y(), 0), flat_rate(up_rate.x(), up_rate.y(), 0);
  const Vec3 rho = -a / level * flat,
             rho_rate = -a / level * (flat_rate - flat * flat.dot(flat_rate) / (level * level));
  const Mat3 I = (m * a * a / 4 * Vec3(1, 1, 2)).asDiagonal(), S = skew(rho);
  const Vec3 contour = disc.contour / (level * level) * (axis - up.z() * up);
  const Vec3 moment = -omega.cross(I * omega) +
                      m * rho.cross(rho_rate.cross(omega) + omega.cross(rho.cross(omega))) +
                      m * kGravity * rho.cross(up) + contour - std::copysign(disc.pivot, omega.dot(up)) * up;
  VecX rate(6);
  rate << up_rate, (I - m * S * S).inverse() * moment;
  return rate;
}
std::function<VecX(double)> exact(const EulerDisc& disc, double t_end) {
  const CaseScene s = euler_disc(disc);
  VecX y(6);
  y << pose(s.state, s.body).R.conjugate() * Vec3::UnitZ(), twist(s.state, s.body).tail<3>();
  return ode_solution([disc](double, const VecX& now) { return rolling(disc, now); }, y, t_end, 1e-4);
}
double tilt_of(const VecX& y) {
  return std::atan2(y.head<2>().norm(), y[2]);
}

/// Followed by a scheme: largest difference of the tilt from the equations [rad].
double off_equations(const EulerDisc& disc, const std::string& name, const SchemeOptions& o, double t_end) {
  const auto y = exact(disc, t_end);
  const CaseScene s = euler_disc(disc);
  double worst = 0;
  const State end = run_scene(s, name, o, t_end, [&](const State& state, const StepReport&) {
    worst = std::max(worst, std::abs(axis_angle(s, state) - tilt_of(y(std::min(state.t, t_end)))));
  });
  EXPECT_NEAR(end.t, t_end, 1e-9);
  return worst;
}

// alpha^(3/2) falls straight to zero (TOY-17): all of it would take 1.977 s. What the law leaves out is the
// nutation with which it starts, and higher powers of the tilt.
constexpr EulerDisc kContour{.contour = 8e-5}, kPivot{.pivot = 3e-4};

TEST(EulerDisc, DescendsInFiniteTimeByContourFriction) {
  const EulerDisc& d = kContour;
  const double q = std::sqrt(kGravity / d.radius), weight = d.mass * kGravity * d.radius;
  const auto y = exact(d, 1.8);
  for (const double t : {0.3, 0.6, 0.9, 1.2, 1.5, 1.8}) {
    const double law = std::pow(std::pow(kTilt, 1.5) - 2 * d.contour * q / weight * t, 2.0 / 3);
    EXPECT_NEAR(tilt_of(y(t)), law, 0.01 * law) << t;
  }
  EXPECT_LT(tilt_of(y(1.8)), 0.022);
  EXPECT_LT(off_equations(d, "event_driven", options(1e-2), 1.5), 1e-6);
  const double coarse = off_equations(d, "moreau_jean", options(2e-4, kMean), 1.5),
               fine = off_equations(d, "moreau_jean", options(1e-4, kMean), 1.5);
  EXPECT_LT(fine, 2e-5);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

// A moment about the vertical is one about the axis, nearly: before it takes any height it spins the disc up
// (TOY-19), its centre leaves its place, and the law (TOY-18) of a centre at rest does not hold.
TEST(EulerDisc, IsSpunAboutItsAxisByAPivotTorque) {
  const EulerDisc& d = kPivot;
  const double t = 1, q = std::sqrt(kGravity / d.radius), weight = d.mass * kGravity * d.radius;
  const double law = std::pow(std::pow(kTilt, -0.5) + 2 * d.pivot * q / (3 * weight) * t, -2);
  const VecX y = exact(d, t)(t);
  const double spin = -2 * d.pivot * t / (3 * d.mass * d.radius * d.radius);
  EXPECT_NEAR(y[5], spin, 0.05 * std::abs(spin));
  EXPECT_NEAR((kTilt - tilt_of(y)) / (kTilt - law), 0.506, 0.01);  // of what the law says
  EXPECT_LT(off_equations(d, "event_driven", options(1e-2), t), 1e-6);
  EXPECT_LT(off_equations(d, "moreau_jean", options(1e-4, kMean), t), 2e-5);
}

// The equations lose what the power of the contour's moment takes: c times the speed of the contact along the
// rim, in radii.
TEST(EulerDisc, LosesThePowerOfItsContourMoment) {
  const auto y = exact(kContour, 1);
  const auto energy_at = [&](double t) {
    const VecX now = y(t);
    const Vec3 up = now.head<3>(), omega = now.tail<3>(),
               rho = -kContour.radius * Vec3(up.x(), up.y(), 0).normalized();
    const double I = kContour.mass * std::pow(kContour.radius, 2) / 4;
    return 0.5 * I * (omega.squaredNorm() + omega.z() * omega.z()) +
           0.5 * kContour.mass * rho.cross(omega).squaredNorm() +
           kContour.mass * kGravity * kContour.radius * up.head<2>().norm();
  };
  double along = 0;  // of the contact along the rim [rad], by its angle in the body
  double before = std::atan2(y(0)[1], y(0)[0]);
  for (int k = 1; k <= 10000; ++k) {
    const VecX now = y(1e-4 * k);
    const double angle = std::atan2(now[1], now[0]);
    along += std::remainder(angle - before, 2 * kPi);
    before = angle;
  }
  EXPECT_GT(std::abs(along), 100);
  EXPECT_NEAR(energy_at(0) - energy_at(1), kContour.contour * std::abs(along), 1e-9);
}

// A rim of edges is struck at each of its corners: what a mesh of a wheel loses in one turn has no other
// cause. Finer steps do not help, more corners do.
double lost_in_a_turn(int corners, double h, const char* scheme = "moreau_jean") {
  constexpr double kRound = 1e-3, kPlate = 1e-2;
  const EulerDisc disc;
  const CaseScene smooth = euler_disc(disc);
  CaseScene s;
  s.model.contact_law = {.mu = disc.mu};
  RigidBody plate = fixed_body("plate", add(s.model, prepare(dilate(make_plate(1, 1), kPlate))));
  plate.g_bs = translation(0, 0, -kPlate - kRound);
  add(s.model, plate);
  std::vector<Vec3> rim;
  for (int k = 0; k < corners; ++k)
    rim.push_back(rotation(Vec3::UnitZ(), 2 * kPi * k / corners) * Vec3(0, -disc.radius, 0));
  RigidBody body = smooth.model.bodies[std::size_t(smooth.body)];
  body.shape = add(s.model, prepare(dilate(make_complex(rim, {}), kRound)));
  s.body = add(s.model, body);
  s.state = rest_state(s.model);
  pose(s.state, s.body) = pose(smooth.state, smooth.body);
  twist(s.state, s.body) = twist(smooth.state, smooth.body);
  return changes(s, scheme, options(h), kTurn).energy;
}

// As the reference that finds every impact says, to the order of the scheme.
TEST(EulerDisc, LosesItsEnergyAtTheCornersOfAPolygon) {
  for (const int corners : {32, 128}) {
    const double reference = lost_in_a_turn(corners, 1e-2, "event_driven"),
                 coarse = std::abs(lost_in_a_turn(corners, 1e-4) - reference),
                 fine = std::abs(lost_in_a_turn(corners, 2.5e-5) - reference);
    EXPECT_GT(reference, 8. / corners);
    EXPECT_LT(fine, 0.02 * reference) << corners;
    EXPECT_GT(std::log2(coarse / fine) / 2, 0.8) << corners;
  }
  EXPECT_LT(changes(euler_disc({}), "moreau_jean", options(1e-4), kTurn).energy, 1e-3);  // the circle
}

}  // namespace
}  // namespace aussois
