// SPDX-License-Identifier: Apache-2.0
#include "station/spacenav.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include <sys/socket.h>
#include <sys/un.h>

namespace aussois {
namespace {

constexpr std::int32_t kAskForOne = 0x7faa5501;  // version 1 of the protocol, in the last byte
constexpr int kAnswerMilliseconds = 300;         // a daemon of version 0 says nothing

bool wait_for(int socket, int milliseconds) {
  pollfd one{.fd = socket, .events = POLLIN, .revents = 0};
  return poll(&one, 1, milliseconds) > 0;
}

}  // namespace

std::vector<SpacenavEvent> SpacenavFraming::add(std::string_view bytes) {
  std::vector<SpacenavEvent> out;
  for (const char byte : bytes) {
    record_[filled_++] = byte;
    if (filled_ < record_.size()) continue;
    filled_ = 0;
    std::array<std::int32_t, 8> words{};
    std::memcpy(words.data(), record_.data(), record_.size());
    SpacenavEvent event;
    if (words[0] == 0) {
      for (std::size_t i = 0; i < 6; ++i) event.axes[i] = words[i + 1];
      event.milliseconds = words[7];
    } else if (words[0] == 1 || words[0] == 2) {
      event.kind = words[0] == 1 ? SpacenavEvent::Kind::press : SpacenavEvent::Kind::release;
      event.button = words[1];
    } else {
      continue;
    }
    out.push_back(event);
  }
  return out;
}

LiveCommand command_of(const SpacenavEvent& motion, const Vec3& grip, double speed, double spin) {
  constexpr double kFull = 350, kDead = 0.05;
  const auto bent = [](int value) {
    const double x = double(value) / kFull, size = (std::abs(x) - kDead) / (1 - kDead);
    return size > 0 ? std::copysign(std::min(1.0, size * size * size), x) : 0.0;
  };
  LiveCommand out{.mode = LiveCommand::Mode::twist, .grip = grip};
  const auto& a = motion.axes;  // of the daemon: y up, z away
  out.twist << speed * Vec3(bent(a[0]), bent(a[2]), bent(a[1])),
      spin * Vec3(bent(a[3]), bent(a[5]), bent(a[4]));
  if (out.twist.isZero(0)) out.mode = LiveCommand::Mode::none;
  return out;
}

std::filesystem::path Spacenav::usual_socket() {
  if (const char* said = std::getenv("SPNAV_SOCKET"); said && *said) return said;
  std::ifstream settings("/etc/spnavrc");
  for (std::string line; std::getline(settings, line);) {
    const std::size_t is = line.find('=');
    if (line.find("socket") < is && is != line.npos) {
      const std::size_t begin = line.find_first_not_of(" \t", is + 1);
      if (begin != line.npos) return line.substr(begin, line.find_last_not_of(" \t") - begin + 1);
    }
  }
  return "/var/run/spnav.sock";
}

Spacenav::Spacenav(const std::filesystem::path& path) {
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof at.sun_path) throw std::runtime_error(name + ": too long for a socket");
  std::memcpy(at.sun_path, name.c_str(), name.size());
  socket_ = socket(AF_UNIX, SOCK_STREAM, 0);
  if (socket_ < 0 || connect(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0) {
    const std::string why = std::strerror(errno);
    if (socket_ >= 0) close(socket_);
    throw std::runtime_error(name + ": no space mouse daemon: " + why);
  }
  std::int32_t answer = 0;
  if (send(socket_, &kAskForOne, sizeof kAskForOne, MSG_NOSIGNAL) == sizeof kAskForOne &&
      wait_for(socket_, kAnswerMilliseconds) &&
      recv(socket_, &answer, sizeof answer, MSG_PEEK) == sizeof answer &&
      (answer & 0x7fffff00) == (kAskForOne & 0x7fffff00)) {
    (void)recv(socket_, &answer, sizeof answer, 0);
    protocol_ = answer & 0xff;
  }
}

Spacenav::~Spacenav() {
  close(socket_);
}

std::vector<SpacenavEvent> Spacenav::read(double seconds) {
  if (!wait_for(socket_, int(1e3 * seconds))) return {};
  char bytes[1024];
  const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
  if (count <= 0) throw std::runtime_error("the space mouse daemon is gone");
  return framing_.add({bytes, std::size_t(count)});
}

}  // namespace aussois
