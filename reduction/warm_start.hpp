// SPDX-License-Identifier: Apache-2.0
// Matches the contacts of two steps and gives each its starting impulse: the cascade of (PER-3) to (PER-6),
// the transport of (RED-5).
#pragma once

#include <span>
#include <vector>

#include "lmd/lmd_shape.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {

class SettingVisitor;

enum class Matching {
  none,     // every solve starts from zero
  key,      // matches contacts of the same features
  cascade,  // the same, then those of incident features, then those at the same place
};

/// `describe` gives the ranges, and with which choice an option is read: with others only its default is
/// taken.
struct PersistenceOptions {
  Matching matching = Matching::cascade;
  double reach = 1e-3;      // a contact not matched by key is the same if it moved by at most this on either
                            // body, or by at most twice the bodies' own motion there [m]; a matter of
                            // taste, as in Bullet, Jolt and Newton
  double max_reach = 1e-2;  // upper bound of that distance, whatever the motion [m], >= reach
  double max_turn = 5 * kPi / 180;  // largest turn of the normal if matched by place [rad]
  bool redistribute = true;    // impulses of contacts that the reducer drops go to those it keeps (PER-7)
  bool anchors = false;        // static friction pulls back the drift (PER-8), (PER-9)
  double anchor_rate = 0.2;    // fraction of the drift undone per step [-]
  double anchor_speed = 0.05;  // the drift is undone at most this fast [m/s]
  double slip_speed = 1e-4;    // a contact that slips faster than this lets go of its anchor [m/s]
};
void validate(const PersistenceOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, PersistenceOptions& options);

/// What has happened since the memory was made.
struct MatchInput {
  double scale = 1;          // h_new / h_old
  std::span<const SE3> g{};  // g_wb of all bodies now; empty: the identity
  // Shapes of all bodies, for incidence; empty: no contact is matched by incidence
  std::span<const LmdShape* const> shapes{};
  // How far the two bodies moved relative to each other at each contact [m]; empty: 0
  std::vector<double> moved{};
  std::span<const std::array<Vec3, 2>> places{};  // as in StepTrace
};

enum class MatchKind : std::uint8_t { none, key, adjacent, geometric };

struct MatchCounts {
  int by_key = 0, by_adjacency = 0, by_geometry = 0, unmatched = 0;  // present contacts
  int inherited = 0;  // remembered contacts that are gone; what they carried went to a neighbour
  int matched() const { return by_key + by_adjacency + by_geometry; }
};

/// Each vector has one entry per contact of the set.
struct WarmStart {
  std::vector<Vec3> impulse{};     // on A, world [N s]; zero where nothing matches
  std::vector<double> drilling{};  // angular impulse about the normal, on A [N m s]; likewise
  std::vector<Anchor> anchor{};    // with the present drift
  std::vector<MatchKind> kind{};
  std::vector<int> match{};        // index into the memory, -1: none
  std::vector<char> remembered{};  // 1: the contact was in the problem of the last step, 0: it is new
  MatchCounts counts{};
};

/// The order of the contacts in either set does not matter. Each remembered contact is used at most once, and
/// not at all if its normal turned by a right angle or more.
WarmStart warm_start(const ContactMemory& memory, const ContactSet& contacts, const MatchInput& input = {},
                     const PersistenceOptions& options = {});

}  // namespace aussois
