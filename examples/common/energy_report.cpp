// SPDX-License-Identifier: Apache-2.0
#include "examples/common/energy_report.hpp"

#include <cstdio>

namespace aussois {

void set_gain(Summary& summary, const EnergyGain& gain) {
  summary.set("energy_gain", gain.largest);
}

void tell(const EnergyGain& gain) {
  if (energy_rises(gain))
    std::fprintf(stderr, "energy rose by %.3g J that nothing gave, %.2g of the largest kinetic energy\n",
                 gain.largest, gain.largest / gain.kinetic);
}

void keep(const EnergyGain& gain, Checkpoint& checkpoint) {
  checkpoint.numbers["gain_stored"] = gain.stored;
  checkpoint.numbers["gain_above"] = gain.above;
  checkpoint.numbers["gain_largest"] = gain.largest;
  checkpoint.numbers["gain_kinetic"] = gain.kinetic;
}

EnergyGain energy_gain_of(const Checkpoint& checkpoint) {
  return {.stored = checkpoint_number(checkpoint, "gain_stored"),
          .above = checkpoint_number(checkpoint, "gain_above"),
          .largest = checkpoint_number(checkpoint, "gain_largest"),
          .kinetic = checkpoint_number(checkpoint, "gain_kinetic")};
}

}  // namespace aussois
