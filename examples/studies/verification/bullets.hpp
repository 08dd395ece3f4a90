// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// A5: nothing passes through paper, whatever the start, the scheme and its settings; nothing is hit that is
/// missed.
std::vector<VerificationCase> bullet_verification();

}  // namespace aussois
