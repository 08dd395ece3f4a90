// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/problem_run.hpp"

#include <cmath>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

/// One contact with W = I, as FCLIB's example: u = r + q, so the answer is minus the projection of q on the
/// cone made large enough by sliding; for mu = 0.5 and q = (-1, 2, 0) it slides with r = (1, -0.5, 0).
FclibFile sliding_contact() {
  SparseMatrix W(3, 3);
  W.setIdentity();
  return {.problem = LocalProblem{.W = W, .q = Vec3(-1, 2, 0), .laws = {coulomb(0.5)}}};
}

}  // namespace

TEST(RunProblem, JudgesTheAnswer) {
  const std::filesystem::path path = fresh_folder() / "sliding.hdf5";
  write_fclib(path, sliding_contact());
  const ProblemRun run = run_problem(path, {.solver = {.tolerance = 1e-12}});
  EXPECT_EQ(run.problem, "sliding");
  EXPECT_EQ(run.form, "local");
  EXPECT_EQ(run.contacts, 1);
  EXPECT_EQ(run.rows, 3);
  EXPECT_EQ(run.status, "converged");
  EXPECT_TRUE(run.solved);
  EXPECT_LE(run.scaled_residual, 1e-12);
  EXPECT_LE(run.natural_map_residual, 1e-12);  // W = I: the same number
  EXPECT_LE(run.physical.worst_misalignment, 1e-7);
  EXPECT_GT(run.cpu_s, 0);
}

TEST(RunProblem, StartsFromWhatTheFileHas) {
  const std::filesystem::path path = fresh_folder() / "sliding.hdf5";
  FclibFile file = sliding_contact();
  file.solution = FclibValues{.r = Vec3(1, -0.5, 0)};
  write_fclib(path, file);
  const RunOptions from_solution{.solver = {.tolerance = 1e-12}, .start = Start::solution};
  const ProblemRun run = run_problem(path, from_solution);
  EXPECT_EQ(run.start, Start::solution);
  EXPECT_EQ(run.report.iterations, 0);  // it is good enough as it is
  EXPECT_TRUE(run.solved);
  RunOptions from_guess = from_solution;
  from_guess.start = Start::guess;
  EXPECT_EQ(run_problem(path, from_guess).start, Start::zero);  // there is none
}

TEST(RunProblem, TellsOfFilesAndNumbersByAStatus) {
  const std::filesystem::path folder = fresh_folder();
  const ProblemRun missing = run_problem(folder / "none.hdf5", {});
  EXPECT_EQ(missing.status, "unreadable");
  EXPECT_EQ(missing.reason, (folder / "none.hdf5").string() + ": no such file");
  EXPECT_FALSE(missing.solved);
  FclibFile file = sliding_contact();
  std::get<LocalProblem>(file.problem).q[1] = std::nan("");
  write_fclib(folder / "nan.hdf5", file);
  const ProblemRun nan = run_problem(folder / "nan.hdf5", {});
  EXPECT_EQ(nan.status, "not_finite");
  EXPECT_FALSE(nan.solved);
  EXPECT_NE(message_of([&] { run_problem(folder / "nan.hdf5", {.solver = {.tolerance = -1}}); }), "");
  EXPECT_EQ(message_of([&] { run_problem(folder / "nan.hdf5", {.repeat = 0}); }),
            "RunOptions::repeat = 0 must be at least 1");
}

TEST(ProblemFiles, AreThoseOfFoldersInOrder) {
  const std::filesystem::path folder = fresh_folder();
  for (const char* name : {"b.hdf5", "a.h5", "c.hdf5", "README.md"}) write_bytes(folder / name, "x");
  std::filesystem::create_directories(folder / "empty");
  EXPECT_EQ(problem_files({"missing.hdf5", folder}),
            (std::vector<std::filesystem::path>{"missing.hdf5", folder / "a.h5", folder / "b.hdf5",
                                                folder / "c.hdf5"}));
  EXPECT_EQ(message_of<std::runtime_error>([&] { problem_files({folder / "empty"}); }),
            (folder / "empty").string() + ": no *.hdf5 or *.h5 in this folder");
}

}  // namespace aussois
