// SPDX-License-Identifier: Apache-2.0
#include "nsgs/cone.hpp"

#include <algorithm>

namespace aussois {

Vec3 project_cone(const Vec3& r, double mu) {
  const double t = r.tail<2>().norm();
  if (t <= mu * r[0]) return r;
  if (mu * t <= -r[0]) return Vec3::Zero();  // in the polar cone
  const double normal = (r[0] + mu * t) / (1 + mu * mu);
  Vec3 p;
  p << normal, r.tail<2>() * (mu * normal / t);  // t > 0: else one of the tests above holds
  return p;
}

Vec3 project_dual_cone(const Vec3& u, double mu) {
  return u + project_cone(-u, mu);
}  // Moreau's decomposition

Vec2 project_disk(const Vec2& r, double radius) {
  const double length = r.norm();
  return length <= radius ? r : Vec2(r * (radius / length));
}

Vec3 de_saxce(const Vec3& u, double mu) {
  return {u[0] + mu * u.tail<2>().norm(), u[1], u[2]};
}

Vec3 project_coulomb(const Vec3& r, double mu) {
  if (r[0] <= 0) return Vec3::Zero();
  const Vec2 t = project_disk(r.tail<2>(), mu * r[0]);
  return {r[0], t[0], t[1]};
}

Mat3 project_coulomb_derivative(const Vec3& r, double mu) {
  if (r[0] <= 0) return Mat3::Zero();
  const double t = r.tail<2>().norm();
  if (t <= mu * r[0]) return Mat3::Identity();
  const Vec2 along = r.tail<2>() / t;
  Mat3 D = Mat3::Zero();
  D(0, 0) = 1;
  D.block<2, 1>(1, 0) = mu * along;
  D.bottomRightCorner<2, 2>() = (mu * r[0] / t) * (Mat2::Identity() - along * along.transpose());
  return D;
}

}  // namespace aussois
