// SPDX-License-Identifier: Apache-2.0
// How a step is tried until it may be accepted (CA-5) to (CA-8): by scripted attempts, and by a blow that
// throws a body beyond what was searched.
#include "integrators/schemes/advance_step.hpp"

#include <gtest/gtest.h>

#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

/// One free body, and a scheme that objects to its own trials as a script says; the calls are written
/// down.
struct Scripted {
  Model model{};
  State state{};
  std::function<Outcome(double h, int tried)> script{};  // `tried`: attempts of this step before
  std::vector<double> h{};
  std::vector<Estimate> asked{};

  Scripted() {
    add(model, RigidBody{.name = "body", .mass = 1, .inertia = Mat3::Identity()});
    state = rest_state(model);
  }

  StepReport step(const AdvancementOptions& advancement = {}, double h_limit = kInf) {
    const StepSetting setting = step_setting(model, {.h = 1e-2, .advancement = advancement});
    h.clear(), asked.clear();
    return advance_step(
        setting, state, h_limit,
        {[](const State& s, double) { return VecX(0 * s.v); },
         [&](const State& s, const Estimate& ahead, double length) {
           const Outcome outcome = script(length, int(h.size()));
           h.push_back(length), asked.push_back(ahead);
           const double k = double(h.size());
           Trial out{.found = find_ahead(setting, s, ahead, length)};
           out.impulses = solve_step(
               setting, s, out.found,
               std::make_shared<const FreeMotion>(free_motion(model, s, setting.dofs, length, 1)), 1);
           out.move = {.v_path = VecX::Constant(6, k), .v_end = VecX::Zero(6)};
           out.beforehand = {outcome, "attempt " + std::to_string(h.size()), {{BodyId::at(h.size()), 9}}};
           return out;
         }});
  }
};

TEST(AdvanceStep, GrowsAgainStepByStepAfterACutOne) {
  Scripted s;
  s.script = [](double h, int) { return h > 1.3e-3 ? Outcome::not_certified : Outcome::accepted; };
  const StepReport cut = s.step();
  EXPECT_EQ(s.h, (std::vector<double>{1e-2, 5e-3, 2.5e-3, 1.25e-3}));
  EXPECT_EQ(cut.attempts, 4);
  EXPECT_EQ(cut.h, 1.25e-3);
  EXPECT_EQ(s.state.h_next, 1.5 * 1.25e-3);
  s.script = [](double, int) { return Outcome::accepted; };
  std::vector<double> lengths;
  for (int k = 0; k < 8; ++k) {
    const StepReport report = s.step();
    EXPECT_EQ(report.attempts, 1);
    lengths.push_back(report.h);
  }
  double h = 1.25e-3;
  for (const double length : lengths) {
    h = std::min(1e-2, 1.5 * h);
    EXPECT_DOUBLE_EQ(length, h);
  }
  EXPECT_EQ(lengths.back(), 1e-2);
  EXPECT_GT(lengths[4], 9e-3);  // 1.5^5 is 7.6 of the 8 times
}

// What is left of a run is no reason to be careful, and a growth of one never leaves what it was cut to.
TEST(AdvanceStep, GrowsByItsOptionAndNotLessAfterAShortRest) {
  Scripted s;
  s.script = [](double h, int) { return h > 3e-3 ? Outcome::not_certified : Outcome::accepted; };
  EXPECT_TRUE(s.step({.growth = 1}).ok());
  EXPECT_EQ(s.state.h_next, 2.5e-3);
  s.script = [](double, int) { return Outcome::accepted; };
  EXPECT_EQ(s.step({.growth = 1}, 1e-5).h, 1e-5);
  EXPECT_EQ(s.state.h_next, 2.5e-3);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(s.step({.growth = 1}).h, 2.5e-3);
  EXPECT_EQ(s.step({.growth = 4}).h, 2.5e-3);
  EXPECT_EQ(s.step({.growth = 4}).h, 1e-2);
}

// Halving did not help: the next step is tried as long as this one, however many are not solved.
TEST(AdvanceStep, ThatNobodySolvesShortensNoOther) {
  Scripted s;
  s.script = [](double, int) { return Outcome::not_solved; };
  for (int k = 0; k < 5; ++k) {
    EXPECT_EQ(s.step().status, StepStatus::not_solved);
    EXPECT_EQ(s.h, (std::vector<double>{1e-2, 5e-3, 2.5e-3, 1.25e-3})) << "step " << k;
    EXPECT_EQ(s.state.h_next, 1e-2);
  }
  s.script = [](double h, int) { return h > 3e-3 ? Outcome::not_solved : Outcome::accepted; };
  EXPECT_TRUE(s.step().ok());
  EXPECT_EQ(s.state.h_next, 1.5 * 2.5e-3) << "here it helped";
}

// Each broken bound makes the velocity that broke it the estimate; the fourth and eighth halve the step.
TEST(AdvanceStep, EnlargesThreeTimesBeforeItHalves) {
  Scripted s;
  s.script = [](double, int tried) { return tried < 9 ? Outcome::bound_exceeded : Outcome::accepted; };
  const StepReport report = s.step();
  ASSERT_TRUE(report.status == StepStatus::ok);
  EXPECT_EQ(report.attempts, 10);
  EXPECT_EQ(s.h, (std::vector<double>{1e-2, 1e-2, 1e-2, 1e-2, 5e-3, 5e-3, 5e-3, 5e-3, 2.5e-3, 2.5e-3}));
  for (std::size_t k = 0; k < s.asked.size(); ++k)
    EXPECT_EQ(s.asked[k].v[0], double(k));  // of the one before
  EXPECT_EQ(s.state.h_next, 1.5 * 2.5e-3);
}

// Pairs that met are asked from then on, all of them; in half the time others may meet.
TEST(AdvanceStep, GathersWhatMeetsUntilItHalves) {
  Scripted s;
  s.script = [](double, int tried) {
    return tried < 2 ? Outcome::meets : tried == 2 ? Outcome::not_certified : Outcome::accepted;
  };
  EXPECT_TRUE(s.step().ok());
  ASSERT_EQ(s.asked.size(), 4U);
  const std::vector<BodyPair> one{{1, 9}}, two{{1, 9}, {2, 9}}, none;
  EXPECT_EQ(s.asked[1].meeting, one);
  EXPECT_EQ(s.asked[2].meeting, two);
  EXPECT_EQ(s.asked[3].meeting, none);
  EXPECT_EQ(s.h, (std::vector<double>{1e-2, 1e-2, 1e-2, 5e-3}));
}

TEST(AdvanceStep, RefusesBelowItsSmallestStepAndAfterItsLastAttempt) {
  Scripted s;
  const std::uint64_t before = hash(s.state);
  s.script = [](double, int) { return Outcome::not_certified; };
  const StepReport small = s.step({.min_h = 1e-3});
  EXPECT_EQ(small.status, StepStatus::refused);
  EXPECT_EQ(small.attempts, 4);  // 10, 5, 2.5, 1.25 ms
  EXPECT_EQ(small.h, 0);
  EXPECT_EQ(small.reason, "no step of at least 0.001 s was accepted: attempt 4");
  s.script = [](double, int) { return Outcome::meets; };
  const StepReport many = s.step({.max_attempts = 7});
  EXPECT_EQ(many.status, StepStatus::refused);
  EXPECT_EQ(many.attempts, 7);
  EXPECT_EQ(hash(s.state), before);
}

// A ram hits a ball that rests before a wall: the solve throws the ball four times as far as to the wall,
// whose contact was not searched for. The attempt is thrown away, in the explicit step and with the Newton
// loop whose iterates lie behind the wall; the next one looks that far and the ball stays before it.
TEST(AdvanceStep, LooksAgainWhereASolveLeavesWhatWasLookedAt) {
  const SimplicialComplex point = make_complex({Vec3::Zero()}, {});
  for (const int iterations : {1, 50}) {
    Model model;
    model.gravity = Vec3::Zero();
    model.contact_law = {.mu = 0, .restitution = 0};
    const auto ball = add(model, prepare(dilate(point, 1e-2)));
    const auto wall = add(model, prepare(dilate(make_plate(1, 1), 1e-3)));
    add(model, fixed_body("wall", wall));
    for (const double mass : {0.1, 10.0})
      add(model,
          RigidBody{.name = "ball", .shape = ball, .mass = mass, .inertia = 1e-4 * mass * Mat3::Identity()});
    State state = rest_state(model);
    state.g[1].p.z() = 1.1e-2 + 1.5e-3;
    state.g[2].p.z() = state.g[1].p.z() + 2e-2 + 1e-5;
    twist(state, 2)[2] = -6;
    const MoreauJean scheme(model, {.h = 1e-3},
                            {.theta = 1,
                             .law = NormalLaw::gap_over_step,
                             .contacts = iterations > 1 ? ContactsAt::end : ContactsAt::start,
                             .newton = {.max_iterations = iterations}});
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    EXPECT_GT(report.attempts, 1) << iterations;
    EXPECT_EQ(report.h, 1e-3) << iterations;
    EXPECT_EQ(report.contacts.size(), 2U) << iterations;
    EXPECT_GT(report.threshold, 1.5e-3) << iterations;
    EXPECT_NEAR(state.g[1].p.z(), 1.1e-2, 1e-8) << iterations;  // at the wall
    EXPECT_NEAR(state.g[2].p.z(), 3.1e-2, 1e-8) << iterations;  // on the ball
    EXPECT_GE(state.h_next, 1e-3) << iterations;                // it was not cut
  }
}

}  // namespace
}  // namespace aussois
