// SPDX-License-Identifier: Apache-2.0
// How much energy does a hand get beyond what was stored in the simulation? Simulated hands on a
// simulated device push a part against a plate, into a slot and between two slopes, at several rates.
//
// Theory   doc/theory/ports.md (PORT-1) to (PORT-11)
// Run      haptic_trial --pushes 3
//          haptic_trial --scene wall --hand loose shaking --way held --rate 10:0 --pushes 3
// Expect   out/haptic_trial.csv. With a reserve, no excess beyond what is lent, 10 mJ, by the encoders, nor
//          1.5 mJ more in truth: exit code 0. Other ways are not judged.
#include "examples/studies/haptic/haptic_trial.hpp"

#include <atomic>
#include <cstdio>
#include <string>

#include "examples/common/driver.hpp"
#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "io/atomic_file.hpp"
#include "io/summary.hpp"

using namespace aussois;

namespace {

constexpr double kHidden = 1.5e-3;  // what encoders of 10 um may hide at forces of tens of newtons [J]

struct Arguments {
  std::vector<std::string> scenes = names_of(kHapticScenes), hands = names_of(kHandKinds),
                           rates{"1:0", "3:0", "10:0", "1:3"};
  std::string way = "reserve";
  HapticTrial trial{};
  CommonOptions common{};
};

template <class Enum, std::size_t n>
std::vector<Enum> named(const char* flag, const std::vector<std::string>& words,
                        const Named<Enum> (&all)[n]) {
  std::vector<Enum> out;
  for (const std::string& word : words) out.push_back(value_named(word, flag, all));
  return out;
}

/// "10:3": one step for ten samples, forces three samples late.
std::pair<int, int> rate_of(const std::string& word) {
  int every = 0, late = 0, read = 0;
  const bool ok = std::sscanf(word.c_str(), "%d:%d%n", &every, &late, &read) == 2 &&
                  std::size_t(read) == word.size() && every >= 1 && every <= 100 && late >= 0 && late <= 100;
  require(ok, "--rate must be SAMPLES:LATE, two whole numbers from 1 and 0 up to 100, not " + word);
  return {every, late};
}

std::vector<HapticTrial> trials(const Arguments& a) {
  std::vector<HapticTrial> out;
  for (const HapticScene scene : named("--scene", a.scenes, kHapticScenes))
    for (const std::string& rate : a.rates)
      for (const HandKind hand : named("--hand", a.hands, kHandKinds)) {
        HapticTrial& trial = out.emplace_back(a.trial);
        trial.scene = scene;
        trial.hand = hand;
        trial.way = value_named(a.way, "--way", kHapticWays);
        std::tie(trial.every, trial.late) = rate_of(rate);
      }
  return out;
}

std::string row_text(const HapticTrial& t, const HapticResult& r) {
  char text[256];
  std::snprintf(text, sizeof text, "%s,%s,%g,%d,%d,%s,%.6g,%.6g,%.6g,%.3g,%.4g,%.4g,%lld,%lld,%lld,%lld\n",
                name_of(t.scene, kHapticScenes), name_of(t.hand, kHandKinds), t.stiffness, t.every, t.late,
                name_of(t.way, kHapticWays), r.excess, r.true_excess, r.given, r.changed, r.force_left,
                r.peak, (long long)r.events, (long long)r.steps, (long long)r.unsolved, (long long)r.beyond);
  return text;
}

bool holds(const HapticTrial& trial, const HapticResult& r) {
  const bool judged = trial.way == HapticWay::reserve || trial.way == HapticWay::held_reserve;
  return !judged || (!r.flew_off && !r.refused && r.unsolved == 0 && r.beyond == 0 &&
                     r.excess <= trial.reserve.lend + 1e-9 && r.true_excess <= trial.reserve.lend + kHidden);
}

ExitCode push(const Arguments& a) {
  const std::vector<HapticTrial> all = trials(a);
  make_folders(a.common);
  std::vector<HapticResult> results(all.size());
  std::atomic<int> done = 0;
  Progress progress("haptic_trial", double(all.size()), Progress::style_of_stderr(a.common.quiet));
  parallel_for(int(all.size()), a.common.threads, [&](int i) {
    if (interrupted()) return;
    results[i] = haptic_trial(all[i], [](std::int64_t) { return !interrupted(); });
    ++done;
  });
  if (interrupted()) return ExitCode::interrupted;
  progress.at(double(done));
  std::string csv =
      "scene,hand,stiffness_N_m,samples_per_step,late_samples,way,excess_J,true_excess_J,given_J,changed,"
      "force_left,peak_N,events,steps,unsolved,beyond\n";
  bool good = true;
  double worst = 0, worst_true = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const HapticResult& r = results[i];
    csv += row_text(all[i], r);
    worst = std::max(worst, r.excess), worst_true = std::max(worst_true, r.true_excess);
    const bool held = holds(all[i], r);
    good = good && held;
    if (a.common.quiet) continue;
    std::printf(
        "%-6s %-8s %2d:%d  excess %8.4f mJ, in truth %8.4f  valve %5.2f %%  peak %5.1f N  %lld events%s\n",
        name_of(all[i].scene, kHapticScenes), name_of(all[i].hand, kHandKinds), all[i].every, all[i].late,
        1e3 * r.excess, 1e3 * r.true_excess, 100 * r.changed, r.peak, (long long)r.events,
        held                          ? ""
        : r.refused || r.unsolved > 0 ? "  STEPS UNSOLVED"
        : r.beyond > 0                ? "  HANDLE TOO FAST"
                                      : "  BOUND BROKEN");
  }
  write_whole_file(a.common.out / "haptic_trial.csv", csv);
  if (!a.common.summary.empty()) {
    Summary summary;
    summary.set("trials", all.size());
    summary.set("largest_excess_J", worst);
    summary.set("largest_true_excess_J", worst_true);
    summary.set("bounds_hold", good);
    write_summary(a.common.summary, summary);
  }
  return good ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "haptic_trial",
      "Simulated hands push a part through a port; prints the energy that they get beyond what was stored.");
  cli.group("trial");
  cli.option("--scene", a.scenes, "what is in the way: wall, slot, wedge");
  cli.option("--hand", a.hands, "who pushes: loose, soft, firm, rigid, shaking");
  cli.option(
      "--rate", a.rates,
      "SAMPLES:LATE, samples of the device for one step of the bodies, and samples by which forces are late");
  cli.choice("--way", a.way, "where the force on the hand comes from", names_of(kHapticWays));
  cli.option("--stiffness", a.trial.stiffness, "stiffness of the port", "N/m", range_above(0));
  cli.option("--pushes", a.trial.pushes, "pushes of each hand", "", {1, 1e7});
  cli.option("--lend", a.trial.reserve.lend, "energy that may leave beyond what is stored", "J",
             not_negative_range());
  cli.option("--seed", a.trial.seed, "of the hands");
  a.common.threads = ManyTasks::all_cores();
  cli.common(a.common);
  cli.example("haptic_trial", "five hands, three scenes, four rates");
  cli.example("haptic_trial --way held --rate 10:0", "without local model and valve: the hand gets joules");
  return run_driver(cli, argc, argv, [&] { return push(a); });
}
