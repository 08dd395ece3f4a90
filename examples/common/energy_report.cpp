// SPDX-License-Identifier: Apache-2.0
#include "examples/common/energy_report.hpp"

#include <cstdio>

#include "examples/common/checkpoint_fields.hpp"

namespace aussois {
namespace {

constexpr CheckpointField<EnergyGain, double> kNumbers[] = {{"gain_stored", &EnergyGain::stored},
                                                            {"gain_above", &EnergyGain::above},
                                                            {"gain_largest", &EnergyGain::largest},
                                                            {"gain_kinetic", &EnergyGain::kinetic}};

}  // namespace

void set_gain(Summary& summary, const EnergyGain& gain) {
  summary.set("energy_gain", gain.largest);
}

void tell(const EnergyGain& gain) {
  if (energy_rises(gain))
    std::fprintf(stderr, "energy rose by %.3g J that nothing gave, %.2g of the largest kinetic energy\n",
                 gain.largest, gain.largest / gain.kinetic);
}

void keep(const EnergyGain& gain, Checkpoint& checkpoint) {
  keep(kNumbers, gain, checkpoint);
}

EnergyGain energy_gain_of(const Checkpoint& checkpoint) {
  EnergyGain out;
  take(kNumbers, checkpoint, out);
  return out;
}

}  // namespace aussois
