// SPDX-License-Identifier: Apache-2.0
#include "nsgs/residual.hpp"

#include <gtest/gtest.h>

#include "nsgs/solve.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

LocalProblem one_contact(const Mat3& W, const Vec3& q, double mu) {
  return {.W = MatX(W).sparseView(), .q = q, .laws = {coulomb(mu)}};
}

TEST(Residual, OfNoImpulseIsThatOfTheFreeVelocity) {
  // r = 0, q = (-3, 0, 4), mu = 0: the map projects (3, 0, -4) on the normal: 3 of |q| = 5.
  const LocalProblem problem = one_contact(2 * Mat3::Identity(), {-3, 0, 4}, 0);
  EXPECT_NEAR(natural_map_residual(problem, VecX::Zero(3)), 0.6, 1e-15);
  EXPECT_NEAR(scaled_residual(problem, VecX::Zero(3)), 0.6, 1e-15);
}

TEST(Residual, VanishesAtASolutionOnly) {
  const LocalProblem problem = one_contact(Vec3(2, 4, 4).asDiagonal(), {-2, 3, 4}, 0.5);
  const VecX r = Vec3(1, -0.3, -0.4);  // slip, by hand
  EXPECT_LT(scaled_residual(problem, r), 1e-15);
  EXPECT_LT(natural_map_residual(problem, r), 1e-15);
  EXPECT_GT(scaled_residual(problem, VecX(1.001 * r)), 1e-4);
  EXPECT_GT(scaled_residual(problem, VecX(Vec3(1, -0.4, -0.3))), 1e-2);
}

TEST(Residual, DoesNotDependOnUnitsWhenScaled) {
  Random random(5);
  const LocalProblem problem = condense(random_peg_in_hole(random, 2, 10, 0.2));
  const VecX r = uniform_vector(random, 30, 0, 1e-3);
  LocalProblem other = problem;  // masses times 1e6, velocities times 1e-3: W / 1e6, q / 1e3, r times 1e3
  other.W /= 1e6;
  other.q /= 1e3;
  const double scaled = scaled_residual(problem, r);
  EXPECT_NEAR(scaled_residual(other, 1e3 * r), scaled, 1e-12 * scaled);
  EXPECT_GT(std::abs(natural_map_residual(other, 1e3 * r) / natural_map_residual(problem, r) - 1), 0.1);
}

// (NSGS-15), on anything but a solution; and factors of that size do occur.
TEST(Residual, OnQIsBoundedByTheScaledOneTimesWhatUnitsMakeOfIt) {
  double largest = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    LocalProblem problem = condense(random_peg_in_hole(random, 1 + int(seed % 2), 10, 0.4));
    problem.W *= random.log_uniform(1e-6, 1e6);
    const VecX w = row_scales(problem.W.diagonal(), problem.laws);
    const VecX r = VecX(uniform_vector(random, 30, -1, 1) * problem.q.norm()).cwiseQuotient(w);
    const double longest = std::max(std::sqrt(w.maxCoeff()), 1 / std::sqrt(w.minCoeff()));
    const double bound = longest / std::sqrt(w.minCoeff()), scaled = scaled_residual(problem, r);
    EXPECT_LE(natural_map_residual(problem, r), bound * scaled * (1 + 1e-12)) << "seed " << seed;
    largest = std::max(largest, natural_map_residual(problem, r) / scaled);
  }
  EXPECT_GT(largest, 1e3);
}

TEST(Residual, OfNothingIsZeroAndOfNanIsNan) {
  EXPECT_EQ(scaled_residual(LocalProblem{}, VecX(0)), 0);
  LocalProblem problem = one_contact(Mat3::Identity(), Vec3::Zero(), 0.3);
  EXPECT_EQ(scaled_residual(problem, VecX::Zero(3)), 0);
  problem.q[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(scaled_residual(problem, VecX::Zero(3))));
}

TEST(Residual, InUnitsThatPeopleKnow) {
  // Contact 0 approaches with 2 m/s; contact 1 leaves its cone by 0.4 - 0.5 * 0.2 and slips at right angles
  // to it.
  const Vec6 u(-2, 0, 0, 0.5, 1, 0), r(3, 0, 0, 0.2, 0, 0.4);
  const PhysicalResidual wrong = physical_residual(u, r, {coulomb(0.5), coulomb(0.5)});
  EXPECT_DOUBLE_EQ(wrong.worst_normal_approach, 2);
  EXPECT_DOUBLE_EQ(wrong.worst_cone_violation, 0.3);
  EXPECT_DOUBLE_EQ(wrong.worst_complementarity, 6);
  EXPECT_DOUBLE_EQ(wrong.worst_misalignment, kPi / 2);
}

}  // namespace
}  // namespace aussois
