// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/linking_number.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

namespace aussois {
namespace {

// Of the segments from a to b and from c to d, with the sign of their crossing; 4 pi is once around.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::array<Vec3, 4> sight{c - a, d - a, d - b, c - b};
  std::array<Vec3, 4> normal;
  for (std::size_t k = 0; k < 4; ++k) {
    normal[k] = sight[k].cross(sight[(k + 1) % 4]);
    if (normal[k].isZero(0)) return 0;  // both lie in one plane
    normal[k].normalize();
  }
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    sum += std::asin(std::clamp(normal[k].dot(normal[(k + 1) % 4]), -1.0, 1.0));
  return std::copysign(sum, (d - c).cross(b - a).dot(c - a));
}

}  // namespace

double linking_number(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j)
      sum += solid_angle(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()]);
  return sum / (4 * kPi);
}

}  // namespace aussois
