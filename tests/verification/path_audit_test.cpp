// SPDX-License-Identifier: Apache-2.0
// Samples that check certificates (CA-9): they find nothing in honest steps, and everything in others.
#include "integrators/prove/path_audit.hpp"

#include <algorithm>

#include "integrators/prove/certify_step.hpp"
#include "lmd/coverage.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/change.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scheme_variants.hpp"

namespace aussois {
namespace {

Scene thrown_block() {
  Scene s = block_on_plate(0.3, 0.4, 0.1, 0.03);
  pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
  twist(s.state, s.block) << 2, 0.5, -3, 30, 10, -20;
  return s;
}

class EverySchemeAudited : public ::testing::TestWithParam<SchemeVariant> {
 protected:
  static Scheme scheme_of(Model& model) {
    drop_refused_restitution(model, GetParam());
    SchemeOptions options = GetParam().options;
    options.step.h = 5e-3;
    return make_scheme(GetParam().name, model, options);
  }
};

TEST_P(EverySchemeAudited, HasNoViolationOfATumblingBlockAndTheDistanceItSaw) {
  Scene s = thrown_block();
  const Scheme scheme = scheme_of(s.model);
  PathAudit audit{.samples = 17};
  double at_ends = kInf;  // of steps
  bool pushed = false;
  for (int k = 0; k < 50; ++k) {
    const State start = s.state;
    const StepReport report = scheme.step(s.state, kInf);
    ASSERT_TRUE(report.ok()) << report.reason;
    audit_path(s.model, start, s.state, report, 1, audit);
    at_ends = std::min(at_ends, min_base_distance(s.model, s.state, 4 * kRadius, 1));
    for (const StepContact& c : report.contacts) pushed = pushed || !c.impulse.isZero(0);
  }
  EXPECT_TRUE(pushed);
  EXPECT_EQ(audit.steps, 50);
  EXPECT_EQ(audit.violations, 0);
  EXPECT_GT(audit.min_distance, 0.96 * 2 * kRadius);
  EXPECT_LE(audit.min_distance, at_ends + 1e-14);
  EXPECT_GE(audit.min_slack, -1e-14);
}
// Nothing can touch: nothing is looked at, and nothing is found.
TEST_P(EverySchemeAudited, HasNothingToShowWhereNoTwoBodiesHaveShapes) {
  Scene s = thrown_block();
  s.model.bodies[s.ground].shape = -1;
  const Scheme scheme = scheme_of(s.model);
  PathAudit audit{.samples = 17};
  const State start = s.state;
  const StepReport report = scheme.step(s.state, kInf);
  audit_path(s.model, start, s.state, report, 1, audit);
  EXPECT_EQ(audit.steps, 0);
  EXPECT_EQ(audit.violations, 0);
}

std::vector<SchemeVariant> audited_variants() {
  std::vector<SchemeVariant> out = scheme_variants();
  out.push_back({"event_driven", {}});
  return out;
}
INSTANTIATE_TEST_SUITE_P(Registry, EverySchemeAudited, ::testing::ValuesIn(audited_variants()),
                         [](const auto& v) { return test_name(v.param); });

// The chords of the reference, one after the other from the start of the step to its end.
TEST(PathAudit, FollowsTheReferenceThroughItsImpacts) {
  Scene s = thrown_block();
  const Scheme scheme = make_scheme("event_driven", s.model, {.step = {.h = 0.05}});
  const State start = s.state;
  const StepReport report = scheme.step(s.state, kInf);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_FALSE(report.events.empty());
  ASSERT_GT(report.pieces.size(), 10U);
  double t = start.t;
  for (const PathPiece& piece : report.pieces) {
    EXPECT_NEAR(piece.t, t, 1e-12);
    t = piece.t + piece.h;
  }
  EXPECT_NEAR(t, s.state.t, 1e-12);
  StepReport deeper = report;
  PathAudit honest{.samples = 3}, forged = honest;
  audit_path(s.model, start, s.state, report, 1, honest);
  EXPECT_EQ(honest.violations, 0);
  for (PathPiece& piece : deeper.pieces) piece.g[s.block].p.z() -= 2e-4;
  audit_path(s.model, start, s.state, deeper, 1, forged);
  EXPECT_EQ(forged.violations, 1);
}

/// Steps until the block comes near the plate: where the last step began, and its report.
std::pair<State, StepReport> landing_step(const MoreauJean& scheme, Scene& s) {
  for (;;) {
    const State start = s.state;
    if (const StepReport report = scheme.step(s.state); report.min_gap <= 1e-4) return {start, report};
  }
}

// A report that claims more than the path keeps, and a path through the plate.
TEST(PathAudit, CatchesACertificateThatClaimsTooMuch) {
  Scene s = thrown_block();
  const MoreauJean scheme(s.model, {.h = 5e-3}, {.theta = 1});
  auto [start, report] = landing_step(scheme, s);
  PathAudit honest{.samples = 17}, forged = honest, through = honest;
  audit_path(s.model, start, s.state, report, 1, honest);
  EXPECT_EQ(honest.violations, 0);
  report.min_base_distance = 2 * kRadius;
  linear_part(report.v_path, s.block).z() -= 5e-4 / report.h;  // half a millimetre deeper
  audit_path(s.model, start, s.state, report, 1, forged);
  EXPECT_EQ(forged.violations, 1);
  report.min_base_distance = 0;
  linear_part(report.v_path, s.block).z() -= 5e-3 / report.h;
  audit_path(s.model, start, s.state, report, 1, through);
  EXPECT_EQ(through.violations, 1);
  EXPECT_LE(through.min_distance, 0);
}

// A plate whose faces look into it has no contacts on top; its distance from the block is what it was.
TEST(PathAudit, CatchesAContactThatIsMissing) {
  Scene s = thrown_block();
  const MoreauJean scheme(s.model, {.h = 5e-3}, {.theta = 1});
  const auto [start, report] = landing_step(scheme, s);
  auto& plate = s.model.shapes[s.model.bodies[s.ground].shape];
  LmdShape turned = *plate;
  change_each(turned.regions, [](RegionPlane& region) { region = {-region.normal, -region.offset}; });
  plate = std::make_shared<const LmdShape>(std::move(turned));
  PathAudit audit{.samples = 3};
  audit_path(s.model, start, s.state, report, 1, audit);
  EXPECT_EQ(audit.uncovered, 1);
  EXPECT_EQ(audit.violations, 1);
}

// Nearer or farther than the plate is: then the step did not find what is there.
TEST(PathAudit, CatchesAStepThatFoundOtherContacts) {
  Scene s = thrown_block();
  const MoreauJean scheme(s.model, {.h = 5e-3}, {.theta = 1});
  auto [start, report] = landing_step(scheme, s);
  const double found = report.min_gap, tolerance = coverage_tolerance(posed_shape(s.model, start, s.ground),
                                                                      posed_shape(s.model, start, s.block));
  for (const double off : {0.0, 0.9, -0.9, 1.1, -1.1, kInf}) {
    report.min_gap = found + off * tolerance;
    PathAudit audit{.samples = 1};
    audit_path(s.model, start, s.state, report, 1, audit);
    EXPECT_EQ(audit.uncovered, std::abs(off) > 1) << off;
  }
}

// The certificate covers the path; a state elsewhere is not certified, on whichever side of the plate.
TEST(PathAudit, CatchesAnEndThatThePathDoesNotLeadTo) {
  Scene s = thrown_block();
  const MoreauJean scheme(s.model, {.h = 5e-3}, {.theta = 1});
  const auto landing = landing_step(scheme, s);
  const auto violations = [&](double deeper) {
    State end = s.state;
    pose(end, s.block).p.z() -= deeper;
    PathAudit audit{.samples = 3};
    audit_path(s.model, landing.first, end, landing.second, 1, audit);
    return audit.violations;
  };
  EXPECT_EQ(violations(0), 0);
  EXPECT_EQ(violations(1e-3), 1);
  EXPECT_EQ(violations(0.4), 1);  // beyond the plate, far from it again
  EXPECT_EQ(violations(-0.4), 1);
}

// A ball of 5 mm and a crumb of 0.05 mm rest on paper: what the crumb may come near says nothing of the ball.
TEST(PathAudit, JudgesEveryPairByItsOwnDilations) {
  constexpr double kBall = 5e-3, kCrumb = 5e-5, kDensity = 1000;
  for (const double paper : {5e-5, 0.0}) {
    Model model;
    add(model, fixed_body("paper", add(model, prepare(dilate(make_plate(0.1, 0.1), paper)))));
    for (const double radius : {kBall, kCrumb}) {
      const double mass = 4 * kPi / 3 * kDensity * radius * radius * radius;
      add(model, RigidBody{.name = "ball",
                           .shape = add(model, prepare(dilate(make_point(), radius))),
                           .mass = mass,
                           .inertia = 0.4 * mass * radius * radius * Mat3::Identity()});
    }
    State state = rest_state(model);
    pose(state, 1).p.z() = kBall + paper;
    pose(state, 2).p = Vec3(0.02, 0, kCrumb + paper);
    const State start = state;
    const StepReport honest = MoreauJean(model, {}, {.theta = 1}).step(state);
    ASSERT_TRUE(honest.ok()) << honest.reason;
    ASSERT_LE(honest.min_base_distance, kCrumb + paper);
    const auto violations = [&](double deeper, double claim) {
      StepReport report = honest;
      linear_part(report.v_path, 1).z() -= deeper * (kBall + paper) / report.h;
      report.min_base_distance = claim;
      PathAudit audit{.samples = 5};
      audit_path(model, start, state, report, 1, audit);
      return audit.violations;
    };
    const double claim = honest.min_base_distance;
    EXPECT_EQ(violations(0, claim), 0);
    EXPECT_EQ(violations(0.03, claim), 0);  // an overlap that is granted
    EXPECT_EQ(violations(0.05, claim), 1);  // one that is not (CA-6): 250 times deeper than the crumb's
    EXPECT_EQ(violations(0.03, kBall + paper), 1);
  }
}

TEST(PathAudit, IsFreeIfNothingIsAskedAndRefusesAStepWithoutAPath) {
  const Scene s = thrown_block();
  PathAudit none, asked{.samples = 1};
  audit_path(s.model, s.state, s.state, {}, 1, none);
  EXPECT_EQ(none.steps, 0);
  EXPECT_NE(message_of([&] { audit_path(s.model, s.state, s.state, {}, 1, asked); }).find("path"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
