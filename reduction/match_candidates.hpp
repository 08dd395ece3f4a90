// SPDX-License-Identifier: Apache-2.0
// Finds the contacts of now and then that may be the same: those on incident features and those at one place.
#pragma once

#include <compare>
#include <functional>
#include <span>
#include <vector>

#include "lmd/lmd_shape.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {

/// A contact of now, as a memory would hold it, and where it stands in its set.
struct PresentContact {
  ContactKey key{};
  Vec3 normal = Vec3::Zero();                           // as in RememberedContact
  Vec3 point_a = Vec3::Zero(), point_b = Vec3::Zero();  // likewise [m]
  std::size_t place = 0;
};

/// Two contacts that may be the same, by rank among those of their pair of bodies: nearest first (PER-2).
struct MatchCandidate {
  double distance = 0;  // squared [m^2]
  std::size_t now = 0, old = 0;
  auto operator<=>(const MatchCandidate&) const = default;
};

/// The contacts of one pair of bodies, both sorted by key, and which of them may be matched.
struct Unmatched {
  std::span<const PresentContact> now{};
  std::span<const RememberedContact> old{};
  std::vector<std::size_t> left{};  // of `old`, ascending
  std::vector<char> has_name{};     // by rank in `now`: matched by key; it can still inherit from solved ones
};

/// The squared distance of (PER-2) [m^2].
double squared_distance(const PresentContact& now, const RememberedContact& old);

/// Whether the normal turned by a right angle or more.
bool has_turned_away(const PresentContact& now, const RememberedContact& old);

/// Those on incident features of both shapes, no farther apart than `max_reach` [m] on either body (PER-4);
/// some twice.
std::vector<MatchCandidate> incident_candidates(const Unmatched& contacts, const LmdShape& a,
                                                const LmdShape& b, double max_reach);

/// Those no farther apart than `reach(rank)` [m] on either body, whose normals are at most `max_turn` [rad]
/// apart (PER-5).
std::vector<MatchCandidate> near_candidates(const Unmatched& contacts,
                                            const std::function<double(std::size_t)>& reach, double max_turn);

}  // namespace aussois
