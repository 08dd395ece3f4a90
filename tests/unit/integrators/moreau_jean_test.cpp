// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/moreau_jean.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/pose/reduced_solve.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

TEST(MoreauJean, ABlockAtRestCarriesItsWeightOnFourContacts) {
  Scene s = block_on_plate(0.3, 0, 0);
  const MoreauJean scheme(s.model, {.h = 1e-3, .solver = {.tolerance = 1e-12}}, {.theta = 1});
  const StepReport report = run(scheme, s.state, 0.1);
  ASSERT_EQ(report.contacts.size(), 4U);
  Vec3 total = Vec3::Zero();
  for (const StepContact& c : report.contacts) total += c.impulse;  // on A, the ground
  const double weight = kDensity * std::pow(kSide, 3) * kGravity;
  EXPECT_LT((total / report.h + Vec3(0, 0, weight)).norm(), 1e-9 * weight);
  EXPECT_LT(twist(s.state, s.block).norm(), 1e-10);
  EXPECT_GE(report.matches.matched(), 4);
}

TEST(MoreauJean, ABlockLandsWithoutOverlapOrBounce) {
  Scene s = block_on_plate(0.3, 0, 0, 0.05);
  const MoreauJean scheme(s.model, {.h = 1e-2}, {.theta = 1});
  double least = kInf;
  while (s.state.t < 0.3) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    least = std::min(least, report.min_gap);
  }
  EXPECT_GT(least, -1e-9);
  EXPECT_LT(twist(s.state, s.block).norm(), 1e-7);  // solver tolerance 1e-8 of 1 m/s and more
  EXPECT_NEAR(pose(s.state, s.block).p.z(), kSide / 2 + 2 * kRadius, 1e-8);
}

TEST(MoreauJean, AStepThatIsNotSolvedAfterTheLastHalvingIsNotOk) {
  Scene s = block_on_plate(0.3, 0, 0);
  const SolverOptions one_sweep{.method = Method::nsgs, .tolerance = 1e-15, .max_iterations = 1};
  const StepReport report = MoreauJean(s.model, {.h = 1e-3, .solver = one_sweep}, {.theta = 1}).step(s.state);
  EXPECT_EQ(report.status, StepStatus::not_solved);
  EXPECT_EQ(report.solve.status, SolveStatus::max_iterations);
  EXPECT_FALSE(report.ok());
  EXPECT_TRUE(report.moved());
  EXPECT_EQ(report.attempts, 4);
  EXPECT_EQ(s.state.t, 1e-3 / 8);
  EXPECT_EQ(report.t, s.state.t);
}

TEST(MoreauJean, AnIsolatedPairKeepsItsMomenta) {
  Random random(4);
  Model model;
  model.gravity = Vec3::Zero();
  model.contact_law = {.mu = 0.4, .restitution = 0};
  const SimplicialComplex box = make_box(kSide, 0.8 * kSide, 0.6 * kSide);
  const ShapeId shape = add(model, prepare(dilate(box, kRadius)));
  for (const char* name : {"a", "b"}) add(model, solid_body(name, shape, mass_properties(box, kDensity)));
  State state = rest_state(model);
  pose(state, 0) = {random.rotation(), Vec3(0, 0, 0)};
  pose(state, 1) = {random.rotation(), Vec3(0.02, 0.01, 0.2)};
  twist(state, 1) << 0.1, 0, -1, 3, -2, 1;
  const auto momenta = [&] {
    Vec6 sum = Vec6::Zero();
    for (const BodyId b : model.bodies.ids()) {
      const RigidBody& body = model.bodies[b];
      const Vec3 p = body.mass * twist(state, b).head<3>();
      sum.head<3>() += p;
      sum.tail<3>() +=
          pose(state, b).p.cross(p) + pose(state, b).R * (body.inertia * twist(state, b).tail<3>());
    }
    return sum;
  };
  const Vec6 before = momenta();
  const MoreauJean scheme(model, {.h = 1e-4}, {.theta = 0.5});
  int touching = 0;
  while (state.t < 0.2) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    double push = 0;  // the work of (MJ-6) on overlaps, r_N (u^- + u^+) / 2 with u^- <= u^+
    for (const StepContact& c : report.contacts) {
      touching += c.impulse.norm() > 0;
      push += c.impulse.dot(c.point.normal) *
              std::clamp(-c.point.gap / report.h, 0.0, StepOptions{}.correction_speed);
    }
    EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
    EXPECT_LE(report.energy.contact_work, push + 1e-12);
  }
  EXPECT_GT(touching, 0);
  EXPECT_LT((momenta() - before).head<3>().norm(), 1e-12);
  EXPECT_LT((momenta() - before).tail<3>().norm(), 1e-4);  // gyroscopic term: second order in h
}

// doc/theory/moreau_jean.md, What can go wrong: a ball that sticks does so in the middle of its gap.
TEST(MoreauJean, StopsSlipInTheMiddleOfTheGap) {
  constexpr double kRadius = 0.05, kGap = 2.4e-3;
  Model model;
  model.gravity = Vec3::Zero();
  model.contact_law = {.mu = 10};
  const auto point = add(model, prepare(dilate(make_point(), kRadius)));
  const auto plate = add(model, prepare(dilate(make_plate(2, 2), 1e-3)));
  add(model, fixed_body("plate", plate));
  add(model,
      RigidBody{
          .name = "ball", .shape = point, .mass = 1, .inertia = 0.4 * kRadius * kRadius * Mat3::Identity()});
  State state = rest_state(model);
  state.g[1].p.z() = kRadius + 1e-3 + kGap;
  twist(state, 1) << 1, 0, -2, 0, 0, 0;
  const StepReport report =
      MoreauJean(model, {.h = 2e-3, .solver = {.tolerance = 1e-14}}, {.theta = 1}).step(state);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.contacts.size(), 1U);
  const double spin = twist(state, 1)[4], slip = twist(state, 1)[0] - spin * kRadius;
  EXPECT_GT(spin, 10);
  EXPECT_NEAR(slip, spin * kGap / 2, 1e-10);
}

TEST(MoreauJean, DoesNotTunnel) {
  for (int phase = 0; phase < 20; ++phase) {
    Model model;
    model.gravity = Vec3::Zero();
    const SimplicialComplex paper = make_plate(0.1, 0.1);
    const auto sheet = add(model, prepare(dilate(paper, 5e-5)));
    const auto point = add(model, prepare(dilate(make_point(), 5e-3)));
    add(model,
        RigidBody{
            .name = "paper", .shape = sheet, .mass = 1e-3, .inertia = Vec3(8e-7, 8e-7, 1.6e-6).asDiagonal()});
    add(model, RigidBody{.name = "bullet", .shape = point, .mass = 8e-3, .inertia = 8e-8 * Mat3::Identity()});
    State state = rest_state(model);
    pose(state, 1).p.z() = 0.3 + 5.05e-3 + 0.04 * phase;
    twist(state, 1)[2] = -800;
    const MoreauJean scheme(model, {.h = 1e-3}, {.theta = 1});
    while (state.t < 5e-3) {
      const StepReport report = scheme.step(state);
      ASSERT_TRUE(report.ok()) << report.reason;
    }
    EXPECT_NEAR(twist(state, 0)[2], -800.0 * 8 / 9, 1e-6) << phase;  // plastic: one momentum, two masses
    EXPECT_NEAR(twist(state, 1)[2], -800.0 * 8 / 9, 1e-6) << phase;
    EXPECT_GT(pose(state, 1).p.z(), pose(state, 0).p.z());
  }
}

TEST(MoreauJean, HasTheSameBitsForAnyNumberOfThreadsAndFromACopy) {
  const auto hash_after = [](int threads, bool fresh_scheme, int pause) {
    Scene s = block_on_plate(0.3, 0, 0.2, 0.03);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
    twist(s.state, s.block) << 1, 0.5, 0, 3, 1, 2;
    const StepOptions options{.h = 2e-3, .threads = threads};
    const MoreauJean scheme(s.model, options, {.theta = 1});
    for (int i = 0; i < 200; ++i) {
      EXPECT_TRUE((fresh_scheme ? MoreauJean(s.model, options, {.theta = 1}) : scheme).step(s.state).ok());
      if (i == pause) {  // rewind and go again
        const State copy = s.state;
        EXPECT_TRUE(scheme.step(s.state).ok());
        s.state = copy;
      }
    }
    return hash(s.state);
  };
  const std::uint64_t reference = hash_after(1, false, -1);
  EXPECT_EQ(hash_after(2, false, -1), reference);
  EXPECT_EQ(hash_after(1, true, -1), reference);
  EXPECT_EQ(hash_after(1, false, 77), reference);
}

// Four closed corners of one block, three of which the selection leaves out: they re-enter, and all carry.
TEST(MoreauJean, KeepsTheProblemOfAStepIfAskedAndChangesNoBit) {
  Scene plain = block_on_plate(0.3, 0, 0.2), kept = block_on_plate(0.3, 0, 0.2);
  const MoreauJean scheme(plain.model, {}, {.theta = 1}),
      keeping(kept.model, {.keep_problem = true}, {.theta = 1});
  for (int i = 0; i < 5; ++i) {
    EXPECT_FALSE(scheme.step(plain.state).problem.has_value());
    const StepReport report = keeping.step(kept.state);
    ASSERT_TRUE(report.problem.has_value());
    const auto& [problem, start, solution] = *report.problem;
    ASSERT_EQ(problem.contact_count(), report.contacts_kept);
    ASSERT_EQ(start.size(), solution.r.size());
    // Its answer is what moved the block: M v = H r + f.
    EXPECT_LT((problem.M * solution.v - problem.H * solution.r - problem.f).norm(), 1e-12 * problem.f.norm());
    EXPECT_EQ(solution.v, VecX(twist(kept.state, kept.block)));
  }
  EXPECT_EQ(hash(plain.state), hash(kept.state));
}

TEST(ReducedSolve, LetsEveryContactBackInThatWouldClose) {
  const Scene scene = block_on_plate(0.3, 0, 0);
  const MoreauJean scheme(scene.model, {}, {.theta = 1});
  const ContactSet found = scheme.contacts(scene.state, 1e-4);
  ASSERT_EQ(found.points.size(), 4U);
  const Layout dofs = layout(scene.model);
  const FreeMotion free = free_motion(scene.model, scene.state, dofs, 1e-3, 1);
  const VecX still = prescribed_velocity(scene.model, scene.state, 1e-3);
  const std::vector<ContactRow> rows =
      contact_rows(scene.model, scene.state, layout(scene.model), found, still, 1e-3, {});
  const Selection one{.kept = {2}, .cluster = {0, 0, 0, 0}, .cluster_count = 1};
  StageClock clock(Stage::solve, false);
  const ReducedSolution solved =
      solve_reduced(free, dofs, rows, {}, one, std::vector<RowVector>(4, RowVector::Zero()),
                    std::vector<double>(4, 1e-9), {.tolerance = 1e-12}, clock);
  for (const ContactRow& row : rows) EXPECT_GT(relative_velocity(row, dofs, solved.solution.v).x(), -2e-9);
  EXPECT_GE(solved.kept.size(), 2U);  // two across a diagonal carry the block
}

TEST(MoreauJean, TakesARestShorterThanTheSmallestStepAndGoesOnWithTheLargest) {
  Scene s = block_on_plate(0.3, 0, 0, 0.05);
  const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = 1});
  EXPECT_EQ(scheme.step(s.state).h, 1e-3);
  EXPECT_EQ(scheme.step(s.state, 1e-12).h, 1e-12);
  EXPECT_EQ(scheme.step(s.state).h, 1e-3);
}

TEST(MoreauJean, RefusesAStepThatStartsInOverlapAndLeavesTheState) {
  Scene s = block_on_plate(0.3, 0, 0);
  pose(s.state, s.block).p.z() = kSide / 2 + 0.5 * kRadius;
  const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = 1});
  const std::uint64_t before = hash(s.state);
  const StepReport report = scheme.step(s.state);
  EXPECT_EQ(report.status, StepStatus::refused);
  EXPECT_NE(report.reason.find("bodies 0 (ground) and 1 (block)"), std::string::npos) << report.reason;
  EXPECT_EQ(hash(s.state), before);
}

TEST(MoreauJean, TurnsAPoseThatIsNoneIntoAStatusAndLeavesTheState) {
  Scene s = block_on_plate(0.3, 0, 0);
  pose(s.state, s.block).p.z() = std::nan("");
  const std::uint64_t before = hash(s.state);
  EXPECT_EQ(MoreauJean(s.model, {.h = 1e-3}).step(s.state).status, StepStatus::not_finite);
  EXPECT_EQ(hash(s.state), before);
  EXPECT_THROW((void)MoreauJean(s.model, {.h = 1e-3}).step(s.state, 0), std::invalid_argument);
}

TEST(MoreauJean, TurnsANumberThatIsNoneIntoAStatusInTheSameStep) {
  Scene s = block_on_plate(0.3, 0, 0);
  add(s.model, ForceLaw{.name = "bad",
                        .add_to = [](const Model&, const State&, double,
                                     GeneralisedForce& out) { out.f[6] = std::nan(""); },
                        .potential = {}});
  const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = 1});
  EXPECT_EQ(scheme.step(s.state).status, StepStatus::not_finite);
}

TEST(MoreauJean, NamesBadOptions) {
  const Scene s = block_on_plate(0.3, 0, 0);
  EXPECT_THROW(MoreauJean(s.model, {.h = -1}), std::invalid_argument);
  EXPECT_THROW(MoreauJean(s.model, {}, {.theta = 0.3}), std::invalid_argument);
  EXPECT_THROW(MoreauJean(s.model, {.advancement = {.max_overlap = 1}}), std::invalid_argument);
  Model bare;
  const auto plate = add(bare, prepare(dilate(make_plate(1, 1), 0)));
  add(bare, RigidBody{.name = "a", .shape = plate, .mass = 1, .inertia = Vec3(1, 1, 2).asDiagonal()});
  add(bare, RigidBody{.name = "b", .shape = plate, .mass = 1, .inertia = Vec3(1, 1, 2).asDiagonal()});
  EXPECT_THROW(MoreauJean(bare, {}), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
