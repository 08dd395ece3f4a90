// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// C2: a slider-crank with clearance (doc/theory/mechanism_benchmarks.md).
std::vector<VerificationCase> slider_crank_verification();

}  // namespace aussois
