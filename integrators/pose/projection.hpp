// SPDX-License-Identifier: Apache-2.0
// Finds the nearest poses at which nothing overlaps (PRJ-1) to (PRJ-3).
#pragma once

#include "integrators/pose/impulse_step.hpp"

namespace aussois {

/// Overlaps up to this count as none [m], for coordinates of some metres.
inline constexpr double kOverlapRounding = 1e-13;

struct Projection {
  State end{};                         // poses and coordinates; the velocities are those that came in
  double moved = 0;                    // largest component of the displacement [m, rad]
  double overlap = 0;                  // what is left of the deepest overlap [m], >= 0
  std::vector<ContactKey> contacts{};  // contacts that overlapped on the way, sorted
  std::vector<int> gaps{};             // the same for gap functions
  SolveReport solve{};  // effort of all rounds, and the worst status of those that led to `end`
};

/// Moves `plain`, where the step would end, by the smallest displacement in the metric of the masses that
/// opens all contacts of `pairs` and all gap functions to rounding and keeps the joints of the step, `G`, as
/// they are.
Projection without_overlap(const StepSetting& setting, const State& plain, const std::vector<StepPair>& pairs,
                           const FreeMotion& free, const SparseMatrix& G, double h);

struct OpeningDisplacement {
  VecX d{};  // in the places of the problem's rows [m, rad]
  SolveReport report{};
};
/// The smallest displacement d in the metric of `mass` with J d + w >= 0 for the normal of each row, w = its
/// first bias [m], that keeps the joints `G` as they are (PRJ-1). Solved by the automatic method: a problem
/// without friction has one solution, and a method under study need not reach 1e-12.
OpeningDisplacement opening_displacement(const StepSetting& setting, const SparseMatrix& mass,
                                         std::vector<ContactRow> rows, const SparseMatrix& G, double h);

}  // namespace aussois
