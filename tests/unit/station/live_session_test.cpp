// SPDX-License-Identifier: Apache-2.0
// A session on its own thread, and a haptic device on another.
#include "station/live_session.hpp"

#include <functional>

#include "ports/simulated_hand.hpp"
#include "station/device_loop.hpp"
#include "station/take_reader.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/unit/station/desk.hpp"

namespace aussois {
namespace {

using Clock = std::chrono::steady_clock;

// Machines that run tests are slow: what matters is that it comes.
bool comes(const std::function<bool()>& fact) {
  const auto end = Clock::now() + std::chrono::seconds(60);
  while (!fact()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

SessionParameters slow_ticks() {
  SessionParameters out = parameters();
  out.tick = 5e-3;
  out.gravity.setZero();
  return out;
}
struct Live {
  std::filesystem::path file = fresh_folder() / "session.h5";
  std::unique_ptr<LiveSession> session{};
  explicit Live(const std::string& scheme = "moreau_jean", LiveOptions options = {}) {
    SessionOptions way{.scheme = scheme};
    way.options.moreau_jean.theta = 1;
    options.file = file;
    session = std::make_unique<LiveSession>(Session(desk, slow_ticks(), way), options);
    scheme_ = way;
  }
  bool flag(LiveFlag which) const { return session->frame().flags & which; }
  // Ends it; every take has the same bits again.
  void end() {
    session.reset();
    const SessionData data = read_session(file);
    for (int take = 0; take < int(data.log.takes.size()); ++take) {
      SessionStage stage(desk, slow_ticks(), scheme_);
      EXPECT_EQ(repeat_take(data.log, take, stage).differs, -1);
    }
  }

 private:
  SessionOptions scheme_{};
};
LiveCommand down(double z) {
  return {.mode = LiveCommand::Mode::pose, .pose = translation(0, 0, z)};
}

TEST(LiveSession, StandsUntilItBeginsThenFollowsTheNewestCommand) {
  Live live;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(live.session->frame().moment, 0);
  live.session->begin();
  EXPECT_TRUE(comes([&] { return live.session->frame().moment > 10; }));
  EXPECT_TRUE(comes([&] {
    live.session->hand(down(0.02));
    live.session->hand(down(0.005));  // into the plate
    return live.flag(kLiveHeld) && !live.session->frame().contacts.empty();
  }));
  EXPECT_GT(live.session->frame().distance, 0);
  live.end();
}

// A hand that says nothing for half a second has let go; the part stays where it is.
TEST(LiveSession, LetsGoWhenTheHandIsGone) {
  Live live;
  live.session->begin();
  EXPECT_TRUE(comes([&] {
    live.session->hand(down(0.03));
    return live.session->frame().meshes[0].p.z() > 0.029;
  }));
  EXPECT_TRUE(comes([&] { return !live.flag(kLiveHeld); }));
  const std::int64_t moment = live.session->frame().moment;
  EXPECT_TRUE(comes([&] { return live.session->frame().moment > moment + 100; }));
  EXPECT_GT(live.session->frame().meshes[0].p.z(), 0.028);
  live.end();
}

TEST(LiveSession, GoesBackAndWaitsForAHandThatTakesHoldAnew) {
  Live live;
  live.session->begin();
  EXPECT_TRUE(comes([&] {
    live.session->hand(down(0.03));
    return live.session->frame().moment > 60;
  }));
  live.session->ask(1, R"({"kind": "seek", "take": 0, "moment": 20})");
  EXPECT_TRUE(comes([&] {
    live.session->hand(down(0.03));  // it has not let go
    return live.flag(kLivePaused) && live.session->frame().moment == 20;
  }));
  live.session->let_go();
  live.session->hand({});
  EXPECT_TRUE(comes([&] {
    live.session->hand(down(0.01));
    return live.session->frame().take == 1;
  }));
  live.end();
}

TEST(LiveSession, AnswersWhoAskedAndTellsAllOfMarks) {
  Live live;
  live.session->begin();
  live.session->ask(7, R"({"kind": "set", "name": "mu", "value": -1})");
  live.session->ask(7, R"({"kind": "mark", "text": "here"})");
  bool refused = false, marked = false;
  EXPECT_TRUE(comes([&] {
    for (const LiveAnswer& answer : live.session->answers()) {
      refused = refused || (answer.page == 7 && answer.text.find("mu = -1") != std::string::npos);
      marked = marked || (answer.page == 0 && answer.text.find("here") != std::string::npos);
    }
    return refused && marked;
  }));
  expect_names(message_of([&] { live.session->ask(1, "[]"); }), "JSON object");
  expect_names(message_of([&] { live.session->ask(1, R"({"kind": "fly"})"); }), "must be one of: set");
  expect_names(message_of([&] { live.session->ask(1, R"({"kind": "seek", "take": 0.5, "moment": 1})"); }),
               "take = 0.5");
  live.end();
}

// ---- a device

HapticDevice hand_above_the_plate(HandKind kind) {
  return simulated_device(kind, {}, {.home = translation(0, 0, 0.02), .shallow = 0.012, .deep = 0.02}, 3);
}

TEST(DeviceLoop, LeadsThePartAndKeepsToTheReserve) {
  Live live("passive_midpoint");
  live.session->begin();
  DeviceRecord record;
  {
    const DeviceLoop device(*live.session, hand_above_the_plate(HandKind::soft));
    EXPECT_TRUE(comes([&] {
      record = device.record();
      return record.samples > 1500 && record.largest_force > 0.1 && !live.session->frame().contacts.empty();
    }));
    EXPECT_TRUE(record.lost.empty()) << record.lost;
  }
  EXPECT_EQ(record.reserve.refused, 0);
  EXPECT_TRUE(comes([&] { return !live.flag(kLiveHeld); }));
  live.end();
}

// Frozen readings, no answer, no numbers: the hand lets go and the device gets no force; a jump lets go for a
// while.
TEST(DeviceLoop, LetsGoOfADeviceThatFails) {
  for (const std::string way : {"frozen", "silent", "nan", "jump"}) {
    Live live("passive_midpoint");
    live.session->begin();
    int reads = 0;
    DeviceForce last;
    HapticDevice device{.name = way,
                        .open = [] {},
                        .read = [&]() -> std::optional<DeviceSample> {
                          const bool bad = ++reads > 300;
                          DeviceSample out{.pose = translation(0, 0, 0.02), .serial = std::uint64_t(reads)};
                          if (bad && way == "silent") return {};
                          if (bad && way == "frozen") out.serial = 300;
                          if (bad && way == "nan") out.pose.p.x() = kInf;
                          if (reads == 301 && way == "jump") out.pose.p.x() = 0.01;
                          return out;
                        },
                        .write = [&](const DeviceForce& force) { last = force; },
                        .close = [] {}};
    {
      const DeviceLoop loop(*live.session, device);
      EXPECT_TRUE(comes([&] {
        return way == "jump" ? loop.record().jumps > 0 : !loop.record().lost.empty();
      })) << way;
      EXPECT_TRUE(comes([&] { return !live.flag(kLiveHeld); })) << way;
    }
    EXPECT_TRUE(last.force.isZero(0)) << way;
    live.end();
  }
}

}  // namespace
}  // namespace aussois
