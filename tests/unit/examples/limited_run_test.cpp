// SPDX-License-Identifier: Apache-2.0
// A problem that is solved in a process of its own gives the same result, and may crash or take too long.
#include "examples/studies/friction/limited_run.hpp"

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

std::filesystem::path two_bodies_at_rest(const std::filesystem::path& folder) {
  SparseMatrix W(3, 3);
  W.setIdentity();
  std::filesystem::path path = folder / "rest.hdf5";
  write_fclib(path, {.problem = LocalProblem{.W = W, .q = Vec3(-1, 0.1, 0), .laws = {coulomb(0.5)}}});
  return path;
}

}  // namespace

TEST(RunLimited, GivesWhatRunProblemGives) {
  const std::filesystem::path path = two_bodies_at_rest(fresh_folder());
  const ProblemRun here = run_problem(path, {});
  const ProfileResult there = run_limited(path, {}, 10);
  EXPECT_EQ(there.status, "converged");
  EXPECT_TRUE(there.solved);
  EXPECT_EQ(there.scaled_residual, here.scaled_residual);
  EXPECT_EQ(there.iterations, here.report.iterations);
  EXPECT_EQ(there.problem, "rest");
  EXPECT_GT(there.cpu_s, 0);  // a microsecond: its clock is fine
  EXPECT_LT(there.cpu_s, 0.01);
  EXPECT_EQ(run_limited("nowhere.hdf5", {}, 10).status, "unreadable");
}

TEST(RunLimited, SurvivesACrash) {
  const std::filesystem::path folder = fresh_folder();
  ::testing::internal::CaptureStderr();  // "terminate called after throwing ..."
  RunOptions options;
  options.save = folder / "no such folder";
  const ProfileResult result = run_limited(two_bodies_at_rest(folder), options, 10);
  ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(result.status, "crashed");
  EXPECT_FALSE(result.solved);
  EXPECT_EQ(result.problem, "rest");
}

TEST(RunLimited, EndsAtItsLimit) {
  const std::filesystem::path path = two_bodies_at_rest(fresh_folder());
  const ProfileResult result = run_limited(path, {.repeat = 1000000000}, 0.05);
  EXPECT_EQ(result.status, "time_limit");
  EXPECT_FALSE(result.solved);
  EXPECT_EQ(result.time_limit, 0.05);
  EXPECT_EQ(message_of([&] { run_limited(path, {}, 0); }), "time_limit = 0 must lie in (0, 1e8) [s]");
}

}  // namespace aussois
