// SPDX-License-Identifier: Apache-2.0
// How the contacts of a body pair are put into groups, each of which is reduced by itself: the rule of the
// step (RED-2), or one of the clusterings of other works, (CLU-1) to (CLU-9), whose groups never hold normals
// that would cancel (CLU-5).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reduction/clusters.hpp"
#include "reduction/cube_map.hpp"
#include "reduction/selection.hpp"

namespace aussois {

enum class Clustering {
  angle,                     // to the normal of the deepest contact (RED-2)
  cube_map,                  // cells of a cube that normals point to (CLU-1) [Moravanszky2004]
  normals,                   // k-means of normals (CLU-3) [Moravanszky2004]
  position_normal_friction,  // k-means in seven dimensions (CLU-6) [Hauser2013]
  position_depth,            // k-means of positions, weighted by depth (CLU-7) [Kim2003]
  kmc,                       // k-means of positions from random seeds [Kim2019]
  kmcw,                      // the same from where the last problem had its contacts (CLU-9)
};
const char* to_string(Clustering rule);
/// By its name; throws std::invalid_argument naming all of them.
Clustering clustering(const std::string& name);
std::vector<std::string> clustering_names();

struct ClusteringOptions {
  Clustering rule = Clustering::angle;
  double angle = 0.1;             // largest one of a normal to that of its seed [rad], in (0, pi/2]; taste
  CubeMapOptions cube{};          // of cube_map
  int k = 3;                      // of k-means, groups per body pair before normals part them, >= 1
  std::uint64_t random_seed = 0;  // of kmc
};
void validate(const ClusteringOptions& options);  // throws std::invalid_argument: field, value, bound

/// A function of the input, whatever the order of its contacts. Bodies, impulses and h are not looked at.
Clusters clusters_of(const ReductionInput& input, const ClusteringOptions& options);

}  // namespace aussois
