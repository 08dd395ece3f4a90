// SPDX-License-Identifier: Apache-2.0
#include "reduction/clustering.hpp"

#include <utility>

#include "geometry/settings.hpp"
#include "reduction/contact_order.hpp"
#include "reduction/mean_contacts.hpp"
#include "reduction/normal_clusters.hpp"

namespace aussois {
namespace {

constexpr Named<Clustering> kNames[] = {{Clustering::angle, "angle"},
                                        {Clustering::cube_map, "cube_map"},
                                        {Clustering::normals, "normals"},
                                        {Clustering::position_normal_friction, "position_normal_friction"},
                                        {Clustering::position_depth, "position_depth"},
                                        {Clustering::kmc, "kmc"},
                                        {Clustering::kmcw, "kmcw"}};

// Those of some contacts that the last problem had, as k-means sees them (CLU-9).
MatX centres_before(const ReductionInput& input, const std::vector<int>& members, int k) {
  if (input.kept_before.empty()) return MatX(3, 0);
  std::vector<int> before;
  for (const int i : members)
    if (input.kept_before[i]) before.push_back(i);
  MatX x(3, Eigen::Index(before.size()));
  for (std::size_t j = 0; j < before.size(); ++j)
    x.col(Eigen::Index(j)) = mid_point(input.contacts.points[before[j]]);
  return before.empty() ? x : kmeans(x, {}, {.k = k}).centres;
}

MeanContactOptions places_of(const ReductionInput& input, const std::vector<int>& members,
                             const ClusteringOptions& o) {
  switch (o.rule) {
    case Clustering::position_normal_friction:
      return {.rule = MeanRule::position_normal_friction, .k = o.k};
    case Clustering::position_depth:
      return {.rule = MeanRule::position_depth, .k = o.k};
    case Clustering::kmcw:
      return {.k = o.k, .seeding = SeedWarm{centres_before(input, members, o.k)}};
    default:
      return {.k = o.k, .seeding = SeedRandom{o.random_seed}};
  }
}

// Places do not contain normals: each group is split by normals where they would cancel (CLU-5).
Clusters clusters_by_place(const ReductionInput& input, const ClusteringOptions& o) {
  Clusters out;
  for (const std::vector<int>& members : contacts_by_pair(input.contacts)) {
    std::vector<double> mu;
    for (const int i : members) mu.push_back(input.mu.empty() ? 0 : input.mu[i]);
    const std::vector<int> label =
        mean_contacts(select(input.contacts, members), mu, {}, places_of(input, members, o)).label;
    for (const std::vector<int>& group : parts_of(members, label)) {
      const NormalClusters parted = cluster_normals(select(input.contacts, group), {.k = 1});
      for (std::vector<int>& part : parts_of(group, parted.label)) out.push_back(std::move(part));
    }
  }
  return out;
}

}  // namespace

const char* to_string(Clustering rule) {
  return name_of(rule, kNames);
}
Clustering clustering(const std::string& name) {
  return value_named(name, "clustering", kNames);
}
std::vector<std::string> clustering_names() {
  return names_of(kNames);
}

void describe(SettingVisitor& visit, ClusteringOptions& o) {
  visit.begin("ClusteringOptions");
  visit.choice({.name = "rule", .what = "rule that groups contacts into patches", .flag = "--clustering"},
               o.rule, kNames);
  visit.number(
      {"angle", "largest angle to the normal of the deepest contact", "rad", range_open_below(0, kPi / 2)},
      o.angle);
  visit.group("cube", o.cube, "cube_map");
  visit.count({.name = "k",
               .what = "number of groups per body pair",
               .unit = "",
               .range = range_from(1),
               .flag = "--clusters",
               .only_for = "not angle, cube_map"},
              o.k);
  visit.seed({.name = "random_seed", .what = "seed of the first means", .only_for = "kmc"}, o.random_seed);
}

void validate(const ClusteringOptions& options) {
  check_options(options);
}

Clusters clusters_of(const ReductionInput& input, const ClusteringOptions& options) {
  validate(options);
  return clusters_of_checked(input, options);
}

Clusters clusters_of_checked(const ReductionInput& input, const ClusteringOptions& o) {
  switch (o.rule) {
    case Clustering::angle:
      return clusters_by_angle(input.contacts, o.angle);
    case Clustering::cube_map:
      return clusters_by_normals(input.contacts, {.method = NormalClustering::cube_map, .cube = o.cube});
    case Clustering::normals:
      return clusters_by_normals(input.contacts, {.k = o.k});
    default:
      return clusters_by_place(input, o);
  }
}

}  // namespace aussois
