// SPDX-License-Identifier: Apache-2.0
#include "lmd/broad_phase.hpp"

#include <algorithm>
#include <numeric>

namespace aussois {

std::vector<std::pair<int, int>> broad_phase(const std::vector<Ball>& balls) {
  Vec3 lo = Vec3::Constant(kInf), hi = Vec3::Constant(-kInf);
  for (const Ball& ball : balls) lo = lo.cwiseMin(ball.centre), hi = hi.cwiseMax(ball.centre);
  Eigen::Index axis = 0;
  if (!balls.empty()) (hi - lo).maxCoeff(&axis);

  std::vector<int> order(balls.size());
  std::iota(order.begin(), order.end(), 0);
  const auto begin = [&](int i) { return balls[std::size_t(i)].centre[axis] - balls[std::size_t(i)].radius; };
  const auto end = [&](int i) { return balls[std::size_t(i)].centre[axis] + balls[std::size_t(i)].radius; };
  std::ranges::sort(order, [&](int i, int j) { return begin(i) != begin(j) ? begin(i) < begin(j) : i < j; });

  std::vector<std::pair<int, int>> pairs;
  std::vector<int> open;
  for (int i : order) {
    std::erase_if(open, [&](int j) { return end(j) < begin(i); });
    for (int j : open) {
      const Ball &a = balls[std::size_t(i)], &b = balls[std::size_t(j)];
      if ((a.centre - b.centre).norm() <= a.radius + b.radius) pairs.push_back(std::minmax(i, j));
    }
    open.push_back(i);
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace aussois
