// SPDX-License-Identifier: Apache-2.0
// Simulates recorded tosses of a real cube onto a board, from shortly before the first contact: how far are
// the roll-outs from what a camera recorded?
//
// Theory   doc/theory/cube_toss.md
// Run      cube_toss --synthetic 20 --replay toss_003
//          cube_toss --synthetic 6 --fit --replay toss_002
//          cube_toss --synthetic 6 --substeps 3 --certify 20 --replay toss_004
// Expect   mean errors of position and rotation over all tosses; no refused step
//
// It can be interrupted at any time: the next call with the same -o continues. Tosses of --synthetic are
// data: while they are made they are neither audited nor written as problems.
#include <cmath>
#include <cstdio>

#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/scheme_flags.hpp"
#include "examples/studies/toss/toss_fit.hpp"
#include "examples/studies/toss/toss_report.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path data{}, test{};
  int synthetic = 0;
  std::uint64_t seed = 1;
  double noise = 5e-4;
  TossWorld world{};
  SchemeFlags scheme{};
  WatchFlags watch{};
  double scale = 1;
  ContactLaw from{.mu = 0.3, .restitution = 0.3};  // of a fit; far from what tosses were found to have
  bool fit = false, measure_board = false, swap = false;
  std::string replay{};
  CommonOptions common{};
  std::string command_line{};
};

std::vector<Toss> synthetic_tosses(const Arguments& a) {
  std::vector<Toss> tosses(static_cast<std::size_t>(a.synthetic));
  parallel_for(a.synthetic, a.common.threads,
               [&](int i) { tosses[i] = synthetic_toss(unsigned(a.seed) + unsigned(i), a.world, a.noise); });
  const std::filesystem::path folder = a.common.out / "synthetic";
  std::filesystem::create_directories(folder);
  for (const Toss& toss : tosses) write_toss(folder, toss);
  return tosses;
}

TossKeep keep_of(const Arguments& a) {
  return {.folder = a.common.out / "results",
          .read = a.watch.dump.folder.empty(),  // files of problems are wanted
          .choice = choice_text(a.scheme, a.world.options)};
}

// `name` of the tosses; none if it was interrupted.
TossRuns roll_out_all(const Arguments& a, const std::string& name, const std::vector<Toss>& tosses,
                      const TossWorld& world, Progress& progress) {
  return roll_out_all(tosses, world, a.watch, keep_of(a), name, a.common.threads, [&](int done) {
    progress.at(double(done));
    return !interrupted();
  });
}

void print_errors(const char* what, const std::vector<TossRun>& runs) {
  const TossStatistics s = statistics_of(runs);
  std::printf(
      "%-12s %4zu tosses: position %.2f +- %.2f %% of the edge (median %.2f), rotation %.2f +- %.2f deg "
      "(median %.2f), loss %.4f\n",
      what, runs.size(), s.position.mean, s.position.sd, s.position.median, s.rotation.mean, s.rotation.sd,
      s.rotation.median, s.loss);
}

// The toss whose loss is the median, or the one that was asked for.
std::size_t shown(const std::vector<Toss>& tosses, const std::vector<TossRun>& runs,
                  const std::string& name) {
  if (!name.empty()) {
    for (std::size_t i = 0; i < tosses.size(); ++i)
      if (tosses[i].name == name) return i;
    throw std::invalid_argument("--replay " + name + ": no such toss");
  }
  std::vector<std::size_t> order(runs.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return runs[i].errors.loss; });
  return order[order.size() / 2];
}

std::vector<Toss> every_second(const std::vector<Toss>& tosses, std::size_t from) {
  std::vector<Toss> out;
  for (std::size_t i = from; i < tosses.size(); i += 2) out.push_back(tosses[i]);
  return out;
}

// `audit` of what else was rolled out.
ExitCode finish(const Arguments& a, Summary& summary, const std::vector<Toss>& tosses,
                const std::vector<TossRun>& runs, const TossWorld& world, RunAudit audit = {}) {
  std::int64_t failures = 0;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (!runs[i].failure.empty()) {
      ++failures;
      std::fprintf(stderr, "%s: %s\n", tosses[i].name.c_str(), runs[i].failure.c_str());
    }
  summary.set("failures", failures);
  for (const TossRun& run : runs) add(run.audit, audit);
  set_audit(audit, summary);
  set_profile(a.watch, summary);
  print_profile(a.watch);
  write_toss_table(a.common.out, tosses, runs);
  if (!write_toss_histogram(a.common.out, runs))
    std::fprintf(stderr, "no histogram.png: gnuplot is missing or failed\n");
  const std::size_t i = shown(tosses, runs, a.replay);
  write_toss_replay(a.common.out, tosses[i], world, a.command_line);
  summary.set("replay", tosses[i].name);
  if (!a.common.summary.empty()) write_summary(a.common.summary, summary);
  std::printf("%s: per-toss table, histogram and %s.html\n", a.common.out.c_str(), tosses[i].name.c_str());
  return print_findings(audit) && failures == 0 ? ExitCode::ok : ExitCode::not_accepted;
}

std::vector<Toss> read_scaled(const std::filesystem::path& folder, double scale) {
  std::vector<Toss> tosses = read_tosses(folder);
  for (Toss& toss : tosses) toss = scaled_toss(std::move(toss), scale);
  return tosses;
}

ExitCode fit_and_report(const Arguments& a, const std::vector<Toss>& tosses) {
  require(tosses.size() >= 2, "--fit needs at least two tosses");
  const std::vector<Toss> seen = a.test.empty() ? every_second(tosses, a.swap ? 1 : 0) : tosses,
                          unseen = a.test.empty() ? every_second(tosses, a.swap ? 0 : 1)
                                                  : read_scaled(a.test, a.scale);
  TossWorld world = a.world;
  world.law = a.from;
  if (a.measure_board) world.board = board_of(seen);
  TossFit found;
  {
    constexpr double kAbout = 35;  // points
    Progress progress("cube_toss --fit", kAbout, Progress::style_of_stderr(a.common.quiet));
    found = fit(
        seen, world, a.common.threads,
        [&](const TossFit& at) {
          char note[80];
          std::snprintf(note, sizeof note, "mu %.4f e %.4f error %.3f mm", at.mu, at.restitution,
                        1e3 * at.error);
          progress.at(std::min(double(at.points), kAbout), note);
          return !interrupted();
        },
        keep_of(a), a.watch);
  }
  if (interrupted()) return ExitCode::interrupted;
  world.law.mu = found.mu;
  world.law.restitution = found.restitution;
  Progress progress("cube_toss", double(seen.size() + unseen.size()),
                    Progress::style_of_stderr(a.common.quiet));
  const TossRuns of_seen = roll_out_all(a, "seen", seen, world, progress);
  const TossRuns of_unseen = roll_out_all(a, "unseen", unseen, world, progress);
  if (interrupted()) return ExitCode::interrupted;
  const std::vector<TossRun>&runs_seen = of_seen.runs, &runs = of_unseen.runs;
  tell_known(found.known, std::size_t(found.points), keep_of(a).folder, "points of the fit");
  tell_known(of_seen.known + of_unseen.known, seen.size() + unseen.size(), keep_of(a).folder, "tosses");
  std::printf(
      "mu = %.4f, restitution = %.4f, board at %.2f mm: mean error %.3f mm after %d points, %.2g million "
      "steps\n",
      found.mu, found.restitution, 1e3 * world.board, 1e3 * found.error, found.points,
      1e-6 * double(found.steps));
  print_errors("seen", runs_seen);
  print_errors("unseen", runs);
  Summary summary;
  summary.set("tosses", std::int64_t(seen.size() + unseen.size()));
  summary.set("unseen", std::int64_t(unseen.size()));
  summary.set("mu", found.mu);
  summary.set("restitution", found.restitution);
  summary.set("board_m", world.board);
  summary.set("fit_error_m", found.error);
  summary.set("fit_points", found.points);
  summary.set("fit_steps", found.steps);
  set_errors(summary, "seen_", statistics_of(runs_seen));
  set_errors(summary, "", statistics_of(runs));
  RunAudit audit = found.audit;
  for (const TossRun& run : runs_seen) add(run.audit, audit);
  return finish(a, summary, unseen, runs, world, audit);
}

ExitCode run(Arguments& a) {
  require(a.data.empty() != (a.synthetic == 0), "give either --data or --synthetic");
  require(a.test.empty() || !a.swap,
          "--swap and --test cannot be combined: --test fits to all tosses of --data");
  a.world.scheme = a.scheme.scheme;
  a.world.options = scheme_options(a.scheme);
  require(
      scheme_traits(a.world.scheme, a.world.options).restitution || (!a.fit && a.world.law.restitution == 0),
      label(a.world.scheme, a.world.options) + " is plastic: it needs --restitution 0, without --fit");
  make_folders(a.common);
  std::vector<Toss> tosses = a.synthetic > 0 ? synthetic_tosses(a) : read_scaled(a.data, a.scale);
  if (a.synthetic > 0)
    for (Toss& toss : tosses) toss = scaled_toss(std::move(toss), a.scale);
  if (a.fit) return fit_and_report(a, tosses);
  Progress progress("cube_toss", double(tosses.size()), Progress::style_of_stderr(a.common.quiet));
  const TossRuns done = roll_out_all(a, "all", tosses, a.world, progress);
  if (interrupted()) return ExitCode::interrupted;
  const std::vector<TossRun>& runs = done.runs;
  tell_known(done.known, tosses.size(), keep_of(a).folder, "tosses");
  print_errors(a.synthetic > 0 ? "synthetic" : "all", runs);
  Summary summary;
  summary.set("tosses", std::int64_t(tosses.size()));
  summary.set("synthetic", a.synthetic > 0);
  summary.set("mu", a.world.law.mu);
  summary.set("restitution", a.world.law.restitution);
  summary.set("substeps", a.world.substeps);
  summary.set("scheme", label(a.world.scheme, a.world.options));
  summary.set("reducer", to_string(a.world.options.step.reduction.reducer));
  summary.set("cut", a.world.cut);
  std::int64_t reduced = 0;
  for (const TossRun& r : runs) reduced += r.reduced_steps;
  summary.set("reduced_steps", reduced);
  summary.set("scale", a.scale);
  set_errors(summary, "", statistics_of(runs));
  summary.set("cpu_s", done.cpu_s);
  return finish(a, summary, tosses, runs, a.world);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  start_from_theta(a.scheme.options, 1);  // of the study: doc/theory/cube_toss.md
  Cli cli("cube_toss",
          "Simulates recorded tosses of a cube and reports the errors of position and rotation: mean over "
          "time, then over tosses.");
  cli.group("data");
  cli.input("--data", a.data, "folder with recorded tosses: toss_*.csv with columns t_s, px_m ... wz_radps");
  cli.option("--synthetic", a.synthetic, "number of synthetic tosses to simulate instead of --data; 0: none",
             "", {0, 999});
  cli.option("--seed", a.seed, "seed of the first synthetic toss");
  cli.option("--noise", a.noise, "measurement noise of synthetic tosses", "m", {0, 0.01});
  cli.option("--scale", a.scale, "factor on recorded lengths; 1.0225 corrects the scale error of the data",
             "-", {0.5, 2});
  cli.group("world");
  cli.option(setting_of<TossWorld>("law.mu"), a.world.law.mu);
  cli.option(setting_of<TossWorld>("law.restitution"), a.world.law.restitution);
  cli.option(setting_of<TossWorld>("board"), a.world.board);
  cli.flag("--fit", a.fit, "identify friction and restitution from every second toss, report the others");
  cli.option("--from-mu", a.from.mu, "with --fit: friction coefficient from which the search starts", "-",
             setting_of<ContactLaw>("mu").range);
  cli.option("--from-restitution", a.from.restitution,
             "with --fit: restitution coefficient from which the search starts", "-",
             setting_of<ContactLaw>("restitution").range);
  cli.flag("--measure-board", a.measure_board,
           "with --fit: estimate --board from the rest heights of the tosses it fits");
  cli.flag("--swap", a.swap, "with --fit: exchange the tosses to identify from and those to report");
  cli.input("--test", a.test, "with --fit: identify from all tosses of --data, report those of this folder");
  cli.option(setting_of<TossWorld>("cut"), a.world.cut);
  cli.group("stepping");
  cli.option(setting_of<TossWorld>("substeps"), a.world.substeps);
  cli.group("results");
  cli.option("--json", a.common.summary, "the same as --summary");
  cli.option("--replay", a.replay,
             "toss to replay in the browser, such as toss_042; empty: the one of median loss");
  add_options(cli, a.scheme);
  add_options(cli, a.watch, "roll-outs");
  cli.common(a.common, Cli::Restart::by_itself);
  cli.example("cube_toss --data cube_toss --json out/toss.json", "all 347 tosses");
  cli.example("cube_toss --data cube_toss --fit",
              "friction and restitution from one half, tested on the other");
  cli.example("cube_toss --data first --fit --test second", "the same with two folders");
  cli.example("cube_toss --synthetic 40 --fit",
              "recovers the values that its synthetic tosses were made with");
  return run_driver(cli, argc, argv, [&] {
    refuse_unread_flags(cli, a.scheme);
    check(cli, a.watch.dump, a.scheme.scheme);
    if (a.synthetic == 0) refuse_given(cli, {"--seed", "--noise"}, "--synthetic");
    if (!a.fit)
      refuse_given(cli, {"--from-mu", "--from-restitution", "--swap", "--measure-board", "--test"}, "--fit");
    for (const char* flag : {"--mu", "--restitution"})
      require(!a.fit || a.synthetic > 0 || !cli.is_given(flag),
              flag + std::string(" is identified by --fit; set the start of its search with --from-mu and "
                                 "--from-restitution"));
    require(!a.measure_board || !cli.is_given("--board"), "--board is what --measure-board finds");
    return run(a);
  });
}
