// SPDX-License-Identifier: Apache-2.0
// Selects contacts of a body pair, whatever their normals, so that every wrench with friction that the pair
// can carry is kept up to a factor, with a certificate (RED-12).
#pragma once

#include <span>

#include "reduction/linear_program.hpp"
#include "reduction/selection.hpp"

namespace aussois {

inline constexpr int kFacets = 8;  // of the pyramid inside the friction cone

/// Unit wrenches of the members, as columns in the frame of body A. A contact gives its normal or, with
/// friction, the edges of the pyramid about it. Forces come first, then moments about the mean of the
/// members, divided by the distance of the farthest member from it. The mean of the columns is subtracted,
/// and they are projected on the directions in which they reach at all (1e-6).
struct UnitWrenches {
  Generators g{};
  std::vector<int> first{};  // first column of every member, and at the end the number of columns
};
UnitWrenches unit_wrenches(const ReductionInput& input, std::span<const int> members);

/// The least factor by which the unit wrenches of `kept` must be enlarged so that their hull with zero
/// contains those of every member; kInf if some cannot be reached at all. If it is at most 1 / (1 - loss),
/// the part carries at least 1 - loss of any wrench that all members could.
double wrench_factor(const UnitWrenches& all, std::span<const int> kept);

/// Numbers of the kept members of a body pair, ascending: `start` and those that must join it so that the
/// factor is at most 1 / (1 - loss), loss in [0, 1).
std::vector<int> wrench_cone(const UnitWrenches& all, std::vector<int> start, double loss);

}  // namespace aussois
