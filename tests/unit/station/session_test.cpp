// SPDX-License-Identifier: Apache-2.0
// Sessions against themselves: whatever a hand does, going back and repeating give the same bits (SES-1) to
// (SES-3).
#include "station/session.hpp"

#include "station/take_reader.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"
#include "tests/unit/station/desk.hpp"

namespace aussois {
namespace {

PortTarget to(double x, double z) {
  return {.mode = PortTarget::Mode::pose, .pose = translation(x, 0, z)};
}
// Down into the plate, along it, and away.
PortTarget stroke(std::int64_t tick) {
  const double s = 1e-3 * double(tick % 200);
  return tick % 200 < 190 ? to(0.1 * s, std::max(0.005, 0.02 - 0.2 * s)) : PortTarget{};
}
void play(Session& session, std::int64_t ticks) {
  for (std::int64_t k = 0; k < ticks; ++k) ASSERT_TRUE(session.tick(stroke(session.moment())).whole());
}
TakeRepeat repeat(const Session& session, int take, const SessionOptions& options = {}) {
  SessionStage stage(desk, parameters(), options);
  return repeat_take(session.log(), take, stage);
}

struct Sessions : testing::TestWithParam<const char*> {
  SessionOptions options() const {
    SessionOptions out{.scheme = GetParam()};
    out.options.moreau_jean.theta = 1;
    return out;
  }
};

// Ten seconds with three ways back and four changes.
TEST_P(Sessions, AreRepeatedWithTheSameBits) {
  Session session(desk, parameters(), options());
  play(session, 300);
  session.change("mu", 0.5);
  play(session, 100);
  session.seek(0, 150);
  session.change("gravity_x", 1);
  session.change("port.gains.stiffness", 1e3);
  play(session, 200);
  session.seek(1, 101);
  play(session, 77);
  session.seek(0, 400);
  session.change("tick", 1e-3);
  play(session, 130);
  session.add_hash();
  ASSERT_EQ(session.log().takes.size(), 3u);
  for (int take = 0; take < 3; ++take) {
    const TakeRepeat again = repeat(session, take, options());
    EXPECT_EQ(again.differs, -1) << "take " << take;
    EXPECT_EQ(again.ticks, session.log().takes[std::size_t(take)].ends);
    EXPECT_GT(again.hashes, again.ticks / 64);
  }
}

TEST_P(Sessions, GoBackToAnyMoment) {
  Session session(desk, parameters(), options());
  std::vector<std::uint64_t> then{hash(session.state())};
  for (int k = 0; k < 500; ++k) {
    if (k == 222) session.change("mu", 0);
    (void)session.tick(stroke(k));
    then.push_back(hash(session.state()));
  }
  Random random(5);
  for (int k = 0; k < 40; ++k) {
    const std::int64_t moment = k == 0 ? 0 : k == 1 ? 500 : std::int64_t(random.uniform(0, 500));
    session.seek(0, moment);
    EXPECT_EQ(hash(session.state()), then[std::size_t(moment)]) << moment;
    EXPECT_EQ(session.parameters().mu, moment > 222 ? 0 : 0.2);
  }
  EXPECT_EQ(session.log().takes.size(), 1u);  // who only looks begins nothing
}

INSTANTIATE_TEST_SUITE_P(By, Sessions, testing::Values("moreau_jean", "passive_midpoint"),
                         [](const auto& way) { return std::string(way.param); });

TEST(Session, BeginsATakeWhereAHandTouchesThePast) {
  Session session(desk, parameters());
  play(session, 100);
  session.seek(0, 40);
  EXPECT_EQ(session.take(), 0);
  play(session, 10);
  EXPECT_EQ(session.take(), 1);
  EXPECT_EQ(session.log().takes[1].parent, 0);
  EXPECT_EQ(session.log().takes[1].begins, 40);
  EXPECT_EQ(session.log().takes[0].ends, 100);
  session.seek(1, 20);  // in the past of take 1
  EXPECT_EQ(session.take(), 0);
  session.seek(0, 100);
  play(session, 5);  // at its end a take goes on
  EXPECT_EQ(session.take(), 0);
  EXPECT_EQ(session.log().takes[0].ends, 105);
}

TEST(Session, MarksTouchesAndLimitsByItself) {
  SessionParameters p = parameters();
  p.port.limits.force = 5;
  p.gravity.setZero();
  Session session(desk, p);
  const auto count = [&](const std::string& kind) {
    return std::ranges::count_if(session.log().marks, [&](const SessionMark& m) { return m.kind == kind; });
  };
  for (int k = 0; k < 150; ++k) (void)session.tick(to(0, 0.02));
  EXPECT_EQ(count("touch"), 0);
  for (int k = 0; k < 150; ++k) (void)session.tick(to(0, 0.005));
  EXPECT_EQ(count("touch"), 1);
  EXPECT_EQ(count("limit"), 1);
  EXPECT_EQ(count("refused"), 0);
  session.mark("here");
  EXPECT_EQ(session.log().marks.back().kind, "note");
  EXPECT_EQ(session.log().marks.back().moment, 300);
}

TEST(Session, RefusesAChangeThatDoesNotFitAndGoesOn) {
  Session session(desk, parameters());
  play(session, 100);  // on the plate
  const std::uint64_t before = hash(session.state());
  const auto told = [&](const char* name, double value) {
    return message_of([&] { session.change(name, value); });
  };
  expect_names(told("friction", 1), "parameter 'friction' must be one of: tick, mu, restitution");
  expect_names(told("mu", -1), "mu = -1");
  expect_names(told("tick", 0), "tick = 0");
  expect_names(told("dilation", 0.02), "base distance");
  expect_names(told("port.gains.stiffness", kInf), "stiffness");
  EXPECT_EQ(session.parameters().mu, 0.2);
  EXPECT_EQ(hash(session.state()), before);
  EXPECT_TRUE(session.log().changes.empty());
  play(session, 10);
}

TEST(Session, ChangesTheDilationOfItsParts) {
  Session session(desk, parameters());
  play(session, 100);
  session.change("dilation", 0.5e-3);
  play(session, 100);
  EXPECT_EQ(session.model().shapes[0]->radius, 0.5e-3);
  session.seek(0, 50);
  EXPECT_EQ(session.model().shapes[0]->radius, 1e-3);
  EXPECT_EQ(repeat(session, 0).differs, -1);
}

TEST(Session, RefusesWhatNeverWas) {
  Session session(desk, parameters());
  play(session, 10);
  expect_names(message_of([&] { session.seek(0, 11); }), "moment = 11 must lie in [0, 10]");
  expect_names(message_of([&] { session.seek(0, -1); }), "moment = -1");
  expect_names(message_of([&] { session.seek(1, 0); }), "take = 1 must lie in [0, 1)");
  PortTarget lost = to(0, 0.02);
  lost.pose.p.x() = kInf;
  expect_names(message_of([&] { (void)session.tick(lost); }), "PortTarget::pose");
  EXPECT_EQ(session.moment(), 10);
  EXPECT_EQ(session.log().inputs.size(), 10u);
}

// An older take that goes on with what another take said last; a hash of a moment that is past.
TEST(Session, LogsATakeThatGoesOnAndHashesOfThePast) {
  Session session(desk, parameters());
  play(session, 100);
  session.seek(0, 40);
  for (int k = 0; k < 30; ++k) (void)session.tick({});
  session.seek(0, 100);
  for (int k = 0; k < 100; ++k) (void)session.tick({});
  session.seek(0, 70);
  session.add_hash();
  session.seek(0, 200);
  session.add_hash();
  for (const int take : {0, 1}) {
    const TakeRepeat again = repeat(session, take);
    EXPECT_EQ(again.differs, -1);
    EXPECT_EQ(again.ticks, take == 0 ? 200 : 70);
    EXPECT_GE(again.hashes, take == 0 ? 5 : 2);  // none is left out
  }
}

TEST(Session, TellsWhatCameOfTheTickToWhichItGoes) {
  Session session(desk, parameters());
  play(session, 150);
  const TickReport then = session.tick(stroke(150));
  play(session, 20);
  const TickReport back = session.seek(0, 151);
  ASSERT_EQ(back.steps.size(), then.steps.size());
  EXPECT_EQ(back.steps.back().contacts.size(), then.steps.back().contacts.size());
  EXPECT_FALSE(back.steps.back().contacts.empty());
  EXPECT_TRUE(session.seek(0, 0).steps.empty());
}

// A log that was spoilt, or another program: the first moment that differs is named.
TEST(Session, NamesTheFirstMomentThatDiffers) {
  Session session(desk, parameters());
  play(session, 300);
  SessionLog log = session.log();
  log.inputs[150].target.pose.p.x() += 1e-12;
  SessionStage stage(desk, parameters(), {});
  EXPECT_EQ(repeat_take(log, 0, stage).differs, 192);
}

TEST(Session, KeepsItsStatesWithinItsMemory) {
  SessionOptions options{.memory = 20000};
  SessionParameters p = parameters();
  p.tick = 0.02;
  Session session(desk, p, options);
  std::vector<std::uint64_t> then{hash(session.state())};
  for (int k = 0; k < 4000; ++k) {
    (void)session.tick(to(0, 0.02));
    then.push_back(hash(session.state()));
    ASSERT_LE(session.kept_bytes(), options.memory + 2000);
  }
  for (const std::int64_t moment : {3999, 1, 2049}) {
    session.seek(0, moment);
    EXPECT_EQ(hash(session.state()), then[std::size_t(moment)]);
  }
}

}  // namespace
}  // namespace aussois
