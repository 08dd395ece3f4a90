// SPDX-License-Identifier: Apache-2.0
// Rows of options that several schemes have.
#pragma once

#include "geometry/settings.hpp"

namespace aussois {

inline Setting theta_setting() {
  return {.name = "theta",
          .what = "point of the step at which forces act; 0.5: midpoint, 1: end",
          .unit = "-",
          .range = {0.5, 1},
          .flag = "--theta",
          .label = "theta %",
          .in_every_label = true};
}

inline Setting normal_law_setting() {
  return {.name = "law",
          .what = "law of normal rows; gap_over_step is plastic",
          .flag = "--normal-law",
          .label = "%",
          .in_every_label = true};
}

}  // namespace aussois
