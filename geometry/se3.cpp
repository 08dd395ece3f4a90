// SPDX-License-Identifier: Apache-2.0
#include "geometry/se3.hpp"

#include <cmath>
#include <string>

#include "geometry/check.hpp"

namespace aussois {
namespace {

// Upper right block of the left differential (SE3-7), after [Barfoot2017, ch. 7]: the derivative of
// dexp_left along the translation, written with Stumpff functions so that it is smooth at zero.
Mat3 coupling_block(const Vec3& v, const Vec3& omega) {
  const double x = omega.squaredNorm();
  const double c3 = stumpff(3, x), c4 = stumpff(4, x), c5 = stumpff(5, x);
  const Mat3 V = skew(v), W = skew(omega);
  const Mat3 WV = W * V, VW = V * W, WVW = WV * W;
  return V / 2 + c3 * (WV + VW + WVW) + c4 * (W * WV + VW * W - 3 * WVW) +
         (c4 - 3 * c5) / 2 * (WVW * W + W * WVW);
}

}  // namespace

SE3 operator*(const SE3& a, const SE3& b) {
  return {(a.R * b.R).normalized(), a * b.p};
}

SE3 inverse(const SE3& g) {
  const Quat R = g.R.conjugate();
  return {R, -(R * g.p)};
}

SE3 translation(double x, double y, double z) {
  return {Quat::Identity(), {x, y, z}};
}

SE3 rotation(const Vec3& axis, double angle) {
  const double length = axis.stableNorm();
  require_field(length > 0 && std::isfinite(length), "|axis|", length, "be finite and > 0");
  require_field(std::isfinite(angle), "angle", angle, "be finite");
  return {exp_so3(angle / length * axis), Vec3::Zero()};
}

SE3 exp_se3(const Vec6& twist) {
  const Vec3 omega = twist.tail<3>();
  return {exp_so3(omega), dexp_left(omega) * twist.head<3>()};
}

Vec6 log_se3(const SE3& g) {
  const Vec3 omega = log_so3(g.R);
  Vec6 twist;
  twist << dexp_left_inverse(omega) * g.p, omega;
  return twist;
}

Mat6 adjoint(const SE3& g) {
  const Mat3 R = g.R.toRotationMatrix();
  Mat6 A;
  A << R, skew(g.p) * R, Mat3::Zero(), R;
  return A;
}

Mat6 dexp_left_se3(const Vec6& twist) {
  const Vec3 v = twist.head<3>(), omega = twist.tail<3>();
  const Mat3 J = dexp_left(omega);
  Mat6 D;
  D << J, coupling_block(v, omega), Mat3::Zero(), J;
  return D;
}

Mat6 dexp_right_se3(const Vec6& twist) {
  return dexp_left_se3(-twist);
}

SE3 checked_pose(const SE3& g, const char* field) {
  static const Eigen::IOFormat one_line(Eigen::StreamPrecision, Eigen::DontAlignCols);
  const std::string name = field;
  require_field(g.p.allFinite(), (name + ".p").c_str(), g.p.transpose().format(one_line), "be finite");
  const double norm = g.R.norm();
  require_field(std::abs(norm - 1) <= 1e-6, ("|" + name + ".R|").c_str(), norm, "be 1 within 1e-6");
  return {g.R.normalized(), g.p};
}

}  // namespace aussois
