// SPDX-License-Identifier: Apache-2.0
// Contacts of one body pair in groups of similar normals, by k-means on the sphere or by the cells of a cube
// map, and never two opposite ones in a group (CLU-5). Source: [Moravanszky2004]; seeds, guard and order are
// ours.
#pragma once

#include "lmd/contact_point.hpp"
#include "reduction/clusters.hpp"
#include "reduction/cube_map.hpp"
#include "reduction/kmeans.hpp"

namespace aussois {

enum class NormalClustering { kmeans, cube_map };

struct NormalClusterOptions {
  NormalClustering method = NormalClustering::kmeans;
  CubeMapOptions cube{};
  int k = 3;                       // of k-means, >= 1
  int max_iterations = 3;          // of k-means, >= 1
  double merge = 5 * kPi / 180;    // centres of k-means this close are one [rad], in [0, pi/2)
  double least_resultant = 0.5;    // |sum of normals| / count below which a group is split, in [0, 1]
  double widest = 60 * kPi / 180;  // angle of a normal to its centre above which it is, in (0, pi/2] [rad]
};
void validate(const NormalClusterOptions& options);  // throws std::invalid_argument: field, value, bound

struct NormalClusters {
  std::vector<int> label{};    // of each contact
  std::vector<Vec3> centre{};  // of each group, unit, world; none is empty
  int splits = 0;              // that the guard asked for; then there may be more than k groups
  int iterations = 0;          // of k-means
  bool converged = true;       // k-means had come to rest
};

/// A function of the contacts whatever their order. `previous`: centres of the same pair, in the world; keep
/// them in A's frame from step to step and turn them with A; groups keep their places in the list then.
/// Throws std::invalid_argument if a normal is not of unit length (1e-6), a gap not finite, or the contacts
/// are of more than one pair.
NormalClusters cluster_normals(const ContactSet& contacts, const NormalClusterOptions& options = {},
                               const std::vector<Vec3>& previous = {});

/// The same for any number of pairs, each for itself, as reducers take them: the deepest contact of each
/// group first. Unlike by angle to a seed, a group may be as wide as NormalClusterOptions::widest allows.
Clusters clusters_by_normals(const ContactSet& contacts, const NormalClusterOptions& options = {});

}  // namespace aussois
