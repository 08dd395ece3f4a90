// SPDX-License-Identifier: Apache-2.0
#include "examples/common/driven_run.hpp"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "examples/common/progress.hpp"
#include "examples/common/run_watch.hpp"
#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "io/build_info.hpp"
#include "io/replay_html.hpp"

namespace aussois {

void add_run_options(Cli& cli, RunFlags& f) {
  add_options(cli, f.scheme);
  cli.group("run");
  add_certify(cli, f.certify);
  cli.option("--stop-after", f.stop_after,
             "write a checkpoint and stop after this many steps; 0: run to the end", "", {0, 1e9});
  add_profile(cli, f.profile);
  add_options(cli, f.dump);
  cli.common(f.common, Cli::Restart::yes);
}

std::string scene_text(const Cli& cli, const std::string& content, const std::vector<std::string>& paths) {
  std::string text = content;
  for (const char* group : {"scene", "path", "stepping"}) {
    std::istringstream lines(cli.values(group));
    for (std::string line; std::getline(lines, line);)
      if (std::ranges::find(paths, line.substr(0, line.find(' '))) == paths.end()) (text += '\n') += line;
  }
  return text;
}

void check(const Cli& cli, const RunFlags& flags) {
  refuse_unread_flags(cli, flags.scheme);
  check(cli, flags.dump, flags.scheme.scheme);
}

namespace {

SchemeOptions options_of(const RunPlan& plan, const RunFlags& flags) {
  SchemeOptions out = plan.options ? *plan.options : scheme_options(flags.scheme);
  out.step.h = plan.h;
  out.step.threads = flags.common.threads;
  out.step.keep_problem = !flags.dump.folder.empty();
  out.step.profile = flags.profile;
  return out;
}

RecordingOptions recording_options(const RunPlan& plan, const RunFlags& flags, const SchemeOptions& chosen) {
  const CommonOptions& o = flags.common;
  RecordingOptions out{.folder = o.out,
                       .every = o.every,
                       .checkpoint_every = o.checkpoint_every,
                       .resume = o.resume,
                       .other = o.resume_anyway ? OtherProgram::accept : OtherProgram::refuse,
                       .audit_samples = flags.certify,
                       .threads = o.threads,
                       .pull = plan.pull};
  std::string text = plan.scene + "\n" + choice_text(flags.scheme, chosen);
  for (const std::string& option : settings_text(out)) (text += '\n') += option;
  out.fingerprint = fingerprint_of(text);
  return out;
}

void tell_other_program(const Recording& recording, const std::filesystem::path& folder) {
  if (recording.other_program().empty()) return;
  std::fprintf(
      stderr, "%s: written by %s, continued by %s: the results are bit for bit those of neither program\n",
      (folder / "checkpoint.h5").c_str(), recording.other_program().c_str(), program_version().c_str());
}

void write_page(const Model& model, const std::filesystem::path& folder) {
  const std::filesystem::path replay = folder / "replay.html";
  if (std::ranges::any_of(model.bodies, [](const RigidBody& b) { return bool(b.shape); })) {
    RunReader run(folder / "run.h5");
    write_replay_html(replay, run);
  } else {
    std::filesystem::remove(replay);  // that of another scene
    std::printf("no replay: no body of this scene has a shape\n");
  }
}

}  // namespace

DrivenRun drive(const Model& model, const State& start, RunPlan plan, const RunFlags& flags) {
  const SchemeOptions chosen = options_of(plan, flags);
  const Scheme scheme = make_scheme(flags.scheme.scheme, model, chosen);
  const std::string name = label(flags.scheme.scheme, chosen);
  const std::vector<std::string> options = settings_text(chosen);
  make_folders(flags.common);
  plan.header.build = build_info();
  plan.header.notes["scheme"] = name;
  for (const std::string& option : options) plan.header.notes["options"] += option + "\n";
  DrivenRun out{.scheme = name,
                .options = options,
                .recording = Recording(model, plan.header, std::move(plan.gauges),
                                       recording_options(plan, flags, chosen), start)};
  out.state = out.recording.state();
  out.first = out.recording.steps();
  tell_other_program(out.recording, flags.common.out);
  StepDump dump(flags.dump, plan.driver + "_" + plan.name);
  Progress progress(plan.driver, plan.t_end, Progress::style_of_stderr(flags.common.quiet));
  StageTime end;  // of the last step
  const Scheme timed{.name = scheme.name, .step = [&](State& s, double h_limit) {
                       const StageTime begin = time_now(true);
                       StepReport report = scheme.step(s, h_limit);
                       end = time_now(true);
                       out.step_cpu += end.cpu - begin.cpu;
                       return report;
                     }};
  const auto goes_on = [&] { return !plan.go_on || plan.go_on(out.recording); };
  const double t_end = goes_on() ? plan.t_end : out.state.t;
  out.last = record_run(timed, out.state, t_end, out.recording, [&](const StepReport& report) {
    const std::int64_t steps = out.recording.steps();
    if (flags.profile) out.profile.add(report, time_since(end, true));
    dump.step(steps + !report.moved(), report);
    char note[80];
    std::snprintf(note, sizeof note, "step %lld, %s", static_cast<long long>(steps),
                  counted_noun(report.contacts_found, "contact").c_str());
    progress.at(out.state.t, note);
    out.interrupted = interrupted() || (flags.stop_after > 0 && steps >= flags.stop_after);
    return !out.interrupted && goes_on();
  });
  if (flags.profile && out.profile.steps() > 0) std::printf("%s", table_of(out.profile).c_str());
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
    std::fprintf(stderr, "step refused at t = %.6g s: %s\n", out.state.t, out.last.reason.c_str());
  return out;
}

void set_run(const DrivenRun& run, Summary& summary) {
  run.recording.set(summary);
  set_profile(run.profile, summary);
}

bool print_findings(const PathAudit& audit, const Model& model) {
  return print_findings(RunAudit{.path = audit, .skipped = names_of_skipped(model)});
}

bool print_findings(const RunTotals& totals, const Model& model) {
  const EnergyGain& gain = totals.gain;
  if (energy_rises(gain))
    std::fprintf(stderr, "energy rose by %.3g J without a source, %.2g of the largest kinetic energy\n",
                 gain.largest, gain.largest / gain.kinetic);
  const UncertifiedPairs& un = totals.uncertified;
  if (un.driven_overlaps > 0)
    std::fprintf(stderr, "moved and fixed bodies overlapped in %s, first in the step from t = %.6g s\n",
                 counted_noun(un.driven_overlaps, "step").c_str(), un.driven_t);
  return print_findings(totals.audit, model);
}

}  // namespace aussois
