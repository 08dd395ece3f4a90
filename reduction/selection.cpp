// SPDX-License-Identifier: Apache-2.0
#include "reduction/selection.hpp"

#include <string>

#include "geometry/check.hpp"

namespace aussois {

ContactSet select(const ContactSet& found, const std::vector<int>& kept) {
  ContactSet result;
  for (const int i : kept) {
    require(i >= 0 && std::size_t(i) < found.points.size(), "select: index " + std::to_string(i) +
                                                                " must lie in [0, " +
                                                                std::to_string(found.points.size()) + ")");
    result.points.push_back(found.points[std::size_t(i)]);
  }
  return result;
}

}  // namespace aussois
