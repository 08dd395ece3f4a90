// SPDX-License-Identifier: Apache-2.0
#include "lmd/normal_cone.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "geometry/min_norm_point.hpp"

namespace aussois {
namespace {

constexpr double kMerge = 1e-7;  // directions closer than this are one [rad]
// Rays that leave the plane of two others by less are in it. Facets that CAD programs cut into triangles bend
// by 1e-6 and less at coordinates that were rounded: a coarser bound takes the concave crease for the convex
// one.
constexpr double kFlat = 1e-10;  // [rad]
constexpr double kLineality = kHullContainsOrigin;

void merge_close(std::vector<Vec3>& g) {
  std::vector<Vec3> kept;
  for (const Vec3& a : g)
    if (std::ranges::none_of(kept, [&](const Vec3& b) { return (a - b).norm() < kMerge; })) kept.push_back(a);
  g = std::move(kept);
}

// Two extreme rays of a pointed cone in a plane: the pair with the largest angle.
std::vector<Vec3> extremes_in_plane(const std::vector<Vec3>& g) {
  std::pair<std::size_t, std::size_t> widest{0, 0};
  double least = 2;
  for (std::size_t i = 0; i < g.size(); ++i)
    for (std::size_t j = i + 1; j < g.size(); ++j)
      if (g[i].dot(g[j]) < least) least = g[i].dot(g[j]), widest = {i, j};
  return {g[widest.first], g[widest.second]};
}

// Gift wrapping on the unit sphere: the extreme rays of a pointed 3D cone in cyclic order about `inside`.
std::vector<Vec3> wrap(const std::vector<Vec3>& g, const Vec3& inside) {
  std::size_t start = 0;
  for (std::size_t i = 1; i < g.size(); ++i)
    if (g[i].dot(inside) < g[start].dot(inside)) start = i;
  std::vector<Vec3> rays{g[start]};
  std::size_t at = start;
  for (std::size_t turn = 0; turn < g.size(); ++turn) {
    std::size_t next = at;
    for (std::size_t j = 0; j < g.size(); ++j) {
      if (j == at) continue;
      if (next == at) {
        next = j;
        continue;
      }
      const Vec3 across = g[at].cross(g[next]);
      const double side = across.dot(g[j]);  // negative: j lies outside the arc at -> next
      const bool tie = std::abs(side) <= kFlat * across.norm();
      const bool farther = g[at].dot(g[j]) < g[at].dot(g[next]);
      if ((!tie && side < 0) || (tie && farther)) next = j;
    }
    if (next == start) break;
    rays.push_back(g[next]);
    at = next;
  }
  return rays;
}

// Post-condition of the wrapping: no direction lies outside a facet of the cone that the rays span.
bool holds(const std::vector<Vec3>& rays, const std::vector<Vec3>& directions) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& g : rays) middle += g;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    Vec3 n = rays[k].cross(rays[(k + 1) % rays.size()]).normalized();
    if (n.dot(middle) > 0) n = -n;
    if (std::ranges::any_of(directions, [&](const Vec3& g) { return g.dot(n) > 10 * kMerge; })) return false;
  }
  return rays.size() >= 3;
}

// A cap around N: exact smallest is not needed, every direction of N must lie inside.
void bound_polar(NormalCone& cone, const Vec3& inside) {
  const auto& rays = cone.rays;
  if (cone.lineality == 3) {
    cone.half_angle = 0;
    return;
  }
  if (cone.lineality == 2) {  // N: a ray, or both ends of a line
    cone.axis = rays.empty() ? Vec3(cone.lin[0].cross(cone.lin[1]).normalized()) : Vec3(-rays[0]);
    cone.half_angle = rays.empty() ? kPi : 0;
    return;
  }
  if (cone.lineality == 1 && rays.empty()) {  // N: a plane
    cone.axis = cone.lin[0];
    cone.half_angle = kPi / 2;
    return;
  }
  if (cone.lineality == 0 && rays.empty()) {  // N: everything
    cone.half_angle = kPi;
    return;
  }
  if (rays.size() == 1) {  // N: a half-plane or a half-space
    cone.axis = -rays[0];
    cone.half_angle = kPi / 2;
    return;
  }
  if (!cone.cyclic) {  // no order, no corners: q in C bounds all of N by the half-space n . q <= 0
    cone.axis = -inside;
    cone.half_angle = kPi / 2;
    return;
  }
  std::vector<Vec3> corners;  // unit vectors whose spherical hull is N
  if (cone.lineality == 1) {
    const ArcEnds arc = arc_ends(cone);
    corners.assign(arc.span().begin(), arc.span().end());
  } else if (rays.size() == 2) {  // planar sector: N contains the line across the sector's plane
    cone.axis = -(rays[0] + rays[1]).normalized();
    cone.half_angle = kPi / 2;
    return;
  } else {
    Vec3 middle = Vec3::Zero();  // strictly inside C; the minimal-norm point may lie on its border
    for (const Vec3& g : rays) middle += g;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      Vec3 n = rays[k].cross(rays[(k + 1) % rays.size()]).normalized();
      if (n.dot(middle) > 0) n = -n;
      corners.push_back(n);
    }
  }
  Vec3 axis = Vec3::Zero();
  for (const Vec3& n : corners) axis += n;
  if (axis.norm() < 1e-3) axis = -inside;
  cone.axis = axis.normalized();
  for (const Vec3& n : corners)
    cone.half_angle = std::max(cone.half_angle, std::atan2(n.cross(cone.axis).norm(), n.dot(cone.axis)));
  cone.half_angle += 1e-9;          // rounding of the corners
  if (cone.half_angle > kPi / 2) {  // such a cap is not convex
    cone.axis = -inside;
    cone.half_angle = kPi / 2;
  }
}

}  // namespace

NormalCone make_normal_cone(const std::vector<Vec3>& directions) {
  std::vector<Vec3> rest;
  for (const Vec3& d : directions)
    if (d.norm() > 0) rest.push_back(d.normalized());
  merge_close(rest);

  NormalCone cone;
  cone.lineality = 0;
  Vec3 inside = Vec3::UnitZ();
  for (int round = 0; round < 3 && !rest.empty() && cone.lineality < 3; ++round) {
    const MinNorm nearest = min_norm_point(rest);
    if (nearest.point.norm() > kLineality) {
      inside = nearest.point.normalized();
      if (cone.lineality == 0) cone.depth = nearest.point.norm();
      break;
    }
    for (int i : nearest.support) {  // these span a part of Lin
      Vec3 d = rest[i];
      for (int k = 0; k < cone.lineality; ++k) d -= cone.lin[k].dot(d) * cone.lin[k];
      if (d.norm() > 1e-6 && cone.lineality < 3) cone.lin[cone.lineality++] = d.normalized();
    }
    std::vector<Vec3> projected;
    for (Vec3 d : rest) {
      for (int k = 0; k < cone.lineality; ++k) d -= cone.lin[k].dot(d) * cone.lin[k];
      if (d.norm() > 10 * kMerge) projected.push_back(d.normalized());
    }
    rest = std::move(projected);
    merge_close(rest);
  }
  if (cone.lineality == 3) rest.clear();
  if (cone.lineality == 2 && rest.size() > 1) {  // rays on both sides of a plane would be lineality 3
    const bool one_side = std::ranges::all_of(rest, [&](const Vec3& d) { return d.dot(rest[0]) > 0; });
    if (!one_side)
      cone = NormalCone{}, rest.clear();
    else
      rest.resize(1);
  }
  if (rest.size() >= 2) {
    Vec3 normal = Vec3::Zero();  // of the plane of the rays, if they lie in one
    for (const Vec3& d : rest)
      if (rest[0].cross(d).norm() > normal.norm()) normal = rest[0].cross(d);
    normal.normalize();
    const bool planar =
        std::ranges::all_of(rest, [&](const Vec3& d) { return std::abs(d.dot(normal)) <= kMerge; });
    cone.rays = planar ? extremes_in_plane(rest) : wrap(rest, inside);
    if (!planar && !holds(cone.rays, rest)) {
      cone.rays = rest;
      cone.cyclic = false;
    }
  } else {
    cone.rays = rest;
  }
  bound_polar(cone, inside);
  return cone;
}

NormalCone edge_cone(const Vec3& e, std::span<const Vec3> conormals) {
  const bool opposite = conormals.size() == 2 && (conormals[0] + conormals[1]).norm() <= 2 * kLineality;
  if (conormals.size() > 2 || opposite) {
    std::vector<Vec3> generators{e, -e};
    generators.insert(generators.end(), conormals.begin(), conormals.end());
    return make_normal_cone(generators);
  }
  NormalCone cone;
  cone.lineality = 1;
  cone.lin[0] = e;
  cone.rays.assign(conormals.begin(), conormals.end());
  merge_close(cone.rays);
  Vec3 inside = Vec3::Zero();
  for (const Vec3& g : cone.rays) inside += g;
  bound_polar(cone, inside.normalized());
  return cone;
}

bool may_contain(const ConeView& cone, const Vec3& u, double sin_alpha) {
  if (cone.lin.size() == 3) return false;
  double along = 0;
  for (const Vec3& e : cone.lin) along += e.dot(u) * e.dot(u);
  if (along > sin_alpha * sin_alpha) return false;
  for (const Vec3& g : cone.rays)
    if (g.dot(u) > sin_alpha) return false;
  return true;
}

double angle_to(const ConeView& cone, const Vec3& u) {
  if (cone.lin.size() == 3) return kInf;
  Vec3 v = u;
  for (const Vec3& e : cone.lin) v -= e.dot(u) * e;
  const auto& g = cone.rays;
  const std::size_t m = g.size();
  const auto feasible = [&](const Vec3& p, std::size_t a, std::size_t b) {
    for (std::size_t k = 0; k < m; ++k)
      if (k != a && k != b && g[k].dot(p) > 2 * kFlat) return false;
    return true;
  };
  Vec3 projection = Vec3::Zero();
  const auto take = [&](const Vec3& p) {
    if (p.squaredNorm() > projection.squaredNorm()) projection = p;
  };
  if (feasible(v, m, m)) {
    projection = v;
  } else {
    for (std::size_t k = 0; k < m; ++k) {  // on the facet of N across g_k
      const double excess = g[k].dot(v);
      if (excess <= 0) continue;
      const Vec3 p = v - excess * g[k];
      if (feasible(p, k, k)) take(p);
    }
    if (cone.lin.empty() && m >= 2)
      for (std::size_t k = 0; k < m; ++k)  // on the ray of N between two facets
        for (std::size_t j = cone.cyclic ? k + 1 : 0; j < (cone.cyclic ? k + 2 : m); ++j) {
          const std::size_t next = j % m;
          const Vec3 cross = g[k].cross(g[next]);
          if (cross.norm() < kMerge) continue;
          const Vec3 n = cross.normalized(), p = n.dot(v) * n;
          if (feasible(p, k, next)) take(p);
        }
  }
  if (projection.squaredNorm() == 0) return kPi / 2;
  const double off = (u - projection).norm();
  return off <= 1e-15 ? 0 : std::min(kPi / 2, std::atan2(off, projection.norm()));
}

ArcEnds arc_ends(const ConeView& cone) {
  AUSSOIS_ASSERT(cone.lin.size() == 1);
  const Vec3& e = cone.lin[0];
  if (cone.rays.empty()) return {};
  if (cone.rays.size() == 1) return {{e.cross(cone.rays[0]), -e.cross(cone.rays[0])}, 2};
  ArcEnds out{.count = 2};
  for (std::size_t k = 0; k < 2; ++k) {
    const Vec3 n = e.cross(cone.rays[k]).normalized();
    out.ends[k] = n.dot(cone.rays[1 - k]) > 0 ? Vec3(-n) : n;
  }
  return out;
}

}  // namespace aussois
