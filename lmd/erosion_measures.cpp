// SPDX-License-Identifier: Apache-2.0
#include "lmd/erosion_measures.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "lmd/vertex_fans.hpp"

namespace aussois {
namespace {

/// f(triangle, x) at the points of a regular grid on each triangle: corners, middles of sides, centre and as
/// many more as its share of the area asks for. Returns their number.
template <class F>
int for_samples(const SimplicialComplex& k, int wanted, const F& f) {
  double total = 0;
  std::vector<double> area(k.triangles.size());
  for (std::size_t t = 0; t < area.size(); ++t) {
    const auto& [a, b, c] = k.triangles[t];
    const Vec3& o = k.vertices[a];
    area[t] = 0.5 * (k.vertices[b] - o).cross(k.vertices[c] - o).norm();
    total += area[t];
  }
  int count = 0;
  for (std::size_t t = 0; t < area.size(); ++t) {
    const auto& [a, b, c] = k.triangles[t];
    const Vec3 &o = k.vertices[a], &p = k.vertices[b], &q = k.vertices[c];
    const double share = total > 0 ? area[t] / total : 0;
    const int n = std::max(2, int(std::sqrt(2 * double(wanted) * share)));
    f(int(t), Vec3((o + p + q) / 3));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) f(int(t), Vec3(o + double(i) / n * (p - o) + double(j) / n * (q - o)));
    count += 1 + (n + 1) * (n + 2) / 2;
  }
  return count;
}

/// +1 convex, -1 concave, 0 flat: where the triangle's neighbour over the edge lies.
int bend(const SimplicialComplex& k, const SurfaceTree& tree, int edge) {
  const auto both = k.edge_triangles[edge];
  const Vec3 d = k.vertices[k.edges[edge][1]] - k.vertices[k.edges[edge][0]];
  const Vec3 &n = tree.normal(both[0]), &m = tree.normal(both[1]);
  const auto corner = corner_at(k, both[0], k.edges[edge][0]);
  const bool upwards = k.triangle_edges[both[0]][corner] == edge;
  const double sine = n.cross(m).dot(d.stableNormalized()) * (upwards ? 1 : -1);
  return sine > 1e-6 ? 1 : sine < -1e-6 ? -1 : 0;
}

struct ConvexParts {
  std::vector<char> edges{}, vertices{};
};

ConvexParts convex_parts(const SimplicialComplex& k, const SurfaceTree& tree) {
  ConvexParts out{std::vector<char>(k.edges.size(), 0), std::vector<char>(k.vertices.size(), 0)};
  for (std::size_t e = 0; e < k.edges.size(); ++e)
    if (k.edge_triangles[int(e)].size() == 2 && bend(k, tree, int(e)) > 0) {
      out.edges[e] = 1;
      for (int v : k.edges[e]) out.vertices[v] = 1;
    }
  return out;
}

}  // namespace

Thickness smallest_thickness(const SimplicialComplex& k, const SurfaceTree& tree, int samples) {
  Thickness best;
  constexpr double kCos30 = 0.8660254037844387;
  for_samples(k, samples, [&](int t, const Vec3& x) {
    const Vec3& n = tree.normal(t);
    if (n.isZero()) return;
    const Vec3 inner = 0.98 * x + 0.02 * centre_of(k, t);  // off the sides, where rays slip through
    const std::optional<double> length = tree.first_exit(inner, -n, 0, kCos30);
    if (length && *length < best.value) best = {*length, inner, t};
  });
  return best;
}

ErosionMeasures measure_erosion_where(const SimplicialComplex& solid, const SimplicialComplex& eroded,
                                      const SurfaceTree& inner, double depth, int samples,
                                      const IsRestored& restored) {
  const SurfaceTree outer(solid);
  ErosionMeasures out;
  out.rounding = -kInf;
  out.samples += for_samples(solid, samples, [&](int t, const Vec3& x) {
    const SurfacePoint foot = inner.nearest(x);
    const double off = foot.distance - depth;
    out.rounding = std::max(out.rounding, off);
    const bool face = restored(t, x, foot);
    out.face_samples += face;
    out.face_error = std::max(out.face_error, face ? std::abs(off) : -off);
  });
  out.samples += for_samples(eroded, samples, [&](int, const Vec3& x) {
    out.shallow = std::max(out.shallow, depth + outer.signed_distance(x));
  });
  const ConvexParts convex = convex_parts(eroded, inner);
  for (std::size_t e = 0; e < eroded.edges.size(); ++e)  // the middle of the round of each convex edge
    if (convex.edges[e]) {
      const auto both = eroded.edge_triangles[int(e)];
      const auto& [a, b] = eroded.edges[e];
      const Vec3 middle = 0.5 * (eroded.vertices[a] + eroded.vertices[b]);
      const Vec3 way = (inner.normal(both[0]) + inner.normal(both[1])).stableNormalized();
      out.hausdorff = std::max(out.hausdorff, outer.nearest(middle + depth * way).distance);
    }
  out.hausdorff = std::max(out.hausdorff, out.rounding);
  out.thickness = smallest_thickness(eroded, inner, 1).value;
  return out;
}

ErosionMeasures measure_erosion(const SimplicialComplex& solid, const SimplicialComplex& eroded, double depth,
                                int samples) {
  const SurfaceTree inner(eroded);
  const ConvexParts convex = convex_parts(eroded, inner);
  return measure_erosion_where(solid, eroded, inner, depth, samples,
                               [&](int, const Vec3&, const SurfacePoint& foot) {
                                 return !(foot.dim == 1 && convex.edges[foot.simplex]) &&
                                        !(foot.dim == 0 && convex.vertices[foot.simplex]);
                               });
}

}  // namespace aussois
