// SPDX-License-Identifier: Apache-2.0
// The bar: every family with 100 to 1000 contacts to 1e-8 by the automatic solver.
#include <string>

#include <gtest/gtest.h>

#include "examples/studies/families/problem_families.hpp"
#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest calls it so
void PrintTo(const ProblemFamily& family, std::ostream* out) {
  *out << family.name;
}

class LargeFamilies : public ::testing::TestWithParam<ProblemFamily> {};

TEST_P(LargeFamilies, AreSolvedByTheAutomaticSolver) {
  for (const int size : {100, 300, 1000})
    for (std::uint64_t seed = 1; seed <= (size < 1000 ? 10u : 3u); ++seed) {
      const std::string stem = family_file_stem(GetParam(), size, seed);
      const FrictionProblem problem = friction_problem(family_scene(GetParam(), size, seed));
      const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-8});
      EXPECT_EQ(s.report.status, SolveStatus::converged) << stem << ": " << s.report.residual;
      EXPECT_LE(scaled_residual(condense(problem), s.r), 1.01e-8) << stem;
    }
}

INSTANTIATE_TEST_SUITE_P(All, LargeFamilies,
                         ::testing::ValuesIn(problem_families().begin(), problem_families().end()),
                         [](const auto& family) { return std::string(family.param.name); });

}  // namespace aussois
