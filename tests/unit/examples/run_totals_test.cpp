// SPDX-License-Identifier: Apache-2.0
#include "examples/common/driven_run.hpp"
#include "io/record.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// A block on a plate and two parts on hinges, of which one has no shape.
Scene hinged_parts() {
  Scene s = block_on_plate(0.3, 0, 0);
  const RigidBody block = s.model.bodies[s.block];
  for (const auto& [name, shape] : {std::pair{"lid", block.shape}, std::pair{"pin", ShapeId()}}) {
    RigidBody part = block;
    part.name = name, part.shape = shape;
    const BodyId body = add(s.model, part);
    add(s.model, Joint{.kind = JointKind::spherical, .body_a = body, .body_b = s.block});
  }
  s.state = rest_state(s.model);
  return s;
}

std::string told(const PathAudit& audit, const Model& model) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(print_findings(audit, model), audit.violations == 0);
  return testing::internal::GetCapturedStdout();
}

TEST(RunTotals, NameThePairsThatNobodyLooksAt) {
  const Scene s = hinged_parts();
  Summary summary;
  set_totals({.audit = {.samples = 3, .steps = 2}}, s.model, summary);
  EXPECT_NE(to_json(summary).find("\"certify_skipped\": [\n    \"block and lid\"\n  ]"), std::string::npos)
      << to_json(summary);
  EXPECT_EQ(
      told({.samples = 3, .steps = 2}, s.model),
      "certify: 2 steps, each at 3 places and at its end, no two bodies came within twice their dilations, "
      "0 violations\n"
      "certify: not checked, because they may pass through each other: block and lid\n");
  EXPECT_EQ(
      told({.samples = 3, .min_distance = 2e-3, .min_slack = 1e-3, .steps = 2, .violations = 1, .nested = 1},
           block_on_plate(0, 0, 0).model),
      "certify: 2 steps, each at 3 places and at its end, base distance at least 2000 um, 1000 um above the "
      "certificate, 1 violation\n"
      "certify: one body was inside another in 1 step\n");
  EXPECT_EQ(told({}, s.model), "");
}

TEST(RunTotals, AddUpOfWhomTheCertificatesDoNotSpeak) {
  const Scene s = block_on_plate(0.3, 0, 0);
  RunTotals run = run_totals(s.model, s.state, 0);
  for (int k = 0; k < 5; ++k) {
    StepReport report{.t = 0.5 * (k + 1), .h = 0.5, .passing_pairs = k % 4};
    if (k == 2 || k == 4) report.driven_overlaps = {{0, 1}, {0, 2}};
    add_frame({s.model, s.state, s.state, s.state, report, k + 1}, 1, run);
  }
  Checkpoint checkpoint;
  keep_totals(run, checkpoint);
  for (const RunTotals& of : {run, run_totals_of(checkpoint, 0)}) {
    EXPECT_EQ(of.uncertified.passing_pairs, 3);
    EXPECT_EQ(of.uncertified.driven_overlaps, 2);
    EXPECT_EQ(of.uncertified.driven_t, 1);
  }
  Summary summary;
  set_totals({}, s.model, summary);
  EXPECT_NE(to_json(summary).find("\"driven_overlap_t\": null"), std::string::npos);
}

}  // namespace
}  // namespace aussois
