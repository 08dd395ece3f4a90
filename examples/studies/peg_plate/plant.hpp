// SPDX-License-Identifier: Apache-2.0
// The synthetic reference that stands in for a laboratory (PEG-2) to (PEG-6): a peg as made, on a robot under
// impedance control, on a plate with compliant, rough, frictional patches, seen by sensors. Deliberately
// richer than the model of the solver, and made by us: no figure that rests on it is a measurement.
#pragma once

#include <cstdint>
#include <vector>

#include "examples/studies/peg_plate/peg.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct PlantOptions {
  PegScenario scenario = PegScenario::surface;
  double tilt = 0.1;      // of the plate about x; about y it is -0.7 of this [deg]
  double tilts = 0;       // and up to this more about x and y from case to case, at random [deg]
  double scatter = 0.05;  // of the set-point's orientation from case to case, about x and y [deg]
  double step = 2e-5;     // [s]: explicit steps
  double sample = 4e-3;   // between samples [s]
  int count = 10;         // incidences, and speeds
  int leans = 5;          // of the edge
  std::uint64_t seed = 1;
};
void describe(SettingVisitor& visit, PlantOptions& options);

/// The peg's face as made: one patch per entry.
struct Plant {
  PlantOptions options{};
  Eigen::ArrayXd x{}, y{}, z{};      // in the body's frame [m]
  Eigen::ArrayXd stiffness{}, mu{};  // [N/m], [-]
};
/// Throws std::invalid_argument for a bad option.
Plant make_plant(const PlantOptions& options);

/// The samples in contact (more than 2 N on the plate). A pure function of plant, case and its index, which
/// seeds orientations and noise.
std::vector<PegSample> peg_samples(const Plant& plant, const PegCase& which, int index);

}  // namespace aussois
