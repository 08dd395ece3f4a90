// SPDX-License-Identifier: Apache-2.0
#include "reduction/warm_start.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "lmd/feature_incidence.hpp"
#include "reduction/contact_order.hpp"

namespace aussois {
namespace {

// Q(from, to) x of (RED-5), written out; from . to > 0.
Vec3 turned(const Vec3& x, const Vec3& from, const Vec3& to) {
  const Vec3 w = from.cross(to);
  return x + w.cross(x) + w.cross(w.cross(x)) / (1 + from.dot(to));
}

bool same_pair(const ContactKey& a, const ContactKey& b) {
  return a.body_a == b.body_a && a.body_b == b.body_b;
}
bool same_key(const ContactKey& a, const ContactKey& b) {
  return a == b;
}

// A contact now, as a memory would hold it, and where it stands in the set.
struct Seen {
  ContactKey key{};
  Vec3 normal = Vec3::Zero(), point_a = Vec3::Zero(), point_b = Vec3::Zero();
  std::size_t place = 0;
};

bool before(const Seen& a, const Seen& b) {
  if (a.key != b.key) return a.key < b.key;
  return std::lexicographical_compare(a.point_a.begin(), a.point_a.end(), b.point_a.begin(), b.point_a.end());
}

// In the order of a memory. Sets come with their pairs in order: then pairs are sorted each for itself.
std::vector<Seen> ranked(const ContactSet& contacts, std::span<const SE3> g) {
  std::vector<Seen> out;
  out.reserve(contacts.points.size());
  const std::vector<SE3> to_body = inverses(g);
  for (const ContactPoint& c : contacts.points)
    out.push_back({.key = key_of(c),
                   .normal = c.normal,
                   .point_a = pose_of(to_body, c.a.body) * c.x_a,
                   .point_b = pose_of(to_body, c.b.body) * c.x_b,
                   .place = out.size()});
  const auto pair_before = [](const Seen& a, const Seen& b) {
    return a.key.body_a != b.key.body_a ? a.key.body_a < b.key.body_a : a.key.body_b < b.key.body_b;
  };
  if (!std::is_sorted(out.begin(), out.end(), pair_before))
    std::stable_sort(out.begin(), out.end(), pair_before);
  const auto of_one_pair = [](const Seen& a, const Seen& b) { return same_pair(a.key, b.key); };
  for (const std::span<Seen> pair : runs_of(std::span(out), of_one_pair))
    if (!std::is_sorted(pair.begin(), pair.end(), before)) std::stable_sort(pair.begin(), pair.end(), before);
  return out;
}

// Two contacts that may be the same, by rank: nearest first (PER-2).
struct Candidate {
  double distance = 0;  // squared [m^2]
  std::size_t now = 0, old = 0;
  auto operator<=>(const Candidate&) const = default;
};

class Cascade {
 public:
  Cascade(const ContactMemory& memory, const std::vector<Seen>& now, const MatchInput& input,
          const PersistenceOptions& options)
      : old_(memory.contacts),
        now_(now),
        input_(input),
        options_(options),
        match_(now.size(), -1),
        kind_(now.size(), MatchKind::none),
        taken_(old_.size(), 0) {}

  // A merge of two sequences sorted by key, pair by pair.
  void run() {
    std::size_t i = 0, j = 0;
    while (i < now_.size() && j < old_.size()) {
      const std::size_t i_end = end(now_, i, same_pair), j_end = end(old_, j, same_pair);
      const ContactKey &a = now_[i].key, &b = old_[j].key;
      if (same_pair(a, b)) {
        match_keys(i, i_end, j, j_end);
        if (options_.matching == Matching::cascade) match_places(i, i_end, j, j_end);
        i = i_end, j = j_end;
      } else if (a < b) {
        i = i_end;
      } else {
        j = j_end;
      }
    }
  }

  int match(std::size_t rank) const { return match_[rank]; }
  MatchKind kind(std::size_t rank) const { return kind_[rank]; }
  const std::vector<std::pair<std::size_t, std::size_t>>& legacies() const { return legacies_; }

 private:
  // One past the last that is the same as `first`.
  template <class Contact, class Same>
  static std::size_t end(const std::vector<Contact>& sorted, std::size_t first, const Same& same) {
    std::size_t at = first;
    while (at < sorted.size() && same(sorted[at].key, sorted[first].key)) ++at;
    return at;
  }

  bool turned_away(std::size_t i, std::size_t j) const { return !(now_[i].normal.dot(old_[j].normal) > 0); }
  double squared_distance(std::size_t i, std::size_t j) const {
    return (now_[i].point_a - old_[j].point_a).squaredNorm() +
           (now_[i].point_b - old_[j].point_b).squaredNorm();
  }
  double farther_side(std::size_t i, std::size_t j) const {
    return std::max((now_[i].point_a - old_[j].point_a).norm(), (now_[i].point_b - old_[j].point_b).norm());
  }

  void match_keys(std::size_t i, std::size_t i_end, std::size_t j, std::size_t j_end) {
    while (i < i_end && j < j_end) {
      const std::size_t i_next = end(now_, i, same_key), j_next = end(old_, j, same_key);
      if (now_[i].key == old_[j].key) {
        of_one_key_.clear();
        for (std::size_t k = i; k < i_next; ++k)
          for (std::size_t l = j; l < j_next; ++l)
            if (!turned_away(k, l)) of_one_key_.push_back({squared_distance(k, l), k, l});
        claim(of_one_key_, MatchKind::key);
        i = i_next, j = j_next;
      } else if (now_[i].key < old_[j].key) {
        i = i_next;
      } else {
        j = j_next;
      }
    }
  }

  // What has no key yet, by incidence (PER-4), then by place (PER-5); and who inherits from those that nobody
  // is (PER-6). Found in a window along A's x.
  void match_places(std::size_t i, std::size_t i_end, std::size_t j, std::size_t j_end) {
    std::vector<std::size_t> left;  // of the memory, by point_a.x
    for (std::size_t l = j; l < j_end; ++l)
      if (!taken_[l]) left.push_back(l);
    if (left.empty()) return;
    const auto x = [&](std::size_t l) { return old_[l].point_a.x(); };
    std::stable_sort(left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return x(a) < x(b); });
    std::vector<Candidate> adjacent, geometric;
    for (std::size_t k = i; k < i_end; ++k) {
      const double at = now_[k].point_a.x();
      const auto first = std::lower_bound(left.begin(), left.end(), at - options_.max_reach,
                                          [&](std::size_t l, double value) { return x(l) < value; });
      for (auto l = first; l != left.end() && x(*l) <= at + options_.max_reach; ++l) {
        if (turned_away(k, *l)) continue;
        const double moved = farther_side(k, *l);
        if (moved > options_.max_reach) continue;
        const Candidate candidate{squared_distance(k, *l), k, *l};
        if (is_adjacent(k, *l)) adjacent.push_back(candidate);
        const Vec3 &n = now_[k].normal, &n_old = old_[*l].normal;
        if (moved <= reach(k) && std::atan2(n.cross(n_old).norm(), n.dot(n_old)) <= options_.max_turn)
          geometric.push_back(candidate);
      }
    }
    claim(adjacent, MatchKind::adjacent);
    claim(geometric, MatchKind::geometric);
    inherit(adjacent);
    inherit(geometric);
  }

  double reach(std::size_t rank) const {
    const double moved = input_.moved.empty() ? 0 : input_.moved[now_[rank].place];
    return std::min(std::max(2 * moved, options_.reach), options_.max_reach);
  }

  bool is_adjacent(std::size_t i, std::size_t j) const {
    const ContactKey &now = now_[i].key, &old = old_[j].key;
    const auto shape = [&](int body) {
      return input_.shapes.empty() ? nullptr : input_.shapes[std::size_t(body)];
    };
    const LmdShape *a = shape(now.body_a), *b = shape(now.body_b);
    return a && b && incident(*a, feature_a(now), feature_a(old)) &&
           incident(*b, feature_b(now), feature_b(old));
  }

  // Nearest first, nobody twice.
  void claim(std::vector<Candidate>& candidates, MatchKind kind) {
    std::sort(candidates.begin(), candidates.end());
    for (const Candidate& c : candidates) {
      if (match_[c.now] >= 0 || taken_[c.old]) continue;
      match_[c.now] = int(c.old);
      kind_[c.now] = kind;
      taken_[c.old] = 1;
    }
  }

  // Sorted by claim().
  void inherit(const std::vector<Candidate>& candidates) {
    for (const Candidate& c : candidates) {
      if (taken_[c.old] || !old_[c.old].solved) continue;
      taken_[c.old] = 1;
      legacies_.emplace_back(c.now, c.old);
    }
  }

  const std::vector<RememberedContact>& old_;
  const std::vector<Seen>& now_;
  const MatchInput& input_;
  const PersistenceOptions& options_;
  std::vector<int> match_;  // by rank
  std::vector<MatchKind> kind_;
  std::vector<char> taken_;
  std::vector<Candidate> of_one_key_{};                          // kept for its memory
  std::vector<std::pair<std::size_t, std::size_t>> legacies_{};  // (rank now, remembered)
};

// The anchor of a matched contact with the drift of now (PER-8).
Anchor moved_anchor(const RememberedContact& from, const ContactPoint& c, std::span<const SE3> g) {
  if (!from.held) return {};
  const Vec3 apart = pose_of(g, c.a.body) * from.point_a - pose_of(g, c.b.body) * from.anchor_b;
  return {.held = true, .drift = apart - c.normal.dot(apart) * c.normal};
}

}  // namespace

void validate(const PersistenceOptions& o) {
  require_field(o.reach >= 0 && std::isfinite(o.reach), "PersistenceOptions::reach", o.reach,
                "be finite and at least 0 m");
  require_field(o.max_reach >= o.reach && std::isfinite(o.max_reach), "PersistenceOptions::max_reach",
                o.max_reach, "be finite and at least reach [m]");
  require_field(o.max_turn >= 0 && o.max_turn < kPi / 2, "PersistenceOptions::max_turn", o.max_turn,
                "lie in [0, pi/2) rad");
  require_field(o.anchor_rate > 0 && o.anchor_rate <= 1, "PersistenceOptions::anchor_rate", o.anchor_rate,
                "lie in (0, 1]");
  require_field(o.anchor_speed > 0, "PersistenceOptions::anchor_speed", o.anchor_speed, "be > 0 m/s");
  require_field(o.slip_speed > 0, "PersistenceOptions::slip_speed", o.slip_speed, "be > 0 m/s");
  require(!o.anchors || o.matching != Matching::none,
          "PersistenceOptions::anchors need contacts that are matched");
}

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
  const std::vector<Seen> now = ranked(contacts, input.g);
  Cascade cascade(memory, now, input, options);
  cascade.run();
  for (std::size_t k = 0; k < n; ++k) {
    if (cascade.match(k) < 0) continue;
    const std::size_t i = now[k].place;
    const RememberedContact& from = memory.contacts[std::size_t(cascade.match(k))];
    out.impulse[i] = input.scale * turned(from.impulse, from.normal, contacts.points[i].normal);  // (RED-5)
    out.drilling[i] = input.scale * from.drilling;
    out.anchor[i] = moved_anchor(from, contacts.points[i], input.g);
    out.kind[i] = cascade.kind(k);
    out.match[i] = cascade.match(k);
    out.remembered[i] = from.solved;
    --out.counts.unmatched;
    ++(out.kind[i] == MatchKind::key        ? out.counts.by_key
       : out.kind[i] == MatchKind::adjacent ? out.counts.by_adjacency
                                            : out.counts.by_geometry);
  }
  for (const auto& [k, l] : cascade.legacies()) {  // (PER-6)
    const RememberedContact& from = memory.contacts[l];
    const std::size_t i = now[k].place;
    out.impulse[i] += input.scale * turned(from.impulse, from.normal, contacts.points[i].normal);
    out.drilling[i] += input.scale * from.drilling;
  }
  out.counts.inherited = int(cascade.legacies().size());
  return out;
}

}  // namespace aussois
