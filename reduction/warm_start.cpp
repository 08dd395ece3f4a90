// SPDX-License-Identifier: Apache-2.0
#include "reduction/warm_start.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include <Eigen/Geometry>

#include "geometry/settings.hpp"
#include "reduction/contact_order.hpp"
#include "reduction/match_candidates.hpp"

namespace aussois {
namespace {

constexpr Named<Matching> kMatchings[] = {
    {Matching::none, "none"}, {Matching::key, "key"}, {Matching::cascade, "cascade"}};

// Q(from, to) x of (RED-5), written out; from . to > 0.
Vec3 turned(const Vec3& x, const Vec3& from, const Vec3& to) {
  const Vec3 w = from.cross(to);
  return x + w.cross(x) + w.cross(w.cross(x)) / (1 + from.dot(to));
}

bool same_pair(const ContactKey& a, const ContactKey& b) {
  return a.body_a == b.body_a && a.body_b == b.body_b;
}
bool pair_before(const ContactKey& a, const ContactKey& b) {
  return a.body_a != b.body_a ? a.body_a < b.body_a : a.body_b < b.body_b;
}

bool before(const PresentContact& a, const PresentContact& b) {
  if (a.key != b.key) return a.key < b.key;
  return std::lexicographical_compare(a.point_a.begin(), a.point_a.end(), b.point_a.begin(), b.point_a.end());
}

// Places in the set, pair by pair; empty where the set has that order already, as found sets have.
std::vector<int> by_pair(const ContactSet& contacts) {
  const auto by_bodies = [](const ContactPoint& a, const ContactPoint& b) {
    return a.a.body != b.a.body ? a.a.body < b.a.body : a.b.body < b.b.body;
  };
  std::vector<int> order;
  if (std::is_sorted(contacts.points.begin(), contacts.points.end(), by_bodies)) return order;
  order.resize(contacts.points.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int i, int j) { return by_bodies(contacts.points[i], contacts.points[j]); });
  return order;
}

class Cascade {
 public:
  Cascade(const MatchInput& input, const PersistenceOptions& options) : input_(input), options_(options) {}

  // Of one pair, both sorted by key; what is kept from the last pair is its memory.
  void run(std::span<const RememberedContact> old, std::span<const PresentContact> now) {
    old_ = old, now_ = now;
    match_.assign(now.size(), -1);
    kind_.assign(now.size(), MatchKind::none);
    taken_.assign(old.size(), 0);
    legacies_.clear();
    match_keys();
    if (options_.matching == Matching::cascade) match_places();
  }

  int match(std::size_t rank) const { return match_[rank]; }
  MatchKind kind(std::size_t rank) const { return kind_[rank]; }
  const std::vector<std::pair<std::size_t, std::size_t>>& legacies() const { return legacies_; }

 private:
  // One past the last with the key of `first`.
  template <class Contact>
  static std::size_t end_of_key(std::span<const Contact> sorted, std::size_t first) {
    std::size_t at = first;
    while (at < sorted.size() && sorted[at].key == sorted[first].key) ++at;
    return at;
  }

  void match_keys() {
    std::size_t i = 0, j = 0;
    while (i < now_.size() && j < old_.size()) {
      const std::size_t i_next = end_of_key(now_, i), j_next = end_of_key(old_, j);
      if (now_[i].key == old_[j].key) {
        of_one_key_.clear();
        for (std::size_t k = i; k < i_next; ++k)
          for (std::size_t l = j; l < j_next; ++l)
            if (!has_turned_away(now_[k], old_[l]))
              of_one_key_.push_back({squared_distance(now_[k], old_[l]), k, l});
        claim(of_one_key_, MatchKind::key);
        i = i_next, j = j_next;
      } else if (now_[i].key < old_[j].key) {
        i = i_next;
      } else {
        j = j_next;
      }
    }
  }

  // Matches what has no key yet, by incidence (PER-4), then by place (PER-5). What is then left in the memory
  // is inherited (PER-6).
  void match_places() {
    Unmatched contacts{.now = now_, .old = old_};
    for (std::size_t l = 0; l < old_.size(); ++l)
      if (!taken_[l]) contacts.left.push_back(l);
    if (contacts.left.empty()) return;
    for (int match : match_) contacts.has_name.push_back(char(match >= 0));
    const auto shape = [&](BodyId body) {
      return input_.shapes.empty() ? nullptr : input_.shapes[body.index()];
    };
    const LmdShape *a = shape(now_[0].key.body_a), *b = shape(now_[0].key.body_b);
    std::vector<MatchCandidate> adjacent, geometric;
    if (a && b) adjacent = incident_candidates(contacts, *a, *b, options_.max_reach);
    geometric = near_candidates(
        contacts, [&](std::size_t k) { return reach(k); }, options_.max_turn);
    claim(adjacent, MatchKind::adjacent);
    claim(geometric, MatchKind::geometric);
    inherit(adjacent);
    inherit(geometric);
  }

  double reach(std::size_t rank) const {
    const double moved = input_.moved.empty() ? 0 : input_.moved[now_[rank].place];
    return std::min(std::max(2 * moved, options_.reach), options_.max_reach);
  }

  // Nearest first, none twice.
  void claim(std::vector<MatchCandidate>& candidates, MatchKind kind) {
    std::sort(candidates.begin(), candidates.end());
    for (const MatchCandidate& c : candidates) {
      if (match_[c.now] >= 0 || taken_[c.old]) continue;
      match_[c.now] = int(c.old);
      kind_[c.now] = kind;
      taken_[c.old] = 1;
    }
  }

  // Sorted by claim().
  void inherit(const std::vector<MatchCandidate>& candidates) {
    for (const MatchCandidate& c : candidates) {
      if (taken_[c.old] || !old_[c.old].solved) continue;
      taken_[c.old] = 1;
      legacies_.emplace_back(c.now, c.old);
    }
  }

  const MatchInput& input_;
  const PersistenceOptions& options_;
  std::span<const RememberedContact> old_{};
  std::span<const PresentContact> now_{};
  std::vector<int> match_{};  // by rank
  std::vector<MatchKind> kind_{};
  std::vector<char> taken_{};
  std::vector<MatchCandidate> of_one_key_{};
  std::vector<std::pair<std::size_t, std::size_t>> legacies_{};  // (rank now, remembered)
};

// The anchor of a matched contact with the drift of now (PER-8).
Anchor moved_anchor(const RememberedContact& from, const ContactPoint& c, std::span<const SE3> g) {
  if (!from.held) return {};
  const Vec3 apart = pose_of(g, c.a.body) * from.point_a - pose_of(g, c.b.body) * from.anchor_b;
  return {.held = true, .drift = apart - c.normal.dot(apart) * c.normal};
}

}  // namespace

void describe(SettingVisitor& visit, PersistenceOptions& o) {
  visit.begin("PersistenceOptions");
  visit.choice(
      {.name = "matching",
       .what = "matching of contacts with those of the last step; none: every solve starts from zero",
       .flag = "--matching"},
      o.matching, kMatchings);
  visit.number({.name = "reach",
                .what = "largest motion of a contact matched by place",
                .unit = "m",
                .range = not_negative_range(),
                .only_for = "cascade"},
               o.reach);
  visit.number({.name = "max_reach",
                .what = "upper bound of that distance for moving bodies",
                .unit = "m",
                .range = not_negative_range(),
                .only_for = "cascade"},
               o.max_reach);
  visit.number({.name = "max_turn",
                .what = "largest turn of the normal of a contact matched by place",
                .unit = "rad",
                .range = range_open_above(0, kPi / 2),
                .only_for = "cascade"},
               o.max_turn);
  visit.toggle({.name = "redistribute",
                .what = "pass the impulses of dropped contacts on to kept ones",
                .only_for = "not none"},
               o.redistribute);
  visit.toggle({.name = "anchors",
                .what = "pull sticking contacts back to where they began to stick",
                .flag = "--anchors"},
               o.anchors);
  visit.number({"anchor_rate", "fraction of the drift undone per step", "-", range_open_below(0, 1)},
               o.anchor_rate);
  visit.number({"anchor_speed", "largest speed at which the drift is undone", "m/s", range_above(0)},
               o.anchor_speed);
  visit.number({"slip_speed", "slip speed above which a contact releases its anchor", "m/s", range_above(0)},
               o.slip_speed);
}

void validate(const PersistenceOptions& o) {
  check_options(o);
  require_field(o.max_reach >= o.reach, "PersistenceOptions::max_reach", o.max_reach,
                "be at least reach [m]");
  const PersistenceOptions usual;
  require(o.anchors || (o.anchor_rate == usual.anchor_rate && o.anchor_speed == usual.anchor_speed &&
                        o.slip_speed == usual.slip_speed),
          "PersistenceOptions::anchor_rate, anchor_speed and slip_speed need anchors");
  require(!o.anchors || o.matching != Matching::none,
          "PersistenceOptions::anchors need contacts that are matched");
}

namespace {

// What the contacts `now` of a pair take over from those remembered of it, the first of which is `begin`.
void take_over(std::span<const RememberedContact> old, std::size_t begin,
               const std::vector<PresentContact>& now, const Cascade& cascade, const ContactSet& contacts,
               const MatchInput& input, WarmStart& out) {
  for (std::size_t k = 0; k < now.size(); ++k) {
    if (cascade.match(k) < 0) continue;
    const std::size_t i = now[k].place;
    const RememberedContact& from = old[cascade.match(k)];
    out.impulse[i] = input.scale * turned(from.impulse, from.normal, contacts.points[i].normal);  // (RED-5)
    out.drilling[i] = input.scale * from.drilling;
    out.anchor[i] = moved_anchor(from, contacts.points[i], input.g);
    out.kind[i] = cascade.kind(k);
    out.match[i] = int(begin) + cascade.match(k);
    out.remembered[i] = from.solved;
    --out.counts.unmatched;
    ++(out.kind[i] == MatchKind::key        ? out.counts.by_key
       : out.kind[i] == MatchKind::adjacent ? out.counts.by_adjacency
                                            : out.counts.by_geometry);
  }
  for (const auto& [k, l] : cascade.legacies()) {  // (PER-6)
    const RememberedContact& from = old[l];
    const std::size_t i = now[k].place;
    out.impulse[i] += input.scale * turned(from.impulse, from.normal, contacts.points[i].normal);
    out.drilling[i] += input.scale * from.drilling;
  }
  out.counts.inherited += int(cascade.legacies().size());
}

}  // namespace

WarmStart warm_start(const ContactMemory& memory, const ContactSet& contacts, const MatchInput& input,
                     const PersistenceOptions& options) {
  const std::size_t n = contacts.points.size();
  WarmStart out{.impulse = std::vector<Vec3>(n, Vec3::Zero()),
                .drilling = std::vector<double>(n, 0),
                .anchor = std::vector<Anchor>(n),
                .kind = std::vector<MatchKind>(n, MatchKind::none),
                .match = std::vector<int>(n, -1),
                .remembered = std::vector<char>(n, 0)};
  out.counts.unmatched = int(n);
  if (options.matching == Matching::none || memory.contacts.empty() || n == 0) return out;
  const std::vector<int> order = by_pair(contacts);
  const auto place = [&](std::size_t k) { return order.empty() ? k : std::size_t(order[k]); };
  const std::vector<SE3> to_body = inverses(input.g);
  Cascade cascade(input, options);
  std::vector<PresentContact> now;  // of one pair: what is read again soon stays small
  for (std::size_t first = 0, j = 0; first < n;) {
    now.clear();
    std::size_t last = first;
    for (; last < n; ++last) {
      const ContactPoint& c = contacts.points[place(last)];
      const ContactKey key = key_of(c);
      if (!now.empty() && !same_pair(key, now[0].key)) break;
      now.push_back({.key = key, .normal = c.normal, .place = place(last)});
      PresentContact& seen = now.back();
      if (input.places.empty()) {
        seen.point_a = pose_of(to_body, c.a.body) * c.x_a;
        seen.point_b = pose_of(to_body, c.b.body) * c.x_b;
      } else {
        seen.point_a = input.places[seen.place][0];
        seen.point_b = input.places[seen.place][1];
      }
    }
    first = last;
    if (!std::is_sorted(now.begin(), now.end(), before)) std::stable_sort(now.begin(), now.end(), before);
    while (j < memory.contacts.size() && pair_before(memory.contacts[j].key, now[0].key)) ++j;
    const std::size_t begin = j;
    while (j < memory.contacts.size() && same_pair(memory.contacts[j].key, now[0].key)) ++j;
    if (j == begin) continue;
    const std::span old = std::span(memory.contacts).subspan(begin, j - begin);
    cascade.run(old, now);
    take_over(old, begin, now, cascade, contacts, input, out);
  }
  return out;
}

}  // namespace aussois
