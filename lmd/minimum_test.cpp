// SPDX-License-Identifier: Apache-2.0
#include "lmd/minimum_test.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/min_norm_point.hpp"

namespace aussois {
namespace {

// Chains that bend by no more go through a vertex that has no cone of its own (normal_cone.cpp) [rad].
constexpr double kStraight = 2 * kHullContainsOrigin;

// Angle between u and the cone; nothing if it is larger than alpha.
std::optional<double> angle_within(const ConeView& cone, const Vec3& u, double alpha, double sin_alpha) {
  if (!may_contain(cone, u, sin_alpha + 1e-12)) return std::nullopt;
  const double angle = angle_to(cone, u);
  return angle <= alpha ? std::optional(angle) : std::nullopt;
}

// Is a displacement d of length `distance` in N? The test g . d <= tolerance is the foot test of the
// neighbouring simplex with the opposite sign, so the tests partition space up to the tolerance.
bool in_polar(std::span<const Vec3> rays, const Vec3& d, double tolerance) {
  return std::ranges::all_of(rays, [&](const Vec3& g) { return g.dot(d) <= tolerance; });
}

std::optional<Vec3> foot_on_face(const Leaf& face, const Vec3& p, double tolerance) {
  const double h = face.direction.dot(p) - face.extent;
  if (h <= 0) return std::nullopt;  // behind this side
  const Vec3 foot = p - h * face.direction;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = face.x[(k + 1) % 3] - face.x[k];
    const Vec3 inward = face.turn * face.direction.cross(side);
    const double inside = inward.dot(p - face.x[k]);
    if (inside >= 0) continue;
    if (inside < -tolerance * inward.norm()) return std::nullopt;
    // Beyond the tip of a needle its long sides are near, the triangle is not.
    const double along = side.dot(foot - face.x[k]), length = side.norm();
    if (along < -tolerance * length || along > (length + tolerance) * length) return std::nullopt;
  }
  return foot;
}

std::optional<Vec3> foot_on_chain(const Leaf& chain, const Vec3& p, double tolerance) {
  const double s = chain.direction.dot(p - chain.x[0]);
  const double beyond = std::max(-s, s - chain.extent);
  if (beyond > tolerance && chain.misfit == 0) return std::nullopt;
  const Vec3 foot = chain.x[0] + s * chain.direction, off = p - foot;
  if (!in_polar(cone_of(chain).rays, off, tolerance)) return std::nullopt;
  if (beyond <= tolerance) return foot;
  if (beyond > tolerance + chain.misfit * off.norm()) return std::nullopt;
  return s < 0 ? chain.x[0] : chain.x[1];
}

// V | B: x2 is an exact local minimiser of |p - .| on the simplex `on`, and the direction is in N_V enlarged
// by alpha. All in the frame of `on`; `to_v` turns directions into the vertex' frame.
std::optional<LocalMinimum> vertex_against(const Leaf& vertex, const Vec3& p, const Mat3& to_v,
                                           const Leaf& on, const MinimumCriteria& c) {
  std::optional<Vec3> foot;
  if (on.dim == 2)
    foot = foot_on_face(on, p, c.tolerance);
  else if (on.dim == 1)
    foot = foot_on_chain(on, p, c.tolerance);
  else if (in_polar(on.rays, p - on.x[0], c.tolerance))
    foot = on.x[0];
  if (!foot) return std::nullopt;
  const Vec3 d = *foot - p;
  const double distance = d.norm();
  if (distance > c.max_distance || distance <= 0) return std::nullopt;
  const Vec3 u = on.dim == 2 ? Vec3(-on.direction) : Vec3(d / distance);
  const std::optional<double> off = angle_within(cone_of(vertex), to_v * u, c.alpha, c.sin_alpha);
  if (!off) return std::nullopt;
  return LocalMinimum{
      .x_a = p, .x_b = *foot, .direction = u, .distance = distance, .angle_margin = c.alpha - *off};
}

// Angle between the arcs N_E and -N_E' where u, which is u_e in the frame of e, does not lie in both
// (smallest relative rotation that makes a common normal); R turns from that frame to the other.
double arc_distance(const ConeView& e, const ConeView& f, const Mat3& R, const Vec3& u, const Vec3& u_e) {
  if (angle_to(e, -u_e) <= 0 && angle_to(f, u) <= 0) return 0;  // the great circles meet at both +-u
  double rho = kInf;
  const ArcEnds ends_e = arc_ends(e), ends_f = arc_ends(f);
  for (const Vec3& end : ends_e.span()) rho = std::min(rho, angle_to(f, -(R * end)));
  for (const Vec3& end : ends_f.span()) rho = std::min(rho, angle_to(e, R.transpose() * (-end)));
  return rho;
}

std::optional<LocalMinimum> edge_against_edge(const Leaf& a, const Leaf& b, const Mat3& R, const Vec3& t,
                                              const MinimumCriteria& c) {
  const Vec3 p = R * a.x[0] + t, e = R * a.direction;
  const Vec3 across = e.cross(b.direction);
  const double sin2 = across.squaredNorm();
  if (sin2 <= 1e-16)
    return std::nullopt;  // parallel: the ends of the overlap are V-E pairs of the same distance
  // Along the edges by their cross products: off by rounding / sin psi. Dot products lose 1 / sin^2 psi.
  const Vec3 w = p - b.x[0];
  double s = b.direction.cross(w).dot(across) / sin2, r = e.cross(w).dot(across) / sin2;
  const double beyond = std::max({-s, s - a.extent, -r, r - b.extent});
  double most = c.max_distance;
  if (beyond > c.tolerance) {  // (LMD-16); most end at the first line
    if ((beyond - c.tolerance) * sin2 > kStraight * c.max_distance) return std::nullopt;
    const double apart = std::abs(w.dot(across)) / std::sqrt(sin2);
    if (beyond > c.tolerance + kStraight * apart / sin2) return std::nullopt;
    most = std::min(most, apart + c.tolerance);
    if (r < 0 || r > b.extent) {  // one foot for all chains that end there
      r = r < 0 ? 0 : b.extent;
      s = std::clamp(e.dot(r * b.direction - w), 0.0, a.extent);
    } else {
      s = s < 0 ? 0 : a.extent;
      r = std::clamp(b.direction.dot(w + s * e), 0.0, b.extent);
    }
  }
  const Vec3 x_a = p + s * e, x_b = b.x[0] + r * b.direction;
  const double distance = (x_b - x_a).norm();
  if (distance > most || distance <= 0) return std::nullopt;
  Vec3 u = across.normalized();  // the common perpendicular, better conditioned than x_b - x_a
  if (u.dot(x_b - x_a) < 0) u = -u;
  const ConeView cone_a = cone_of(a), cone_b = cone_of(b);
  const Vec3 u_a = R.transpose() * u;
  const std::optional<double> off_a = angle_within(cone_a, u_a, c.alpha_ee, c.sin_alpha_ee);
  if (!off_a) return std::nullopt;
  const std::optional<double> off_b = angle_within(cone_b, -u, c.alpha_ee, c.sin_alpha_ee);
  if (!off_b) return std::nullopt;
  const bool inside = *off_a <= 0 && *off_b <= 0;
  const double rho = inside ? 0 : arc_distance(cone_a, cone_b, R, u, u_a);
  if (rho > c.alpha) return std::nullopt;
  return LocalMinimum{.x_a = x_a,
                      .x_b = x_b,
                      .direction = u,
                      .distance = distance,
                      .angle_margin = std::min({c.alpha_ee - *off_a, c.alpha_ee - *off_b, c.alpha - rho})};
}

LocalMinimum swapped(const LocalMinimum& m, const Mat3& R,
                     const Vec3& t) {  // found in A's frame, wanted in B's
  return {.x_a = R * m.x_b + t,
          .x_b = R * m.x_a + t,
          .direction = -(R * m.direction),
          .distance = m.distance,
          .angle_margin = m.angle_margin};
}

}  // namespace

std::optional<LocalMinimum> test_minimum(const Leaf& a, const Leaf& b, const Mat3& R, const Vec3& t,
                                         const MinimumCriteria& criteria) {
  if (a.dim == 1 && b.dim == 1) return edge_against_edge(a, b, R, t, criteria);
  std::optional<LocalMinimum> found;
  if (a.dim == 0) found = vertex_against(a, R * a.x[0] + t, R.transpose(), b, criteria);
  if (b.dim == 0 && !found) {  // A | V', and of two vertices the other one's exact test
    const std::optional<LocalMinimum> m = vertex_against(b, R.transpose() * (b.x[0] - t), R, a, criteria);
    if (m) found = swapped(*m, R, t);
  }
  return found;
}

}  // namespace aussois
