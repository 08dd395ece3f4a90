// SPDX-License-Identifier: Apache-2.0
// How the contacts of a body pair are grouped; each group is reduced by itself. The rule is that of the step
// (RED-2) or a clustering from other works, (CLU-1) to (CLU-9). Groups of the latter never hold normals that
// would cancel (CLU-5).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reduction/clusters.hpp"
#include "reduction/cube_map.hpp"
#include "reduction/selection.hpp"

namespace aussois {

class SettingVisitor;

enum class Clustering {
  angle,                     // by angle to the normal of the deepest contact (RED-2)
  cube_map,                  // by the cell of a cube that the normal points to (CLU-1) [Moravanszky2004]
  normals,                   // k-means of normals (CLU-3) [Moravanszky2004]
  position_normal_friction,  // k-means in seven dimensions (CLU-6) [Hauser2013]
  position_depth,            // k-means of positions, weighted by depth (CLU-7) [Kim2003]
  kmc,                       // k-means of positions from random seeds [Kim2019]
  kmcw,                      // the same, seeded where the last problem had its contacts (CLU-9)
};
const char* to_string(Clustering rule);
/// The rule with this name; throws std::invalid_argument listing all names.
Clustering clustering(const std::string& name);
std::vector<std::string> clustering_names();

/// `describe` gives the ranges, and the rules that read an option: with others only its default is taken.
struct ClusteringOptions {
  Clustering rule = Clustering::angle;
  double angle =
      0.1;  // largest angle to the seed's normal, also in a patch of friction [rad]; a matter of taste
  CubeMapOptions cube{};
  int k = 3;  // of k-means: groups per body pair before they are split by normals
  std::uint64_t random_seed = 0;
};
void validate(const ClusteringOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, ClusteringOptions& options);

/// Depends on the input only, not on the order of its contacts. Bodies, impulses and h are ignored.
Clusters clusters_of(const ReductionInput& input, const ClusteringOptions& options);
/// The same for options that have been validated.
Clusters clusters_of_checked(const ReductionInput& input, const ClusteringOptions& options);

}  // namespace aussois
