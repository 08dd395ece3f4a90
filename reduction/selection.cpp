// SPDX-License-Identifier: Apache-2.0
#include "reduction/selection.hpp"

#include <stdexcept>
#include <string>

namespace aussois {

ContactSet select(const ContactSet& found, const std::vector<int>& kept) {
  ContactSet result;
  result.points.reserve(kept.size());
  for (const int i : kept) {
    if (i < 0 || std::size_t(i) >= found.points.size())
      throw std::invalid_argument("select: index " + std::to_string(i) + " must lie in [0, " +
                                  std::to_string(found.points.size()) + ")");
    result.points.push_back(found.points[i]);
  }
  return result;
}

}  // namespace aussois
