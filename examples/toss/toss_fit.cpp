// SPDX-License-Identifier: Apache-2.0
#include "examples/toss/toss_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/parallel.hpp"

namespace aussois {
namespace {

constexpr double kGridMu = 0.0025, kGridRestitution = 0.0125;
constexpr int kFirstStride = 8;  // of the search, halved where no neighbour is better

using Point = std::pair<int, int>;  // of the grid

}  // namespace

double board_of(const std::vector<Toss>& tosses) {
  std::vector<double> heights;
  for (const Toss& toss : tosses) heights.push_back(toss.pose.back().p.z() - kTossEdge / 2);
  std::ranges::nth_element(heights, heights.begin() + std::ptrdiff_t(heights.size() / 2));
  return heights[heights.size() / 2];
}

TossFit fit(const std::vector<Toss>& tosses, const TossWorld& world, int threads,
            const std::function<bool(const TossFit&)>& seen) {
  std::map<Point, double> known;
  TossFit out;
  bool go_on = true;
  const auto error_at = [&](Point p) {
    if (const auto found = known.find(p); found != known.end()) return found->second;
    TossWorld tried = world;
    tried.mu = kGridMu * p.first;
    tried.restitution = kGridRestitution * p.second;
    if (p.first < 0 || p.second < 0 || tried.restitution > 1) return kInf;
    std::vector<double> of_toss(tosses.size());
    parallel_for(int(tosses.size()), threads, [&](int i) {
      const TossRun run = roll_out(tosses[std::size_t(i)], tried);
      of_toss[std::size_t(i)] =
          run.failure.empty() ? run.errors.position + kTossEdge / 2 * run.errors.rotation : kInf;
    });
    double sum = 0;
    for (const double e : of_toss) sum += e;
    ++out.evaluations;
    const double mean = known[p] = sum / double(tosses.size());
    go_on = seen({tried.mu, tried.restitution, mean, out.evaluations});
    return mean;
  };
  Point best{int(std::lround(world.mu / kGridMu)), int(std::lround(world.restitution / kGridRestitution))};
  double least = error_at(best);
  for (int stride = kFirstStride; stride > 0 && go_on;) {
    const Point from = best;
    for (const auto& [dm, de] : std::array<Point, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
      if (!go_on) break;
      const Point p{from.first + stride * dm, from.second + stride * de};
      if (const double e = error_at(p); e < least) least = e, best = p;
    }
    if (best == from) stride /= 2;
  }
  out.mu = kGridMu * best.first;
  out.restitution = kGridRestitution * best.second;
  out.error = least;
  return out;
}

}  // namespace aussois
