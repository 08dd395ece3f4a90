// SPDX-License-Identifier: Apache-2.0
// The binary messages between a station and its pages, as bytes: no socket here. doc/live_protocol.md is the
// reference of their fields.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

inline constexpr const char* kLiveProtocol = "aussois.live.1";
inline constexpr std::uint16_t kLiveVersion = 1;

enum class LiveKind : std::uint16_t { frame = 1, command = 2, mesh = 3 };

/// Points and poses are relative to an origin, so that single precision is enough.
struct LiveContact {
  Vec3 point = Vec3::Zero();   // on A's dilated surface [m]
  Vec3 normal = Vec3::Zero();  // unit, from B to A
  Vec3 force = Vec3::Zero();   // on A [N]
  double gap = 0;              // [m]
  int a = 0, b = 0;            // bodies
};

enum LiveFlag : std::uint32_t {
  kLiveHeld = 1,      // the hand holds the part
  kLivePaused = 2,    // no ticks are taken
  kLiveRefused = 4,   // the rest of the last tick was refused
  kLiveUnsolved = 8,  // a problem of the last tick was not solved
  kLiveLimit = 16     // the pull is at its limit
};

/// What a page draws.
struct LiveFrame {
  std::uint64_t serial = 0;                           // grows with each that is new; not sent
  double t = 0;                                       // [s]
  std::int64_t moment = 0, ends = 0;                  // of the take, and its last
  std::uint32_t take = 0, flags = 0;                  // LiveFlag
  double slow = 1;                                    // simulated seconds per second
  double distance = kInf;                             // of the meshes in the last tick, lower bound [m]
  Vec3 near_a = Vec3::Zero(), near_b = Vec3::Zero();  // proximal points of the smallest gap [m]
  Vec3 pull = Vec3::Zero(), torque = Vec3::Zero();    // of the hand on the part, world [N], [N m]
  std::vector<SE3> meshes{};                          // poses of the bodies' meshes [m]
  std::vector<LiveContact> contacts{};                // the largest forces first
  std::uint32_t all_contacts = 0;                     // how many there are
};

/// What a hand says.
struct LiveCommand {
  enum class Mode : std::uint32_t { none, pose, twist };
  Mode mode = Mode::none;
  bool firm = true;
  std::uint64_t drawn = 0;    // sequence of the last frame that the page has drawn
  SE3 pose{};                 // of the grip; R: of the mesh [m]
  Vec6 twist = Vec6::Zero();  // of the grip, in the world [m/s, rad/s]
  Vec3 grip = Vec3::Zero();   // in the frame of the mesh [m]
};

struct LiveMesh {
  std::uint64_t hash = 0;  // of the content
  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> faces{};
  std::vector<std::array<int, 2>> wires{};
};

/// Positions are sent relative to `origin`. `skipped`: frames that this page was not sent.
std::string to_bytes(const LiveFrame& frame, const Vec3& origin, std::uint64_t sequence,
                     std::uint64_t skipped);
std::string to_bytes(const LiveMesh& mesh);
std::string to_bytes(const LiveCommand& command, const Vec3& origin, std::uint64_t sequence);  // for tests

/// Throws std::invalid_argument naming what is wrong: length, kind, version, a value and its bound.
LiveCommand live_command(std::string_view bytes, const Vec3& origin);

std::uint64_t content_hash(const LiveMesh& mesh);

}  // namespace aussois
