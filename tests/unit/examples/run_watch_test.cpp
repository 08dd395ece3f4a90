// SPDX-License-Identifier: Apache-2.0
// What a watch sees of a run changes nothing in it, adds up over runs and reads back as the same bits.
#include "examples/common/run_watch.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

/// A box a millimetre above a plate, and its way down.
struct Fall {
  Model model{};
  State state{};
};
Fall falling_box() {
  Fall out;
  const ShapeId plate = add(out.model, prepare(dilate(make_plate(1, 1), 1e-3))),
                box = add(out.model, prepare(dilate(make_box(0.1, 0.1, 0.1), 1e-3)));
  add(out.model, fixed_body("plate", plate));
  const BodyId body = add(out.model, solid_body("box", box, mass_properties(make_box(0.1, 0.1, 0.1), 1000)));
  out.state = rest_state(out.model);
  pose(out.state, body).p.z() = 0.053;
  return out;
}

RunAudit audit_of(const WatchFlags& flags, State& end) {
  Fall fall = falling_box();
  RunWatch watch(flags, "fall");
  SchemeOptions options{.step = {.h = 1e-3}};
  watch.set_options(options.step);
  const Scheme scheme = watch.watched(fall.model, make_scheme("moreau_jean", fall.model, options));
  EXPECT_TRUE(run_until(scheme, fall.state, 0.03).ok());
  end = fall.state;
  return watch.audit();
}

}  // namespace

TEST(RunWatch, AuditsEveryStepAndChangesNone) {
  State plain, watched;
  const RunAudit none = audit_of({}, plain), found = audit_of({.certify = 7}, watched);
  EXPECT_EQ(none.path.steps, 0);
  EXPECT_GE(found.path.steps, 30);
  EXPECT_EQ(found.path.violations, 0);
  EXPECT_GT(found.path.min_distance, 1.9e-3);  // two dilations, less the overlap that is granted
  EXPECT_LT(found.path.min_distance, 2.1e-3);
  EXPECT_EQ(plain.g[1].p, watched.g[1].p);
  EXPECT_EQ(plain.v, watched.v);
}

TEST(RunWatch, WritesProblemsUnderTheNameOfTheRun) {
  const std::filesystem::path folder = fresh_folder() / "steps";
  State end;
  audit_of({.dump = {.folder = folder, .steps = "25"}}, end);
  EXPECT_TRUE(std::filesystem::exists(folder / "fall_000025.hdf5"));
  const Cli cli("driver", "of nothing");
  EXPECT_NE(message_of([&] { check(cli, {.folder = "steps"}, "event_driven"); }).find("no one-step problem"),
            std::string::npos);
}

TEST(RunAudit, AddsCountsAndKeepsTheLeastDistances) {
  RunAudit all;
  add({.path = {.samples = 5, .min_distance = 2, .min_slack = -1, .steps = 10, .violations = 1, .nested = 2},
       .skipped = {"a and b"}},
      all);
  add({.path = {.samples = 5, .min_distance = 1, .steps = 3, .violations = 2, .uncovered = 4},
       .skipped = {"c and d", "a and b"}},
      all);
  add({}, all);
  EXPECT_EQ(all.path.samples, 5);
  EXPECT_EQ(all.path.min_distance, 1);
  EXPECT_EQ(all.path.min_slack, -1);
  EXPECT_EQ(all.path.steps, 13);
  EXPECT_EQ(all.path.violations, 3);
  EXPECT_EQ(all.path.nested, 2);
  EXPECT_EQ(all.path.uncovered, 4);
  EXPECT_EQ(all.skipped, (std::vector<std::string>{"a and b", "c and d"}));
}

TEST(RunAudit, ReadsBackTheSameBits) {
  const RunAudit audit{
      .path =
          {.samples = 3, .min_distance = 0.1 + 0.2, .steps = 7, .violations = 1, .nested = 2, .uncovered = 3},
      .skipped = {"lid and box"}};
  const auto text = json_of(audit).dump();
  const RunAudit back = audit_in(nlohmann::ordered_json::parse(text));
  EXPECT_EQ(back.path.min_distance, audit.path.min_distance);
  EXPECT_EQ(back.path.min_slack, kInf);
  EXPECT_EQ(json_of(back).dump(), text);
  EXPECT_ANY_THROW(audit_in({{"samples", 3}}));
}

}  // namespace aussois
