// SPDX-License-Identifier: Apache-2.0
// Anderson acceleration of a fixed-point map g(x) (AA-1) to (AA-3): where the last steps together point to.
// The caller decides whether to go there. Private to nsgs. Source: Anderson 1965; Walker and Ni 2011.
#pragma once

#include <cstddef>

#include "geometry/types.hpp"

namespace aussois {

class Anderson {
 public:
  /// Combines `memory` differences of steps; 0: never proposes.
  explicit Anderson(int memory) : memory_(std::size_t(memory)) {}

  /// The proposal (AA-2) from the step x -> g and those before it. Empty after the first step.
  VecX propose(const VecX& x, const VecX& g);
  void forget() { *this = Anderson(int(memory_)); }

 private:
  std::size_t memory_;
  VecX f_{}, g_{};
  MatX df_{}, dg_{};  // columns: differences of steps f = g - x and of images, the oldest overwritten
  MatX gram_{};       // the Gram matrix of df_
  std::size_t steps_ = 0;
};

}  // namespace aussois
