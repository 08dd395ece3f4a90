// SPDX-License-Identifier: Apache-2.0
#include "examples/common/audit_report.hpp"

#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

// A block on a plate and two parts on hinges, of which one has no shape.
Scene hinged_parts() {
  Scene s = block_on_plate(0.3, 0, 0);
  const RigidBody block = s.model.bodies[std::size_t(s.block)];
  for (const auto& [name, shape] : {std::pair{"lid", block.shape}, std::pair{"pin", -1}}) {
    RigidBody part = block;
    part.name = name, part.shape = shape;
    const int body = add(s.model, part);
    add(s.model, Joint{.kind = JointKind::spherical, .body_a = body, .body_b = s.block});
  }
  s.state = rest_state(s.model);
  return s;
}

std::string told(const PathAudit& audit, const Model& model) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(tell(audit, model), audit.violations == 0);
  return testing::internal::GetCapturedStdout();
}

TEST(AuditReport, NamesThePairsThatNobodyLooksAt) {
  const Scene s = hinged_parts();
  Summary summary;
  set_audit(summary, {.samples = 3, .steps = 2}, s.model);
  EXPECT_NE(to_json(summary).find("\"certify_skipped\": [\n    \"block and lid\"\n  ]"), std::string::npos)
      << to_json(summary);
  EXPECT_EQ(
      told({.samples = 3, .steps = 2}, s.model),
      "certify: 2 steps, 3 places and the end of each, no two bodies came within twice their dilations, "
      "0 violations\n"
      "certify: not looked at, because they pass through each other: block and lid\n");
  EXPECT_EQ(
      told({.samples = 3, .min_distance = 2e-3, .min_slack = 1e-3, .steps = 2, .violations = 1, .nested = 1},
           block_on_plate(0, 0, 0).model),
      "certify: 2 steps, 3 places and the end of each, base distance at least 2000 um, 1000 um above the "
      "certificate, 1 violation\n"
      "certify: a body was inside another in 1 step\n");
  EXPECT_EQ(told({}, s.model), "");
}

TEST(AuditReport, AddsUpOfWhomTheCertificatesDoNotSpeak) {
  Uncertified run;
  for (int k = 0; k < 5; ++k) {
    StepReport report{.t = 0.5 * (k + 1), .h = 0.5, .passing_pairs = k % 4};
    if (k == 2 || k == 4) report.driven_overlaps = {{0, 1}, {0, 2}};
    add(run, report);
  }
  Checkpoint checkpoint;
  keep(run, checkpoint);
  for (const Uncertified& of : {run, uncertified_of(checkpoint)}) {
    EXPECT_EQ(of.passing_pairs, 3);
    EXPECT_EQ(of.driven_overlaps, 2);
    EXPECT_EQ(of.driven_t, 1);
  }
  Summary summary;
  set_uncertified(summary, {});
  EXPECT_NE(to_json(summary).find("\"driven_overlap_t\": null"), std::string::npos);
}

}  // namespace
}  // namespace aussois
