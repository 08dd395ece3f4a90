// SPDX-License-Identifier: Apache-2.0
// Soft parts that are squeezed, snapped and pressed, and Cook's membrane.
#pragma once

#include <array>

#include "examples/scenes/solids.hpp"
#include "geometry/volume_primitives.hpp"

namespace aussois {

/// A quarter of a rubber ring about z between two plates without friction, which touch it.
struct RingBetweenPlates {
  static constexpr double kThick = 5e-3, kDiameter = 50e-3;  // [m]
  Model model{};
  State state{};
  Solid ring{};
  std::array<BodyId, 2> plates{};  // lower and upper
  /// Young's modulus [Pa], viscosity [Pa s].
  explicit RingBetweenPlates(double young, double viscosity = 0);
  /// Each plate moves towards the ring [m/s].
  void press_at(double speed);
};

/// A cantilever along x with a tooth near its end, below it, and a catch that moves past it towards -x. In
/// the plane z = 0.
struct SnapFit {
  static constexpr double kLength = 50e-3, kHeight = 2.5e-3, kWide = 0.625e-3;     // of the cantilever [m]
  static constexpr double kTooth = 2e-3, kHalf = 2.5e-3, kPeak = kLength - kHalf;  // where it is deepest
  static constexpr double kRise = 1e-3, kLift = 0.8e-3, kFlat = 1e-3;              // of the catch [m]
  static constexpr double kYoung = 2e9, kMu = 0.2;                                 // [Pa], [-]
  Model model{};
  State state{};
  BodyId caught{};
  /// Speed of the catch [m/s], viscosity of the cantilever [Pa s].
  explicit SnapFit(double speed, double viscosity = 0);
  /// Tangent of the ramp of the catch, and the ramp's length [m].
  static double slope();
  static double ramp();
  /// How far along the catch the tooth is [m].
  double passed() const;
};

/// Cook's membrane: a tapered panel of 48 x 44 to 60 units [m], `side` cells a side, one layer in plane
/// strain, clamped on the left. A load pushes its right side up.
struct CookMembrane {
  SolidScene scene{};
  FaceLoad load{};
  double unit = 1;
  CookMembrane(int side, CellKind cells, SolidOptions options, double force, double unit);
  /// How far the middle of its right side has risen [m].
  double rise() const;
};

/// The ring is squeezed by a quarter in half a second; `body` is the upper plate.
CaseScene o_ring();
/// The catch passes the tooth in 0.1 s; `body` is the catch.
CaseScene snap_fit();
/// The membrane of 48 cm of rubber under a load that is put on at once, beside a floor; `body` is the floor.
CaseScene cook_panel();
/// A rubber ball of 10 cm falls onto a plate by 5 cm and bounces; `body` is the plate.
CaseScene rubber_ball();

}  // namespace aussois
