// SPDX-License-Identifier: Apache-2.0
// Who is who between two steps, and with which impulse a contact starts: the cascade of (PER-3) to (PER-6),
// the transport of (RED-5).
#pragma once

#include <span>
#include <vector>

#include "lmd/lmd_shape.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {

enum class Matching {
  none,     // every solve starts from zero
  key,      // contacts of the same features
  cascade,  // then those of incident features, then those at the same place
};

struct PersistenceOptions {
  Matching matching = Matching::cascade;
  double reach = 1e-3;  // a contact without a key is the same if it moved by no more on either body, or by
                        // twice the bodies' own motion there [m], >= 0; taste, as in Bullet, Jolt and Newton
  double max_reach = 1e-2;          // but by no more than this, whatever the motion [m], >= reach
  double max_turn = 5 * kPi / 180;  // of its normal, for contacts matched by place [rad], in [0, pi/2)
  bool redistribute = true;    // impulses of contacts that the reducer drops go to those it keeps (PER-7)
  bool anchors = false;        // static friction pulls back what it has lost (PER-8), (PER-9)
  double anchor_rate = 0.2;    // part of the drift undone per step [-], in (0, 1]
  double anchor_speed = 0.05;  // at most this fast [m/s], > 0
  double slip_speed = 1e-4;    // a contact that slips faster lets go of its anchor [m/s], > 0
};
void validate(const PersistenceOptions& options);  // throws std::invalid_argument: field, value, bound

/// What has happened since the memory was made.
struct MatchInput {
  double scale = 1;          // h_new / h_old
  std::span<const SE3> g{};  // g_wb of all bodies now; empty: the identity
  // Of all bodies, for incidence; empty: no contact is matched by it
  std::span<const LmdShape* const> shapes{};
  // How far the two bodies moved against each other at each contact [m]; empty: 0
  std::vector<double> moved{};
  std::span<const std::array<Vec3, 2>> places{};  // as of StepTrace
};

enum class MatchKind : std::uint8_t { none, key, adjacent, geometric };

struct MatchCounts {
  int by_key = 0, by_adjacency = 0, by_geometry = 0, unmatched = 0;  // of the contacts now
  int inherited = 0;  // of the remembered ones: they are gone, and what they carried went to a neighbour
  int matched() const { return by_key + by_adjacency + by_geometry; }
};

/// One entry per contact of the set each.
struct WarmStart {
  std::vector<Vec3> impulse{};     // on A, world [N s]; zero where nothing matches
  std::vector<double> drilling{};  // about the normal, on A [N m s], likewise
  std::vector<Anchor> anchor{};    // with the drift as it is now
  std::vector<MatchKind> kind{};
  std::vector<int> match{};        // in the memory, -1: none
  std::vector<char> remembered{};  // 1: the contact was in the problem of the last step, 0: it is new
  MatchCounts counts{};
};

/// A function of the two sets, whatever the order of the contacts. Each remembered contact is used at most
/// once; one whose normal turned by a right angle or more is not used.
WarmStart warm_start(const ContactMemory& memory, const ContactSet& contacts, const MatchInput& input = {},
                     const PersistenceOptions& options = {});

}  // namespace aussois
