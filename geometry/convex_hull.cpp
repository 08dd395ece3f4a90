// SPDX-License-Identifier: Apache-2.0
#include "geometry/convex_hull.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "geometry/exact_point.hpp"

namespace aussois {
namespace {

struct Facet {
  std::array<int, 3> corner{};     // counter-clockwise from outside
  std::array<int, 3> neighbour{};  // facet across the side from corner k to k + 1
  std::vector<int> outside{};      // points that see this facet and are not on the hull yet
  bool alive = true;
};

// With exact signs the facets that a point sees strictly form a disc, coplanar facets included, so that their
// border (the horizon) is one cycle and no new facet is degenerate: no case needs a tolerance.
class Quickhull {
 public:
  explicit Quickhull(std::span<const Vec3> points) : points_(points), facet_from_(points.size(), -1) {}

  std::vector<std::array<int, 3>> hull() {
    start_with_tetrahedron();
    for (std::size_t f = 0; f < facets_.size(); ++f)  // new facets join at the end
      if (facets_[f].alive && !facets_[f].outside.empty()) add_point(farthest_outside(facets_[f]), int(f));
    std::vector<std::array<int, 3>> triangles;
    for (const Facet& facet : facets_)
      if (facet.alive) triangles.push_back(facet.corner);
    return triangles;
  }

 private:
  const Vec3& at(int i) const { return points_[i]; }
  Facet& facet(int f) { return facets_[f]; }

  bool sees(int point, const std::array<int, 3>& corner) const {
    return CGAL::orientation(exact(at(corner[0])), exact(at(corner[1])), exact(at(corner[2])),
                             exact(at(point))) == CGAL::POSITIVE;  // the side of the outward normal
  }

  // The point with the largest measure; only a good choice, never a decision.
  template <class Measure>
  int largest(const Measure& measure) const {
    int best = 0;
    double value = -1;
    for (int i = 0; i < int(points_.size()); ++i) {
      const double m = measure(at(i));
      if (m > value) value = m, best = i;
    }
    return best;
  }

  // `guess`, unless it is exactly degenerate; then the first point that is not. -1: there is none.
  template <class Degenerate>
  int confirmed(int guess, const Degenerate& degenerate) const {
    if (!degenerate(guess)) return guess;
    for (int i = 0; i < int(points_.size()); ++i)
      if (!degenerate(i)) return i;
    return -1;
  }

  void start_with_tetrahedron() {
    const int a = 0;
    const int b = largest([&](const Vec3& x) { return (x - at(a)).norm(); });
    const Vec3 ab = at(b) - at(a);
    const int c = confirmed(largest([&](const Vec3& x) { return ab.cross(x - at(a)).norm(); }),
                            [&](int i) { return CGAL::collinear(exact(at(a)), exact(at(b)), exact(at(i))); });
    require(c >= 0, "convex hull: all points lie on one line");
    const Vec3 normal = ab.cross(at(c) - at(a));
    const int d = confirmed(
        largest([&](const Vec3& x) { return std::abs(normal.dot(x - at(a))); }),
        [&](int i) { return CGAL::coplanar(exact(at(a)), exact(at(b)), exact(at(c)), exact(at(i))); });
    require(d >= 0, "convex hull: all points lie in one plane");

    std::array<int, 3> base = {a, b, c};
    if (sees(d, base)) std::swap(base[1], base[2]);  // the base looks away from d
    const auto [p, q, r] = base;
    facets_ = {{{p, q, r}, {1, 2, 3}, {}},
               {{q, p, d}, {0, 3, 2}, {}},
               {{r, q, d}, {0, 1, 3}, {}},
               {{p, r, d}, {0, 2, 1}, {}}};
    for (int i = 0; i < int(points_.size()); ++i) hand_over(i, 0);
  }

  // Gives the point to the first facet from `begin` on that it sees; a point that sees none is inside for
  // ever.
  void hand_over(int point, std::size_t begin) {
    for (std::size_t f = begin; f < facets_.size(); ++f) {
      if (!sees(point, facets_[f].corner)) continue;
      facets_[f].outside.push_back(point);
      return;
    }
  }

  int farthest_outside(const Facet& facet) const {
    const Vec3& origin = at(facet.corner[0]);
    const Vec3 normal = (at(facet.corner[1]) - origin).cross(at(facet.corner[2]) - origin);
    return *std::max_element(facet.outside.begin(), facet.outside.end(), [&](int i, int j) {
      return normal.dot(at(i) - origin) < normal.dot(at(j) - origin);
    });
  }

  void add_point(int point, int first_visible) {
    std::vector<int> visible = {first_visible};
    facet(first_visible).alive = false;
    const std::size_t begin = facets_.size();
    std::vector<int> horizon;  // the vertices from which its sides start
    for (std::size_t k = 0; k < visible.size(); ++k) {
      for (std::size_t side = 0; side < 3; ++side) {
        const Facet& old = facet(visible[k]);
        const int beyond = old.neighbour[side];
        if (!facet(beyond).alive) continue;
        if (sees(point, facet(beyond).corner)) {
          facet(beyond).alive = false;
          visible.push_back(beyond);
        } else {
          add_facet(old.corner[side], old.corner[(side + 1) % 3], point, beyond, visible[k]);
          horizon.push_back(facets_.back().corner[0]);
        }
      }
    }
    for (const int from : horizon) {  // the new facets stand around the point in the order of the horizon
      const int f = facet_from_[from];
      const int next = facet_from_[facet(f).corner[1]];
      facet(f).neighbour[1] = next;
      facet(next).neighbour[2] = f;
    }
    for (const int f : visible) {
      for (const int i : facet(f).outside)
        if (i != point) hand_over(i, begin);
      facet(f).outside = {};
    }
  }

  // The facet from a side of the horizon to the point, in place of `old`, which lay at that side.
  void add_facet(int from, int to, int point, int beyond, int old) {
    const int f = int(facets_.size());
    std::replace(facet(beyond).neighbour.begin(), facet(beyond).neighbour.end(), old, f);
    facet_from_[from] = f;
    facets_.push_back({{from, to, point}, {beyond, -1, -1}, {}});
  }

  std::span<const Vec3> points_;
  std::vector<int> facet_from_;  // facet of the last horizon whose side starts at this point
  std::vector<Facet> facets_{};
};

}  // namespace

std::vector<std::array<int, 3>> convex_hull(std::span<const Vec3> points) {
  require_field(points.size() >= 4, "number of points", points.size(), "be at least 4 for a convex hull");
  for (std::size_t i = 0; i < points.size(); ++i)
    require(points[i].allFinite(), "convex hull: point " + std::to_string(i) + " must be finite");
  return Quickhull(points).hull();
}

}  // namespace aussois
