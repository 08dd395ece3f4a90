// SPDX-License-Identifier: Apache-2.0
// A belt drive: a closed limp belt around two round pulleys that are turned.
#pragma once

#include <array>

#include "examples/scenes/cases.hpp"
#include "mechanics/cable.hpp"

namespace aussois {

struct BeltDrive {
  static constexpr double kPulley = 0.1, kApart = 0.4,
                          kRadius = 2e-3;  // of pulleys, between them, of the belt [m]
  static constexpr double kMu = 0.5, kStiffness = 1e4, kTension = 100;  // EA and where it is laid [N]
  static constexpr double kSpeed = 0.1;                                 // of the belt [m/s]
  static constexpr int kElements = 96;
  static double chord_angle();  // about a pulley [rad]
  Model model{};
  State state{};
  Cable belt{};
  std::array<BodyId, 2> pulleys{};  // the one that drives, at x < 0, and the one that is driven
  /// Both turn about z, so that the half of the belt with y > 0 is pulled; the second is slower by that part.
  explicit BeltDrive(double slower, double damping_time = 0);
};

/// The belt drive with a part of 1 %; `body` is the pulley that is driven.
CaseScene belt_drive();

}  // namespace aussois
