// SPDX-License-Identifier: Apache-2.0
#include "reduction/reduce.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "geometry/settings.hpp"
#include "reduction/contact_order.hpp"
#include "reduction/direction_set.hpp"
#include "reduction/extreme_points.hpp"
#include "reduction/hull_area_loss.hpp"
#include "reduction/hull_exact.hpp"
#include "reduction/load_carrier.hpp"
#include "reduction/wrench_cone.hpp"

namespace aussois {
namespace {

constexpr Named<Reducer> kNames[] = {{Reducer::none, "none"},
                                     {Reducer::extreme_points, "extreme_points"},
                                     {Reducer::hull_exact, "hull_exact"},
                                     {Reducer::hull_area_loss, "hull_area_loss"},
                                     {Reducer::hull_margin, "hull_margin"},
                                     {Reducer::direction_set, "direction_set"},
                                     {Reducer::wrench_cone, "wrench_cone"},
                                     {Reducer::load_carrier, "load_carrier"},
                                     {Reducer::selector, "selector"}};

constexpr Named<FrictionAt> kPlaces[] = {{FrictionAt::contacts, "contacts"},
                                         {FrictionAt::patches, "patches"}};

constexpr double kSameGap = 1e-12;  // fraction of the extent by which rounding tells gaps apart

void check(const ReductionInput& input) {
  const std::vector<ContactPoint>& points = input.contacts.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContactPoint& c = points[i];
    const bool finite = c.x_a.allFinite() && c.x_b.allFinite() && std::isfinite(c.gap);
    if (finite && std::abs(c.normal.norm() - 1) <= 1e-6) continue;
    throw std::invalid_argument(
        "contact " + std::to_string(i) +
        (finite ? ": the normal must have unit length (within 1e-6)" : ": points and gap must be finite"));
  }
  for (const auto& [field, size] : {std::pair{"kept_before", input.kept_before.size()},
                                    {"impulse", input.impulse.size()},
                                    {"mu", input.mu.size()}})
    if (size != 0 && size != points.size())
      throw std::invalid_argument(std::string("ReductionInput::") + field + ": " + std::to_string(size) +
                                  " entries for " + std::to_string(points.size()) + " contacts");
  if (input.g.empty()) return;
  for (const ContactPoint& c : points)
    for (const BodyId body : {c.a.body, c.b.body})
      if (!body || body.index() >= int(input.g.size()))
        throw std::invalid_argument("ReductionInput::g: " + std::to_string(input.g.size()) +
                                    " poses for a contact of body " + to_string(body));
}

std::vector<int> at(std::span<const int> members, const std::vector<int>& chosen) {
  std::vector<int> out;
  for (const int k : chosen) out.push_back(members[k]);
  return out;
}

// Members whose contact is marked, as numbers in the cluster.
std::vector<int> marked(std::span<const int> cluster, const std::vector<char>& mark) {
  std::vector<int> out;
  for (std::size_t k = 0; k < cluster.size(); ++k)
    if (mark[cluster[k]]) out.push_back(int(k));
  return out;
}

// Normal impulses of the members in the last step; empty: not known.
std::vector<double> loads(const ReductionInput& input, std::span<const int> members) {
  std::vector<double> out;
  if (input.impulse.empty()) return out;
  for (const int i : members) out.push_back(input.impulse[i].dot(input.contacts.points[i].normal));
  return out;
}

// A reducer of one plane, without memory; other reducers do not come here.
std::vector<int> fresh_choice(const ReductionInput& input, std::span<const int> members,
                              const PlanarPatch& patch, const ReductionOptions& o) {
  switch (o.reducer) {
    case Reducer::hull_exact:
      return hull_exact(patch);
    case Reducer::hull_area_loss:
      return hull_area_loss(patch, o.corners);
    case Reducer::hull_margin:
      return hull_margin(patch, o.hull_margin);
    case Reducer::direction_set:
      return direction_set(patch, o.directions, o.tie);
    case Reducer::load_carrier:
      return load_carrier(patch, loads(input, members));
    default:
      return extreme_points(patch, o.tie, o.paper_exact);
  }
}

// How many corners a reducer with a choice may keep; 0: it has no choice, or a memory of its own.
std::size_t most_corners(const ReductionOptions& o) {
  switch (o.reducer) {
    case Reducer::extreme_points:
      return o.paper_exact ? 0 : 4;
    case Reducer::hull_area_loss:
      return std::size_t(o.corners);
    case Reducer::hull_margin:
      return std::size_t(o.hull_margin.max_corners);
    case Reducer::direction_set:
      return std::size_t(o.directions);
    default:
      return 0;
  }
}

// The corners among what was kept in the last step; a new choice among them if the solver had to add many.
std::vector<int> old_choice(const ReductionInput& input, std::span<const int> members,
                            const PlanarPatch& patch, const ReductionOptions& o) {
  std::vector<int> old = hull_of(patch, marked(members, input.kept_before));
  if (old.size() <= most_corners(o) + 1) return old;  // the deepest may be one more
  std::vector<Vec2> x;
  for (const int k : old) x.push_back(patch.x[k]);
  return at(old, fresh_choice(input, at(members, old), planar_patch(std::move(x)), o));
}

// Whether it stays (RED-14): about as few, not worse by more than the hysteresis, and no required margin
// lost.
bool stays(const PlanarPatch& patch, const std::vector<int>& old, const std::vector<int>& fresh,
           const ReductionOptions& o) {
  if (old.empty() || old.size() > fresh.size() + 1) return false;
  if (o.reducer == Reducer::hull_area_loss)
    return loss_of(patch, old).area * (1 + o.hysteresis) >= loss_of(patch, fresh).area;
  const double was = margin_of(patch, old).value, now = margin_of(patch, fresh).value;
  const double promised = o.reducer == Reducer::hull_margin ? o.hull_margin.margin : -kInf;
  return was * (1 + o.hysteresis) >= now && was >= std::min(promised, now);
}

// At one place lie contacts of other normals, each of which holds the others up: the deepest stands for all
// (RED-16), of as deep ones what was kept in the last step.
std::vector<int> deepest_there(const ReductionInput& input, std::span<const int> members,
                               const PlanarPatch& patch, std::vector<int> chosen, const ReductionOptions& o) {
  const bool remembers = o.hysteresis > 0 && !input.kept_before.empty();
  const auto contact = [&](int k) { return std::size_t(members[k]); };
  const double near = o.tie * patch.extent, same = kSameGap * patch.extent;
  for (int& k : chosen) {
    const Vec2 place = patch.x[k];
    for (int i = 0; i < int(members.size()); ++i) {
      if (i == k || (patch.x[i] - place).norm() > near) continue;
      const double deeper = input.contacts.points[contact(k)].gap - input.contacts.points[contact(i)].gap;
      const bool kept = remembers && input.kept_before[contact(i)] && !input.kept_before[contact(k)];
      if (deeper > same || (deeper >= -same && kept)) k = i;
    }
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

// The patches of the clusters, each made when it is first asked for.
class Patches {
 public:
  Patches(const ReductionInput& input, const Clusters& clusters)
      : input_(input), clusters_(clusters), patches_(clusters.size()) {}
  const PlanarPatch& of(std::size_t cluster) {
    std::optional<PlanarPatch>& patch = patches_[cluster];
    if (!patch) patch = planar_patch(input_.contacts, clusters_[cluster], input_.g);
    return *patch;
  }

 private:
  const ReductionInput& input_;
  const Clusters& clusters_;
  std::vector<std::optional<PlanarPatch>> patches_;
};

// What the reducer chooses of more members than are kept whole: of one cluster, or of its closed layer.
std::vector<int> chosen_of(const ReductionInput& input, std::span<const int> members,
                           const PlanarPatch& patch, const ReductionOptions& options) {
  const std::vector<int> fresh = fresh_choice(input, members, patch, options);
  if (options.hysteresis > 0 && most_corners(options) > 0 && !input.kept_before.empty()) {
    const std::vector<int> old = old_choice(input, members, patch, options);
    if (stays(patch, old, fresh, options))
      return at(members, deepest_there(input, members, patch, old, options));
  }
  return at(members, options.paper_exact ? fresh : deepest_there(input, members, patch, fresh, options));
}

// Of all members of cluster k and of its closed layer (RED-4).
void add_chosen(const ReductionInput& input, const Clusters& clusters, std::size_t k, Patches& patches,
                const ReductionOptions& options, std::vector<int>& kept) {
  const std::vector<int>& cluster = clusters[k];
  const auto add = [&](std::span<const int> some) { kept.insert(kept.end(), some.begin(), some.end()); };
  if (int(cluster.size()) <= options.min_per_cluster) return add(cluster);
  add(chosen_of(input, cluster, patches.of(k), options));
  const std::span<const int> closed = closed_layer(input.contacts, cluster, options.layer);
  if (closed.size() == cluster.size()) return;
  if (int(closed.size()) <= options.min_per_cluster) return add(closed);
  add(chosen_of(input, closed, planar_patch(input.contacts, closed, input.g), options));
}

// Of all clusters of one body pair together, beginning with their extremes (RED-12).
std::vector<int> chosen_by_wrench(const ReductionInput& input, std::span<const std::vector<int>> clusters,
                                  const ReductionOptions& options) {
  std::vector<int> members, start;
  for (const std::vector<int>& cluster : clusters) {
    const int first = int(members.size());
    start.push_back(first);
    if (int(cluster.size()) > options.min_per_cluster)
      for (const int k : extreme_points(planar_patch(input.contacts, cluster, input.g), options.tie))
        start.push_back(first + k);
    members.insert(members.end(), cluster.begin(), cluster.end());
  }
  std::sort(start.begin(), start.end());
  start.erase(std::unique(start.begin(), start.end()), start.end());
  if (int(members.size()) <= options.min_per_cluster) return members;
  return at(members, wrench_cone(unit_wrenches(input, members), start, options.wrench_loss));
}

// The clusters of one body pair after those of the other.
std::vector<int> chosen_by_wrenches(const ReductionInput& input, const Clusters& clusters,
                                    const ReductionOptions& options) {
  const auto first = [&](const std::vector<int>& cluster) -> const ContactPoint& {
    return input.contacts.points[cluster.front()];
  };
  const auto of_one_pair = [&](const auto& a, const auto& b) { return same_pair(first(a), first(b)); };
  std::vector<int> kept;
  for (const std::span<const std::vector<int>> pair : runs_of(std::span(clusters), of_one_pair)) {
    const std::vector<int> chosen = chosen_by_wrench(input, pair, options);
    kept.insert(kept.end(), chosen.begin(), chosen.end());
  }
  return kept;
}

std::vector<int> chosen_by_selector(const ReductionInput& input, const Clusters& clusters,
                                    const ReductionOptions& options) {
  std::vector<int> kept = options.selector(input, clusters);
  for (const int i : kept)
    require(i >= 0 && std::size_t(i) < input.contacts.points.size(),
            "ReductionOptions::selector: contact " + std::to_string(i) + " must lie in [0, " +
                std::to_string(input.contacts.points.size()) + ")");
  return kept;
}

// Adds corners until the margin is met, and returns what the cluster loses then (RED-7).
LossReport complete(const ContactSet& found, const Clusters& clusters, std::size_t k, Patches& patches,
                    double min_margin, std::vector<char>& mark) {
  const std::vector<int>& cluster = clusters[k];
  if (std::ranges::all_of(cluster, [&](int i) { return mark[i] != 0; })) return {};
  std::vector<int> part = marked(cluster, mark);
  const PlanarPatch& patch = patches.of(k);
  for (std::size_t n = 0; min_margin > 0 && n < patch.hull.size(); ++n) {
    const Margin margin = margin_of(patch, part);
    if (margin.value >= min_margin - kSamePlace) break;
    const int more =
        extreme_member(patch, margin.direction, Vec2(-margin.direction.y(), margin.direction.x()),
                       kSamePlace * patch.extent);
    part.push_back(more);
    mark[cluster[more]] = 1;
  }
  LossReport loss = loss_of(patch, part);
  double deepest = kInf;
  for (const int i : part) deepest = std::min(deepest, found.points[cluster[i]].gap);
  loss.depth = deepest - found.points[cluster.front()].gap;
  return loss;
}

}  // namespace

const char* to_string(Reducer reducer) {
  return name_of(reducer, kNames);
}
Reducer reducer(const std::string& name) {
  return value_named(name, "reducer", kNames);
}
std::vector<std::string> reducer_names() {
  return names_of(kNames);
}

void describe(SettingVisitor& visit, HullMargin& o) {
  visit.begin("HullMargin");
  visit.number({"margin", "margin to keep", "-", range_open_below(0, 1)}, o.margin);
  visit.count({"min_corners", "minimum number of corners to keep, if there are that many", "", range_from(3)},
              o.min_corners);
  visit.count({"max_corners", "maximum number of corners to keep", "", range_from(4)}, o.max_corners);
}

void describe(SettingVisitor& visit, ReductionOptions& o) {
  visit.begin("ReductionOptions");
  visit.choice({.name = "reducer",
                .what = "rule that selects the contacts of a patch with which the solver begins",
                .flag = "--reducer"},
               o.reducer, kNames);
  visit.group("clustering", o.clustering);
  visit.count({.name = "min_per_cluster",
               .what = "size up to which sets of contacts are kept whole",
               .unit = "",
               .range = range_from(1),
               .only_for = "not none, selector"},
              o.min_per_cluster);
  visit.number(
      {"layer", "distance from the deepest contact within which contacts are also reduced on their own", "m",
       range_from(0)},
      o.layer);
  visit.number({.name = "min_margin",
                .what = "add contacts until every patch keeps this margin of its support; 0: add none",
                .unit = "-",
                .range = {0, 1},
                .flag = "--min-margin",
                .only_for = "not none"},
               o.min_margin);
  visit.number({.name = "hysteresis",
                .what = "fraction by which other corners must be better to replace those of the last step",
                .range = range_open_above(0, 1),
                .only_for = "not none, selector, wrench_cone"},
               o.hysteresis);
  visit.number({.name = "tie",
                .what = "fraction of the extent within which extremes are tied",
                .range = {0, 0.1},
                .only_for = "not none, selector"},
               o.tie);
  visit.toggle({.name = "paper_exact", .what = "choose points as published", .only_for = "extreme_points"},
               o.paper_exact);
  visit.group("hull_margin", o.hull_margin, "hull_margin");
  visit.count({.name = "corners",
               .what = "number of corners to keep",
               .unit = "",
               .range = range_from(3),
               .only_for = "hull_area_loss"},
              o.corners);
  visit.count({.name = "directions",
               .what = "number of directions",
               .unit = "",
               .range = range_from(3),
               .only_for = "direction_set"},
              o.directions);
  visit.number({.name = "wrench_loss",
                .what = "largest fraction of a wrench that may be lost",
                .range = range_open_above(0, 1),
                .only_for = "wrench_cone"},
               o.wrench_loss);
  visit.choice({.name = "friction",
                .what = "apply friction at the centre of each patch, with its drilling torque",
                .flag = "--patch-friction=patches"},
               o.friction, kPlaces);
}

void validate(const ReductionOptions& options) {
  check_options(options);
  const ReductionOptions usual;
  require(options.clustering.rule == Clustering::angle || options.friction == FrictionAt::patches ||
              options.clustering.angle == usual.clustering.angle,
          "ClusteringOptions::angle = " + number_text(options.clustering.angle) + " is not read by " +
              to_string(options.clustering.rule) + ", only by angle and by friction at patches");
  require(!options.paper_exact || (options.tie == usual.tie && options.hysteresis == usual.hysteresis),
          "ReductionOptions::tie and hysteresis are not read with paper_exact");
  require_field(options.hull_margin.max_corners >= options.hull_margin.min_corners, "HullMargin::max_corners",
                options.hull_margin.max_corners, "be at least min_corners");
  if ((options.reducer == Reducer::selector) != bool(options.selector))
    require(false, std::string("ReductionOptions::selector must be ") +
                       (options.selector ? "empty" : "given") + " with reducer " +
                       to_string(options.reducer));
}

Selection reduce(const ReductionInput& input, const ReductionOptions& options) {
  validate(options);
  check(input);
  const Clusters clusters = clusters_of_checked(input, options.clustering);
  Patches patches(input, clusters);
  std::vector<int> kept;
  if (options.reducer == Reducer::none) {
    kept.resize(input.contacts.points.size());
    std::iota(kept.begin(), kept.end(), 0);
  } else if (options.reducer == Reducer::selector) {
    kept = chosen_by_selector(input, clusters, options);
  } else if (options.reducer == Reducer::wrench_cone) {
    kept = chosen_by_wrenches(input, clusters, options);
  } else {
    for (std::size_t k = 0; k < clusters.size(); ++k) add_chosen(input, clusters, k, patches, options, kept);
  }

  Selection out;
  out.cluster.resize(input.contacts.points.size());
  out.cluster_count = int(clusters.size());
  std::vector<char> mark(out.cluster.size(), 0);
  for (const int i : kept) mark[i] = 1;
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    for (const int i : clusters[k]) out.cluster[i] = int(k);
    mark[clusters[k].front()] = 1;  // the deepest, always
    out.loss = worst_loss(out.loss, complete(input.contacts, clusters, k, patches, options.min_margin, mark));
  }
  for (std::size_t i = 0; i < mark.size(); ++i)
    if (mark[i]) out.kept.push_back(int(i));
  return out;
}

Selection reduce(const ContactSet& found, const ReductionOptions& options) {
  return reduce(ReductionInput{.contacts = found}, options);
}

LossReport measure_loss(const ContactSet& found, const Selection& selection) {
  require(selection.cluster.size() == found.points.size(),
          "measure_loss: the selection belongs to another set");
  Clusters clusters(selection.cluster_count);
  for (std::size_t i = 0; i < found.points.size(); ++i) clusters[selection.cluster[i]].push_back(int(i));
  std::vector<char> mark(found.points.size(), 0);
  for (const int i : selection.kept) mark[i] = 1;
  const ReductionInput input{.contacts = found};
  Patches patches(input, clusters);
  LossReport loss;
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    std::vector<int>& cluster = clusters[k];
    if (cluster.empty()) continue;
    std::swap(cluster.front(), *std::min_element(cluster.begin(), cluster.end(), [&](int i, int j) {
                return found.points[i].gap < found.points[j].gap;
              }));
    loss = worst_loss(loss, complete(found, clusters, k, patches, 0, mark));
  }
  return loss;
}

}  // namespace aussois
