// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// C4: a dimer that bounces on both ends. C5: a rod that comes between the balls of one.
std::vector<VerificationCase> dimer_verification();

}  // namespace aussois
