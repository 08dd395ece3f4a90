// SPDX-License-Identifier: Apache-2.0
// The contacts of the last step with their impulses, matched to the present ones by feature keys (RED-5),
// (RED-6).
#pragma once

#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

struct RememberedContact {
  ContactKey key{};
  Vec3 normal = Vec3::UnitZ();  // world, from B to A
  Vec3 point_a = Vec3::Zero();  // proximal point on A in world coordinates when it was remembered [m]
  Vec3 impulse = Vec3::Zero();  // on A, world [N s]
  double drilling = 0;          // moment of it about the normal, on A [N m s]; 0 without drilling friction
};

/// Part of the State: a plain value, sorted by key, then by the coordinates of point_a. Keys may repeat: two
/// crossings of the same two edge chains.
struct ContactMemory {
  std::vector<RememberedContact> contacts{};
};

struct WarmStart {
  std::vector<Vec3> impulse{};  // on A, world [N s], one per contact of the set; zero where nothing matches
  std::vector<double> drilling{};  // about the normal, on A [N m s], likewise
  std::vector<char> remembered{};  // 1: the contact was in the problem of the last step, 0: it is new
  int matched = 0;
};

/// Impulses to start the solver with (RED-5): matched by key, among equal keys the nearest by point_a
/// (RED-6), turned from the old to the new normal by the smallest rotation; `scale` is h_new / h_old. Each
/// remembered contact is used at most once; one whose normal turned by a right angle or more is not used.
WarmStart warm_start(const ContactMemory& memory, const ContactSet& contacts, double scale = 1.0);

/// `impulses[i]` acts on A of contact i, world [N s], `drilling[i]` about its normal [N m s] (empty: zero).
/// Keeps every contact. Throws std::invalid_argument unless there is one impulse per contact.
ContactMemory remember(const ContactSet& contacts, const std::vector<Vec3>& impulses,
                       const std::vector<double>& drilling = {});

}  // namespace aussois
