// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include "geometry/box_tree.hpp"
#include "geometry/repair_steps.hpp"

namespace aussois {
namespace {

bool comes_before(const Vec3& x, const Vec3& y) {
  return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end());
}

// For each vertex the one that stands for it (CPX-7). In the order of the coordinates, so that the numbering
// of the vertices has no influence, each free vertex takes the free ones around it.
std::vector<int> leaders(std::span<const Vec3> vertices, double tolerance) {
  const auto at = [&](int i) -> const Vec3& { return vertices[i]; };
  std::vector<int> leader = first_at_same_place(vertices);
  if (tolerance <= 0) return leader;
  std::vector<int> places;
  std::vector<Box> boxes;
  for (int i = 0; i < int(vertices.size()); ++i) {
    boxes.push_back({at(i), at(i)});
    if (leader[i] == i) places.push_back(i);
  }
  const BoxTree tree(std::move(boxes), places);
  std::ranges::sort(places, [&](int i, int j) { return comes_before(at(i), at(j)); });
  std::vector<int> taken_by(vertices.size(), -1);
  for (const int i : places) {
    if (taken_by[i] >= 0) continue;
    const Box around{at(i) - Vec3::Constant(tolerance), at(i) + Vec3::Constant(tolerance)};
    tree.for_each([&](const Box& box) { return overlap(box, around); },
                  [&](int j) {
                    int& taken = taken_by[j];
                    if (taken < 0 && (at(j) - at(i)).norm() <= tolerance) taken = i;
                  });
  }
  for (int& place : leader) place = taken_by[place];
  return leader;
}

template <std::size_t N>
Vec3 centre(std::span<const Vec3> vertices, const std::array<int, N>& corners) {
  Vec3 sum = Vec3::Zero();
  for (const int corner : corners) sum += vertices[corner];
  return sum / double(N);
}

// The simplices in new numbers, without those that name a vertex twice.
template <std::size_t N>
std::vector<std::array<int, N>> renumbered(std::span<const std::array<int, N>> simplices,
                                           const std::vector<int>& vertex, const std::vector<Vec3>& place,
                                           RepairStep& collapsed) {
  std::vector<std::array<int, N>> kept;
  for (std::array<int, N> simplex : simplices) {
    for (int& corner : simplex) corner = vertex[corner];
    bool repeats = false;
    for (std::size_t k = 0; k < N; ++k) repeats |= simplex[k] == simplex[(k + 1) % N];
    if (repeats)
      collapsed.add(centre(place, simplex), 0);
    else
      kept.push_back(simplex);
  }
  return kept;
}

struct Corners {
  std::array<int, 3> sorted{};
  int triangle = 0;
  auto operator<=>(const Corners&) const = default;  // NOLINT(modernize-use-nullptr): false alarm
};

}  // namespace

std::vector<std::array<int, 2>> wires_of(const SimplicialComplex& complex) {
  std::vector<std::array<int, 2>> wires;
  for (std::size_t e = 0; e < complex.edges.size(); ++e)
    if (complex.edge_triangles[int(e)].empty()) wires.push_back(complex.edges[e]);
  return wires;
}

WeldedComplex weld_vertices(const SimplicialComplex& complex, double tolerance) {
  WeldedComplex out;
  const std::vector<int> leader = leaders(complex.vertices, tolerance);
  std::vector<Vec3> kept;
  std::vector<int> number(leader.size(), -1);  // of a leader
  for (std::size_t i = 0; i < leader.size(); ++i) {
    const auto stands = std::size_t(leader[i]);
    const Vec3& x = complex.vertices[stands];
    if (number[stands] < 0) number[stands] = int(kept.size()), kept.push_back(x);
    if (stands != i) out.vertices.add(complex.vertices[i], (complex.vertices[i] - x).norm());
    out.vertex.push_back(number[stands]);
  }
  if (out.vertices.count == 0) {
    out.complex = complex;
    return out;
  }
  auto triangles = renumbered<3>(complex.triangles, out.vertex, kept, out.collapsed_triangles);
  const auto wires = renumbered<2>(wires_of(complex), out.vertex, kept, out.collapsed_wires);
  out.complex = make_complex(std::move(kept), std::move(triangles), wires);
  return out;
}

DistinctComplex drop_duplicate_triangles(const SimplicialComplex& complex) {
  std::vector<Corners> all;
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    all.push_back({complex.triangles[t], int(t)});
    std::ranges::sort(all.back().sorted);
  }
  std::ranges::sort(all);
  std::vector<bool> repeated(all.size());
  for (std::size_t i = 1; i < all.size(); ++i) repeated[all[i].triangle] = all[i].sorted == all[i - 1].sorted;

  DistinctComplex out;
  std::vector<std::array<int, 3>> kept;
  for (std::size_t t = 0; t < complex.triangles.size(); ++t)
    if (repeated[t])
      out.dropped.add(centre(complex.vertices, complex.triangles[t]), 0);
    else
      kept.push_back(complex.triangles[t]);
  out.complex =
      out.dropped.count == 0 ? complex : make_complex(complex.vertices, std::move(kept), wires_of(complex));
  return out;
}

}  // namespace aussois
