// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// B6: what a friction law without drilling cannot do, and one with it does.
std::vector<VerificationCase> tippe_top_verification();

}  // namespace aussois
