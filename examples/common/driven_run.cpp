// SPDX-License-Identifier: Apache-2.0
#include "examples/common/driven_run.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <sstream>

#include "examples/common/progress.hpp"
#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "io/build_info.hpp"
#include "io/replay_html.hpp"

namespace aussois {

void add_run_options(Cli& cli, RunFlags& f) {
  add_options(cli, f.scheme);
  cli.group("solver");
  cli.option("--tolerance", f.tolerance, "on the scaled residual", "-", {1e-15, 0.1});
  cli.group("run");
  cli.option("--certify", f.certify,
             "look at the path of every step at so many places, to check its certificate; 0: none", "",
             {0, 1000000});
  cli.option("--stop-after", f.stop_after, "stop with a checkpoint after this many steps; 0: never", "",
             {0, 1e9});
  add_options(cli, f.dump);
  cli.common(f.common, Cli::Restart::yes);
}

std::uint64_t run_fingerprint(const Cli& cli, const RunFlags& flags, const std::string& content,
                              const std::vector<std::string>& paths) {
  std::string text = content;
  for (const char* group : {"scene", "path", "stepping", "scheme", "solver"}) {
    std::istringstream lines(cli.values(group));
    for (std::string line; std::getline(lines, line);)
      if (std::ranges::find(paths, line.substr(0, line.find(' '))) == paths.end()) (text += '\n') += line;
  }
  for (const int often : {flags.common.every, flags.certify}) (text += '\n') += std::to_string(often);
  return fingerprint_of(text);
}

void check(const Cli& cli, const RunFlags& flags) {
  refuse_unread(cli, flags.scheme);
  step_choice(flags.dump.steps);
  require(flags.dump.folder.empty() || flags.scheme.scheme != "event_driven",
          "--dump-problem: event_driven solves no problem of a step");
}

SchemeOptions step_options_of(const RunFlags& flags, double h) {
  SchemeOptions out = scheme_options(flags.scheme);
  out.h = h;
  if (flags.scheme.min_h == 0) out.advancement.min_h = std::min(out.advancement.min_h, 1e-4 * h);
  out.solver.tolerance = flags.tolerance;
  out.threads = flags.common.threads;
  out.keep_problem = !flags.dump.folder.empty();
  return out;
}

namespace {

RecordingOptions recording_options(const RunPlan& plan, const RunFlags& flags) {
  const CommonOptions& o = flags.common;
  return {.folder = o.out,
          .every = o.every,
          .checkpoint_every = o.checkpoint_every,
          .resume = o.resume,
          .other = o.resume_anyway ? OtherProgram::accept : OtherProgram::refuse,
          .fingerprint = plan.fingerprint,
          .audit_samples = flags.certify,
          .threads = o.threads,
          .pull = plan.pull};
}

void tell_other_program(const Recording& recording, const std::filesystem::path& folder) {
  if (recording.other_program().empty()) return;
  std::fprintf(stderr, "%s: written by %s, continued by %s: the bits of this run are those of neither\n",
               (folder / "checkpoint.h5").c_str(), recording.other_program().c_str(),
               program_version().c_str());
}

void write_page(const Model& model, const std::filesystem::path& folder) {
  const std::filesystem::path replay = folder / "replay.html";
  if (std::ranges::any_of(model.bodies, [](const RigidBody& b) { return b.shape >= 0; })) {
    RunReader run(folder / "run.h5");
    write_replay_html(replay, run);
  } else {
    std::filesystem::remove(replay);  // that of another scene
    std::printf("no replay: no body of this scene has a shape\n");
  }
}

std::string nearest_of(const PathAudit& audit) {
  if (!(audit.min_distance < kInf)) return "no two bodies came within twice their dilations";
  char text[100];
  std::snprintf(text, sizeof text, "base distance at least %.4g um, %.4g um above the certificate",
                1e6 * audit.min_distance, 1e6 * audit.min_slack);
  return text;
}

}  // namespace

DrivenRun drive(const Scheme& scheme, const Model& model, const State& start, RunPlan plan,
                const RunFlags& flags) {
  make_folders(flags.common);
  plan.header.build = build_info();
  DrivenRun out{.recording = Recording(model, plan.header, std::move(plan.gauges),
                                       recording_options(plan, flags), start)};
  out.state = out.recording.state();
  out.first = out.recording.steps();
  tell_other_program(out.recording, flags.common.out);
  StepDump dump(flags.dump, plan.driver + "_" + plan.name);
  Progress progress(plan.driver, plan.t_end, Progress::style_of_stderr(flags.common.quiet));
  const Scheme timed{.name = scheme.name, .step = [&](State& s, double h_limit) {
                       const std::clock_t begin = std::clock();
                       StepReport report = scheme.step(s, h_limit);
                       out.step_cpu += double(std::clock() - begin) / CLOCKS_PER_SEC;
                       return report;
                     }};
  out.last = record_run(timed, out.state, plan.t_end, out.recording, [&](const StepReport& report) {
    const std::int64_t steps = out.recording.steps();
    dump.step(steps + !report.moved(), report);
    char note[80];
    std::snprintf(note, sizeof note, "step %lld, %s", static_cast<long long>(steps),
                  counted(report.contacts_found, "contact").c_str());
    progress.at(out.state.t, note);
    out.interrupted = interrupted() || (flags.stop_after > 0 && steps >= flags.stop_after);
    return !out.interrupted;
  });
  if (out.interrupted) {
    out.recording.checkpoint();
    std::fprintf(stderr, "stopped after step %lld; continue with --resume\n",
                 static_cast<long long>(out.recording.steps()));
    return out;
  }
  out.recording.close();
  write_page(model, flags.common.out);
  if (out.last.status == StepStatus::not_finite)
    throw NumericalFailure("step " + std::to_string(out.recording.steps() + 1) + ": " + out.last.reason);
  if (out.last.status == StepStatus::refused)
    std::fprintf(stderr, "refused at t = %.6g s: %s\n", out.state.t, out.last.reason.c_str());
  return out;
}

bool tell(const PathAudit& audit, const Model& model) {
  if (audit.samples == 0) return true;
  if (audit.steps == 0)
    std::printf("certify: nothing to look at, no two bodies that can touch\n");
  else
    std::printf("certify: %s, %s and the end of each, %s, %s\n", counted(audit.steps, "step").c_str(),
                counted(audit.samples, "place").c_str(), nearest_of(audit).c_str(),
                counted(audit.violations, "violation").c_str());
  if (audit.nested > 0)
    std::printf("certify: a body was inside another in %s\n", counted(audit.nested, "step").c_str());
  if (audit.uncovered > 0)
    std::printf("certify: contacts and base distances disagree at the end of %s\n",
                counted(audit.uncovered, "step").c_str());
  const std::vector<std::string> skipped = names_of_skipped(model);
  if (!skipped.empty())
    std::printf("certify: not looked at, because they pass through each other: %s%s\n",
                skipped.front().c_str(),
                skipped.size() > 1 ? (", and " + std::to_string(skipped.size() - 1) + " more").c_str() : "");
  return audit.violations == 0;
}

bool tell(const RunTotals& totals, const Model& model) {
  const EnergyGain& gain = totals.gain;
  if (energy_rises(gain))
    std::fprintf(stderr, "energy rose by %.3g J that nothing gave, %.2g of the largest kinetic energy\n",
                 gain.largest, gain.largest / gain.kinetic);
  const Uncertified& un = totals.uncertified;
  if (un.driven_overlaps > 0)
    std::fprintf(stderr, "moved and fixed bodies overlapped in %s, first from t = %.6g s on\n",
                 counted(un.driven_overlaps, "step").c_str(), un.driven_t);
  return tell(totals.audit, model);
}

}  // namespace aussois
