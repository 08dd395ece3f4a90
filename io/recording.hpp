// SPDX-License-Identifier: Apache-2.0
// A run on disk: run.h5, steps.csv, and a checkpoint.h5 from which it goes on with the same bits.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "integrators/scheme.hpp"
#include "io/run_file.hpp"
#include "io/run_totals.hpp"
#include "mechanics/virtual_coupling.hpp"

namespace aussois {

struct RecordingOptions {
  std::filesystem::path folder{};             // must be there
  int every = 1;                              // each n-th step is a row of run.h5 and of steps.csv, >= 1
  double checkpoint_every = kInf;             // wall time between checkpoints [s], >= 0
  bool resume = false;                        // go on from the checkpoint in `folder`
  OtherProgram other = OtherProgram::refuse;  // that wrote it
  std::uint64_t fingerprint = 0;              // of all that the bits of the run depend on
  int audit_samples = 0;                      // PathAudit::samples
  int threads = 1;                            // of the audit
  std::function<CouplingWrench(const State&)> pull{};  // written into run.h5; empty: none
};

class Recording {
 public:
  /// Of a run that begins at `start`; a resumed one goes on from its checkpoint. Throws std::invalid_argument
  /// for a bad option or gauge, std::runtime_error for a file that is missing, does not fit, is being
  /// written, or cannot be.
  Recording(const Model& model, const RunHeader& header, std::vector<Gauge> gauges,
            const RecordingOptions& options, const State& start);
  Recording(Recording&&) noexcept;
  ~Recording();  // without close(): what was flushed stays for a resumed run

  /// A step that was accepted; the one before led to its start. Writes a checkpoint where one is due.
  void add(const State& state, const StepReport& report);
  void checkpoint();
  /// The files get their names, and the checkpoint goes.
  void close();

  const State& state() const;  // after the last step that was added, or where the run goes on
  std::int64_t steps() const;
  double total(const std::string& name) const;  // what a gauge kept; throws std::invalid_argument without one
  const RunTotals& totals() const;
  double cpu_seconds() const;  // of the process, and of those that this run goes on from
  /// The program that wrote the checkpoint, if it was another; empty: this one.
  const std::string& other_program() const;
  /// steps, all totals of gauges in their order, RunTotals.
  void set(Summary& summary) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// `run` of a scheme with a recording: goes on with steps that were not solved, as long as they lead
/// somewhere. `go_on(report)` hears of every step after it was recorded; the last may have led nowhere.
StepReport record_run(const Scheme& scheme, State& state, double t_end, Recording& recording,
                      const std::function<bool(const StepReport&)>& go_on = {});

}  // namespace aussois
