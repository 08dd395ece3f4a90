// SPDX-License-Identifier: Apache-2.0
// Seeded random vectors and the angles at which rotations are delicate.
#pragma once

#include <random>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// Uniform in [lo, hi), the same on every platform.
inline double uniform(std::mt19937_64& random, double lo, double hi) {
  return lo + (hi - lo) * (double(random() >> 11) / 9007199254740992.0);
}

inline Vec3 random_vector(std::mt19937_64& random, double size) {
  return {uniform(random, -size, size), uniform(random, -size, size), uniform(random, -size, size)};
}

inline Vec3 random_direction(std::mt19937_64& random) {
  Vec3 x;
  do {
    x = random_vector(random, 1);
  } while (x.norm() > 1 || x.norm() < 0.1);
  return x.normalized();
}

/// Zero, tiny, around the switch of the logarithm (2e-4) and of the Stumpff functions (1 and 2), ordinary,
/// near pi.
inline const std::vector<double> kAngles = {0,       1e-200,     1e-12,      1e-8,       1e-5,       1.99e-4,
                                            2.01e-4, 0.1,        0.999,      1.001,      1.999,      2.001,
                                            2.7,     kPi - 1e-3, kPi - 1e-6, kPi - 1e-9, kPi - 1e-12};

}  // namespace aussois
