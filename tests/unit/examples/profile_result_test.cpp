// SPDX-License-Identifier: Apache-2.0
// Results of solvers come back from their files to the last bit, and only for the key that they belong to.
#include "examples/studies/friction/profile_result.hpp"

#include <cmath>
#include <limits>

#include "tests/support/altered.hpp"
#include "tests/support/files.hpp"

namespace aussois {
namespace {

const ProfileKey kKey{
    .digest = 0xfedcba9876543210u, .options = {.solver = {.max_iterations = 99}}, .program = 42};

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

void expect_same(const ProfileResult& result, const ProfileResult& expected) {
  EXPECT_EQ(result.status, expected.status);
  EXPECT_EQ(result.solved, expected.solved);
  EXPECT_EQ(result.iterations, expected.iterations);
  EXPECT_EQ(result.scaled_residual, expected.scaled_residual);
  EXPECT_EQ(result.natural_map_residual, expected.natural_map_residual);
  EXPECT_EQ(result.cpu_s, expected.cpu_s);
  EXPECT_EQ(result.time_limit, expected.time_limit);
  EXPECT_EQ(result.contacts, expected.contacts);
  EXPECT_EQ(result.problem, expected.problem);
}

}  // namespace

TEST(ProfileResult, ComesBackToTheLastBit) {
  const ProfileResult expected = solved_result();
  expect_same(profile_result_in(to_json(expected)), expected);
  const std::filesystem::path folder = fresh_folder();
  write_profile_result(folder, kKey, expected);
  const std::optional<ProfileResult> kept = read_profile_result(folder, kKey, 1e3);
  ASSERT_TRUE(kept);
  expect_same(*kept, expected);

  ProfileResult odd = expected;
  odd.natural_map_residual = -kInf;
  odd.cpu_s = std::numeric_limits<double>::denorm_min();
  expect_same(profile_result_in(to_json(odd)), odd);
  odd.scaled_residual = std::nan("");
  EXPECT_TRUE(std::isnan(profile_result_in(to_json(odd)).scaled_residual));
  odd.problem = "caf\xe9";  // no UTF-8: it is shown as well as can be
  EXPECT_EQ(profile_result_in(to_json(odd)).problem, "caf\xEF\xBF\xBD");
}

TEST(ProfileResult, IsThatOfItsKeyAlone) {
  const std::filesystem::path folder = fresh_folder();
  write_profile_result(folder, kKey, solved_result());
  EXPECT_TRUE(names_in(folder).begin()->starts_with("fedcba9876543210_auto_1e-08_"));
  std::vector<ProfileKey> others{kKey};
  others[0].digest = 1;
  for (const auto& [path, options] : altered(kKey.options)) {
    others.push_back(kKey);
    others.back().options = options;
  }
  EXPECT_EQ(others.size(), 10u);
  for (const ProfileKey& other : others) {
    EXPECT_FALSE(read_profile_result(folder, other, 1e3)) << profile_result_file(folder, other);
    write_profile_result(folder, other, {.status = "other"});
  }
  EXPECT_EQ(names_in(folder).size(), 11u);
  EXPECT_EQ(read_profile_result(folder, kKey, 1e3)->status, "converged");
  ProfileKey another_program = kKey, oftener = kKey;
  another_program.program = 43, oftener.options.repeat = 7;
  EXPECT_FALSE(read_profile_result(folder, another_program, 1e3));
  EXPECT_TRUE(read_profile_result(folder, oftener, 1e3));
  // What has the name of another's file does not become the other's.
  std::filesystem::copy_file(profile_result_file(folder, kKey), profile_result_file(folder, others[0]),
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_FALSE(read_profile_result(folder, others[0], 1e3));
}

TEST(ProfileResult, IsDoneAgainIfItsFileIsDamaged) {
  const std::filesystem::path folder = fresh_folder();
  write_profile_result(folder, kKey, solved_result());
  const std::filesystem::path path = profile_result_file(folder, kKey);
  const std::string whole = content_of(path);
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    write_bytes(path, whole.substr(0, size));
    EXPECT_FALSE(read_profile_result(folder, kKey, 1e3)) << size;
  }
  for (const auto& [good, bad] : {std::pair("\"iterations\": 7", "\"iterations\": \"x\""),
                                  std::pair("\"solved\": true", "\"solved\": 1"),
                                  std::pair("\"inf\"", "\"infinite\""), std::pair("\"inf\"", "null")}) {
    std::string damaged = whole;
    damaged.replace(damaged.find(good), std::string(good).size(), bad);
    write_bytes(path, damaged);
    EXPECT_FALSE(read_profile_result(folder, kKey, 1e3)) << damaged;
  }
  write_profile_result(folder, kKey, solved_result());
  EXPECT_EQ(content_of(path), whole);
  EXPECT_EQ(names_in(folder).size(), 1u);
}

TEST(ProfileResult, GivesUpNothingForGood) {
  const std::filesystem::path folder = fresh_folder();
  write_profile_result(folder, kKey, {.status = "time_limit", .time_limit = 10});
  EXPECT_TRUE(read_profile_result(folder, kKey, 10));
  EXPECT_TRUE(read_profile_result(folder, kKey, 1));
  EXPECT_FALSE(read_profile_result(folder, kKey, 11));  // more patience: once more
  write_profile_result(folder, kKey, solved_result());
  EXPECT_TRUE(read_profile_result(folder, kKey, 11)->solved);  // the later one counts
}

}  // namespace aussois
