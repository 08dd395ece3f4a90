// SPDX-License-Identifier: Apache-2.0
// One problem of a file, one solver, and what the residuals outside of all solvers say of its answer.
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "io/fclib_file.hpp"
#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

enum class Start { zero, guess, solution };
const char* to_string(Start start);

struct RunOptions {
  SolverOptions solver{};
  Start start = Start::zero;     // the first guess, or the solution, of the file; zero where it has none
  int repeat = 1;                // solved so often, the smallest time counts
  std::filesystem::path save{};  // folder for the problem with the answer as its solution; empty: none
};
void validate(const RunOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, RunOptions& options);  // all but save

struct ProblemRun {
  std::string problem{};                               // stem of the file
  std::string form{};                                  // local, global
  int contacts = 0, rows = 0, bodies = 0, joints = 0;  // blocks of rows; rows; unknowns of the bodies, joints
  std::string solver{};
  Start start = Start::zero;  // what was there to start from
  std::string status{};       // that of the solver; unreadable: the file; failed: the solver threw
  std::string reason{};       // of unreadable and failed
  SolveReport report{};       // what the solver says of itself
  double natural_map_residual = std::numeric_limits<double>::quiet_NaN();  // relative to |q|, FCLIB's number
  double scaled_residual = std::numeric_limits<double>::quiet_NaN();       // free of units: decides
  PhysicalResidual physical{};
  double worst_joint_velocity = 0;  // max of |G^T v + b| [m/s, rad/s]
  double cpu_s = 0;                 // of solve() in this process, all its threads
  bool solved = false;              // says the solver, and the judge agrees on the whole
};

/// Folders become the *.hdf5 and *.h5 in them, sorted by name; files stay as they are, also missing ones.
/// Throws std::runtime_error for a folder without any.
std::vector<std::filesystem::path> problem_files(const std::vector<std::filesystem::path>& given);

/// A bad file and bad numbers are a status. Throws std::invalid_argument for options, std::runtime_error if
/// the answer cannot be saved.
ProblemRun run_problem(const std::filesystem::path& path, const RunOptions& options);

/// The row of the table and, first, its head; with line ends.
std::string table_head(const std::vector<std::filesystem::path>& files);
std::string table_row(const ProblemRun& run, const std::vector<std::filesystem::path>& files);

/// A list with an object per run; numbers that are not finite become null.
void write_json(const std::filesystem::path& path, const std::vector<ProblemRun>& runs);

}  // namespace aussois
