// SPDX-License-Identifier: Apache-2.0
// C10, closed chains of rods that spin as one (doc/theory/mechanism_benchmarks.md).
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "integrators/joint_rows.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

constexpr double kOmega = 3, kTurn = 2 * kPi / kOmega;

SchemeOptions on_mean_joints(double h) {
  SchemeOptions out = mechanism_options(h);
  out.update = GroupUpdate::cayley;
  out.mean_joints = true;
  return out;
}

struct Balance {
  double energy = 0, angular = 0, linear = 0;  // relative, relative, [N s]
  double force = 0;                            // of a joint, at the end [N]
};
Balance balance(const CaseScene& s, const char* scheme, const SchemeOptions& options, double turns) {
  const double before = energy(s.model, s.state).total();
  const Momentum start = momentum(s.model, s.state);
  Balance out;
  const State end = run_scene(s, scheme, options, turns * kTurn, [&](const State&, const StepReport& report) {
    out.force = report.joints[0].force.norm();
  });
  const Momentum now = momentum(s.model, end);
  out.energy = std::abs(energy(s.model, end).total() / before - 1);
  out.angular = (now.angular - start.angular).norm() / start.angular.norm();
  out.linear = (now.linear - start.linear).norm();
  return out;
}

const std::pair<int, JointKind> kChains[] = {{6, JointKind::spherical},
                                             {6, JointKind::revolute},  // redundant: 30 rows for 27 motions
                                             {4, JointKind::revolute}};

// (MCH-10), the same for any joints: each step takes kappa (1 - kappa) (omega h)^4 / 4 of the energy, half of
// it of the angular momentum. Linear momentum to rounding.
TEST(SpinningChain, SlowsDownByTheFourthPowerOfTheAngleOfAStep) {
  for (const auto& [rods, kind] : kChains) {
    SCOPED_TRACE(std::to_string(rods) + " rods, " + to_string(kind));
    const CaseScene s = spinning_chain(rods, kOmega, kind);
    const double r = 0.5 / std::tan(kPi / rods), kappa = r * r / (r * r + 1.0 / 12);
    for (const double h : {2e-2, 1e-2}) {
      const Balance now = balance(s, "moreau_jean", mechanism_options(h), 5);
      const double steps = 5 * kTurn / h, each = kappa * (1 - kappa) * std::pow(kOmega * h, 4) / 4;
      EXPECT_NEAR(now.energy, each * steps, 0.01 * each * steps);
      EXPECT_NEAR(now.angular, each * steps / 2, 0.01 * each * steps / 2);
      EXPECT_LT(now.linear, 1e-12);
      const double force = kOmega * kOmega * r / (2 * std::sin(kPi / rods));
      EXPECT_NEAR(now.force, force, 5e-4 * force);
    }
  }
}

// On the mean of both ends nothing is lost at all, at 60 ms a step of 10 degrees; the force is of order two.
TEST(SpinningChain, KeepsEnergyAndMomentumToRoundingOnMeanJoints) {
  for (const auto& [rods, kind] : kChains) {
    SCOPED_TRACE(std::to_string(rods) + " rods, " + to_string(kind));
    const CaseScene s = spinning_chain(rods, kOmega, kind);
    const double r = 0.5 / std::tan(kPi / rods), force = kOmega * kOmega * r / (2 * std::sin(kPi / rods));
    for (const double h : {6e-2, 1e-2}) {
      const Balance now = balance(s, "passive_midpoint", on_mean_joints(h), 2);
      EXPECT_LT(now.energy, 1e-13);
      EXPECT_LT(now.angular, 1e-13);
      EXPECT_LT(now.linear, 1e-13);
      EXPECT_NEAR(now.force, force, kOmega * kOmega * h * h * force);
    }
  }
}

// 7.79423 N at the joints of the hexagon; what ten turns lose is what the integrator's tolerance lets it.
TEST(SpinningChain, KeepsItsEnergyInTheEventDrivenReference) {
  for (const auto& [rods, kind] : kChains) {
    SCOPED_TRACE(std::to_string(rods) + " rods, " + to_string(kind));
    const CaseScene s = spinning_chain(rods, kOmega, kind);
    const Balance now = balance(s, "event_driven", mechanism_options(10 * kTurn), 10);
    EXPECT_LT(now.energy, 2e-7);
    EXPECT_LT(now.angular, 1e-7);
    if (rods == 6) {  // the mean of a short step: over a turn it is none
      EXPECT_NEAR(balance(s, "event_driven", mechanism_options(1e-3), 0.01).force, 7.79423, 1e-5);
    }
  }
}

// Hung at one joint, in gravity, it unfolds and whirls.
CaseScene hung_chain() {
  CaseScene s = spinning_chain(6, kOmega, JointKind::spherical);
  s.model.gravity = Vec3(0, 0, -9.81);
  const SE3 at = pose(s.state, 0) * translation(0.5, 0, 0);
  add(s.model, joint_at(JointKind::spherical, "nail", 0, -1, s.state.g, at));
  s.state = consistent(s.model, s.state);
  return s;
}
double lost_energy(const CaseScene& s, const char* scheme, const SchemeOptions& options) {
  const double before = energy(s.model, s.state).total();
  double worst = 0;
  run_scene(s, scheme, options, 1, [&](const State& now, const StepReport& report) {
    worst = std::max(worst, std::abs(energy(s.model, now).total() - before));
    EXPECT_LT(report.joint_error.translation, 1e-11);
  });
  return worst;
}

// Energy of second order with the directions of a predicted middle, and to rounding on mean joints.
TEST(SpinningChain, HungAtOneJointExchangesItsEnergy) {
  const CaseScene s = hung_chain();
  const double coarse = lost_energy(s, "moreau_jean", mechanism_options(4e-3)),
               fine = lost_energy(s, "moreau_jean", mechanism_options(1e-3));
  EXPECT_LT(fine, 2e-4);  // of 59 J that fall
  EXPECT_NEAR(std::log(coarse / fine) / std::log(4), 2, 0.4);
  EXPECT_LT(lost_energy(s, "passive_midpoint", on_mean_joints(1e-3)), 2e-12);
}

}  // namespace
}  // namespace aussois
