// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/plane_rod.hpp"

#include <cmath>

#include <Eigen/LU>

#include "examples/common/driver.hpp"

namespace aussois {
namespace {

using Eigen::Vector2d;
using Eigen::Vector4d;

// Derivatives along a rod.
RodSection slope(const RodSection& at, const Vector2d& force, const BeamNumbers& numbers) {
  const Vector2d normal(std::cos(at.angle), std::sin(at.angle)), across(-normal.y(), normal.x());
  const Vector2d tangent =
      (1 + force.dot(normal) / numbers.EA) * normal + force.dot(across) / numbers.GA * across;
  return {tangent, at.moment / numbers.EI, tangent.y() * force.x() - tangent.x() * force.y()};
}
RodSection moved(const RodSection& from, double ds, const RodSection& d) {
  return {from.place + ds * d.place, from.angle + ds * d.angle, from.moment + ds * d.moment};
}

// What is not yet as it must be: how far the pushed point has sunk, and the place and moment of the far end.
// The unknowns: force, turn, load.
Vector4d miss(const Vector4d& unknown, double down) {
  const BeamNumbers numbers = lees_numbers();
  const Vector2d force = unknown.head<2>();
  RodSection at = end_of_rod({.angle = kPi / 2 + unknown[2]}, kLeesLeg, force, numbers);
  at.angle -= kPi / 2;
  const RodSection pushed = end_of_rod(at, kLeesArm, force, numbers);
  const RodSection end =
      end_of_rod(pushed, kLeesLeg - kLeesArm, force + unknown[3] * Vector2d::UnitY(), numbers);
  return {pushed.place.y() - (kLeesLeg - down), end.place.x() - kLeesLeg, end.place.y() - kLeesLeg,
          end.moment};
}

}  // namespace

RodSection end_of_rod(RodSection at, double length, const Vector2d& force, const BeamNumbers& numbers) {
  constexpr int kSteps = 60;
  const double ds = length / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const RodSection a = slope(at, force, numbers), b = slope(moved(at, ds / 2, a), force, numbers),
                     c = slope(moved(at, ds / 2, b), force, numbers),
                     d = slope(moved(at, ds, c), force, numbers);
    for (const auto& [weight, s] : {std::pair(1, a), std::pair(2, b), std::pair(2, c), std::pair(1, d)})
      at = moved(at, weight * ds / 6, s);
  }
  return at;
}

BeamNumbers lees_numbers() {
  constexpr double kYoung = 720, kPoisson = 0.3, kArea = 6, kInertia = 2;
  const double shear = kYoung / (2 * (1 + kPoisson));
  return {.EA = kYoung * kArea,
          .GA = 5.0 / 6 * shear * kArea,
          .GJ = shear * 2 * kInertia,
          .EI = kYoung * kInertia,
          .mass = 1e-5,
          .about_x = 2e-5,
          .across = 1e-5};
}

LeesAnswer lees_equilibrium(double down, const LeesAnswer& guess) {
  constexpr double kDifference = 1e-6;
  Vector4d unknown(guess.force.x(), guess.force.y(), guess.turn, guess.load);
  for (int k = 0; k < 20; ++k) {
    const Vector4d off = miss(unknown, down);
    if (off.cwiseAbs().maxCoeff() < 1e-9) return {unknown.head<2>(), unknown[2], unknown[3]};
    Eigen::Matrix4d J;
    for (int i = 0; i < 4; ++i) {
      const Vector4d d = kDifference * Vector4d::Unit(i);
      J.col(i) = (miss(unknown + d, down) - miss(unknown - d, down)) / (2 * kDifference);
    }
    unknown -= J.partialPivLu().solve(off);
  }
  throw NumericalFailure("Lee's frame: no answer at a depth of " + std::to_string(down) + " m");
}

double lees_load(double down) {
  constexpr double kStep = 4;  // [m]
  LeesAnswer at;
  const int steps = int(std::ceil(std::abs(down) / kStep));
  for (int k = 1; k <= steps; ++k) at = lees_equilibrium(down * k / steps, at);
  return at.load;
}

}  // namespace aussois
