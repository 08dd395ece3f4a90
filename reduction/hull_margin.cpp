// SPDX-License-Identifier: Apache-2.0
#include "reduction/hull_margin.hpp"

#include <algorithm>
#include <numeric>

namespace aussois {
namespace {

constexpr int kHalvings = 12;  // of an interval of margins: 2.5e-4 of it is left

/// The corners about the centroid; index h + i is corner i again.
class Corners {
 public:
  Corners(const PlanarPatch& patch, const std::vector<int>& ring) : slack_(kSamePlace * patch.extent) {
    for (const int i : ring) at_.push_back(patch.x[i] - patch.centroid);
  }
  std::size_t count() const { return at_.size(); }

  // For every corner the last one that a chord may lead to so that the hull, shrunk by the margin, stays on
  // its left. The corner farthest beyond the chord, and the end of the chord, only move on.
  std::vector<std::size_t> reach(double margin) const {
    const std::size_t h = count();
    std::vector<std::size_t> last(h);
    std::size_t end = 1, far = 0;
    for (std::size_t i = 0; i < h; ++i) {
      end = std::max(end, i + 1);
      for (std::size_t next = end + 1; next < i + h; ++next) {
        const Vec2 side = corner(next) - corner(i), d(side.y(), -side.x());
        std::size_t beyond = std::max(far, i);
        while (beyond + 1 < next && d.dot(corner(beyond + 1)) > d.dot(corner(beyond))) ++beyond;
        if (d.dot(corner(i)) < margin * d.dot(corner(beyond)) - slack_ * d.norm()) break;
        end = next;
        far = beyond;
      }
      last[i] = end;
    }
    return last;
  }

 private:
  const Vec2& corner(std::size_t i) const { return at_[i < at_.size() ? i : i - at_.size()]; }
  std::vector<Vec2> at_{};
  double slack_ = 0;
};

// The fewest corners with a margin: chords as long as they may be, from the best of the corners under the
// first chord, one of which every choice must have (RED-11).
std::vector<std::size_t> fewest(const Corners& corners, double margin) {
  const std::size_t h = corners.count();
  const std::vector<std::size_t> reach = corners.reach(margin);
  const auto walk = [&](std::size_t start, const auto& visit) {
    std::size_t i = start;
    do {
      visit(i % h);
      i += reach[i % h] - i % h;
    } while (i < start + h);
  };
  std::size_t best = 0, least = h + 1;
  for (std::size_t start = 1; start <= reach[0]; ++start) {
    std::size_t count = 0;
    walk(start, [&](std::size_t) { ++count; });
    if (count < least) least = count, best = start;
  }
  std::vector<std::size_t> tour;
  tour.reserve(least);
  walk(best, [&](std::size_t i) { tour.push_back(i); });
  return tour;
}

}  // namespace

std::vector<int> hull_margin(const PlanarPatch& patch, const HullMargin& options) {
  std::vector<int> ring = patch.hull;  // from the first member on: a start that moves with the bodies
  std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
  const std::size_t least = std::size_t(options.min_corners);
  std::vector<std::size_t> best(ring.size());
  std::iota(best.begin(), best.end(), std::size_t(0));
  if (ring.size() > least) {
    const Corners corners(patch, ring);
    const std::vector<std::size_t> enough = fewest(corners, options.margin);
    const std::size_t count = std::clamp(enough.size(), least, std::size_t(options.max_corners));
    double low = 0, high = 1;
    if (enough.size() <= count) best = enough, low = options.margin;
    for (int n = 0; n < kHalvings; ++n) {
      const double middle = (low + high) / 2;
      std::vector<std::size_t> tour = fewest(corners, middle);
      if (tour.size() <= count)
        best = std::move(tour), low = middle;
      else
        high = middle;
    }
  }
  std::vector<int> out;
  for (const std::size_t i : best) out.push_back(ring[i]);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace aussois
