// SPDX-License-Identifier: Apache-2.0
// Energy that a run has and nothing gave (LED-4): what single steps gain, too little to be told, adds up.
#pragma once

#include "integrators/step_report.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// Told is a gain in a run of more than this, of its largest kinetic energy.
inline constexpr double kGainOfRun = 1e-3;

struct EnergyGain {
  double stored = 0;   // at the last state: kinetic energy, weight, springs of joints [J]
  double above = 0;    // of it: over the lowest value so far, without what was given since [J]
  double largest = 0;  // `above` at its largest: what the run gained [J]
  double kinetic = 0;  // the largest so far, at least what the weight gives from rest in a step [J]
};

/// Of a run that begins with `start`.
EnergyGain energy_gain(const Model& model, const State& start);

/// One more step, accepted, that led to `state`. Force laws, forces of coordinates, motors and moved bodies
/// may give what they like.
void add(const Model& model, const State& state, const StepReport& report, EnergyGain& gain);

inline bool energy_rises(const EnergyGain& gain) {
  return gain.largest > kGainOfRun * gain.kinetic;
}

}  // namespace aussois
