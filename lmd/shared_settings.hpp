// SPDX-License-Identifier: Apache-2.0
// Rows of options that several structs have.
#pragma once

#include "geometry/settings.hpp"

namespace aussois {

inline Setting planarity_setting() {
  return {.name = "planarity",
          .what = "tolerance of planar regions and straight chains, relative to the box diagonal",
          .unit = "-",
          .range = {0, 1e-2},
          .flag = "--planarity"};
}

inline Setting threads_setting() {
  return {.name = "threads",
          .what = "number of threads",
          .unit = "",
          .range = range_from(1),
          .changes_nothing = true};
}

}  // namespace aussois
