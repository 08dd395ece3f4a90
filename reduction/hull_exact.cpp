// SPDX-License-Identifier: Apache-2.0
#include "reduction/hull_exact.hpp"

#include <algorithm>

namespace aussois {

std::vector<int> hull_exact(const PlanarPatch& patch) {
  std::vector<int> result = patch.hull;
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace aussois
