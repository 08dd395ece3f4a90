// SPDX-License-Identifier: Apache-2.0
#include "geometry/self_intersections.hpp"

#include <algorithm>

#include "geometry/box_tree.hpp"
#include "geometry/exact_point.hpp"
#include "geometry/mesh_report.hpp"

namespace aussois {
namespace {

using Point = ExactKernel::Point_3;
using Segment = ExactKernel::Segment_3;
using Triangle = ExactKernel::Triangle_3;

struct Corners {
  std::array<int, 3> place{};  // equal numbers: equal places
  std::array<Point, 3> point{};
};

// Are the corners q(first), ..., q(2) of another triangle strictly on one side of the plane of this one?
template <class Corner>
bool beside(const Corners& triangle, const Corner& q, std::size_t first) {
  const auto& [a, b, c] = triangle.point;
  const CGAL::Orientation side = CGAL::orientation(a, b, c, q(2));
  if (side == CGAL::COPLANAR) return false;
  for (std::size_t k = first; k < 2; ++k)
    if (CGAL::orientation(a, b, c, q(k)) != side) return false;
  return true;
}

// Elsewhere than in what they share; the cases are those of CGAL's PMP::self_intersections.
bool meet(const Corners& s, const Corners& t) {
  std::array<std::size_t, 3> in_s{}, in_t{};  // shared corners first, then the others
  std::size_t shared = 0, rest_s = 3;
  std::array<bool, 3> used_t{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto j = std::size_t(std::find(t.place.begin(), t.place.end(), s.place[i]) - t.place.begin());
    if (j == 3) {
      in_s[--rest_s] = i;
    } else {
      in_s[shared] = i, in_t[shared] = j, used_t[j] = true;
      ++shared;
    }
  }
  std::size_t next = shared;
  for (std::size_t j = 0; j < 3; ++j)
    if (!used_t[j]) in_t[next++] = j;
  const auto p = [&](std::size_t k) -> const Point& { return s.point[in_s[k]]; };
  const auto q = [&](std::size_t k) -> const Point& { return t.point[in_t[k]]; };

  if (shared == 3) return true;
  if (shared == 2)  // folded flat onto each other
    return CGAL::coplanar(p(0), p(1), p(2), q(2)) &&
           CGAL::coplanar_orientation(p(0), p(1), p(2), q(2)) == CGAL::POSITIVE;
  if (beside(s, q, shared) || beside(t, p, shared)) return false;  // nearly all pairs end here
  const Triangle triangle_s(p(0), p(1), p(2)), triangle_t(q(0), q(1), q(2));
  if (shared == 1)  // the side opposite to the shared corner
    return CGAL::do_intersect(triangle_s, Segment(q(1), q(2))) ||
           CGAL::do_intersect(triangle_t, Segment(p(1), p(2)));
  return CGAL::do_intersect(triangle_s, triangle_t);
}

}  // namespace

std::vector<std::array<int, 2>> self_intersections(const SimplicialComplex& complex, std::size_t limit) {
  const std::vector<int> place = first_at_same_place(complex.vertices);
  std::vector<Corners> corners(complex.triangles.size());
  std::vector<Box> boxes(complex.triangles.size());
  std::vector<int> with_area;
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto vertex = std::size_t(complex.triangles[t][k]);
      const Vec3& x = complex.vertices[vertex];
      corners[t].place[k] = place[vertex];
      corners[t].point[k] = exact(x);
      boxes[t] = bounding_box(boxes[t], {x, x});
    }
    const auto& [a, b, c] = corners[t].point;
    if (!CGAL::collinear(a, b, c)) with_area.push_back(int(t));
  }

  std::vector<std::array<int, 2>> pairs;
  BoxTree(std::move(boxes), std::move(with_area)).for_each_pair([&](int i, int j) {
    if (pairs.size() < limit && meet(corners[i], corners[j])) pairs.push_back({i, j});
    return pairs.size() < limit;
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace aussois
