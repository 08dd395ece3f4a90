// SPDX-License-Identifier: Apache-2.0
// What every driver shares: a command line that explains itself, exit codes, one clear line when something is
// wrong.
//
//   int main(int argc, char** argv) {
//     double mu = 0.3, angle = 20;
//     CommonOptions common;
//     Cli cli("sliding_block", "A block slides down an incline; prints the observed order of convergence.");
//     cli.group("scene");
//     cli.option("--mu", mu, "friction coefficient", "-", {0, 10});
//     cli.option("--angle", angle, "slope", "deg", {0, 89});
//     cli.common(common);
//     cli.example("sliding_block --mu 0.2", "a slippery block");
//     cli.example("sliding_block --angle 10 --summary s.json", "a block at rest");
//     return run_driver(cli, argc, argv, [&] { return slide(mu, angle, common); });   // returns an ExitCode
//   }
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/settings.hpp"
#include "geometry/types.hpp"

namespace aussois {

/// What the shell sees.
enum class ExitCode : int {
  ok = 0,
  not_accepted = 1,   // it ran, but an acceptance failed: not converged, penetration, energy gain
  usage = 2,          // the command line, or a value in it or in an input
  missing = 3,        // a file or a dependency is missing, unreadable, does not fit, or cannot be written
  numerical = 4,      // not a number, singular, out of memory, our own mistake
  interrupted = 130,  // SIGINT or SIGTERM, after a checkpoint
};

/// The numbers failed in a way that ends the run: exit code 4.
struct NumericalFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The range of every --threads: a larger number is taken for a typing error.
inline constexpr Range kThreads{1, 256};

/// The options that mean the same in every driver.
struct CommonOptions {
  std::filesystem::path out = "out";  // folder of all results, made if missing
  std::filesystem::path summary{};    // JSON file, none if empty
  int threads = 1;
  int every = 1;  // record each n-th step
  bool quiet = false;
  bool resume = false;           // continue from the checkpoint in `out`
  bool resume_anyway = false;    // the same, also from that of another program
  double checkpoint_every = 60;  // wall time between checkpoints [s]
};

/// --scale: the length of one unit of a mesh file [m].
inline constexpr Range kMeshScale{1e-12, 1e12};

/// The range of every --time [s].
inline constexpr Range kTime{0, 1e5};

/// The same range from 0 on: 0 stands for a value that comes from elsewhere.
inline Range or_zero(Range range) {
  range.lowest = 0, range.open_below = false;
  return range;
}

/// A row of an angle in radians, as a user says it.
inline Setting in_degrees(Setting angle) {
  angle.unit = "deg";
  angle.range.lowest *= 180 / kPi, angle.range.highest *= 180 / kPi;
  return angle;
}

class Cli {
 public:
  /// `name` of the program and one sentence on what it does.
  Cli(std::string name, std::string what);
  ~Cli();
  Cli(const Cli&) = delete;
  Cli& operator=(const Cli&) = delete;

  /// Options that follow stand under this heading of --help: scene, stepping, scheme, solver, output.
  void group(std::string heading);

  /// `value` holds the default, shown in --help, and receives what the user says. `unit` is "-" for a pure
  /// number and
  /// "" for none. NaN and values outside `range` are refused with one line that names option, value and
  /// bound.
  void option(const std::string& flag, double& value, const std::string& what, const std::string& unit,
              Range range = {});
  void option(const std::string& flag, int& value, const std::string& what, const std::string& unit = "",
              Range range = {});
  /// With the flag, the meaning, the unit and the range of a row of a table.
  void option(const Setting& setting, double& value);
  void option(const Setting& setting, int& value);
  void option(const std::string& flag, std::uint64_t& value, const std::string& what,
              const std::string& unit = "");
  void option(const std::string& flag, std::string& value, const std::string& what);
  void option(const std::string& flag, std::filesystem::path& value, const std::string& what);
  /// Words between blanks or commas, and the option as often as the user likes: --case A --case B, --case A B
  /// and --case A,B say the same. A comma in brackets belongs to its word.
  void option(const std::string& flag, std::vector<std::string>& words, const std::string& what);
  void flag(const std::string& flag, bool& value, const std::string& what);
  /// One of `choices`; `note` stands behind their list, in --help and where another is refused.
  void choice(const std::string& flag, std::string& value, const std::string& what,
              const std::vector<std::string>& choices, const std::string& note = "");
  /// A path that must exist: otherwise exit code 3 before anything runs. Not looked at if the user leaves it
  /// empty.
  void input(const std::string& flag, std::filesystem::path& value, const std::string& what);
  /// What stands without a flag: one or more files. They are not looked at: a driver that takes many says
  /// which of them are bad and does the others. A command line without any is refused.
  void files(std::vector<std::filesystem::path>& value, const std::string& what);
  /// The group "output" with -o, --summary, --threads, --quiet; in drivers whose runs are recorded also
  /// --every, --checkpoint-every, --resume and --resume-anyway. A driver that keeps its finished runs in the
  /// folder of -o says so there; one without work for threads has no --threads.
  enum class Restart { no, by_itself, yes };
  enum class Threads { no, yes };
  void common(CommonOptions& options, Restart restart = Restart::no, Threads threads = Threads::yes);
  /// Where a message of run_driver would name the member of a struct, "Struct::member", it names the flag.
  void stands_for(const std::string& flag, const std::string& member);
  std::string said_with_flags(std::string message) const;
  /// A command line that works and what it shows; --help prints them all.
  void example(std::string command, std::string shows);

  /// Fills the values. True: run. False: nothing to run (--help, --version, or something is wrong), `code`
  /// says why.
  bool parse(int argc, const char* const* argv, ExitCode& code);
  /// All options with their values in order, one "--flag value" per line, or those under one heading: what a
  /// fingerprint and the notes of a run are made of.
  std::string values(const std::string& group = "") const;
  /// The options under a heading that the user said, in order.
  std::vector<std::string> given(const std::string& group) const;
  bool offers(const std::string& flag) const;
  bool is_given(const std::string& flag) const;  // of a flag that it offers
  std::string help() const;
  const std::string& name() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Throws std::invalid_argument "--flag needs `what`" for the first of these flags that the user said.
void refuse_given(const Cli& cli, const std::vector<std::string>& flags, const std::string& what);

/// Parses, watches for SIGINT and SIGTERM, runs `body` and turns what it throws into an exit code and one
/// line on stderr: std::invalid_argument 2, NumericalFailure 4, other std::runtime_error (ours are files) 3,
/// anything else 4. A mapped file that is cut off or written while `body` runs is named too: 3.
int run_driver(Cli& cli, int argc, const char* const* argv, const std::function<ExitCode()>& body);

/// Makes the folder of the results and that of the summary, before anything is computed for them. Throws
/// std::runtime_error with the path.
void make_folders(const CommonOptions& options);

/// True since SIGINT or SIGTERM: write a checkpoint and return ExitCode::interrupted. A second signal kills.
bool interrupted();

/// "smallest gap 12.3 um"; "no contact" if there was none [m].
std::string gap_text(double smallest_gap);

/// "base distance at least 12.3 um"; "no bodies near each other" if it has no bound [m].
std::string distance_text(double least_base_distance);

/// The command line as one would type it again.
std::string command_line(int argc, const char* const* argv);

}  // namespace aussois
