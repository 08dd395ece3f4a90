// SPDX-License-Identifier: Apache-2.0
// Takes and their past, by hand.
#include "station/take_reader.hpp"

#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

PortTarget at(double x) {
  return {.mode = PortTarget::Mode::pose, .pose = translation(x, 0, 0)};
}

// Take 1 leaves take 0 at moment 4, take 2 leaves take 1 at moment 2, in the past of its parent.
SessionLog three_takes() {
  return {
      .takes = {{-1, 0, 10}, {0, 4, 8}, {1, 6, 9}},
      .inputs = {{0, 0, at(1)}, {0, 3, at(2)}, {0, 7, at(3)}, {1, 4, at(4)}, {1, 7, at(5)}, {2, 6, at(6)}},
      .changes = {{0, 2, "mu", 0.1}, {0, 4, "mu", 0.2}, {1, 5, "mu", 0.3}, {1, 5, "tick", 0.01}},
      .marks = {{0, 4, "note", "left here"}, {1, 4, "note", "came here"}, {2, 9, "note", "end"}},
      .hashes = {{0, 4, 40}, {0, 8, 80}, {1, 8, 81}, {2, 9, 92}}};
}

TEST(TakeReader, ReadsATakeWithItsPast) {
  const SessionLog log = three_takes();
  validate(log);
  const TakeReader reader(log, 2);
  EXPECT_EQ(reader.ends(), 9);
  const std::vector<double> wanted{1, 1, 1, 2, 4, 4, 6, 6, 6};
  for (int tick = 0; tick < 9; ++tick) EXPECT_EQ(reader.input(tick).pose.p.x(), wanted[std::size_t(tick)]);
}

// What was changed, or said, where a take was left belongs to what came of it there.
TEST(TakeReader, LeavesOutWhatCameAfterATakeWasLeft) {
  const SessionLog log = three_takes();
  const TakeReader reader(log, 2);
  EXPECT_EQ(reader.changes(2).size(), 1u);
  EXPECT_TRUE(reader.changes(4).empty());
  ASSERT_EQ(reader.changes(5).size(), 2u);
  EXPECT_EQ(reader.changes(5)[1].name, "tick");
  ASSERT_EQ(reader.marks().size(), 2u);
  EXPECT_EQ(reader.marks()[0].text, "came here");
  ASSERT_EQ(reader.hashes().size(), 2u);
  EXPECT_EQ(reader.hashes()[0].hash, 40u);
}

TEST(TakeReader, RefusesWhatIsNotThere) {
  const SessionLog log = three_takes();
  expect_names(message_of([&] { (void)TakeReader(log, 3); }), "take = 3 must lie in [0, 3)");
  expect_names(message_of([&] { (void)TakeReader(log, 2).input(9); }), "tick = 9 must lie in [0, 9)");
}

TEST(SessionLog, IsRefusedUnlessItFitsTogether) {
  const auto told = [](const std::function<void(SessionLog&)>& spoil) {
    SessionLog log = three_takes();
    spoil(log);
    return message_of([&] { validate(log); });
  };
  expect_names(told([](SessionLog& l) { l.takes.clear(); }), "has no take");
  expect_names(told([](SessionLog& l) { l.takes[1].parent = 1; }), "take 1: parent = 1");
  expect_names(told([](SessionLog& l) { l.takes[0].parent = 0; }), "take 0: parent = 0 must be -1");
  expect_names(told([](SessionLog& l) { l.takes[1].begins = 11; }), "take 1: begins = 11");
  expect_names(told([](SessionLog& l) { l.takes[2].ends = 5; }), "take 2: ends = 5");
  expect_names(told([](SessionLog& l) { l.inputs[3].tick = 5; }), "input 3: tick = 5");
  expect_names(told([](SessionLog& l) { l.inputs[1].tick = 0; }), "input 1: tick = 0");
  expect_names(told([](SessionLog& l) { l.inputs.pop_back(); }), "take 2: has no input");
  expect_names(told([](SessionLog& l) { l.inputs[0].target.pose.R.w() = 2; }), "input 0: pose");
  expect_names(told([](SessionLog& l) { l.inputs[0].target.grip.x() = kInf; }), "input 0: grip");
  expect_names(told([](SessionLog& l) { l.inputs[0].target.mode = PortTarget::Mode(7); }),
               "input 0: mode = 7");
  expect_names(told([](SessionLog& l) { l.changes[0].take = 3; }), "change 0: take = 3");
  expect_names(told([](SessionLog& l) { l.changes[0].value = kInf; }), "change 0: value");
  expect_names(told([](SessionLog& l) { l.marks[2].moment = 12; }), "mark 2: moment = 12");
  expect_names(told([](SessionLog& l) { l.hashes[0].moment = -1; }), "hash 0: moment = -1");
}

}  // namespace
}  // namespace aussois
