// SPDX-License-Identifier: Apache-2.0
#include "mechanics/beam_element.hpp"

#include <array>
#include <limits>

namespace aussois {
namespace {

// b_k of (t / 2) cot(t / 2) = 1 + sum b_k t^(2k) (BEA-3). Below kLargestBeamTurn each term is at most a sixth
// of the one before.
constexpr int kTerms = 24;
constexpr std::array<double, kTerms> make_coefficients() {
  std::array<double, kTerms> out{1,
                                 -1. / 12,
                                 -1. / 720,
                                 -1. / 30240,
                                 -1. / 1209600,
                                 -1. / 47900160,
                                 -691. / 1307674368000,
                                 -1. / 74724249600};
  for (int k = 8; k < kTerms; ++k) {
    double zeta = 0, power = 1;  // zeta(2k): from the twelfth term on nothing is left
    for (int n = 12; n >= 1; --n) {
      double term = 1;
      for (int i = 0; i < 2 * k; ++i) term /= n;
      zeta += term;
    }
    for (int i = 0; i < 2 * k; ++i) power *= 2 * kPi;
    out[std::size_t(k)] = -2 * zeta / power;
  }
  return out;
}
constexpr std::array<double, kTerms> kB = make_coefficients();

// c_2 and c_4 of (BEA-3), and their derivatives by x.
struct Coefficients {
  double c2 = 0, c4 = 0, dc2 = 0, dc4 = 0;
};
Coefficients coefficients(double x) {
  Coefficients out;
  for (int k = kTerms - 1; k >= 1; --k) {
    const double b = kB[std::size_t(k)];
    out.dc2 = out.dc2 * x + out.c2;
    out.c2 = out.c2 * x + (k - 2) * b;
    if (k < 2) continue;
    out.dc4 = out.dc4 * x + out.c4;
    out.c4 = out.c4 * x + (k - 1) * b;
  }
  return out;
}

Mat6 bracket(const Vec6& h) {  // ad(h)
  Mat6 out;
  out << skew(h.tail<3>()), skew(h.head<3>()), Mat3::Zero(), skew(h.tail<3>());
  return out;
}

Mat6 by_bracket(const Vec6& n) {  // N(n): ad(dh)^T n = N(n) dh
  Mat6 out;
  out << Mat3::Zero(), skew(n.head<3>()), skew(n.head<3>()), skew(n.tail<3>());
  return out;
}

using Mat12 = BeamTangent::Matrix;
using Rates = Eigen::Matrix<double, 6, 12>;

// From the rates of a body (v in the world) to the twist of its attachment.
Mat6 twist_of_end(const SE3& g, const SE3& frame) {
  Mat6 out = adjoint(inverse(frame));
  out.leftCols<3>() *= g.R.toRotationMatrix().transpose();
  return out;
}

}  // namespace

RelativeMotion relative_motion(const SE3& g_a, const SE3& g_b) {
  RelativeMotion out;
  out.h = log_se3(inverse(g_a) * g_b);
  const auto [c2, c4, dc2, dc4] = coefficients(out.h.tail<3>().squaredNorm());
  const Mat6 a = bracket(out.h), a2 = a * a;
  const Mat6 T = Mat6::Identity() + c2 * a2 + c4 * (a2 * a2);
  out.by_a = a / 2 - T;
  out.by_b = a / 2 + T;
  return out;
}

namespace {

// The derivatives of by_a^T n and by_b^T n by h, at constant n (BEA-6).
struct RelativeCurvature {
  Mat6 by_a = Mat6::Zero(), by_b = Mat6::Zero();
};
RelativeCurvature relative_curvature(const Vec6& h, const Vec6& n) {
  const auto [c2, c4, dc2, dc4] = coefficients(h.tail<3>().squaredNorm());
  const Mat6 at = bracket(h).transpose();
  const Vec6 n1 = at * n, n2 = at * n1, n3 = at * n2, n4 = at * n3;
  const Mat6 N = by_bracket(n), N1 = by_bracket(n1) + at * N;
  Mat6 even = c2 * N1 + c4 * (by_bracket(n3) + at * (by_bracket(n2) + at * N1));
  even.rightCols<3>() += 2 * (dc2 * n2 + dc4 * n4) * h.tail<3>().transpose();
  return {N / 2 - even, N / 2 + even};
}

// The derivative of by_a a + by_b b by h, at constant twists of the ends (BEA-7).
Mat6 relative_rate_change(const Vec6& h, const Vec6& a, const Vec6& b) {
  const auto [c2, c4, dc2, dc4] = coefficients(h.tail<3>().squaredNorm());
  const Mat6 ad = bracket(h);
  const Vec6 w = b - a, w1 = ad * w, w2 = ad * w1, w3 = ad * w2, w4 = ad * w3;
  const Mat6 D2 = -bracket(w1) - ad * bracket(w);
  const Mat6 D4 = -bracket(w3) + ad * (ad * D2 - bracket(w2));
  Mat6 out = c2 * D2 + c4 * D4 - bracket(a + b) / 2;
  out.rightCols<3>() += 2 * (dc2 * w2 + dc4 * w4) * h.tail<3>().transpose();
  return out;
}

// B of (BEA-4), and the twists of the ends by the rates of the bodies.
struct StrainRates {
  RelativeMotion motion{};
  Mat6 end_a = Mat6::Zero(), end_b = Mat6::Zero();
  Rates B = Rates::Zero();
};

StrainRates strain_rates(const BeamEnds& ends) {
  StrainRates out{.motion = relative_motion(ends.g_a * ends.frame_a, ends.g_b * ends.frame_b),
                  .end_a = twist_of_end(ends.g_a, ends.frame_a),
                  .end_b = twist_of_end(ends.g_b, ends.frame_b)};
  out.B << out.motion.by_a * out.end_a, out.motion.by_b * out.end_b;
  return out;
}

// The derivative of B^T n at constant n; the second part is that of R in (BEA-4).
Mat12 curvature(const BeamEnds& ends, const StrainRates& rates, const Vec6& n) {
  const RelativeCurvature curved = relative_curvature(rates.motion.h, n);
  Mat12 out;
  out << rates.end_a.transpose() * curved.by_a * rates.B, rates.end_b.transpose() * curved.by_b * rates.B;
  const Eigen::Matrix<double, 12, 1> force = rates.B.transpose() * n;
  out.block<3, 3>(0, 3) -= skew(force.segment<3>(0)) * ends.g_a.R.toRotationMatrix();
  out.block<3, 3>(6, 9) -= skew(force.segment<3>(6)) * ends.g_b.R.toRotationMatrix();
  return out;
}

// The derivative of B v at constant v: v^T G(e_i) of (BEA-5) in row i.
Rates rate_change(const BeamEnds& ends, const StrainRates& rates) {
  Rates out = relative_rate_change(rates.motion.h, rates.end_a * ends.v_a, rates.end_b * ends.v_b) * rates.B;
  out.middleCols<3>(3) += rates.B.leftCols<3>() * (skew(ends.v_a.head<3>()) * ends.g_a.R.toRotationMatrix());
  out.rightCols<3>() += rates.B.middleCols<3>(6) * (skew(ends.v_b.head<3>()) * ends.g_b.R.toRotationMatrix());
  return out;
}

}  // namespace

BeamForces beam_forces(const BeamEnds& ends, const Vec6& stiffness, const Vec6& damping, double length,
                       const Vec6& rest, BeamTangent* tangent) {
  const StrainRates rates = strain_rates(ends);
  const Rates& B = rates.B;
  Eigen::Matrix<double, 12, 1> v;
  v << ends.v_a, ends.v_b;
  BeamForces out;
  out.strain = (rates.motion.h - rest) / length;
  if (!(rates.motion.h.tail<3>().norm() <= kLargestBeamTurn))
    out.strain.setConstant(std::numeric_limits<double>::quiet_NaN());
  const Vec6 elastic = stiffness.cwiseProduct(out.strain);
  out.stress = elastic + damping.cwiseProduct(B * v / length);
  out.energy = length / 2 * out.strain.dot(elastic);
  out.on_a = -B.leftCols<6>().transpose() * out.stress;
  out.on_b = -B.rightCols<6>().transpose() * out.stress;
  if (!tangent) return out;
  Rates by_place = (stiffness / length).asDiagonal() * B;  // of the stress
  if (!damping.isZero(0)) {
    by_place += (damping / length).asDiagonal() * rate_change(ends, rates);
    const Rates by_rate = (damping / length).asDiagonal() * B;
    tangent->C = B.transpose().lazyProduct(by_rate);
  }
  tangent->K = curvature(ends, rates, out.stress);
  tangent->K += B.transpose().lazyProduct(by_place);
  return out;
}

}  // namespace aussois
