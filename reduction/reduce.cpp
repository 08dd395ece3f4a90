// SPDX-License-Identifier: Apache-2.0
#include "reduction/reduce.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/check.hpp"
#include "reduction/extreme_points.hpp"

namespace aussois {
namespace {

constexpr std::pair<Reducer, const char*> kNames[] = {
    {Reducer::none, "none"}, {Reducer::extreme_points, "extreme_points"}, {Reducer::selector, "selector"}};

void check(const ReductionInput& input) {
  const std::vector<ContactPoint>& points = input.contacts.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContactPoint& c = points[i];
    const std::string name = "contact " + std::to_string(i);
    require(c.x_a.allFinite() && c.x_b.allFinite() && std::isfinite(c.gap),
            name + ": points and gap must be finite");
    require(std::abs(c.normal.norm() - 1) <= 1e-6, name + ": the normal must have unit length (within 1e-6)");
  }
  for (const auto& [field, size] : {std::pair{"kept_before", input.kept_before.size()},
                                    {"impulse", input.impulse.size()},
                                    {"mu", input.mu.size()}})
    require(size == 0 || size == points.size(), std::string("ReductionInput::") + field + ": " +
                                                    std::to_string(size) + " entries for " +
                                                    std::to_string(points.size()) + " contacts");
}

std::vector<int> at(std::span<const int> members, const std::vector<int>& chosen) {
  std::vector<int> out;
  for (const int k : chosen) out.push_back(members[std::size_t(k)]);
  return out;
}

// What the reducer says of one cluster, or of its closed layer.
std::vector<int> chosen_of(const ReductionInput& input, std::span<const int> members,
                           const ReductionOptions& options) {
  if (int(members.size()) <= options.min_per_cluster) return {members.begin(), members.end()};
  return at(members, extreme_points(planar_patch(input.contacts, members), options.tie, options.paper_exact));
}

// Of all members and of the closed layer (RED-4).
void add_chosen(const ReductionInput& input, const std::vector<int>& cluster, const ReductionOptions& options,
                std::vector<int>& kept) {
  const auto gap = [&](int i) { return input.contacts.points[std::size_t(i)].gap; };
  const auto open = std::find_if(cluster.begin(), cluster.end(),
                                 [&](int i) { return gap(i) > gap(cluster.front()) + options.layer; });
  const std::vector<int> all = chosen_of(input, cluster, options);
  kept.insert(kept.end(), all.begin(), all.end());
  if (open == cluster.end()) return;
  const std::vector<int> layer = chosen_of(input, {cluster.begin(), open}, options);
  kept.insert(kept.end(), layer.begin(), layer.end());
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

// Members whose contact is marked, as numbers in the cluster.
std::vector<int> marked(const std::vector<int>& cluster, const std::vector<char>& mark) {
  std::vector<int> out;
  for (std::size_t k = 0; k < cluster.size(); ++k)
    if (mark[std::size_t(cluster[k])]) out.push_back(int(k));
  return out;
}

// Adds corners until the margin is met, and says what the cluster loses then (RED-7).
LossReport complete(const ContactSet& found, const std::vector<int>& cluster, double min_margin,
                    std::vector<char>& mark) {
  std::vector<int> part = marked(cluster, mark);
  if (part.size() == cluster.size()) return {};
  const PlanarPatch patch = planar_patch(found, cluster);
  for (std::size_t n = 0; min_margin > 0 && n < patch.hull.size(); ++n) {
    const Margin margin = margin_of(patch, part);
    if (margin.value >= min_margin - kSamePlace) break;
    const int more = extreme(patch, margin.direction, Vec2(-margin.direction.y(), margin.direction.x()),
                             kSamePlace * patch.extent);
    part.push_back(more);
    mark[std::size_t(cluster[std::size_t(more)])] = 1;
  }
  LossReport loss = loss_of(patch, part);
  double deepest = kInf;
  for (const int k : part)
    deepest = std::min(deepest, found.points[std::size_t(cluster[std::size_t(k)])].gap);
  loss.depth = deepest - found.points[std::size_t(cluster.front())].gap;
  return loss;
}

}  // namespace

const char* to_string(Reducer reducer) {
  for (const auto& [value, name] : kNames)
    if (value == reducer) return name;
  return "?";
}

std::vector<std::string> reducer_names() {
  std::vector<std::string> names;
  for (const auto& entry : kNames) names.emplace_back(entry.second);
  return names;
}

Reducer reducer(const std::string& name) {
  std::string all;
  for (const auto& [value, known] : kNames) {
    if (name == known) return value;
    all += (all.empty() ? "" : ", ") + std::string(known);
  }
  throw std::invalid_argument("reducer = " + name + " must be one of " + all);
}

void validate(const ReductionOptions& options) {
  require_field(options.cluster_angle > 0 && options.cluster_angle <= kPi / 2,
                "ReductionOptions::cluster_angle", options.cluster_angle, "lie in (0, pi/2] rad");
  require_field(options.min_per_cluster >= 1, "ReductionOptions::min_per_cluster", options.min_per_cluster,
                "be at least 1");
  require_field(options.tie >= 0 && options.tie <= 0.1, "ReductionOptions::tie", options.tie,
                "lie in [0, 0.1]");
  require_field(options.layer >= 0, "ReductionOptions::layer", options.layer, "be at least 0 m");
  require_field(options.min_margin >= 0 && options.min_margin <= 1, "ReductionOptions::min_margin",
                options.min_margin, "lie in [0, 1]");
  require(!options.paper_exact || options.reducer == Reducer::extreme_points,
          "ReductionOptions::paper_exact is a choice of reducer extreme_points, not of " +
              std::string(to_string(options.reducer)));
  require((options.reducer == Reducer::selector) == bool(options.selector),
          std::string("ReductionOptions::selector must be ") + (options.selector ? "empty" : "given") +
              " with reducer " + to_string(options.reducer));
}

Selection reduce(const ReductionInput& input, const ReductionOptions& options) {
  validate(options);
  check(input);
  const Clusters clusters = clusters_of(input.contacts, options.cluster_angle);
  std::vector<int> kept;
  if (options.reducer == Reducer::none) {
    kept.resize(input.contacts.points.size());
    std::iota(kept.begin(), kept.end(), 0);
  } else if (options.reducer == Reducer::selector) {
    kept = chosen_by_selector(input, clusters, options);
  } else {
    for (const std::vector<int>& cluster : clusters) add_chosen(input, cluster, options, kept);
  }

  Selection out;
  out.cluster.resize(input.contacts.points.size());
  out.cluster_count = int(clusters.size());
  std::vector<char> mark(out.cluster.size(), 0);
  for (const int i : kept) mark[std::size_t(i)] = 1;
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    for (const int i : clusters[k]) out.cluster[std::size_t(i)] = int(k);
    mark[std::size_t(clusters[k].front())] = 1;  // the deepest, always
    out.loss = worst(out.loss, complete(input.contacts, clusters[k], options.min_margin, mark));
  }
  for (std::size_t i = 0; i < mark.size(); ++i)
    if (mark[i]) out.kept.push_back(int(i));
  return out;
}

Selection reduce(const ContactSet& found, const ReductionOptions& options) {
  return reduce(ReductionInput{.contacts = found}, options);
}

ContactSet select(const ContactSet& found, const std::vector<int>& kept) {
  ContactSet result;
  for (const int i : kept) {
    require(i >= 0 && std::size_t(i) < found.points.size(), "select: index " + std::to_string(i) +
                                                                " must lie in [0, " +
                                                                std::to_string(found.points.size()) + ")");
    result.points.push_back(found.points[std::size_t(i)]);
  }
  return result;
}

LossReport measure_loss(const ContactSet& found, const Selection& selection) {
  require(selection.cluster.size() == found.points.size(),
          "measure_loss: the selection belongs to another set");
  Clusters clusters(std::size_t(selection.cluster_count));
  for (std::size_t i = 0; i < found.points.size(); ++i)
    clusters[std::size_t(selection.cluster[i])].push_back(int(i));
  std::vector<char> mark(found.points.size(), 0);
  for (const int i : selection.kept) mark[std::size_t(i)] = 1;
  LossReport loss;
  for (std::vector<int>& cluster : clusters) {
    std::swap(cluster.front(), *std::min_element(cluster.begin(), cluster.end(), [&](int i, int j) {
                return found.points[std::size_t(i)].gap < found.points[std::size_t(j)].gap;
              }));
    loss = worst(loss, complete(found, cluster, 0, mark));
  }
  return loss;
}

}  // namespace aussois
