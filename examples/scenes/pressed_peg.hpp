// SPDX-License-Identifier: Apache-2.0
// The peg of [Kim2019] pressed on a plate off its middle: a scene for learned selectors
// (doc/theory/peg_plate.md).
#pragma once

#include "examples/scenes/cases.hpp"

namespace aussois {

/// Body 0 is the peg, a prism of 32 sides about its axis, body 1 the plate in z = 0. A robot presses with 20
/// N down and 1 N aside, 5 mm off the axis.
CaseScene pressed_peg();

}  // namespace aussois
