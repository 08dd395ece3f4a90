// SPDX-License-Identifier: Apache-2.0
// What every driver that steps a scene shares: its flags, and one run from the first step to the replay page.
#pragma once

#include <optional>

#include "examples/common/scheme_flags.hpp"
#include "examples/common/step_dump.hpp"
#include "examples/common/step_profile.hpp"
#include "io/recording.hpp"

namespace aussois {

struct RunFlags {
  SchemeFlags scheme{};
  int certify = 0;     // samples of each step
  int stop_after = 0;  // steps; 0: never
  bool profile = false;
  DumpOptions dump{};
  CommonOptions common{};
};

/// The groups scheme, solver, run, problems and output.
void add_run_options(Cli& cli, RunFlags& flags);

/// What the user said of the scene, one flag a line, but for those named in `paths`: `content` stands for
/// their files.
std::string scene_text(const Cli& cli, const std::string& content = {},
                       const std::vector<std::string>& paths = {});

/// Throws what refuse_unread_flags does, and for what belongs to no step of the chosen scheme.
void check(const Cli& cli, const RunFlags& flags);

/// Fraction of the dilations by which an accepted step may overlap (CA-6), and what planes are off by
/// (LMD-14).
inline const double kLargestOverlap = AdvancementOptions{}.max_overlap + 2e-3;

/// A run that is to be made.
struct RunPlan {
  std::string driver{}, name{};  // its name; of the case, in the names of dumped problems
  double h = 0, t_end = 0;       // largest step, end [s]
  std::string scene{};           // what the bits of the run depend on, but for the flags of the scheme
  RunHeader header{};            // title, command line and notes; build, scheme and options are added
  std::vector<Gauge> gauges{};
  std::function<CouplingWrench(const State&)> pull{};
  std::optional<SchemeOptions> options{};         // instead of those of the flags; h and threads are set
  std::function<bool(const Recording&)> go_on{};  // asked before the first step and after each; empty: to
                                                  // the end. What it depends on survives in the checkpoint
};

struct DrivenRun {
  std::string scheme{};                // its label
  std::vector<std::string> options{};  // "step.h = 0.001", all that a result depends on
  Recording recording;
  State state{};
  StepReport last{};
  std::int64_t first = 0;    // steps of the run that this one goes on from
  double step_cpu = 0;       // of the steps since [s]
  StepProfile profile{};     // of the steps since, with --profile
  bool interrupted = false;  // with a checkpoint; nothing is left to do
};
/// From `start`, or from the checkpoint in the folder of results: progress, dumps, Ctrl-C, and at the end the
/// files and the replay page, if any body has a shape. Throws NumericalFailure where numbers are not finite;
/// says on stderr where a step is refused.
DrivenRun drive(const Model& model, const State& start, RunPlan plan, const RunFlags& flags);

/// Sets what Recording::set does, and with --profile what set_profile does.
void set_run(const DrivenRun& run, Summary& summary);

/// Prints the energy gained, the pairs without a certificate, and the result of the audit. True: no
/// violation.
bool print_findings(const RunTotals& totals, const Model& model);
bool print_findings(const PathAudit& audit, const Model& model);

}  // namespace aussois
