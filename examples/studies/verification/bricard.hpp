// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// C8: Bricard's ring of six hinges (doc/theory/mechanism_benchmarks.md), against its motion in one
/// coordinate.
std::vector<VerificationCase> bricard_verification();

}  // namespace aussois
