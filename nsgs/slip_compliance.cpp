// SPDX-License-Identifier: Apache-2.0
#include "nsgs/slip_compliance.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include "nsgs/double_double.hpp"

namespace aussois {

namespace {

using std::abs, std::sqrt;

template <class Real>
using Three = std::array<Real, 3>;

constexpr double kLeast = 1e-60, kMost = 1e60;  // compliances that are looked at
constexpr double kStep = 16;                    // between them
constexpr int kMostSteps = 400;                 // each third of them halves: 100 digits

template <class Real>
constexpr double kAsNear = std::is_same_v<Real, double> ? 4e-16 : 1e-30;  // of the compliance: close enough

template <class Real>
struct Contact {
  const Mat3& W;
  const Vec3& q;
  Real mu{};
};

template <class Real>
Real length(const Real& x, const Real& y) {
  return sqrt(x * x + y * y);
}

// (W + compliance of the tangential rows) r = -q by elimination with pivots (ONE-4).
template <class Real>
std::optional<Three<Real>> impulse(const Contact<Real>& contact, std::type_identity_t<Real> compliance) {
  std::array<std::array<Real, 4>, 3> A;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) A[i][j] = contact.W(i, j);
    A[i][3] = -contact.q[i];
    if (i > 0) A[i][i] = A[i][i] + compliance;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = k + 1; i < 3; ++i)
      if (abs(A[k][k]) < abs(A[i][k])) std::swap(A[i], A[k]);
    if (double(A[k][k]) == 0) return std::nullopt;
    for (std::size_t i = k + 1; i < 3; ++i) {
      const Real factor = A[i][k] / A[k][k];
      for (std::size_t j = k + 1; j < 4; ++j) A[i][j] = A[i][j] - factor * A[k][j];
    }
  }
  Three<Real> r;
  for (std::size_t i = 3; i-- > 0;) {
    for (std::size_t j = i + 1; j < 3; ++j) A[i][3] = A[i][3] - A[i][j] * r[j];
    r[i] = A[i][3] / A[i][i];
  }
  return r;
}

// |r_T| - mu r_N (ONE-5): positive where the impulse lies outside of the cone. Infinite if there is none.
template <class Real>
Real excess(const Contact<Real>& contact, std::type_identity_t<Real> compliance) {
  const std::optional<Three<Real>> r = impulse(contact, compliance);
  return r ? length((*r)[1], (*r)[2]) - contact.mu * (*r)[0] : Real(kInf);
}

// The compliance whose impulse lies on the cone, between one outside of it and one inside: the chord of both
// (Illinois), each third time the middle.
template <class Real>
Real root(const Contact<Real>& contact, Real outside, Real inside) {
  Real f_out = excess(contact, outside), f_in = excess(contact, inside);
  int side = 0;
  for (int step = 1; step <= kMostSteps && Real(kAsNear<Real>) * inside < inside - outside; ++step) {
    Real at = (outside + inside) / 2;
    if (const Real chord = (outside * f_in - inside * f_out) / (f_in - f_out);
        step % 3 != 0 && outside < chord && chord < inside)
      at = chord;
    const Real f = excess(contact, at);
    const bool is_outside = Real(0) < f;
    (is_outside ? outside : inside) = at;
    (is_outside ? f_out : f_in) = f;
    if (side == (is_outside ? 1 : -1)) (is_outside ? f_in : f_out) = (is_outside ? f_in : f_out) / 2;
    side = is_outside ? 1 : -1;
  }
  return inside;
}

// |r - P(r - u^)|.
template <class Real>
Real natural_map(const Contact<Real>& contact, const Three<Real>& r) {
  Three<Real> y = r, u;
  for (int i = 0; i < 3; ++i) {
    u[i] = contact.q[i];
    for (int j = 0; j < 3; ++j) u[i] = u[i] + r[j] * contact.W(i, j);
  }
  u[0] = u[0] + contact.mu * length(u[1], u[2]);
  for (std::size_t i = 0; i < 3; ++i) y[i] = r[i] - u[i];
  const Real y_t = length(y[1], y[2]);
  if (y[0] < 0 || contact.mu * y[0] < y_t) {
    const Real normal = (y[0] + contact.mu * y_t) / (Real(1) + contact.mu * contact.mu);
    const Real shrink = Real(0) < normal && Real(0) < y_t ? contact.mu * normal / y_t : Real(0);
    y = {normal < 0 ? Real(0) : normal, shrink * y[1], shrink * y[2]};
  }
  Real sum = 0;
  for (std::size_t i = 0; i < 3; ++i) sum = sum + (r[i] - y[i]) * (r[i] - y[i]);
  return sqrt(sum);
}

// Nothing if the impulse lies on one side of the cone's boundary for all compliances.
template <class Real>
std::optional<Three<Real>> stick_or_slip(const Contact<Real>& contact) {
  if (double(contact.mu) == 0) return Three<Real>{Real(-contact.q[0]) / contact.W(0, 0), 0.0, 0.0};
  if (!(Real(0) < excess(contact, 0.0))) return impulse(contact, 0.0);
  double inside = 1;
  while (inside < kMost && Real(0) < excess(contact, inside)) inside *= kStep;
  double outside = inside / kStep;
  while (outside > kLeast && !(Real(0) < excess(contact, outside))) outside /= kStep;
  if (!(inside < kMost && outside > kLeast)) return std::nullopt;
  return impulse(contact, root<Real>(contact, outside, outside * kStep));
}

template <class Real>
ExactContact solved(const Contact<Real>& contact) {
  const std::optional<Three<Real>> r = stick_or_slip(contact);
  if (!r) return {};
  const double wrong(natural_map(contact, *r));
  const Vec3 rounded{double((*r)[0]), double((*r)[1]), double((*r)[2])};
  return {rounded, std::isfinite(wrong) && rounded.allFinite() ? wrong : kInf};
}

}  // namespace

ExactContact solve_by_slip_compliance(const Mat3& W, const Vec3& q, double mu, Digits digits) {
  return digits == Digits::sixteen ? solved(Contact<double>{W, q, mu})
                                   : solved(Contact<DoubleDouble>{W, q, mu});
}

}  // namespace aussois
