// SPDX-License-Identifier: Apache-2.0
// Rotations: exponential, logarithm and their differentials on SO(3), equations (SO3-1) to (SO3-7).
// No formula divides by an angle: all go through the Stumpff functions, which are smooth at zero.
#pragma once

#include <Eigen/Geometry>

#include "geometry/types.hpp"

namespace aussois {

using Quat = Eigen::Quaterniond;

/// skew(a) b = a x b.
Mat3 skew(const Vec3& a);

/// Stumpff function c_m(x) = sum over k >= 0 of (-x)^k / (2k + m)!, for m in 0 ... 5 and x >= 0 (SO3-7):
/// c_0(t^2) = cos t, c_1 = sin t / t, c_2 = (1 - cos t) / t^2, c_3 = (t - sin t) / t^3, and so on.
/// Series of ten terms below x = 1 (truncated at less than 1e-18), closed form from there on; both within
/// 1e-13 / m! of the true value.
double stumpff(int m, double x);

/// Unit quaternion of the rotation by |phi| [rad] about phi (SO3-1).
Quat exp_so3(const Vec3& phi);

/// Rotation vector [rad] with |log| <= pi (SO3-2). At pi the axis is the one whose first nonzero entry is
/// positive. R need not be normalised: a common factor of its entries cancels.
Vec3 log_so3(const Quat& R);

/// Left differential: d/de exp(phi + e dphi) = skew(dexp_left(phi) dphi) exp(phi) (SO3-3).
Mat3 dexp_left(const Vec3& phi);
/// Right differential: d/de exp(phi + e dphi) = exp(phi) skew(dexp_right(phi) dphi) (SO3-4).
Mat3 dexp_right(const Vec3& phi);
/// Inverses of these two (SO3-5), (SO3-6); defined for |phi| < 2 pi.
Mat3 dexp_left_inverse(const Vec3& phi);
Mat3 dexp_right_inverse(const Vec3& phi);

/// Angle of the rotation that takes a to b, in [0, pi] [rad], from the quaternion without acos.
double angle_between(const Quat& a, const Quat& b);

}  // namespace aussois
