// SPDX-License-Identifier: Apache-2.0
#include "geometry/so3.hpp"

#include <array>
#include <cmath>

#include "geometry/check.hpp"

namespace aussois {

Mat3 skew(const Vec3& a) {
  Mat3 S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

double stumpff(int m, double x) {
  static constexpr std::array<double, 6> kInverseFactorial = {1, 1, 1. / 2, 1. / 6, 1. / 24, 1. / 120};
  AUSSOIS_ASSERT(m >= 0 && m <= 5);
  if (x == 0) return kInverseFactorial[m];  // the value of the series, for all that does not turn
  if (x < 1) {                              // c_m = 1/m! (1 - x/((m+1)(m+2)) (1 - x/((m+3)(m+4)) (...)))
    double sum = 1;
    for (int k = m + 18; k > m; k -= 2) sum = 1 - x / (k * (k - 1)) * sum;
    return kInverseFactorial[m] * sum;
  }
  const double angle = std::sqrt(x);
  double c = m % 2 == 0 ? std::cos(angle) : std::sin(angle) / angle;
  for (int k = m % 2; k < m; k += 2) c = (kInverseFactorial[k] - c) / x;  // c_k = 1/k! - x c_{k+2}
  return c;
}

Quat exp_so3(const Vec3& phi) {
  const double quarter = phi.squaredNorm() / 4;  // square of half the angle
  const Vec3 v = stumpff(1, quarter) / 2 * phi;
  return {stumpff(0, quarter), v.x(), v.y(), v.z()};
}

Vec3 log_so3(const Quat& R) {
  Vec3 v = R.vec();
  double w = R.w();
  const auto first_nonzero_is_negative = [&] {
    return v.x() < 0 || (v.x() == 0 && (v.y() < 0 || (v.y() == 0 && v.z() < 0)));
  };
  if (w < 0 || (w == 0 && first_nonzero_is_negative())) {  // q and -q are the same rotation
    v = -v;
    w = -w;
  }
  const double n = v.norm();
  if (n < 1e-4 * w) return 2 / w * (1 - n * n / (3 * w * w)) * v;  // next term (n/w)^4 / 5 < 2e-17
  return 2 * std::atan2(n, w) / n * v;                             // well conditioned up to pi, where w = 0
}

Mat3 dexp_left(const Vec3& phi) {
  const double x = phi.squaredNorm();
  const Mat3 S = skew(phi);
  return Mat3::Identity() + stumpff(2, x) * S + stumpff(3, x) * S * S;
}

Mat3 dexp_right(const Vec3& phi) {
  return dexp_left(-phi);
}

Mat3 dexp_left_inverse(const Vec3& phi) {
  const double quarter = phi.squaredNorm() / 4;
  const Mat3 S = skew(phi);
  // (1 - (t/2) cot(t/2)) / t^2 without a difference of nearly equal numbers; c_1 is zero first at t = 2 pi
  const double c = (stumpff(2, quarter) - stumpff(3, quarter)) / (4 * stumpff(1, quarter));
  return Mat3::Identity() - S / 2 + c * S * S;
}

Mat3 dexp_right_inverse(const Vec3& phi) {
  return dexp_left_inverse(-phi);
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat R = a.conjugate() * b;
  return 2 * std::atan2(R.vec().norm(), std::abs(R.w()));
}

}  // namespace aussois
