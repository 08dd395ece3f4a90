// SPDX-License-Identifier: Apache-2.0
// Two parts for a contact query and the poses of one in the frame of the other.
#pragma once

#include "examples/drivers/assembly/assembly_input.hpp"

namespace aussois {

struct ContactPair {
  std::string name{};
  AssemblyPart a{}, b{};
  std::vector<SE3> poses{};               // of A's mesh in the frame of B's
  double dilation_a = 0, dilation_b = 0;  // [m]
  double threshold = 0;                   // [m]; 0: not given
};

/// "x,y,z,qw,qx,qy,qz", the position in multiples of `scale` [m]. Throws std::invalid_argument with the text
/// unless it is seven finite numbers with a unit quaternion (1e-6).
SE3 parse_pose(const std::string& text, double scale);

/// Small scenes of our own, for the manual and for trying things; bolt_nut has a path.
inline const std::vector<std::string> kBuiltinPairs{
    "box_on_plate", "cylinder_standing", "cylinder_lying", "peg", "gear", "bolt_nut"};
/// Throws std::invalid_argument with the known names if `name` is none of them.
ContactPair builtin_pair(const std::string& name);

/// The pair of an assembly: its moving part is A.
ContactPair contact_pair(AssemblyInput input);

}  // namespace aussois
