// SPDX-License-Identifier: Apache-2.0
// One step's problem by hand: a block of 2 kg that slides at 1 m/s is pressed by its weight for 10 ms.
// Friction takes mu g h off its speed.
#include <cmath>
#include <cstdio>

#include "nsgs/solve.hpp"

namespace au = aussois;

int main() {
  const double mass = 2, h = 0.01, g = 9.81, mu = 0.3;
  au::FrictionProblem problem;  // M v = H r + f,  u = H^T v + w;  rows: normal, two tangents
  problem.M = (mass * au::MatX::Identity(3, 3)).sparseView();
  problem.H = au::MatX::Identity(3, 3).sparseView();  // here velocities are those of the contact
  problem.f = mass * au::Vec3(-g * h, 1, 0);          // momentum without the contact [N s]
  problem.w = au::VecX::Zero(3);
  problem.laws = {au::coulomb(mu)};

  const au::FrictionSolution solution = solve(problem, au::VecX(), {.tolerance = 1e-12});
  std::printf("%s after %d iterations: r = (%.6f, %.6f, %.6f) N s, speed %.6f m/s\n",
              to_string(solution.report.status), solution.report.iterations, solution.r[0], solution.r[1],
              solution.r[2], solution.v[1]);
  return std::abs(solution.v[1] - (1 - mu * g * h)) < 1e-10 ? 0 : 1;
}
