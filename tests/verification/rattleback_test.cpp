// SPDX-License-Identifier: Apache-2.0
// B7: the rattleback turns round, against the equations of rolling without slip, integrated on their own.
#include <cmath>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "examples/scenes/toys.hpp"
#include "integrators/scheme.hpp"

namespace aussois {
namespace {

constexpr double kGravity = 9.81;

// (TOY-11), (TOY-12) in the body: gamma up, omega; rho from the centre of mass to the point that touches.
VecX rolling(const Rattleback& r, const VecX& y) {
  const Vec3 gamma = y.head<3>(), omega = y.tail<3>(), gamma_rate = gamma.cross(omega);
  const Vec3 A2 = r.semi_axes.cwiseProduct(r.semi_axes), rho = lowest_point(r, gamma);
  const double length = r.semi_axes.cwiseProduct(gamma).norm();
  const Vec3 rho_rate = -A2.cwiseProduct(gamma_rate) / length +
                        A2.cwiseProduct(gamma) * gamma.dot(A2.cwiseProduct(gamma_rate)) / std::pow(length, 3);
  const Mat3 S = skew(rho);
  const Vec3 moment = -omega.cross(r.inertia * omega) +
                      r.mass * rho.cross(rho_rate.cross(omega) + omega.cross(rho.cross(omega))) +
                      r.mass * kGravity * rho.cross(gamma);
  VecX rate(6);
  rate << gamma_rate, (r.inertia - r.mass * S * S).inverse() * moment;
  return rate;
}
double energy_of(const Rattleback& r, const VecX& y) {
  const Vec3 gamma = y.head<3>(), omega = y.tail<3>(), rho = lowest_point(r, gamma);
  return 0.5 * r.mass * rho.cross(omega).squaredNorm() + 0.5 * omega.dot(r.inertia * omega) -
         r.mass * kGravity * rho.dot(gamma);
}
double vertical_spin(const VecX& y) {
  return y.head<3>().dot(y.tail<3>());
}

VecX observed(const CaseScene& s, const State& state) {
  VecX y(6);
  y << pose(state, s.body).R.conjugate() * Vec3::UnitZ(), twist(state, s.body).tail<3>();
  return y;
}

std::function<VecX(double)> reference(double spin, double t_end, double stride) {
  const CaseScene s = rattleback(spin);
  return ode_solution([](double, const VecX& y) { return rolling(Rattleback{}, y); }, observed(s, s.state),
                      t_end, stride);
}

/// The first time at which the vertical spin changes its sign, to a millisecond; infinity: not until t_end.
double reversal(const std::function<VecX(double)>& y, double t_end) {
  const double begin = vertical_spin(y(0));
  for (double t = 0; t < t_end; t += 1e-3)
    if (vertical_spin(y(t)) * begin < 0) return t;
  return kInf;
}

struct Followed {
  double worst = 0;         // error of the vertical spin up to compare_until [rad/s]
  double reversal = kInf;   // [s]
  double energy_error = 0;  // at the end, relative to the kinetic energy of the start [-]
};
Followed follow(const std::string& name, double spin, double h, double t_end, double compare_until,
                const std::function<VecX(double)>& exact,
                const NormalLawOptions& normal = {.law = NormalLaw::combined}) {
  const CaseScene s = rattleback(spin);
  const Scheme scheme = make_scheme(name, s.model,
                                    {.h = h,
                                     .theta = 0.5,
                                     .contacts = ContactsAt::midpoint,
                                     .normal = normal,
                                     .solver = {.tolerance = 1e-12}});
  State state = s.state;
  Followed out;
  while (state.t < t_end * (1 - 1e-12)) {
    const StepReport report = scheme.step(state, t_end - state.t);
    EXPECT_TRUE(report.ok()) << name << ": " << report.reason << " at t = " << state.t;
    if (!report.ok()) break;
    const double now = vertical_spin(observed(s, state));
    if (now * spin < 0) out.reversal = std::min(out.reversal, state.t);
    if (state.t < compare_until)
      out.worst = std::max(out.worst, std::abs(now - vertical_spin(exact(state.t))));
  }
  const Energy before = energy(s.model, s.state);
  out.energy_error = std::abs(energy(s.model, state).total() - before.total()) / before.kinetic;
  return out;
}

// The equations themselves: energy to 1e-12, the same at half the stride; started against its skew inertia it
// soon turns round, with it late. Without loss both senses of rotation turn.
TEST(Rattleback, TurnsRoundByTheEquationsOfRolling) {
  const Rattleback r;
  for (const auto& [spin, t_end, turns_at] : {std::tuple{-5.0, 5.0, 2.77}, {5.0, 20.0, 11.46}}) {
    const auto y = reference(spin, t_end, 2.5e-4), finer = reference(spin, t_end, 1.25e-4);
    const double before = energy_of(r, y(0));
    for (double t = 0; t < t_end; t += 0.05) {
      ASSERT_NEAR(energy_of(r, y(t)), before, 1e-12 * before) << t;
      ASSERT_LT((y(t) - finer(t)).norm(), 1e-8) << t;
    }
    EXPECT_NEAR(reversal(y, t_end), turns_at, 0.01);
    EXPECT_LT(vertical_spin(y(t_end)) * spin, 0);
  }
}

TEST(Rattleback, FollowsThoseEquationsFromEventToEvent) {
  const auto back = reference(-5, 5, 2.5e-4);
  const Followed soon = follow("event_driven", -5, 5e-3, 5, 5, back);
  EXPECT_LT(soon.worst, 1e-4);
  EXPECT_NEAR(soon.reversal, reversal(back, 5), 6e-3);
  const auto forth = reference(5, 13, 2.5e-4);
  const Followed late = follow("event_driven", 5, 5e-3, 13, 13, forth);
  EXPECT_LT(late.worst, 1e-4);
  EXPECT_NEAR(late.reversal, reversal(forth, 13), 6e-3);
}

// Contacts at the middle of the step, and the law of the mean velocity, which is the one there: no slip works
// nothing and is of order two (MJ-10).
const NormalLawOptions kMean = rolling_options().normal;

TEST(Rattleback, RollsToSecondOrderWithTheLawOfTheMeanVelocity) {
  const auto exact = reference(5, 1, 2.5e-4);
  const Followed coarse = follow("moreau_jean", 5, 1e-3, 1, 1, exact, kMean),
                 fine = follow("moreau_jean", 5, 2e-4, 1, 1, exact, kMean);
  EXPECT_LT(coarse.worst, 4e-3);
  EXPECT_LT(coarse.energy_error, 3e-4);
  EXPECT_NEAR(std::log(coarse.worst / fine.worst) / std::log(5),
              scheme_traits("moreau_jean", rolling_options()).rolling, 0.1);
}

TEST(Rattleback, TurnsRoundInTimeWithTheLawOfTheMeanVelocity) {
  for (const auto& [spin, h, t_end, within] :
       {std::tuple{-5.0, 1e-3, 3.5, 0.06}, {-5.0, 2e-4, 3.5, 2e-3}, {5.0, 1e-3, 13.0, 4e-3}}) {
    const auto exact = reference(spin, t_end, 2.5e-4);
    EXPECT_NEAR(follow("moreau_jean", spin, h, t_end, 0, {}, kMean).reversal, reversal(exact, t_end), within)
        << spin << " " << h;
  }
}

// Where the law is that of the velocity at the end, with the arms of another time, no slip works by
// O(h) per second. A small oscillation grows until it takes all of the spin: errors grow with it.
TEST(Rattleback, IsHardForTheLawOfTheLastVelocity) {
  const auto exact = reference(5, 1, 2.5e-4);
  for (const char* name : {"moreau_jean", "generalised_alpha", "passive_midpoint", "d1_minus_linear"}) {
    const Followed coarse = follow(name, 5, 2e-4, 1, 1, exact), fine = follow(name, 5, 1e-4, 1, 1, exact);
    EXPECT_LT(fine.worst, 0.07) << name;
    EXPECT_LT(fine.worst, 0.7 * coarse.worst) << name;
    EXPECT_NEAR(std::log2(coarse.worst / fine.worst),
                scheme_traits(name, {.theta = 0.5, .contacts = ContactsAt::midpoint}).rolling, 0.3)
        << name;
  }
}

TEST(Rattleback, TurnsRoundTooSoonWithLongSteps) {
  const double exact = reversal(reference(-5, 3, 2.5e-4), 3);
  double before = kInf;
  for (const double h : {2e-4, 1e-4, 5e-5}) {
    const Followed run = follow("moreau_jean", -5, h, 3, 0, {});
    EXPECT_LT(run.reversal, exact);
    EXPECT_LT(exact - run.reversal, 0.8 * before) << h;
    before = exact - run.reversal;
  }
  EXPECT_LT(before, 0.45);
}

}  // namespace
}  // namespace aussois
