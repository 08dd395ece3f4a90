// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// C10: closed chains of rods that spin as one, and one that hangs at a joint.
std::vector<VerificationCase> spinning_chain_verification();

}  // namespace aussois
