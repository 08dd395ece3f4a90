// SPDX-License-Identifier: Apache-2.0
// The daemon's protocol, spoken by a double.
#include "station/spacenav.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <thread>
#include <unistd.h>

#include <sys/socket.h>
#include <sys/un.h>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

std::string record(std::array<std::int32_t, 8> words) {
  return {reinterpret_cast<const char*>(words.data()), sizeof words};
}
const std::string kMotion = record({0, 1, -2, 3, 10, -20, 30, 8}), kPress = record({1, 5, 0, 0, 0, 0, 0, 0}),
                  kRelease = record({2, 5, 0, 0, 0, 0, 0, 0});

// A record that comes in two pieces is one, wherever it is cut.
TEST(SpacenavFraming, ReadsARecordThatIsCutAnywhere) {
  for (std::size_t cut = 1; cut < 32; ++cut) {
    SpacenavFraming framing;
    EXPECT_TRUE(framing.add(kMotion.substr(0, cut)).empty());
    const std::vector<SpacenavEvent> events = framing.add(kMotion.substr(cut) + kPress);
    ASSERT_EQ(events.size(), 2u) << cut;
    EXPECT_EQ(events[0].axes, (std::array<int, 6>{1, -2, 3, 10, -20, 30}));
    EXPECT_EQ(events[0].milliseconds, 8);
    EXPECT_EQ(events[1].kind, SpacenavEvent::Kind::press);
    EXPECT_EQ(events[1].button, 5);
  }
}

TEST(SpacenavFraming, LeavesOutWhatItDoesNotKnow) {
  SpacenavFraming framing;
  const std::vector<SpacenavEvent> events = framing.add(record({7, 1, 2, 3, 4, 5, 6, 7}) + kRelease);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, SpacenavEvent::Kind::release);
}

TEST(Spacenav, MotionIsATwistWithADeadZone) {
  SpacenavEvent event{.axes = {350, 0, -350, 10, 0, 175}};
  const LiveCommand command = command_of(event, {1, 2, 3}, 0.1, 2);
  EXPECT_EQ(command.mode, LiveCommand::Mode::twist);
  EXPECT_EQ(command.grip, Vec3(1, 2, 3));
  EXPECT_NEAR(command.twist[0], 0.1, 1e-12);
  EXPECT_NEAR(command.twist[1], -0.1, 1e-12);
  EXPECT_EQ(command.twist[2], 0);
  EXPECT_EQ(command.twist[3], 0);  // within the dead zone
  EXPECT_NEAR(command.twist[4], 2 * std::pow(0.45 / 0.95, 3), 1e-12);
  event.axes = {10, -10, 5, 0, 0, 0};
  EXPECT_EQ(command_of(event, Vec3::Zero()).mode, LiveCommand::Mode::none);
}

// A daemon for one client: answers with its version, or not at all, says its text and hangs up.
class Daemon {
 public:
  Daemon(const std::filesystem::path& path, int version, std::string text) {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, path.c_str(), path.string().size());
    listener_ = socket(AF_UNIX, SOCK_STREAM, 0);
    EXPECT_EQ(bind(listener_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    thread_ = std::thread([this, version, text] {
      const int client = accept(listener_, nullptr, nullptr);
      std::int32_t asked = 0;
      EXPECT_EQ(recv(client, &asked, sizeof asked, MSG_WAITALL), 4);
      EXPECT_EQ(asked & 0x7fffff00, 0x7faa5500);
      const std::int32_t answer = (asked & ~0xff) | version;
      if (version > 0) {
        EXPECT_EQ(send(client, &answer, sizeof answer, 0), 4);
      }
      for (const char byte : text) EXPECT_EQ(send(client, &byte, 1, 0), 1);
      close(client);
    });
  }
  ~Daemon() {
    thread_.join();
    close(listener_);
  }

 private:
  int listener_ = -1;
  std::thread thread_{};
};

void reads_all(int version) {
  const std::filesystem::path path = std::filesystem::absolute(fresh_folder()) / "s";
  if (path.string().size() > 100) GTEST_SKIP() << "the path is too long for a socket";
  const Daemon daemon(path, version, version == 0 ? std::string() : kMotion + kPress + kRelease);
  Spacenav mouse(path);
  EXPECT_EQ(mouse.protocol(), version);
  std::vector<SpacenavEvent> events;
  try {
    for (int k = 0; k < 1000; ++k)
      for (const SpacenavEvent& event : mouse.read(0.1)) events.push_back(event);
  } catch (const std::runtime_error& gone) {
    expect_names(gone.what(), "is gone");
  }
  EXPECT_EQ(events.size(), version == 0 ? 0u : 3u);
}
TEST(Spacenav, ReadsWhatTheDaemonSays) {
  reads_all(1);
}
TEST(Spacenav, TalksToADaemonThatKnowsNoVersions) {
  reads_all(0);
}
TEST(Spacenav, SaysThatNobodyListens) {
  expect_names(message_of<std::runtime_error>([] { Spacenav none("nowhere/spnav.sock"); }),
               "no space mouse daemon");
  expect_names(message_of<std::runtime_error>([] { Spacenav none(std::string(200, 'x')); }),
               "too long for a socket");
}

}  // namespace
}  // namespace aussois
