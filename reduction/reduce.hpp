// SPDX-License-Identifier: Apache-2.0
// Fewer contacts that can still carry the same loads (RED-1) to (RED-4): contacts of one body pair are
// clustered by normal, and of each cluster the extreme points and the deepest one are kept.
// Source of the extremes: [Moravanszky2004]; the tie rule and the layer are ours.
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
  double cluster_angle = 0.1;  // largest angle of a normal to that of its seed [rad], in (0, pi/2]; taste
  int min_per_cluster = 4;     // sets of at most this size are kept whole, >= 1
  double tie = 1e-3;    // extremes within this fraction of the cluster's extent are tied, in [0, 0.1]; larger
                        // than the flatness of real meshes, or noise chooses the corners
  double layer = 1e-5;  // contacts within this of the deepest keep extremes of their own [m], >= 0; taste
};
void validate(const ReductionOptions& options);  // throws std::invalid_argument: field, value, bound

/// What a reduction kept.
struct Selection {
  std::vector<int> kept{};     // indices into the set, ascending
  std::vector<int> cluster{};  // cluster of every contact of the set
  int cluster_count = 0;
};

/// A pure function of the set, whatever its order, and the options; kept contacts are neither moved nor
/// merged. Throws std::invalid_argument naming the contact if a point or gap is not finite or a normal not of
/// unit length (1e-6).
Selection reduce(const ContactSet& found, const ReductionOptions& options = {});

/// The kept contacts, in order. Throws std::invalid_argument if an index is out of range.
ContactSet select(const ContactSet& found, const std::vector<int>& kept);

/// The worst over all clusters of what the kept contacts lost against the full set (RED-7).
struct LossReport {
  double margin = 1;  // least ratio of the support functions about the centroid; 1: nothing lost, <= 0:
                      // centroid unsupported
  double area = 1;    // least ratio of the hull areas, in [0, 1]; clusters without area do not count
};
/// `selection` as returned by reduce() for the same set, or any subset of it with the same clusters.
LossReport measure_loss(const ContactSet& found, const Selection& selection);

}  // namespace aussois
