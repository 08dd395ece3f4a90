// SPDX-License-Identifier: Apache-2.0
// The fewest corners of the hull that keep a margin, and of all choices of that many the best one (RED-11).
#pragma once

#include "reduction/planar_patch.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct HullMargin {
  double margin = 0.9;  // at least this is kept, unless max_corners binds
  int min_corners = 4;  // if the hull has that many
  int max_corners = 8;  // >= min_corners
};
void describe(SettingVisitor& visit, HullMargin& options);

/// Members, ascending.
std::vector<int> hull_margin(const PlanarPatch& patch, const HullMargin& options = {});

}  // namespace aussois
