// SPDX-License-Identifier: Apache-2.0
// What persists from step to step (PER-1): the contacts of the last step with their impulses and anchors.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/se3.hpp"
#include "lmd/contact_point.hpp"

namespace aussois {

/// Remembers where static friction began (PER-8).
struct Anchor {
  bool held = false;          // the contact touched and stuck
  Vec3 drift = Vec3::Zero();  // how far A's side has slipped off B's since then, tangential, world [m]
};

struct RememberedContact {
  ContactKey key{};
  Vec3 normal = Vec3::UnitZ();   // world, from B to A
  Vec3 point_a = Vec3::Zero();   // proximal point on A, in A's frame [m]; if A deforms, its material point
  Vec3 point_b = Vec3::Zero();   // the same on B, in B's frame [m]
  Vec3 impulse = Vec3::Zero();   // on A, world [N s]
  double drilling = 0;           // angular impulse about the normal, on A [N m s]; 0: no drilling friction
  Vec3 anchor_b = Vec3::Zero();  // where the material of point_a began to stick, in B's frame [m] (PER-8)
  bool held = false;             // true: there is an anchor; false: anchor_b is point_b
  bool solved = true;            // it was in the problem; if not, it is kept for its anchor (PER-11)
};

/// Part of the State: a plain value, sorted by key, then by the coordinates of point_a. Keys may repeat, as
/// for two crossings of the same two edge chains.
struct ContactMemory {
  std::vector<RememberedContact> contacts{};
};

/// What a solved step reports about its contacts besides their impulses. Each vector has one entry per
/// contact or is empty.
struct StepTrace {
  std::vector<double> drilling{};  // angular impulse about the normal, on A [N m s]
  std::vector<Anchor> anchors{};
  std::vector<char> solved{};  // 1: the contact was in the problem; empty: all were
  std::span<const SE3> g{};    // g_wb of all bodies at which the contacts were found; empty: the identity
  // Material points of each contact on A and on B, in the frames of the bodies [m]; empty: the proximal
  // points, as for rigid bodies
  std::span<const std::array<Vec3, 2>> places{};
};

/// Stores every contact; `impulses[i]` acts on A at contact i, world [N s]. Throws std::invalid_argument
/// unless there is one impulse per contact.
ContactMemory remember(const ContactSet& contacts, const std::vector<Vec3>& impulses,
                       const StepTrace& trace = {});

/// The inverse of each pose.
std::vector<SE3> inverses(std::span<const SE3> g);

/// The pose of a body, the identity where none is given.
SE3 pose_of(std::span<const SE3> g, BodyId body);

}  // namespace aussois
