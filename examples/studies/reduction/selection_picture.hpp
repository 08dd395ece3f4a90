// SPDX-License-Identifier: Apache-2.0
// Contacts of a patch seen from above, before and after each reducer, as one SVG.
#pragma once

#include <string>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct SelectionPanel {
  std::string title{}, note{};   // above and below
  std::vector<Vec2> all{};       // contacts [m]
  std::vector<double> weight{};  // of each, drawn as the area of a disc; empty: none
  std::vector<int> kept{};       // of them
  std::vector<Vec2> hull_all{}, hull_kept{};
};

/// Five panels a row, all at the scale of the first one's contacts. Plain text, the same for the same panels.
std::string selection_svg(const std::vector<SelectionPanel>& panels);

}  // namespace aussois
