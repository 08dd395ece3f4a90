// SPDX-License-Identifier: Apache-2.0
// Rods in the plane that stretch and shear, by shooting: exact answers to hold beams against.
#pragma once

#include "examples/scenes/beams.hpp"

namespace aussois {

/// A section of a rod: its place, the angle of its normal to x, and the moment that the rod beyond it exerts.
struct RodSection {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // [m]
  double angle = 0;                                 // [rad]
  double moment = 0;                                // [N m]
};
/// The other end of a straight piece whose every section bears the force [N] that the rod beyond exerts.
/// (Reissner 1972) Runge-Kutta of order four.
RodSection end_of_rod(RodSection from, double length, const Eigen::Vector2d& force,
                      const BeamNumbers& numbers);

/// Lee's frame: a column of 120 m from a hinge at the origin along y and a beam of 120 m from its head along
/// x to a second hinge, pushed down 24 m from the corner (Lee, Manuel and Rossow 1968).
inline constexpr double kLeesLeg = 120, kLeesArm = 24;  // [m]
BeamNumbers lees_numbers();
/// An equilibrium of the frame.
struct LeesAnswer {
  Eigen::Vector2d force = Eigen::Vector2d::Zero();  // that the column bears [N]
  double turn = 0;                                  // of its foot [rad]
  double load = 0;                                  // [N]
};
/// The one near `guess` in which the pushed point has sunk by `down` [m]. Throws NumericalFailure.
LeesAnswer lees_equilibrium(double down, const LeesAnswer& guess);
/// The load [N] on the path from rest that sinks the point by `down` [m].
double lees_load(double down);

}  // namespace aussois
