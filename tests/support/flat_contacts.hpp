// SPDX-License-Identifier: Apache-2.0
// Contacts in a plane between bodies 0 and 1, made by hand.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "lmd/contact_point.hpp"

namespace aussois {

/// Vertex `index of the contact` on a face; the point is the middle of the two proximal points.
inline void add(ContactSet& set, const Vec3& point, const Vec3& normal, double gap = 0) {
  ContactPoint c;
  c.a = {.body = 0, .dim = 0, .simplex = int(set.points.size()), .region = int(set.points.size())};
  c.b = {.body = 1, .dim = 2, .simplex = 0, .region = 0};
  c.x_a = point + 0.5 * gap * normal;
  c.x_b = point - 0.5 * gap * normal;
  c.normal = normal;
  c.gap = gap;
  set.points.push_back(c);
}

inline ContactSet flat(const std::vector<Vec2>& points) {
  ContactSet set;
  for (const Vec2& p : points) add(set, {p.x(), p.y(), 0}, Vec3::UnitZ());
  return set;
}

/// Points i of n x m on a rectangle a x b; the corners are 0, n - 1, n (m - 1), n m - 1.
inline std::vector<Vec2> grid(int n, int m, double a, double b) {
  std::vector<Vec2> points;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) points.push_back({a * i / (n - 1), b * j / (m - 1)});
  return points;
}

inline std::vector<Vec2> rotated(std::vector<Vec2> points, double angle) {
  for (Vec2& p : points) p = Eigen::Rotation2D<double>(angle) * p;
  return points;
}

inline ContactSet moved(ContactSet set, const Quat& R, const Vec3& p) {
  for (ContactPoint& c : set.points) {
    c.x_a = R * c.x_a + p;
    c.x_b = R * c.x_b + p;
    c.normal = R * c.normal;
  }
  return set;
}

}  // namespace aussois
