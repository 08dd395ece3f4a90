// SPDX-License-Identifier: Apache-2.0
// Cables, soft blocks and cloth thrown at each other, at plates, edges and meshes, at random.
#pragma once

#include <cstdint>

namespace aussois {

struct ThrowTally {
  int throws = 0;
  int touched = 0;              // throws in which anything touched
  std::int64_t violations = 0;  // steps that the path audit refutes
  int refused = 0;              // throws that ended in a step that was not accepted
};

/// The throws first, first + 1, ...: each is a function of its number alone.
ThrowTally throw_soft_parts(std::uint64_t first, int count);

}  // namespace aussois
