// SPDX-License-Identifier: Apache-2.0
// What every driver that steps a scene shares: its flags, and one run from the first step to the replay page.
#pragma once

#include <optional>

#include "examples/common/scheme_flags.hpp"
#include "examples/common/step_dump.hpp"
#include "io/recording.hpp"

namespace aussois {

struct RunFlags {
  SchemeFlags scheme{};
  double tolerance = 1e-8;  // of the solver
  int certify = 0;          // samples of each step
  int stop_after = 0;       // steps; 0: never
  DumpOptions dump{};
  CommonOptions common{};
};

/// The groups scheme, solver, run, problems and output.
void add_run_options(Cli& cli, RunFlags& flags);

/// Of what the bits of a run depend on: all options but those of the groups run, problems and output and
/// those named in `paths`, whose files `content` stands for; how often is recorded and sampled.
std::uint64_t run_fingerprint(const Cli& cli, const RunFlags& flags, const std::string& content = {},
                              const std::vector<std::string>& paths = {});

/// Throws what refuse_unread does, and for what belongs to no step of the chosen scheme.
void check(const Cli& cli, const RunFlags& flags);

/// scheme_options with what else the flags say; `h` is the largest step [s].
SchemeOptions step_options_of(const RunFlags& flags, double h);

/// A run that is to be made.
struct RunPlan {
  std::string driver{}, name{};  // its name; of the case, in the names of dumped problems
  double t_end = 0;              // [s]
  RunHeader header{};            // title, command line and notes; build is added
  std::vector<Gauge> gauges{};
  std::uint64_t fingerprint = 0;
  std::function<CouplingWrench(const State&)> pull{};
};

struct DrivenRun {
  Recording recording;
  State state{};
  StepReport last{};
  std::int64_t first = 0;    // steps of the run that this one goes on from
  double step_cpu = 0;       // of the steps since [s]
  bool interrupted = false;  // with a checkpoint; nothing is left to do
};
/// From `start`, or from the checkpoint in the folder of results: progress, dumps, Ctrl-C, and at the end the
/// files and the replay page, if any body has a shape. Throws NumericalFailure where numbers are not finite;
/// says on stderr where a step is refused.
DrivenRun drive(const Scheme& scheme, const Model& model, const State& start, RunPlan plan,
                const RunFlags& flags);

/// Prints what was gained, of whom no certificate speaks, and what the audit found. True: no violation.
bool tell(const RunTotals& totals, const Model& model);
bool tell(const PathAudit& audit, const Model& model);

}  // namespace aussois
