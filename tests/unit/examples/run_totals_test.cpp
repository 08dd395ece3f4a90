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
  EXPECT_EQ(tell(audit, model), audit.violations == 0);
  return testing::internal::GetCapturedStdout();
}

TEST(RunTotals, NameThePairsThatNobodyLooksAt) {
  const Scene s = hinged_parts();
  Summary summary;
  set({.audit = {.samples = 3, .steps = 2}}, s.model, summary);
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
    add({s.model, s.state, s.state, s.state, report, k + 1}, 1, run);
  }
  Checkpoint checkpoint;
  keep(run, checkpoint);
  for (const RunTotals& of : {run, run_totals_of(checkpoint, 0)}) {
    EXPECT_EQ(of.uncertified.passing_pairs, 3);
    EXPECT_EQ(of.uncertified.driven_overlaps, 2);
    EXPECT_EQ(of.uncertified.driven_t, 1);
  }
  Summary summary;
  set({}, s.model, summary);
  EXPECT_NE(to_json(summary).find("\"driven_overlap_t\": null"), std::string::npos);
}

// Columns, totals and checkpoint come from one list: a run that was stopped tells what one that was not
// tells.
TEST(Recording, GoesOnWithItsTotalsAndItsTable) {
  const std::filesystem::path folder = fresh_folder();
  const Scene s = block_on_plate(0.3, 0, 0, 0.01);
  const Scheme scheme = make_scheme("moreau_jean", s.model, {.step = {.h = 1e-3}});
  std::vector<Gauge> list =
      gauges({"step", "t", "min_gap", "displacement", "total:solver_failures", "total:max_contacts"});
  list.push_back({"speed", "top_speed", Keep::most, [](const Frame& f) { return f.state.v.norm(); }});
  list.push_back({"", "last_speed", Keep::last, [](const Frame& f) { return f.state.v.norm(); }});
  list.push_back(
      {"", "travel", Keep::sum, [](const Frame& f) { return (f.state.g[1].p - f.before.g[1].p).norm(); }});
  const auto run = [&](const std::string& name, int stop) {
    const RecordingOptions options{.folder = folder / name, .every = 3, .audit_samples = 1};
    std::filesystem::create_directories(options.folder);
    Summary told;
    for (const bool again : {false, true}) {
      if (again && stop == 0) break;
      RecordingOptions o = options;
      o.resume = again;
      Recording recording(s.model, run_header(s.model), list, o, s.state);
      State state = recording.state();
      const StepReport last = record_run(scheme, state, 0.1, recording, [&](const StepReport&) {
        return again || stop == 0 || recording.steps() < stop;
      });
      EXPECT_TRUE(last.ok());
      if (stop > 0 && !again) {
        recording.checkpoint();
        continue;
      }
      recording.close();
      recording.set(told);
      EXPECT_EQ(recording.steps(), 100);
      EXPECT_EQ(recording.total("last_speed"), state.v.norm());
    }
    return std::pair(to_json(told), content_of(options.folder / "steps.csv"));
  };
  const auto whole = run("whole", 0), parts = run("parts", 37);
  EXPECT_EQ(whole, parts);
  EXPECT_EQ(names_in(folder / "parts"), (std::set<std::string>{"run.h5", "steps.csv"}));
  EXPECT_EQ(whole.second.substr(0, whole.second.find('\n')), "step,t,min_gap,displacement,speed");
  EXPECT_EQ(std::ranges::count(whole.second, '\n'), 1 + 33);
}

TEST(Recording, RefusesGaugesThatDoNotFit) {
  const Scene s = block_on_plate(0.3, 0, 0);
  const auto refused = [&](const std::vector<Gauge>& list) {
    return message_of(
        [&] { Recording(s.model, run_header(s.model), list, {.folder = fresh_folder()}, s.state); });
  };
  const auto zero = [](const Frame&) { return 0.0; };
  EXPECT_EQ(refused({{"a", "", Keep::nothing, {}}}), "Gauge a: value must be callable");
  EXPECT_EQ(refused({{"a", "", Keep::sum, zero}}), "Gauge a: a total needs a name, and a name a total");
  EXPECT_EQ(refused({{"a", "x", Keep::sum, zero}, {"b", "x", Keep::most, zero}}),
            "Gauge x: two have this total");
  EXPECT_EQ(message_of([] { (void)gauge("speed"); }).find("gauge = speed must be one of step, t, h, "), 0U);
}

}  // namespace
}  // namespace aussois
