// SPDX-License-Identifier: Apache-2.0
// What drivers of many runs look at in each of them besides its result: the audit of every step, the files of
// its problems, and where all steps spend their time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "examples/common/step_dump.hpp"
#include "examples/common/step_profile.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/scheme.hpp"
#include "io/summary.hpp"

namespace aussois {

struct WatchFlags {
  int certify = 0;  // samples of each step
  bool profile = false;
  DumpOptions dump{};
  std::shared_ptr<SharedProfile> times = std::make_shared<SharedProfile>();  // of all runs, with `profile`
};

/// --certify of every step, or of every step of all `runs`.
void add_certify(Cli& cli, int& samples, const std::string& runs = {});
/// --profile of one run, or of all `runs`.
void add_profile(Cli& cli, bool& profile, const std::string& runs = {});
/// --certify and --profile, in a group "run", and the options of a dump. `runs` as one calls them: "tosses".
void add_options(Cli& cli, WatchFlags& flags, const std::string& runs);
/// Throws std::invalid_argument for a bad choice of steps, for one without a folder of the dump, or if the
/// scheme solves no one-step problem.
void check(const Cli& cli, const DumpOptions& dump, const std::string& scheme);

/// What the audits of one run or of many found.
struct RunAudit {
  PathAudit path{};
  std::vector<std::string> skipped{};  // pairs that no audit looks at, each once: "lid and box"
};
/// Counts add up; of distances the least stays. A run without an audit changes nothing.
void add(const RunAudit& one, RunAudit& all);
/// Prints what was found, nothing without an audit. True: no violation.
bool print_findings(const RunAudit& audit);
/// With an audit sets what RunTotals set of theirs: certify_samples and its siblings.
void set_audit(const RunAudit& audit, Summary& summary);

/// All of it, as JSON that reads back as the same bits. Reading throws std::exception for anything else.
nlohmann::ordered_json json_of(const RunAudit& audit);
RunAudit audit_in(const nlohmann::ordered_json& json);

/// Prints where the steps of all runs that were taken now spent their time; nothing without --profile.
void print_profile(const WatchFlags& flags);
/// Sets what set_profile of a run sets.
void set_profile(const WatchFlags& flags, Summary& summary);

/// Watches one run.
class RunWatch {
 public:
  /// `name` stands in the names of its files; `threads` are those of the audit.
  RunWatch(const WatchFlags& flags, const std::string& name, int threads = 1);
  /// Asks steps for what the watch needs of them.
  void set_options(StepOptions& options) const;
  /// The scheme, every step of which is watched: the results are the same. Model and watch must outlive it.
  Scheme watched(const Model& model, Scheme scheme);
  const RunAudit& audit() const { return audit_; }

 private:
  StepDump dump_;
  std::shared_ptr<SharedProfile> times_{};  // null: not asked for
  int threads_ = 1;
  std::int64_t steps_ = 0;
  RunAudit audit_{};
};

}  // namespace aussois
