// SPDX-License-Identifier: Apache-2.0
// Fewer contacts that can still carry the same loads (RED-1) to (RED-4): contacts of one body pair are clustered by
// normal, and of each cluster the extreme points and the deepest one are kept.
// Sources: Moravanszky and Terdiman 2004 for the extremes; the tie rule is ours.
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

enum class Reducer {
  none,            // keeps everything
  extreme_points,  // four extremes along two in-plane axes and the deepest, with the tie rule (RED-3)
};

struct ReductionOptions {
  Reducer reducer = Reducer::extreme_points;
  double cluster_angle = 0.1;  // contacts whose normals differ by less belong together [rad], in (0, pi/2]
  int min_per_cluster = 4;     // clusters of at most this size are kept whole, >= 1
  double tie = 1e-9;           // extremes within this fraction of the cluster's extent are tied, in [0, 0.1]
};
void validate(const ReductionOptions& options);  // throws std::invalid_argument: field, value, bound

/// What a reduction kept and lost.
struct Selection {
  std::vector<int> kept{};     // indices into the set, ascending
  std::vector<int> cluster{};  // cluster of every contact of the set
  int cluster_count = 0;
};

/// A pure function of the set and the options; kept contacts are neither moved nor merged.
Selection reduce(const ContactSet& found, const ReductionOptions& options = {});

/// The kept contacts, in order.
ContactSet select(const ContactSet& found, const std::vector<int>& kept);

}  // namespace aussois
