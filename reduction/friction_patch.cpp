// SPDX-License-Identifier: Apache-2.0
#include "reduction/friction_patch.hpp"

#include "reduction/clusters.hpp"
#include "reduction/planar_patch.hpp"

namespace aussois {

std::vector<FrictionPatch> friction_patches(const ContactSet& found, double cluster_angle, double layer) {
  std::vector<FrictionPatch> out(found.points.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i].centre = mid_point(found.points[i]);
  for (const std::vector<int>& cluster : clusters_by_angle(found, cluster_angle)) {
    const std::span<const int> closed = closed_layer(found, cluster, layer);
    if (closed.size() < 2) continue;
    const PlanarPatch patch = planar_patch(found, closed);
    const Vec3 centre = patch.origin + patch.frame.rightCols<2>() * patch.centroid;
    for (const int i : closed) out[i] = {centre, patch.drilling_radius};
  }
  return out;
}

}  // namespace aussois
