// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// B7: the rattleback, against the equations of rolling without slip, integrated on their own.
std::vector<VerificationCase> rattleback_verification();

/// B8: Euler's disc, against its steady motion, the equations of rolling without slip with its losses, and
/// the laws of its descent.
std::vector<VerificationCase> euler_disc_verification();

}  // namespace aussois
