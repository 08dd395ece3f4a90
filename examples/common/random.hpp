// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same everywhere: a seeded engine and our own maps (standard distributions
// differ between libraries). Draw one number in an expression: compilers evaluate arguments in orders of
// their own. For examples and tests; tests print the seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "geometry/se3.hpp"

namespace aussois {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t bits() { return engine_(); }
  double uniform(double lo = 0, double hi = 1) { return lo + (hi - lo) * double(bits() >> 11) * 0x1p-53; }
  double log_uniform(double lo, double hi) {
    return std::exp(uniform(std::log(lo), std::log(hi)));
  }  // lo > 0
  /// Of the standard normal distribution (Box and Muller).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * kPi * uniform());
  }
  Vec3 normal_vector() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }
  int index(int n) { return int(bits() % std::uint64_t(n)); }
  Vec3 vector(double half = 1) {
    const double x = uniform(-half, half), y = uniform(-half, half), z = uniform(-half, half);
    return {x, y, z};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 d = vector();
      if (d.norm() > 0.1 && d.norm() <= 1) return d.normalized();
    }
  }
  /// Of any direction, with a length from `shortest` to `longest`.
  Vec3 vector_of_length(double shortest, double longest) {
    const double length = uniform(shortest, longest);
    return length * direction();
  }
  Vec3 vector_of_log_length(double shortest, double longest) {
    const double length = log_uniform(shortest, longest);
    return length * direction();
  }
  Quat rotation() {
    const Vec3 axis = direction();
    return exp_so3(uniform(0, kPi) * axis);
  }
  SE3 pose(double half) {
    const Quat R = rotation();
    return {R, vector(half)};
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace aussois
