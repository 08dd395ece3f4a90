// SPDX-License-Identifier: Apache-2.0
// As many contacts of a body pair, whatever their normals, as keep every wrench with friction that the pair
// can carry, up to a factor, with a certificate (RED-12).
#pragma once

#include <span>

#include "reduction/linear_program.hpp"
#include "reduction/selection.hpp"

namespace aussois {

inline constexpr int kFacets = 8;  // of the pyramid inside the cone of friction

/// Unit wrenches of the members: per contact its normal, or with friction the edges of the pyramid about it;
/// forces, then moments about the mean of the members over the farthest one's distance from it. Columns, in
/// the frame of body A, about their mean and within the directions in which they reach at all (1e-6).
struct UnitWrenches {
  Generators g{};
  std::vector<int> first{};  // column of every member; one more, the end
};
UnitWrenches unit_wrenches(const ReductionInput& input, std::span<const int> members);

/// The least factor by which unit wrenches of `kept` have to be enlarged so that their hull with zero holds
/// those of every member; kInf if some cannot be had at all. At most 1 / (1 - loss): the part carries at
/// least 1 - loss of any wrench that all could.
double wrench_factor(const UnitWrenches& all, std::span<const int> kept);

/// Members of one body pair, as numbers among them, ascending: `start` and those that have to join it so that
/// the factor is at most 1 / (1 - loss), loss in [0, 1).
std::vector<int> wrench_cone(const UnitWrenches& all, std::vector<int> start, double loss);

}  // namespace aussois
