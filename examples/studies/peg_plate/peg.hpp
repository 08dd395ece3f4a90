// SPDX-License-Identifier: Apache-2.0
// The peg of [Kim2019] and what is measured of it (PEG-1). Frames: the world's z points up from the nominal
// plate; the body's frame stands in the peg's centre of mass with z along its axis, the flange above.
#pragma once

#include <array>
#include <vector>

#include "geometry/named.hpp"
#include "reduction/selection.hpp"

namespace aussois {

struct Peg {
  double mass = 0.33953;                                          // [kg]
  Vec3 inertia = Vec3(182767.90e-9, 182767.90e-9, 106769.63e-9);  // about the axes [kg m^2]
  double flange = 0.03454;                                        // the flange above the centre of mass [m]
  double radius = 0.02508;      // of the solid cylinder with this inertia (PEG-1) [m]
  double half_length = 0.0338;  // likewise [m]
};

inline constexpr double kPegGravity = 9.81;  // [m/s^2]

/// X of [Kim2019] with the plate's force, all as sensors tell it.
struct PegSample {
  double t = 0;                     // since the set-point moves [s]
  bool is_static = false;           // the set-point has stood still for 0.4 s
  SE3 g{};                          // body to world
  Vec3 v = Vec3::Zero();            // of the centre of mass, world [m/s]
  Vec3 omega = Vec3::Zero();        // body [rad/s]
  Vec3 force = Vec3::Zero();        // of robot and gravity on the peg, world [N]
  Vec3 torque = Vec3::Zero();       // of the robot about the centre of mass, body [N m]
  Vec3 plate_force = Vec3::Zero();  // of the plate on the peg, world [N]
};

/// As a simulation tells it to a learned selector: with the gyroscopic torque.
BodyLoad load_of(const PegSample& sample);

/// Where the plate's force meets the nominal face of a peg at rest, from the sensors: x and y in the body's
/// frame [m].
Vec2 centre_of_pressure(const PegSample& sample);

/// One run of the robot.
struct PegCase {
  double incidence = kPi / 2;  // of the set-point's way to the plate, in the plane of x and z [rad]
  double speed = 0.05;         // of the set-point [m/s]
  double lean = 0;             // of the set-point about y, from upright [rad]
};

enum class PegScenario { surface, edge };
inline constexpr Named<PegScenario> kPegScenarios[] = {{PegScenario::surface, "surface"},
                                                       {PegScenario::edge, "edge"}};
const char* to_string(PegScenario scenario);

/// `count` incidences of 45 to 135 degrees times as many speeds of 0.02 to 0.07 m/s, for the edge also times
/// `leans` of 43 to 5 degrees, in this order.
std::vector<PegCase> peg_cases(PegScenario scenario, int count, int leans);

}  // namespace aussois
