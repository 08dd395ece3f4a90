// SPDX-License-Identifier: Apache-2.0
// The angles at which rotations are delicate.
#pragma once

#include <vector>

#include "tests/support/random.hpp"

namespace aussois {

/// Zero, tiny, around the switch of the logarithm (2e-4) and of the Stumpff functions (1 and 2), ordinary,
/// near pi.
inline const std::vector<double> kAngles = {0,       1e-200,     1e-12,      1e-8,       1e-5,       1.99e-4,
                                            2.01e-4, 0.1,        0.999,      1.001,      1.999,      2.001,
                                            2.7,     kPi - 1e-3, kPi - 1e-6, kPi - 1e-9, kPi - 1e-12};

}  // namespace aussois
