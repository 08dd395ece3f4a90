// SPDX-License-Identifier: Apache-2.0
// Reads a space mouse from the daemon spacenavd by its socket.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "io/live_message.hpp"

namespace aussois {

struct SpacenavEvent {
  enum class Kind { motion, press, release };
  Kind kind = Kind::motion;
  std::array<int, 6> axes{};  // of a motion: along x, y, z and about them, right-handed, each within some 350
  int milliseconds = 0;       // of a motion: since the last
  int button = 0;
};

/// Makes events of bytes, wherever they are cut.
class SpacenavFraming {
 public:
  /// The events that are whole now. Records of a kind that is unknown are left out.
  std::vector<SpacenavEvent> add(std::string_view bytes);

 private:
  std::array<char, 32> record_{};
  std::size_t filled_ = 0;
};

/// A motion as a twist of a grip [m/s, rad/s]: x to the right, z up, the cap's full way at these speeds.
LiveCommand command_of(const SpacenavEvent& motion, const Vec3& grip, double speed = 0.05, double spin = 1);

class Spacenav {
 public:
  /// Where the daemon listens: SPNAV_SOCKET, or what /etc/spnavrc says, or /var/run/spnav.sock.
  static std::filesystem::path usual_socket();

  /// Throws std::runtime_error if no daemon listens there.
  explicit Spacenav(const std::filesystem::path& socket = usual_socket());
  ~Spacenav();
  Spacenav(const Spacenav&) = delete;
  Spacenav& operator=(const Spacenav&) = delete;

  /// What came within this time [s], at once if there is anything. Throws std::runtime_error if the daemon is
  /// gone.
  std::vector<SpacenavEvent> read(double seconds);
  int protocol() const { return protocol_; }

 private:
  int socket_ = -1;
  int protocol_ = 0;
  SpacenavFraming framing_{};
};

}  // namespace aussois
