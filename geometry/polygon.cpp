// SPDX-License-Identifier: Apache-2.0
// Holes are joined to the outer loop by bridges to a visible corner, ears are cut from the result, and inner
// edges flipped until they are Delaunay [Ericson2005, ch. 12].
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/exact_point.hpp"

namespace aussois {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

// +1: a, b, c run counter-clockwise.
int turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return int(CGAL::orientation(exact(a), exact(b), exact(c)));
}

// Inside or on the border of the counter-clockwise triangle.
bool holds(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& x) {
  return turn(a, b, x) >= 0 && turn(b, c, x) >= 0 && turn(c, a, x) >= 0;
}

class EarCutter {
 public:
  EarCutter(const std::vector<Vec2>& points, const std::vector<int>& outer) : points_(points), ring_(outer) {}

  /// Cuts the ring open at a corner that the hole's rightmost point sees to its right.
  bool bridge(const std::vector<int>& hole) {
    const auto start =
        std::max_element(hole.begin(), hole.end(), [&](int i, int j) { return x(i).x() < x(j).x(); });
    const Vec2 m = x(*start);
    std::size_t seen = ring_.size();
    double reach = kInf;
    Vec2 hit = m;
    for (std::size_t i = 0; i < ring_.size();
         ++i) {  // the nearest upward edge on the ray from m to the right
      const Vec2 &a = x(ring_[i]), &b = x(ring_[next(i)]);
      if (a.y() > m.y() || b.y() < m.y() || a.y() == b.y()) continue;
      const double at = a.x() + (m.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
      if (at < m.x() || at - m.x() >= reach) continue;
      reach = at - m.x();
      hit = {at, m.y()};
      seen = a.x() > b.x() ? i : next(i);
    }
    if (seen == ring_.size()) return false;
    const Vec2 corner = x(ring_[seen]);
    double best = kInf, nearest = kInf;  // corners in the triangle m, hit, corner hide the corner
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const Vec2& p = x(ring_[i]);
      if (p == corner || p.x() < m.x()) continue;
      const bool above = corner.y() > m.y();
      if (!(above ? holds(m, hit, corner, p) : holds(m, corner, hit, p))) continue;
      if (!opens_towards(i, m)) continue;
      const double slope = std::abs(p.y() - m.y()) / std::max(p.x() - m.x(), 1e-300);
      const double distance = (p - m).squaredNorm();
      if (slope < best || (slope == best && distance < nearest)) best = slope, nearest = distance, seen = i;
    }
    for (std::size_t i = 0; i < ring_.size(); ++i)  // of several corners at the same place the one that opens
      if (x(ring_[i]) == x(ring_[seen]) && opens_towards(i, m)) {
        seen = i;
        break;
      }
    std::vector<int> joined(ring_.begin(), ring_.begin() + long(seen) + 1);
    joined.insert(joined.end(), start, hole.end());
    joined.insert(joined.end(), hole.begin(), start + 1);
    joined.insert(joined.end(), ring_.begin() + long(seen), ring_.end());
    ring_ = std::move(joined);
    return true;
  }

  std::optional<Triangles> cut() {
    Triangles triangles;
    std::size_t at = 0, tried = 0;
    while (ring_.size() > 3) {
      if (at >= ring_.size()) at = 0;
      if (is_ear(at)) {
        triangles.push_back({ring_[previous(at)], ring_[at], ring_[next(at)]});
        ring_.erase(ring_.begin() + long(at));
        tried = 0;
        ++at;  // not the neighbour at once: fans would make slivers
      } else if (++tried > ring_.size()) {
        return std::nullopt;
      } else {
        ++at;
      }
    }
    if (turn(x(ring_[0]), x(ring_[1]), x(ring_[2])) < 0) return std::nullopt;
    triangles.push_back({ring_[0], ring_[1], ring_[2]});
    return triangles;
  }

 private:
  const Vec2& x(int i) const { return points_[i]; }
  std::size_t next(std::size_t i) const { return i + 1 == ring_.size() ? 0 : i + 1; }
  std::size_t previous(std::size_t i) const { return i == 0 ? ring_.size() - 1 : i - 1; }

  bool opens_towards(std::size_t i, const Vec2& m) const {
    const Vec2 &a = x(ring_[previous(i)]), &b = x(ring_[i]), &c = x(ring_[next(i)]);
    return turn(a, b, c) >= 0 ? turn(a, b, m) >= 0 && turn(b, c, m) >= 0
                              : turn(a, b, m) >= 0 || turn(b, c, m) >= 0;
  }

  bool is_ear(std::size_t i) const {
    const Vec2 &a = x(ring_[previous(i)]), &b = x(ring_[i]), &c = x(ring_[next(i)]);
    const int bend = turn(a, b, c);
    if (bend < 0) return false;
    for (std::size_t k = 0; k < ring_.size(); ++k) {
      if (k == i || k == previous(i) || k == next(i)) continue;
      const Vec2& p = x(ring_[k]);
      if (p == a || p == b || p == c) continue;
      if (bend == 0 ? turn(a, c, p) == 0 && (p - a).dot(p - c) < 0 && (a - b).dot(c - b) > 0
                    : holds(a, b, c, p))
        return false;
    }
    return true;
  }

  const std::vector<Vec2>& points_;
  std::vector<int> ring_;
};

struct Side {
  int from = 0, to = 0;
  std::size_t triangle = 0, side = 0;
};

// p strictly inside the circle of the counter-clockwise triangle a, b, c, by more than rounding.
bool in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  const Vec2 u = a - p, v = b - p, w = c - p;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), ww = w.squaredNorm();
  const double d = uu * (v.x() * w.y() - v.y() * w.x()) - vv * (u.x() * w.y() - u.y() * w.x()) +
                   ww * (u.x() * v.y() - u.y() * v.x());
  const double size = std::max({uu, vv, ww});
  return d > 1e-12 * size * size;
}

void make_delaunay(const std::vector<Vec2>& points, Triangles& triangles) {
  const auto x = [&](int i) -> const Vec2& { return points[i]; };
  for (std::size_t pass = 0, flips = 1; flips > 0 && pass < 4 * triangles.size() + 8; ++pass) {
    flips = 0;
    std::vector<Side> half;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) half.push_back({triangles[t][k], triangles[t][(k + 1) % 3], t, k});
    const auto key = [](const Side& h) {
      return std::array<int, 3>{std::min(h.from, h.to), std::max(h.from, h.to), h.from};
    };
    std::ranges::sort(half, {}, key);
    std::vector<char> changed(triangles.size(), 0);
    for (std::size_t i = 0; i + 1 < half.size(); ++i) {
      const Side &h = half[i], &g = half[i + 1];
      if (h.from != g.to || h.to != g.from || changed[h.triangle] || changed[g.triangle]) continue;
      const int a = h.from, b = h.to, c = triangles[h.triangle][(h.side + 2) % 3],
                d = triangles[g.triangle][(g.side + 2) % 3];  // a b c and b a d
      if (turn(x(a), x(d), x(c)) <= 0 || turn(x(d), x(b), x(c)) <= 0) continue;
      if (turn(x(a), x(b), x(c)) > 0 ? !in_circle(x(a), x(b), x(c), x(d))
                                     : !in_circle(x(b), x(a), x(d), x(c)) && turn(x(b), x(a), x(d)) > 0)
        continue;
      triangles[h.triangle] = {a, d, c};
      triangles[g.triangle] = {d, b, c};
      changed[h.triangle] = changed[g.triangle] = 1;
      ++flips;
    }
  }
}

}  // namespace

Vec2 nearest_on_segment(const Vec2& a, const Vec2& b, const Vec2& x) {
  const Vec2 side = b - a;
  const double length2 = side.squaredNorm();
  return length2 > 0 ? Vec2(a + std::clamp((x - a).dot(side) / length2, 0.0, 1.0) * side) : a;
}

double twice_area(const std::vector<Vec2>& points, const std::vector<int>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 a = points[loop[i]] - points[loop[0]],
               b = points[loop[(i + 1) % loop.size()]] - points[loop[0]];
    sum += cross(a, b);
  }
  return sum;
}

std::optional<Triangles> triangulate(const std::vector<Vec2>& points,
                                     const std::vector<std::vector<int>>& loops) {
  if (loops.empty() || loops[0].size() < 3) return std::nullopt;
  EarCutter cutter(points, loops[0]);
  std::vector<std::size_t> holes;
  for (std::size_t i = 1; i < loops.size(); ++i) holes.push_back(i);
  const auto rightmost = [&](std::size_t i) {
    double at = -kInf;
    for (int k : loops[i]) at = std::max(at, points[k].x());
    return -at;
  };
  std::ranges::stable_sort(holes, {}, rightmost);
  for (const std::size_t hole : holes)
    if (!cutter.bridge(loops[hole])) return std::nullopt;
  std::optional<Triangles> triangles = cutter.cut();
  if (triangles) make_delaunay(points, *triangles);
  return triangles;
}

}  // namespace aussois
