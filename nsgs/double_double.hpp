// SPDX-License-Identifier: Apache-2.0
// Numbers of 32 digits as sums of two doubles, high + low with |low| <= ulp(high) / 2. This works because the
// rounding errors of a sum and of a product are doubles themselves. The error of each operation is a few
// 1e-32 of its result. Private to nsgs. Sources: Dekker 1971; Hida, Li and Bailey 2001. Needs IEEE 754
// arithmetic, without -ffast-math.
#pragma once

#include <cmath>

namespace aussois {

struct DoubleDouble {
  double high = 0, low = 0;
  DoubleDouble() = default;
  DoubleDouble(double value) : high(value) {}  // exact, so implicit
  explicit operator double() const { return high; }
  /// a + b where |a| >= |b| or a = 0.
  static DoubleDouble ordered_sum(double a, double b) {
    DoubleDouble out(a + b);
    out.low = b - (out.high - a);
    return out;
  }
  static DoubleDouble sum(double a, double b) {
    DoubleDouble out(a + b);
    const double part = out.high - a;
    out.low = (a - (out.high - part)) + (b - part);
    return out;
  }
  static DoubleDouble product(double a, double b) {
    DoubleDouble out(a * b);
    out.low = std::fma(a, b, -out.high);
    return out;
  }
};

inline DoubleDouble operator-(DoubleDouble a) {
  a.high = -a.high;
  a.low = -a.low;
  return a;
}
inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble high = DoubleDouble::sum(a.high, b.high), low = DoubleDouble::sum(a.low, b.low);
  const DoubleDouble part = DoubleDouble::ordered_sum(high.high, high.low + low.high);
  return DoubleDouble::ordered_sum(part.high, part.low + low.low);
}
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) {
  return a + -b;
}
inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = DoubleDouble::product(a.high, b.high);
  return DoubleDouble::ordered_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}
inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {  // long division
  const double first = a.high / b.high;
  DoubleDouble rest = a - b * first;
  const double second = rest.high / b.high;
  rest = rest - b * second;
  return DoubleDouble::ordered_sum(first, second) + rest.high / b.high;
}
inline bool operator<(const DoubleDouble& a, const DoubleDouble& b) {
  return a.high < b.high || (a.high == b.high && a.low < b.low);
}
inline DoubleDouble abs(const DoubleDouble& a) {
  return a < 0 ? -a : a;
}
inline DoubleDouble sqrt(const DoubleDouble& a) {  // one Newton step from the root in doubles
  if (!(a.high > 0)) return {};
  const double root = std::sqrt(a.high);
  return root + DoubleDouble((a - DoubleDouble::product(root, root)).high / (2 * root));
}

}  // namespace aussois
