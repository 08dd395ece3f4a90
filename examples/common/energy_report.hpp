// SPDX-License-Identifier: Apache-2.0
// What a run gained that nothing gave (LED-4), for people, summaries and checkpoints.
#pragma once

#include "integrators/run.hpp"
#include "io/checkpoint.hpp"
#include "io/summary.hpp"

namespace aussois {

/// energy_gain: the largest of the run [J].
void set_gain(Summary& summary, const EnergyGain& gain);
/// Prints a line if energy rises.
void tell(const EnergyGain& gain);

/// In the names of a checkpoint.
void keep(const EnergyGain& gain, Checkpoint& checkpoint);
EnergyGain energy_gain_of(const Checkpoint& checkpoint);

}  // namespace aussois
