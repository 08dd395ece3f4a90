// SPDX-License-Identifier: Apache-2.0
#include "lmd/simplex_distance.hpp"

#include <algorithm>

#include <Eigen/Geometry>

namespace aussois {
namespace {

Vec3 closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double length2 = d.squaredNorm();
  return length2 > 0 ? Vec3(a + std::clamp(d.dot(p - a) / length2, 0.0, 1.0) * d) : a;
}

// Inside the triangle's prism the foot on its plane, otherwise the nearest point of the border.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a);
  const double n2 = n.squaredNorm();
  if (n2 > 0 && n.cross(b - a).dot(p - a) >= 0 && n.cross(c - b).dot(p - b) >= 0 &&
      n.cross(a - c).dot(p - c) >= 0)
    return p - n.dot(p - a) / n2 * n;
  Vec3 best = closest_on_segment(p, a, b);
  for (const Vec3& x : {closest_on_segment(p, b, c), closest_on_segment(p, c, a)})
    if ((x - p).squaredNorm() < (best - p).squaredNorm()) best = x;
  return best;
}

ClosestPoints segments(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 d = a1 - a0, e = b1 - b0, w = a0 - b0;
  const double dd = d.squaredNorm(), ee = e.squaredNorm(), de = d.dot(e), dw = d.dot(w), ew = e.dot(w);
  const double det = dd * ee - de * de;
  double s = det > 1e-14 * dd * ee ? std::clamp((de * ew - ee * dw) / det, 0.0, 1.0) : 0;
  double t = ee > 0 ? (de * s + ew) / ee : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = dd > 0 ? std::clamp((de * t - dw) / dd, 0.0, 1.0) : 0;
  }
  ClosestPoints out{.x_a = a0 + s * d, .x_b = b0 + t * e};
  out.distance = (out.x_a - out.x_b).norm();
  return out;
}

// Does the segment pass through the triangle?
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c, Vec3& at) {
  const Vec3 n = (b - a).cross(c - a);
  const double hp = n.dot(p - a), hq = n.dot(q - a);
  if ((hp > 0) == (hq > 0) || hp == hq) return false;
  at = p + hp / (hp - hq) * (q - p);
  return n.cross(b - a).dot(at - a) >= 0 && n.cross(c - b).dot(at - b) >= 0 &&
         n.cross(a - c).dot(at - c) >= 0;
}

void take(ClosestPoints& best, const ClosestPoints& other) {
  if (other.distance < best.distance) best = other;
}

struct Extent {
  double lo = kInf, hi = -kInf;
};
Extent along(const Vec3& n, std::span<const Vec3> simplex) {
  Extent out;
  for (const Vec3& x : simplex) out.lo = std::min(out.lo, n.dot(x)), out.hi = std::max(out.hi, n.dot(x));
  return out;
}

Vec3 mean(std::span<const Vec3> simplex) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : simplex) sum += x;
  return sum / double(simplex.size());
}

}  // namespace

bool are_apart(std::span<const Vec3> a, std::span<const Vec3> b, double distance) {
  const auto parts = [&](const Vec3& n) {
    const Extent of_a = along(n, a), of_b = along(n, b);
    return std::max(of_b.lo - of_a.hi, of_a.lo - of_b.hi) > distance * n.norm();
  };
  const auto plane_parts = [&](std::span<const Vec3> k) {
    return k.size() == 3 && parts((k[1] - k[0]).cross(k[2] - k[0]));
  };
  return parts(mean(b) - mean(a)) || plane_parts(a) || plane_parts(b);
}

ClosestPoints closest_points(std::span<const Vec3> a, std::span<const Vec3> b) {
  const std::size_t n = a.size(), m = b.size();
  const std::size_t sides_a = n == 3 ? 3 : n - 1, sides_b = m == 3 ? 3 : m - 1;
  ClosestPoints best;
  if (sides_a == 0 && sides_b == 0) return {a[0], b[0], (a[0] - b[0]).norm()};
  for (std::size_t i = 0; i < sides_a; ++i)
    for (std::size_t j = 0; j < sides_b; ++j)
      take(best, segments(a[i], a[(i + 1) % n], b[j], b[(j + 1) % m]));
  const auto point_against = [](const Vec3& p, std::span<const Vec3> k) {
    return k.size() == 3 ? closest_on_triangle(p, k[0], k[1], k[2])
                         : closest_on_segment(p, k[0], k[k.size() - 1]);
  };
  if (m == 3 || n == 1)
    for (const Vec3& p : a) {
      const Vec3 x = point_against(p, b);
      take(best, {p, x, (p - x).norm()});
    }
  if (n == 3 || m == 1)
    for (const Vec3& p : b) {
      const Vec3 x = point_against(p, a);
      take(best, {x, p, (p - x).norm()});
    }
  Vec3 at;
  if (m == 3)
    for (std::size_t i = 0; i < sides_a; ++i)
      if (pierces(a[i], a[(i + 1) % n], b[0], b[1], b[2], at)) return {at, at, 0};
  if (n == 3)
    for (std::size_t j = 0; j < sides_b; ++j)
      if (pierces(b[j], b[(j + 1) % m], a[0], a[1], a[2], at)) return {at, at, 0};
  return best;
}

}  // namespace aussois
