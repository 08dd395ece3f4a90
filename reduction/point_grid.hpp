// SPDX-License-Identifier: Apache-2.0
// Finds the points near a place, by a grid that takes points as they come.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Points in a box. Cells are `width` wide, or wider where that would be many more cells than points.
class PointGrid {
 public:
  PointGrid(const Vec3& low, const Vec3& high, double width, std::size_t points) : low_(low) {
    const double extent = (high - low).maxCoeff(), most = std::ceil(2 * std::cbrt(double(points)));
    width_ = std::max(width, extent / most);
    if (!(width_ > 0)) width_ = 1;
    for (int i = 0; i < 3; ++i) size_[i] = 1 + int((high[i] - low[i]) / width_);
    last_.assign(std::size_t(size_[0]) * size_[1] * size_[2], -1);
    before_.reserve(points);
  }

  /// Adds a point of the box. The first is number 0, the next 1 and so on.
  void add(const Vec3& x) {
    const Vec3 at = (x - low_) / width_;
    int& last = last_[row(int(at.x()), int(at.y())) + int(at.z())];
    before_.push_back(last);
    last = int(before_.size()) - 1;
  }

  /// Calls visit(number) for all points no farther than `reach` from x, and for others.
  void for_each_near(const Vec3& x, double reach, auto&& visit) const {
    std::array<int, 3> from{}, to{};
    for (int i = 0; i < 3; ++i) {
      const double at = (x[i] - low_[i]) / width_, room = reach / width_ + 1e-9;  // for rounding
      if (!(at + room >= 0 && at - room < size_[i])) return;
      from[i] = int(std::max(at - room, 0.0)), to[i] = int(std::min(at + room, size_[i] - 1.0));
    }
    for (int i = from[0]; i <= to[0]; ++i)
      for (int j = from[1]; j <= to[1]; ++j)
        for (int k = from[2]; k <= to[2]; ++k)
          for (int point = last_[row(i, j) + k]; point >= 0; point = before_[point])
            visit(std::size_t(point));
  }

 private:
  std::size_t row(int i, int j) const { return (std::size_t(i) * size_[1] + j) * size_[2]; }

  Vec3 low_;
  double width_ = 0;  // of a cell
  std::array<int, 3> size_{};
  std::vector<int> last_{};    // of each cell, -1: none
  std::vector<int> before_{};  // of each point: the next older one of its cell, -1: none
};

}  // namespace aussois
