// SPDX-License-Identifier: Apache-2.0
// T-4.1 and T-4.2 of doc/theory/persistence.md: a block on a slope stays where it stuck.
#include <algorithm>

#include "tests/support/block_scene.hpp"
#include "tests/support/every_other.hpp"

namespace aussois {
namespace {

struct Creep {
  double drift = 0;        // along the slope, at the end [m]
  double worst = 0;        // at any time [m]
  double energy_rise = 0;  // largest of the mechanical energy above its lowest value so far [J]
};

/// 10^5 steps of 1 ms at 0.9 of the critical slope.
Creep creep(bool anchors, double mu) {
  Scene s = block_on_plate(mu, 0, std::atan(0.9 * mu));
  const MoreauJean scheme(s.model, {.h = 1e-3, .persistence = {.anchors = anchors}}, {.theta = 1});
  Creep out;
  for (int step = 0; step < 100; ++step) EXPECT_TRUE(scheme.step(s.state).ok());  // the gap closes
  const double start = pose(s.state, s.block).p.x();
  double lowest = energy(s.model, s.state).total();
  for (int step = 0; step < 100000; ++step) {
    const StepReport report = scheme.step(s.state);
    if (!report.ok()) {
      ADD_FAILURE() << report.reason << ", step " << step;
      break;
    }
    const double now = energy(s.model, s.state).total();
    lowest = std::min(lowest, now);
    out.energy_rise = std::max(out.energy_rise, now - lowest);
    out.worst = std::max(out.worst, std::abs(pose(s.state, s.block).p.x() - start));
  }
  out.drift = pose(s.state, s.block).p.x() - start;
  return out;
}

TEST(Anchors, T_4_1_T_4_2_KeepABlockInPlaceAndFeedNoEnergy) {
  const double mu = 0.5;
  const Creep with = creep(true, mu), without = creep(false, mu);
  const auto text = [](double x) {
    char out[40];
    std::snprintf(out, sizeof out, "%.3g", x);
    return std::string(out);
  };
  RecordProperty("drift_with_anchors_m", text(with.drift));
  RecordProperty("drift_without_anchors_m", text(without.drift));
  RecordProperty("energy_rise_with_anchors_J", text(with.energy_rise));
  RecordProperty("energy_rise_without_anchors_J", text(without.energy_rise));
  EXPECT_LT(with.worst, 1e-6);
  const double weight = kDensity * kSide * kSide * kSide * kGravity;
  EXPECT_LT(with.energy_rise, 1e-9 * weight * kSide);  // relative to a fall by its own height
}

/// A prism of eight sides on a plate; its eight contacts are asked in two sets of four by turns.
Scene prism_on_plate(double mu, double slope) {
  Scene s = block_on_plate(mu, 0, slope);
  const SimplicialComplex prism = make_cylinder(kSide / 2, kSide / 2, 8);
  const ShapeId shape = add(s.model, prepare(dilate(prism, kRadius)));
  s.model.bodies[s.block] = solid_body("prism", shape, mass_properties(prism, kDensity));
  pose(s.state, s.block).p.z() = kSide / 4 + 2 * kRadius;
  return s;
}

/// Two schemes that ask different sets, ten steps each by turns.
struct ByTurns {
  MoreauJean even, odd;
  ByTurns(const Model& model, bool anchors)
      : even(model, asking(anchors, false), {.theta = 1}), odd(model, asking(anchors, true), {.theta = 1}) {}
  static StepOptions asking(bool anchors, bool second) {
    return {.h = 1e-3,
            .reduction = {.reducer = Reducer::selector, .selector = every_other(second)},
            .persistence = {.anchors = anchors}};
  }
  StepReport step(State& state, int n) const { return (n / 10 % 2 == 0 ? even : odd).step(state); }
};

TEST(Anchors, KeepAPrismInPlaceWhileTheSelectionSwitches) {
  Scene s = prism_on_plate(0.5, std::atan(0.9 * 0.5));
  const ByTurns schemes(s.model, true);
  for (int n = 0; n < 100; ++n) ASSERT_TRUE(schemes.step(s.state, n).ok());
  const double start = pose(s.state, s.block).p.x();
  double worst = 0;
  int most = 0;
  for (int n = 0; n < 20000; ++n) {
    const StepReport report = schemes.step(s.state, n);
    ASSERT_TRUE(report.ok()) << report.reason << ", step " << n;
    worst = std::max(worst, std::abs(pose(s.state, s.block).p.x() - start));
    most = std::max(most, report.contacts_kept);
  }
  EXPECT_LT(worst, 1e-6);
  EXPECT_LT(most, 8);  // the sets do differ
}

/// How far a body 20 cm off the axis of a table that turns by a radian per second has slipped on it in two
/// seconds. It stands exactly if every point of it goes round in a circle: the path of a step is its chord.
template <class Steps>
double slip_on_a_turntable(Scene s, const Steps& steps_of) {
  Trajectory path;
  for (int i = 0; i <= 60; ++i) {
    path.t.push_back(0.05 * i);
    path.pose.push_back(rotation(Vec3::UnitZ(), 0.05 * i));
  }
  const ShapeId shape = s.model.bodies[s.ground].shape;
  s.model.bodies[s.ground] = prescribed_body("table", shape, path);
  pose(s.state, s.block).p.x() = 0.2;
  twist(s.state, s.block) << 0, 0.2, 0, 0, 0, 1;
  const Vec3 before = inverse(pose(s.state, s.ground)) * pose(s.state, s.block).p;
  const auto steps = steps_of(s.model);
  for (int n = 0; s.state.t < 2 - 1e-12; ++n) EXPECT_TRUE(steps(s.state, n).ok()) << n;
  const Vec3 after = inverse(pose(s.state, s.ground)) * pose(s.state, s.block).p;
  return (after - before).head<2>().norm();
}

TEST(Anchors, HoldABlockOnATurntable) {
  const auto slip = [](bool anchors) {
    return slip_on_a_turntable(block_on_plate(0.5, 0, 0), [&](const Model& model) {
      return [scheme = MoreauJean(model, {.h = 1e-3, .persistence = {.anchors = anchors}}, {.theta = 1})](
                 State& state, int) { return scheme.step(state, 2 - state.t); };
    });
  };
  const double without = slip(false), with = slip(true);
  RecordProperty("turntable_without_m", std::to_string(1e6 * without) + "e-6");
  RecordProperty("turntable_with_m", std::to_string(1e6 * with) + "e-6");
  EXPECT_NEAR(without, 2000 * 1e-7, 2e-6);  // r w^2 h^2 / 2 in every step
  EXPECT_NEAR(with, 1e-7 / 0.2, 1e-8);      // of one step, over the rate
}

// Each set starts its anchors when it is first asked, and keeps them while it waits: two sets, twice the
// slip.
TEST(Anchors, HoldAPrismOnATurntableWhileTheSelectionSwitches) {
  const double slip = slip_on_a_turntable(prism_on_plate(0.5, 0), [](const Model& model) {
    return [schemes = ByTurns(model, true)](State& state, int n) { return schemes.step(state, n); };
  });
  RecordProperty("turntable_by_turns_m", std::to_string(1e6 * slip) + "e-6");
  EXPECT_LT(slip, 2 * 1e-7 / 0.2 + 1e-8);
}

}  // namespace
}  // namespace aussois
