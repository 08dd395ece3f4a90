// SPDX-License-Identifier: Apache-2.0
// Mechanisms that run in maximal coordinates or in those of their joints (doc/theory/trees.md).
#pragma once

#include <vector>

#include "examples/scenes/cases.hpp"

namespace aussois {

/// A scene of bodies and joints, and which of the joints make trees.
struct TreeScene {
  CaseScene bodies{};
  std::vector<std::vector<JointId>> trees{};
};
/// The same scene and state in joint coordinates.
CaseScene in_joint_coordinates(const TreeScene& scene);

/// J1, J3. Rods of 1 kg in a row of 1 m, hinged about y to the ground and each other; they hang and swing.
/// `bend` is the angle of the second hinge at the start [rad].
TreeScene rods_in_a_row(int rods, double bend);
/// J2. A crank, a coupler and a rocker of 1 kg whose lower hinge closes the loop; about y.
TreeScene four_bar();
/// J4. Seven hinges with springs and dampers; the last link is a peg that comes down on a plate and is
/// pressed on it while it slides. `body` is the peg.
TreeScene arm_with_peg();

}  // namespace aussois
