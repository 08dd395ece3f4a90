// SPDX-License-Identifier: Apache-2.0
// Records a run on disk: run.h5, steps.csv, and a checkpoint.h5 to continue from with the same bits.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "integrators/scheme.hpp"
#include "io/run_file.hpp"
#include "io/run_totals.hpp"
#include "mechanics/virtual_coupling.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct RecordingOptions {
  std::filesystem::path folder{};                      // must exist
  int every = 1;                                       // each n-th step is a row of run.h5 and of steps.csv
  double checkpoint_every = kInf;                      // wall time between checkpoints [s]
  bool resume = false;                                 // continue from the checkpoint in `folder`
  OtherProgram other = OtherProgram::refuse;           // whether another program may have written it
  std::uint64_t fingerprint = 0;                       // of all that the bits of the run depend on
  int audit_samples = 0;                               // PathAudit::samples
  int threads = 1;                                     // for the audit
  std::function<CouplingWrench(const State&)> pull{};  // written into run.h5; empty: none
};
void describe(SettingVisitor& visit, RecordingOptions& options);  // its numbers

class Recording {
 public:
  /// Records a run that begins at `start`; a resumed run continues from its checkpoint. Throws
  /// std::invalid_argument for a bad option or gauge, std::runtime_error for a file that is missing, does not
  /// fit, is being written by another run, or cannot be written.
  Recording(const Model& model, const RunHeader& header, std::vector<Gauge> gauges,
            const RecordingOptions& options, const State& start);
  Recording(Recording&&) noexcept;
  ~Recording();  // without close(): what was flushed stays for resuming

  /// Adds an accepted step, which starts where the one before ended. Writes a checkpoint when one is due.
  void add(const State& state, const StepReport& report);
  void checkpoint();
  /// Gives the files their final names and removes the checkpoint.
  void close();

  const State& state() const;  // after the last step that was added, or where the run resumes
  std::int64_t steps() const;
  double total(const std::string& name) const;  // what a gauge kept; throws std::invalid_argument if there is
                                                // no such gauge
  const RunTotals& totals() const;
  double cpu_seconds() const;  // of the process, and of those whose run it continues
  /// The program that wrote the checkpoint, if it was not this one; otherwise empty.
  const std::string& other_program() const;
  /// Sets steps, all totals of gauges in their order, and RunTotals.
  void set(Summary& summary) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Calls `run` with a recording. Continues after steps that were not solved, as long as they lead somewhere.
/// `go_on(report)` is called for every step, after it was recorded; the last step may have led nowhere.
StepReport record_run(const Scheme& scheme, State& state, double t_end, Recording& recording,
                      const std::function<bool(const StepReport&)>& go_on = {});

}  // namespace aussois
