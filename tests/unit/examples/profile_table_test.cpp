// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/profile_table.hpp"

#include <cmath>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const ProfileKey kKey{
    .digest = 0xfedcba9876543210u, .solver = "auto", .tolerance = 1e-8, .max_iterations = 99};

ProfileResult solved_result() {
  return {.status = "converged",
          .solved = true,
          .iterations = 7,
          .scaled_residual = 1.0 / 3e9,
          .natural_map_residual = kInf,
          .cpu_s = 0.1 + 0.2,
          .time_limit = 10,
          .contacts = 4,
          .problem = "a \"box\", on\na plate"};
}

std::filesystem::path two_bodies_at_rest(const std::filesystem::path& folder) {
  SparseMatrix W(3, 3);
  W.setIdentity();
  const std::filesystem::path path = folder / "rest.hdf5";
  write_fclib(path, {.problem = LocalProblem{.W = W, .q = Vec3(-1, 0.1, 0), .laws = {coulomb(0.5)}}});
  return path;
}

}  // namespace

TEST(ProfileTable, LinesComeBackToTheLastBit) {
  const auto [key, result] = from_line(to_line(kKey, solved_result()));
  EXPECT_EQ(key, kKey);
  const ProfileResult expected = solved_result();
  EXPECT_EQ(result.status, expected.status);
  EXPECT_TRUE(result.solved);
  EXPECT_EQ(result.iterations, expected.iterations);
  EXPECT_EQ(result.scaled_residual, expected.scaled_residual);
  EXPECT_EQ(result.natural_map_residual, expected.natural_map_residual);
  EXPECT_EQ(result.cpu_s, expected.cpu_s);
  EXPECT_EQ(result.time_limit, expected.time_limit);
  EXPECT_EQ(result.contacts, expected.contacts);
  EXPECT_EQ(result.problem, "a \"box\", on a plate");
  ProfileResult unknown = solved_result();
  unknown.scaled_residual = std::nan("");
  EXPECT_TRUE(std::isnan(from_line(to_line(kKey, unknown)).second.scaled_residual));
}

TEST(ProfileTable, RemembersWhatWasDoneAndForgetsHalfALine) {
  const std::filesystem::path path = fresh_folder() / "results.csv";
  ProfileKey other = kKey;
  other.tolerance = 1e-4;
  { ProfileTable(path).add(kKey, solved_result()); }
  {
    ProfileTable table(path);
    EXPECT_EQ(table.size(), 1u);
    ASSERT_NE(table.find(kKey, 1e3), nullptr);
    EXPECT_EQ(table.find(kKey, 1e3)->cpu_s, solved_result().cpu_s);
    EXPECT_EQ(table.find(other, 1e3), nullptr);
    table.add(other, solved_result());
  }
  const std::string whole = content_of(path);
  write_bytes(path, whole.substr(0, whole.size() - 1));  // killed while it wrote the last line
  {
    ProfileTable table(path);
    EXPECT_EQ(table.size(), 1u);
    EXPECT_EQ(table.find(other, 1e3), nullptr);
    table.add(other, solved_result());
  }
  EXPECT_EQ(content_of(path), whole);
}

TEST(ProfileTable, GivesUpNothingForGood) {
  const std::filesystem::path path = fresh_folder() / "results.csv";
  ProfileTable table(path);
  table.add(kKey, {.status = "time_limit", .time_limit = 10});
  EXPECT_NE(table.find(kKey, 10), nullptr);
  EXPECT_NE(table.find(kKey, 1), nullptr);
  EXPECT_EQ(table.find(kKey, 11), nullptr);  // more patience: once more
  table.add(kKey, solved_result());
  EXPECT_TRUE(ProfileTable(path).find(kKey, 11)->solved);  // the later line counts
}

TEST(ProfileTable, RefusesOtherTables) {
  const std::filesystem::path folder = fresh_folder();
  const auto complaint = [&](const std::string& content) {
    return message_of<std::runtime_error>([&] { ProfileTable(write_bytes(folder / "t.csv", content)); });
  };
  EXPECT_EQ(complaint("tau,auto\n"), (folder / "t.csv").string() + ":1: is not a table of solver_profile");
  write_bytes(folder / "good.csv", "");
  { ProfileTable(folder / "good.csv").add(kKey, solved_result()); }
  std::string bad = content_of(folder / "good.csv");
  bad.replace(bad.find("converged,1,7"), 13, "converged,1,x");
  EXPECT_EQ(complaint(bad), (folder / "t.csv").string() + ":2: iterations = 'x' is not a number");
  EXPECT_EQ(complaint(content_of(folder / "good.csv") + "1,2\n"),
            (folder / "t.csv").string() + ":3: has 2 fields, must have 13");
}

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
