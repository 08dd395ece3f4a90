// SPDX-License-Identifier: Apache-2.0
#include "io/recording.hpp"

#include "io/record.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// Columns, totals and checkpoint come from one list: a run that was stopped tells what one that was not
// tells.
TEST(Recording, GoesOnWithItsTotalsAndItsTable) {
  const std::filesystem::path folder = fresh_folder();
  const Scene s = block_on_plate(0.3, 0, 0, 0.01);
  const Scheme scheme = make_scheme("moreau_jean", s.model, {.step = {.h = 1e-3}});
  std::vector<Gauge> list =
      gauges({"step", "t", "min_gap", "displacement", "total:solver_failures", "total:max_contacts"});
  list.push_back({"speed", "top_speed", GaugeTotal::most, [](const Frame& f) { return f.state.v.norm(); }});
  list.push_back({"", "travel", GaugeTotal::sum,
                  [](const Frame& f) { return (f.state.g[1].p - f.before.g[1].p).norm(); }});
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
    }
    return std::pair(to_json(told), content_of(options.folder / "steps.csv"));
  };
  const auto whole = run("whole", 0), parts = run("parts", 37);
  EXPECT_EQ(whole, parts);
  EXPECT_EQ(names_in(folder / "parts"), (std::set<std::string>{"run.h5", "steps.csv"}));
  EXPECT_EQ(whole.second.substr(0, whole.second.find('\n')), "step,t,min_gap,displacement,speed");
  EXPECT_EQ(std::ranges::count(whole.second, '\n'), 1 + 33);
  const RunData data = read_run(folder / "parts" / "run.h5");
  EXPECT_EQ(data.header.gauges, (std::vector<std::string>{"step", "t", "min_gap", "displacement", "speed"}));
  ASSERT_EQ(data.steps.size(), 1U + 33);
  EXPECT_TRUE(data.steps[0].gauges.array().isNaN().all());
  for (std::size_t k = 1; k < data.steps.size(); ++k) {
    EXPECT_EQ(data.steps[k].gauges[1], data.steps[k].time);
    EXPECT_EQ(data.steps[k].gauges[4], data.steps[k].velocity.norm());
  }
}

TEST(Recording, LeavesTheTimeThatPassedToTheTable) {
  const std::filesystem::path folder = fresh_folder();
  const Scene s = block_on_plate(0.3, 0, 0);
  Recording recording(s.model, run_header(s.model), gauges({"t", "ms_total"}), {.folder = folder}, s.state);
  State state = s.state;
  EXPECT_TRUE(record_run(make_scheme("moreau_jean", s.model, {}), state, 5e-3, recording).ok());
  recording.close();
  EXPECT_EQ(read_run(folder / "run.h5").header.gauges, std::vector<std::string>{"t"});
  EXPECT_EQ(content_of(folder / "steps.csv").substr(0, 11), "t,ms_total\n");
}

TEST(Recording, RefusesGaugesThatDoNotFit) {
  const Scene s = block_on_plate(0.3, 0, 0);
  const auto refused = [&](const std::vector<Gauge>& list) {
    return message_of(
        [&] { Recording(s.model, run_header(s.model), list, {.folder = fresh_folder()}, s.state); });
  };
  const auto zero = [](const Frame&) { return 0.0; };
  EXPECT_EQ(refused({{"a", "", GaugeTotal::nothing, {}}}), "Gauge a: value must be callable");
  EXPECT_EQ(refused({{"a", "", GaugeTotal::sum, zero}}), "Gauge a: a total needs a name, and a name a total");
  EXPECT_EQ(refused({{"a", "x", GaugeTotal::sum, zero}, {"b", "x", GaugeTotal::most, zero}}),
            "Gauge x: two have this total");
  EXPECT_EQ(message_of([] { (void)gauge("speed"); }).find("gauge = speed must be one of step, t, h, "), 0U);
}

}  // namespace
}  // namespace aussois
