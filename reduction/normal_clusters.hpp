// SPDX-License-Identifier: Apache-2.0
// Groups the contacts of a body pair by similar normals, with k-means on the sphere or the cells of a cube
// map; no group holds two opposite normals (CLU-5). Source: [Moravanszky2004]; seeds, guard and order are
// ours.
#pragma once

#include "lmd/contact_point.hpp"
#include "reduction/clusters.hpp"
#include "reduction/cube_map.hpp"
#include "reduction/kmeans.hpp"

namespace aussois {

class SettingVisitor;

enum class NormalClustering { kmeans, cube_map };

/// `describe` gives the ranges, and the method that reads an option: with the other only its default is
/// taken.
struct NormalClusterOptions {
  NormalClustering method = NormalClustering::kmeans;
  CubeMapOptions cube{};
  int k = 3;
  int max_iterations = 3;          // of k-means, also where a group is split
  double merge = 5 * kPi / 180;    // centres of k-means this close are merged [rad]
  double least_resultant = 0.5;    // |sum of normals| / count below which a group is split
  double widest = 60 * kPi / 180;  // largest normal-to-centre angle without a split [rad]
};
void validate(const NormalClusterOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, NormalClusterOptions& options);

struct NormalClusters {
  std::vector<int> label{};    // group of each contact
  std::vector<Vec3> centre{};  // of each group, unit, world; no group is empty
  int splits = 0;              // splits that the guard made; with any, there may be more than k groups
  int iterations = 0;          // of k-means
  bool converged = true;       // k-means came to rest
};

/// Does not depend on the order of the contacts. `previous`: earlier centres of the same pair, in the world.
/// Keep them in A's frame from step to step and turn them with A; then groups keep their places in the list.
/// Throws std::invalid_argument if a normal does not have unit length (1e-6), a gap is not finite, or the
/// contacts are of more than one pair.
NormalClusters cluster_normals(const ContactSet& contacts, const NormalClusterOptions& options = {},
                               const std::vector<Vec3>& previous = {});

/// The same for any number of pairs, each by itself, in the form that reducers take: the deepest contact of
/// each group first. Unlike clusters by angle to a seed, a group may be as wide as
/// NormalClusterOptions::widest allows.
Clusters clusters_by_normals(const ContactSet& contacts, const NormalClusterOptions& options = {});

}  // namespace aussois
