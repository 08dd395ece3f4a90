// SPDX-License-Identifier: Apache-2.0
// Tests T-4.5 and T-4.7 of doc/theory/persistence.md: what a warm start saves, and that it has one
// result.
#include <algorithm>

#include <Eigen/Geometry>

#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/every_other.hpp"

namespace aussois {
namespace {

/// Boxes on a plate, every other turned by an eighth: eight contacts between two of them.
Scene stack_of(int boxes) {
  Scene s;
  s.model.contact_law = {.mu = 0.5, .restitution = 0};
  const SimplicialComplex box = make_box(0.07, 0.07, 0.05);
  const auto plate = add(s.model, prepare(dilate(make_plate(1, 1), kRadius)));
  const ShapeId shape = add(s.model, prepare(dilate(box, kRadius)));
  s.ground = add(s.model, fixed_body("ground", plate));
  for (int i = 0; i < boxes; ++i)
    s.block = add(s.model, solid_body("box " + std::to_string(i), shape, mass_properties(box, kDensity)));
  s.state = rest_state(s.model);
  for (int i = 0; i < boxes; ++i)
    pose(s.state, BodyId::at(i + 1)) = translation(0, 0, 0.025 + 0.05 * i + 2 * kRadius * (i + 1)) *
                                       rotation(Vec3::UnitZ(), i % 2 ? kPi / 4 : 0.0);
  return s;
}

struct Sweeps {
  int warm = 0, cold = 0;
};

/// Sweeps of plain Gauss-Seidel over a hundred steps of five boxes that came to rest by the default solver.
/// The state of each step is stepped cold as well: both solve the same problem to the same tolerance. The
/// selection changes every ten steps, or is that of the default reducer, which keeps the eight corners of
/// each octagon.
Sweeps sweeps(bool switching, bool redistribute = true) {
  Scene s = stack_of(5);
  Sweeps total;
  constexpr int kSettled = 40, kSteps = 140;
  for (int step = 0; step < kSteps; ++step) {
    StepOptions options{.h = 1e-3, .persistence = {.redistribute = redistribute}};
    if (step >= kSettled) options.solver = {.method = Method::nsgs, .tolerance = 1e-8};
    if (switching)
      options.reduction = {.reducer = Reducer::selector, .selector = every_other(step / 10 % 2 == 1)};
    State beside = s.state;
    const StepReport warm = MoreauJean(s.model, options, {.theta = 1}).step(s.state);
    EXPECT_TRUE(warm.ok()) << step << ": " << warm.reason;
    if (step < kSettled) continue;
    options.persistence = {.matching = Matching::none};
    const StepReport cold = MoreauJean(s.model, options, {.theta = 1}).step(beside);
    EXPECT_TRUE(cold.ok()) << step << ": " << cold.reason;
    total.warm += warm.solve.iterations;
    total.cold += cold.solve.iterations;
  }
  return total;
}

TEST(WarmStart, T_4_5_SavesSweepsOfAStackAtRest) {
  for (const bool switching : {false, true}) {
    const auto [warm, cold] = sweeps(switching);
    const std::string name = switching ? "switching" : "resting";
    ::testing::Test::RecordProperty(name + "_cold", cold);
    ::testing::Test::RecordProperty(name + "_warm", warm);
    EXPECT_GT(cold, 100000) << name;
    EXPECT_GE(cold, 10 * warm) << name;
    if (!switching) continue;
    const int undistributed = sweeps(true, false).warm;
    ::testing::Test::RecordProperty("switching_without_redistribution", undistributed);
    EXPECT_GE(undistributed, 3 * warm);
  }
}

// A hundred steps of ten boxes, which plain Gauss-Seidel does not solve from a cold start.
TEST(WarmStart, T_4_5_SavesTheDefaultSolverAllItsWorkAtRest) {
  int iterations[2] = {0, 0};
  for (const bool warm : {false, true}) {
    Scene s = stack_of(10);
    for (int step = 0; step < 140; ++step) {
      StepOptions options{.h = 1e-3};
      if (step >= 40 && !warm) options.persistence.matching = Matching::none;
      const StepReport report = MoreauJean(s.model, options, {.theta = 1}).step(s.state);
      ASSERT_TRUE(report.ok()) << report.reason;
      if (step >= 40) iterations[warm] += report.solve.iterations;
    }
  }
  ::testing::Test::RecordProperty("default_cold", iterations[0]);
  ::testing::Test::RecordProperty("default_warm", iterations[1]);
  EXPECT_GT(iterations[0], 1000);
  EXPECT_GE(iterations[0], 100 * iterations[1]);
}

TEST(Anchors, T_4_7_GiveTheSameBitsForAnyThreadsAndAFreshScheme) {
  Scene s = block_on_plate(0.5, 0, std::atan(0.45), 1e-3);
  const auto run_with = [&](int threads, bool fresh) {
    const StepOptions options{.h = 1e-3, .persistence = {.anchors = true}, .threads = threads};
    const MoreauJean scheme(s.model, options, {.theta = 1});
    State state = s.state;
    for (int step = 0; step < 200; ++step) {
      const StepReport report =
          fresh ? MoreauJean(s.model, options, {.theta = 1}).step(state) : scheme.step(state);
      EXPECT_TRUE(report.ok()) << report.reason;
    }
    const auto& contacts = state.memory.contacts;
    EXPECT_TRUE(std::ranges::any_of(contacts, [](const RememberedContact& c) { return c.held; }));
    return hash(state);
  };
  const std::uint64_t reference = run_with(1, false);
  EXPECT_EQ(run_with(3, false), reference);
  EXPECT_EQ(run_with(1, true), reference);
}

TEST(Anchors, LetGoOfWhatSlidesAndOpens) {
  Scene s = block_on_plate(0.3, 0, std::atan(0.45));
  const MoreauJean with(s.model, {.h = 1e-3, .persistence = {.anchors = true}}, {.theta = 1}),
      without(s.model, {.h = 1e-3}, {.theta = 1});
  State a = s.state, b = s.state;
  for (int step = 0; step < 100; ++step) {
    ASSERT_TRUE(with.step(a).ok() && without.step(b).ok());
    for (const RememberedContact& c : a.memory.contacts) EXPECT_EQ(c.held && step > 1, false) << "it slides";
  }
  EXPECT_LT((a.g[s.block].p - b.g[s.block].p).norm(), 1e-9);
}

// A fast block on its way into the plate: its pair is left apart at first (CA-16) and asked once it meets,
// which costs an attempt; not if they pushed each other in the last step, whatever their features.
TEST(Memory, LetsPairsThatPushedEachOtherBeAskedAtOnce) {
  Scene s = block_on_plate(0.5, 0, 0, 0.02);
  twist(s.state, s.block).z() = -50;
  const auto attempts = [&](double impulse) {
    State state = s.state;
    state.memory.contacts = {
        {.key = {.body_a = s.ground, .body_b = s.block, .feature = feature_word({0, 3}, {0, 7})},
         .point_a = Vec3(1, 1, 0),
         .impulse = Vec3(0, 0, impulse)}};
    const StepReport report = MoreauJean(s.model, {.h = 1e-3}, {.theta = 1}).step(state);
    EXPECT_TRUE(report.ok()) << report.reason;
    EXPECT_NEAR(twist(state, s.block).z(), -0.02 / 1e-3, 1e-6) << "it arrives at the end of the step";
    return report.attempts;
  };
  EXPECT_EQ(attempts(1), attempts(0) - 1);
}

TEST(Anchors, AreRefusedBySchemesWithoutThem) {
  const Scene s = block_on_plate(0.5, 0, 0);
  for (const std::string& name : scheme_names()) {
    SchemeOptions options{.step = {.persistence = {.anchors = true}}};
    if (name == "schatzman_paoli") options.moreau_jean.law = NormalLaw::gap_over_step;
    if (name.starts_with("moreau_jean"))
      EXPECT_NO_THROW(make_scheme(name, s.model, options)) << name;
    else
      EXPECT_THROW(make_scheme(name, s.model, options), std::invalid_argument) << name;
  }
}

}  // namespace
}  // namespace aussois
