// SPDX-License-Identifier: Apache-2.0
// The contacts of the last step with what they did: what persists from step to step (PER-1).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/se3.hpp"
#include "lmd/contact_point.hpp"

namespace aussois {

/// Static friction that knows where it began (PER-8).
struct Anchor {
  bool held = false;          // the contact touched and stuck
  Vec3 drift = Vec3::Zero();  // how far A's side has slipped off B's since, tangential, world [m]
};

struct RememberedContact {
  ContactKey key{};
  Vec3 normal = Vec3::UnitZ();   // world, from B to A
  Vec3 point_a = Vec3::Zero();   // proximal point on A, in A's frame [m]; of what deforms, its material
  Vec3 point_b = Vec3::Zero();   // on B, in B's frame [m]
  Vec3 impulse = Vec3::Zero();   // on A, world [N s]
  double drilling = 0;           // moment of it about the normal, on A [N m s]; 0 without drilling friction
  Vec3 anchor_b = Vec3::Zero();  // where the material of point_a began to stick, in B's frame [m] (PER-8)
  bool held = false;             // there is an anchor; anchor_b is point_b otherwise
  bool solved = true;            // it was in the problem; if not, it is here for its anchor (PER-11)
};

/// Part of the State: a plain value, sorted by key, then by the coordinates of point_a. Keys may repeat: two
/// crossings of the same two edge chains.
struct ContactMemory {
  std::vector<RememberedContact> contacts{};
};

/// What a solved step has to say of its contacts beyond their impulses; vectors of one entry per contact or
/// none.
struct StepTrace {
  std::vector<double> drilling{};  // about the normal, on A [N m s]
  std::vector<Anchor> anchors{};
  std::vector<char> solved{};  // none: all
  std::span<const SE3> g{};    // g_wb of all bodies where the contacts were found; empty: the identity
  // On A and on B of each contact, where their material is in the frames of the bodies [m]; empty: at the
  // proximal points, as of rigid bodies
  std::span<const std::array<Vec3, 2>> places{};
};

/// Keeps every contact; `impulses[i]` acts on A of contact i, world [N s]. Throws std::invalid_argument
/// unless there is one impulse per contact.
ContactMemory remember(const ContactSet& contacts, const std::vector<Vec3>& impulses,
                       const StepTrace& trace = {});

/// Of each pose.
std::vector<SE3> inverses(std::span<const SE3> g);

/// The pose of a body, the identity where none is given.
SE3 pose_of(std::span<const SE3> g, int body);

}  // namespace aussois
