// SPDX-License-Identifier: Apache-2.0
#include "reduction/normal_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/settings.hpp"
#include "reduction/contact_order.hpp"
#include "reduction/selection.hpp"

namespace aussois {
namespace {

constexpr Named<NormalClustering> kMethods[] = {{NormalClustering::kmeans, "kmeans"},
                                                {NormalClustering::cube_map, "cube_map"}};

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

MatX columns(const std::vector<Vec3>& x) {
  MatX out(3, Eigen::Index(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) out.col(Eigen::Index(i)) = x[i];
  return out;
}

struct Group {
  std::vector<int> members{};  // ascending
  Vec3 centre = Vec3::UnitZ();
};

std::vector<Group> groups_of(const std::vector<int>& label, int count) {
  std::vector<Group> out{std::size_t(count)};
  for (std::size_t i = 0; i < label.size(); ++i) out[label[i]].members.push_back(int(i));
  return out;
}

// While two centres are close, the closest two become one, at the place of the first.
void merge_close(std::vector<Group>& groups, double within) {
  for (;;) {
    std::size_t first = 0, second = 0;
    double least = within;
    for (std::size_t i = 0; i < groups.size(); ++i)
      for (std::size_t j = i + 1; j < groups.size(); ++j)
        if (const double a = angle(groups[i].centre, groups[j].centre); a <= least)
          if (second == 0 || a < least) least = a, first = i, second = j;
    if (second == 0) return;
    Group &a = groups[first], &b = groups[second];
    a.centre = (double(a.members.size()) * a.centre + double(b.members.size()) * b.centre).normalized();
    a.members.insert(a.members.end(), b.members.begin(), b.members.end());
    std::sort(a.members.begin(), a.members.end());
    groups.erase(groups.begin() + std::ptrdiff_t(second));
  }
}

// Normals that would cancel are not of one group (CLU-5).
bool is_torn(const Group& group, const std::vector<Vec3>& normals, const NormalClusterOptions& o) {
  Vec3 sum = Vec3::Zero();
  for (const int i : group.members) sum += normals[i];
  if (sum.norm() < o.least_resultant * double(group.members.size())) return true;
  return std::ranges::any_of(group.members,
                             [&](int i) { return angle(normals[i], group.centre) > o.widest; });
}

// The torn ones in two each; parts of parts are looked at again, they stand at the end.
int split_torn(std::vector<Group>& groups, const std::vector<Vec3>& normals, const NormalClusterOptions& o) {
  int splits = 0;
  for (std::size_t g = 0; g < groups.size();) {
    if (!is_torn(groups[g], normals, o)) {
      ++g;
      continue;
    }
    std::vector<Vec3> own;
    for (const int i : groups[g].members) own.push_back(normals[i]);
    const KMeans halves =
        kmeans(columns(own), {}, {.k = 2, .max_iterations = o.max_iterations, .on_sphere = true});
    if (halves.centres.cols() < 2 || halves.count[0] == 0 || halves.count[1] == 0) {  // all of one normal,
      groups[g].centre = own[0];  // far from a stale centre
      ++g;
      continue;
    }
    ++splits;
    std::vector<Group> parts(2);
    for (std::size_t i = 0; i < own.size(); ++i)
      parts[halves.label[i]].members.push_back(groups[g].members[i]);
    for (std::size_t p = 0; p < 2; ++p) parts[p].centre = halves.centres.col(Eigen::Index(p));
    groups[g] = parts[0];
    groups.push_back(parts[1]);
  }
  return splits;
}

}  // namespace

void describe(SettingVisitor& visit, NormalClusterOptions& o) {
  visit.begin("NormalClusterOptions");
  visit.choice({"method", "k-means or the cells of a cube"}, o.method, kMethods);
  visit.group("cube", o.cube, "cube_map");
  visit.count(
      {.name = "k", .what = "number of groups", .unit = "", .range = range_from(1), .only_for = "kmeans"},
      o.k);
  visit.count({"max_iterations", "iterations of k-means", "", range_from(1)}, o.max_iterations);
  visit.number({.name = "merge",
                .what = "angle between centres up to which groups are merged",
                .unit = "rad",
                .range = range_open_above(0, kPi / 2),
                .only_for = "kmeans"},
               o.merge);
  visit.number({"least_resultant", "mean length below which a group is split", "-", {0, 1}},
               o.least_resultant);
  visit.number(
      {"widest", "largest angle between a normal and its centre", "rad", range_open_below(0, kPi / 2)},
      o.widest);
}

void validate(const NormalClusterOptions& options) {
  check_options(options);
}

NormalClusters cluster_normals(const ContactSet& contacts, const NormalClusterOptions& options,
                               const std::vector<Vec3>& previous) {
  validate(options);
  const std::vector<ContactPoint>& c = contacts.points;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const std::string name = "cluster_normals: contact " + std::to_string(i);
    require(std::abs(c[i].normal.norm() - 1) <= 1e-6, name + ": the normal must have unit length (1e-6)");
    require(std::isfinite(c[i].gap), name + ": the gap must be finite");
    require(c[i].a.body == c[0].a.body && c[i].b.body == c[0].b.body, name + " is of another pair");
  }
  NormalClusters out{.label = std::vector<int>(c.size())};
  if (c.empty()) return out;
  const std::vector<int> order = canonical_order(contacts);  // the deepest is the first seed
  std::vector<Vec3> normals;
  for (const int i : order) normals.push_back(c[i].normal);

  std::vector<Group> groups;
  if (options.method == NormalClustering::cube_map) {
    const CubeMap cells = cube_map(normals, options.cube);
    groups = groups_of(cells.label, cells.groups);
    for (Group& g : groups) {
      Vec3 sum = Vec3::Zero();
      for (const int i : g.members) sum += normals[i];
      g.centre = sum.norm() > 0 ? Vec3(sum.normalized()) : normals[g.members[0]];
    }
  } else {
    KMeansOptions k{.k = options.k, .max_iterations = options.max_iterations, .on_sphere = true};
    if (!previous.empty()) k.seeding = SeedWarm{columns(previous)};
    const KMeans found = kmeans(columns(normals), {}, k);
    out.iterations = found.iterations;
    out.converged = found.converged;
    groups = groups_of(found.label, int(found.centres.cols()));
    for (std::size_t g = 0; g < groups.size(); ++g) groups[g].centre = found.centres.col(Eigen::Index(g));
    std::erase_if(groups, [](const Group& g) { return g.members.empty(); });
    merge_close(groups, options.merge);
  }
  out.splits = split_torn(groups, normals, options);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    out.centre.push_back(groups[g].centre);
    for (const int i : groups[g].members) out.label[order[i]] = int(g);
  }
  return out;
}

Clusters clusters_by_normals(const ContactSet& contacts, const NormalClusterOptions& options) {
  Clusters out;
  for (const std::vector<int>& pair : contacts_by_pair(contacts))
    for (std::vector<int>& part : parts_of(pair, cluster_normals(select(contacts, pair), options).label))
      out.push_back(std::move(part));
  return out;
}

}  // namespace aussois
