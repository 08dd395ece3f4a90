// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/performance_profile.hpp"

#include <limits>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

constexpr double kFailed = std::numeric_limits<double>::infinity();

// Four problems: A wins two of them by a factor of two and three, B one by five; neither solves the last.
const std::vector<std::vector<double>> kCost = {{1, 2, 10, kFailed}, {2, 6, 2, kFailed}};

}  // namespace

TEST(PerformanceProfile, CountsTheShareWithinAFactorOfTheBest) {
  const PerformanceProfile profile = performance_profile(kCost);
  EXPECT_EQ(profile.tau, (std::vector<double>{1, 2, 3, 5}));
  ASSERT_EQ(profile.share.size(), 2u);
  EXPECT_EQ(profile.share[0], (std::vector<double>{0.5, 0.5, 0.5, 0.75}));
  EXPECT_EQ(profile.share[1], (std::vector<double>{0.25, 0.5, 0.75, 0.75}));
}

TEST(PerformanceProfile, OfSolversThatFailOnEverythingIsZero) {
  const PerformanceProfile profile = performance_profile({{kFailed, kFailed}, {kFailed, kFailed}});
  EXPECT_EQ(profile.tau, (std::vector<double>{1}));
  EXPECT_EQ(profile.share, (std::vector<std::vector<double>>{{0}, {0}}));
}

TEST(PerformanceProfile, GivesTheWinnerOfEqualTimesToBoth) {
  EXPECT_EQ(performance_profile({{3, 1}, {3, 1}}).share, (std::vector<std::vector<double>>{{1}, {1}}));
}

TEST(PerformanceProfile, RefusesCostsThatAreNone) {
  EXPECT_EQ(message_of([] {
              performance_profile({{1, 0}});
            }),
            "cost = 0 must be positive, infinity for a failure");
  EXPECT_EQ(message_of([] { performance_profile({{std::numeric_limits<double>::quiet_NaN()}}); }),
            "cost = nan must be positive, infinity for a failure");
  EXPECT_EQ(message_of([] {
              performance_profile({{1, 2}, {1}});
            }),
            "problems of a solver = 1 must be 2 as for the other solvers");
}

TEST(PerformanceProfile, IsWrittenAsTableAndScript) {
  const std::filesystem::path folder = fresh_folder();
  const bool picture = write_profile(folder, "profile", {"auto", "a,b"}, performance_profile(kCost), "title");
  EXPECT_EQ(content_of(folder / "profile.csv"),
            "tau,auto,a_b\n1,0.5,0.25\n2,0.5,0.5\n3,0.5,0.75\n5,0.75,0.75\n7.5,0.75,0.75\n");
  EXPECT_NE(content_of(folder / "profile.gp").find("plot for [k=2:3] 'profile.csv'"), std::string::npos);
  EXPECT_EQ(std::filesystem::exists(folder / "profile.png"), picture);
  if (picture) {
    EXPECT_GT(std::filesystem::file_size(folder / "profile.png"), 1000u);
  }
}

}  // namespace aussois
