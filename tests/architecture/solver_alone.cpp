// SPDX-License-Identifier: Apache-2.0
// The solver links by itself, with no shape behind it: a block that slides is slowed by mu g h.
#include "nsgs/solve.hpp"

int main() {
  namespace au = aussois;
  au::FrictionProblem problem;
  problem.M = problem.H = au::MatX::Identity(3, 3).sparseView();
  problem.f = au::Vec3(-0.1, 1, 0);
  problem.w = au::VecX::Zero(3);
  problem.laws = {au::coulomb(0.3)};
  const au::FrictionSolution solution = solve(problem, au::VecX());
  return std::abs(solution.v[1] - 0.97) < 1e-8 ? 0 : 1;
}
