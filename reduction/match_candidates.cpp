// SPDX-License-Identifier: Apache-2.0
#include "reduction/match_candidates.hpp"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "lmd/feature_incidence.hpp"
#include "reduction/point_grid.hpp"

namespace aussois {
namespace {

double farther_side(const PresentContact& now, const RememberedContact& old) {
  return std::max((now.point_a - old.point_a).norm(), (now.point_b - old.point_b).norm());
}

// The pair of ranks, unless nothing allows it whatever the features.
void add_if_near(const Unmatched& c, std::size_t k, std::size_t l, double reach, auto&& is_wanted,
                 std::vector<MatchCandidate>& out) {
  const PresentContact& now = c.now[k];
  const RememberedContact& old = c.old[l];
  if ((c.has_name[k] && !old.solved) || has_turned_away(now, old)) return;
  if (farther_side(now, old) <= reach && is_wanted(now, old))
    out.push_back({squared_distance(now, old), k, l});
}

enum class Side { a, b };

KeyFeature feature(const ContactKey& key, Side side) {
  return side == Side::a ? feature_a(key) : feature_b(key);
}

bool before(const KeyFeature& f, const KeyFeature& g) {
  return f.dim != g.dim ? f.dim < g.dim : f.region < g.region;
}

// Ranks by their feature on one side.
struct ByFeature {
  struct Run {
    KeyFeature feature{};
    std::size_t first = 0, last = 0;  // in `ranks`
  };
  std::vector<std::size_t> ranks{};
  std::vector<Run> runs{};       // sorted by feature
  std::bitset<1 << 14> slots{};  // of those features: most features that are asked for have none

  static std::size_t slot(const KeyFeature& f) { return std::size_t(4 * f.region + f.dim) % (1 << 14); }

  std::span<const std::size_t> of(const KeyFeature& f) const {
    if (!slots[slot(f)]) return {};
    const auto run = std::ranges::lower_bound(runs, f, before, &Run::feature);
    if (run == runs.end() || run->feature != f) return {};
    return std::span(ranks).subspan(run->first, run->last - run->first);
  }
};

// `ranks` are ascending, so they have the order of A's features already.
ByFeature by_feature(std::vector<std::size_t> ranks, Side side, auto&& key_of_rank) {
  const auto of = [&](std::size_t rank) { return feature(key_of_rank(rank), side); };
  if (side == Side::b) std::ranges::stable_sort(ranks, before, of);
  ByFeature out{.ranks = std::move(ranks)};
  for (std::size_t i = 0; i < out.ranks.size(); ++i) {
    const KeyFeature f = of(out.ranks[i]);
    if (out.runs.empty() || out.runs.back().feature != f)
      out.runs.push_back({f, i, i}), out.slots.set(ByFeature::slot(f));
    out.runs.back().last = i + 1;
  }
  return out;
}

}  // namespace

double squared_distance(const PresentContact& now, const RememberedContact& old) {
  return (now.point_a - old.point_a).squaredNorm() + (now.point_b - old.point_b).squaredNorm();
}

bool has_turned_away(const PresentContact& now, const RememberedContact& old) {
  return !(now.normal.dot(old.normal) > 0);
}

std::vector<MatchCandidate> incident_candidates(const Unmatched& c, const LmdShape& a, const LmdShape& b,
                                                double max_reach) {
  const auto old_key = [&](std::size_t l) { return c.old[l].key; };
  const auto now_key = [&](std::size_t k) { return c.now[k].key; };
  // Those of one side are listed, those of the other compared: a plane that carries all sorts out nothing.
  const ByFeature old_a = by_feature(c.left, Side::a, old_key), old_b = by_feature(c.left, Side::b, old_key);
  const Side side = old_b.runs.size() > 2 * old_a.runs.size() ? Side::b : Side::a;
  const ByFeature& old = side == Side::a ? old_a : old_b;
  std::vector<std::size_t> all(c.now.size());
  std::iota(all.begin(), all.end(), 0);
  const ByFeature now = by_feature(std::move(all), side, now_key);

  std::vector<MatchCandidate> out;
  const auto add = [&](std::span<const std::size_t> from, std::span<const std::size_t> to) {
    for (std::size_t k : from)
      for (std::size_t l : to)
        add_if_near(
            c, k, l, max_reach,
            [&](const PresentContact& p, const RememberedContact& q) {
              return side == Side::a ? are_incident(b, feature_b(p.key), feature_b(q.key))
                                     : are_incident(a, feature_a(p.key), feature_a(q.key));
            },
            out);
  };
  const LmdShape& shape = side == Side::a ? a : b;
  for (const ByFeature::Run& run : now.runs) {
    const std::span<const std::size_t> ranks = now.of(run.feature);
    add(ranks, old.of(run.feature));
    for_each_led_to(shape, run.feature, [&](const KeyFeature& f) { add(ranks, old.of(f)); });
  }
  for (const ByFeature::Run& run : old.runs)
    for_each_led_to(shape, run.feature, [&](const KeyFeature& f) { add(now.of(f), old.of(run.feature)); });
  return out;
}

std::vector<MatchCandidate> near_candidates(const Unmatched& c,
                                            const std::function<double(std::size_t)>& reach,
                                            double max_turn) {
  double widest = 0;
  for (std::size_t k = 0; k < c.now.size(); ++k) widest = std::max(widest, reach(k));
  Vec3 low = Vec3::Constant(kInf), high = -low;
  for (std::size_t l : c.left) low = low.cwiseMin(c.old[l].point_a), high = high.cwiseMax(c.old[l].point_a);
  PointGrid grid(low, high, 2 * widest, c.left.size());
  for (std::size_t l : c.left) grid.add(c.old[l].point_a);
  std::vector<MatchCandidate> out;
  for (std::size_t k = 0; k < c.now.size(); ++k)
    grid.for_each_near(c.now[k].point_a, reach(k), [&](std::size_t i) {
      add_if_near(
          c, k, c.left[i], reach(k),
          [&](const PresentContact& p, const RememberedContact& q) {
            return std::atan2(p.normal.cross(q.normal).norm(), p.normal.dot(q.normal)) <= max_turn;
          },
          out);
    });
  return out;
}

}  // namespace aussois
