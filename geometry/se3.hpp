// SPDX-License-Identifier: Apache-2.0
// Rigid displacements g = (R, p), equations (SE3-1) to (SE3-7): g_wb maps body to world coordinates.
#pragma once

#include "geometry/so3.hpp"

namespace aussois {

struct SE3 {
  Quat R = Quat::Identity();  // unit quaternion
  Vec3 p = Vec3::Zero();      // [m]
};

SE3 operator*(const SE3& a, const SE3& b);  // first b, then a; the quaternion is renormalised
inline Vec3 operator*(const SE3& g, const Vec3& point) {
  return g.R * point + g.p;
}
SE3 inverse(const SE3& g);
SE3 translation(double x, double y, double z);
SE3 rotation(const Vec3& axis, double angle);  // [rad]; axis finite, not zero, need not be unit

/// Twists are (v, omega). exp_se3 is the screw motion (SE3-3); log_se3 its inverse, |omega| <= pi (SE3-4).
SE3 exp_se3(const Vec6& twist);
Vec6 log_se3(const SE3& g);
/// Adjoint: (g exp(xi) g^-1) = exp(adjoint(g) xi) (SE3-5).
Mat6 adjoint(const SE3& g);
/// Left and right differentials of exp_se3 (SE3-6), by blocks (SE3-7); continuous through omega = 0.
Mat6 dexp_left_se3(const Vec6& twist);
Mat6 dexp_right_se3(const Vec6& twist);

/// Returns g with R normalised; throws std::invalid_argument naming `field` unless p is finite and
/// | |R| - 1 | <= 1e-6.
SE3 checked_pose(const SE3& g, const char* field);

}  // namespace aussois
