// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "io/session_writer.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

SessionLog some_log() {
  PortTarget pushed{.mode = PortTarget::Mode::pose, .pose = rotation(Vec3::UnitX(), 0.3), .grip = {1, 2, 3}};
  pushed.pose.p = {0.1, -0.0, 1e-300};
  PortTarget turned{.mode = PortTarget::Mode::twist, .firm = false};
  turned.twist << 1, 2, 3, 4, 5, 6;
  return {.takes = {{-1, 0, 70}, {0, 30, 40}},
          .inputs = {{0, 0, {}}, {0, 5, pushed}, {1, 30, turned}},
          .changes = {{0, 9, "mu", 0.1}, {0, 9, "tick", 1e-3}},
          .marks = {{0, 70, "note", "\xc3\xa9pine, \"stuck\"\n"}, {1, 33, "touch", ""}},
          .hashes = {{0, 64, 0xfedcba9876543210u}, {1, 40, 7}}};
}

void expect_same(const SessionLog& a, const SessionLog& b) {
  ASSERT_EQ(a.takes.size(), b.takes.size());
  for (std::size_t i = 0; i < a.takes.size(); ++i) EXPECT_EQ(a.takes[i].ends, b.takes[i].ends);
  ASSERT_EQ(a.inputs.size(), b.inputs.size());
  for (std::size_t i = 0; i < a.inputs.size(); ++i) {
    const PortTarget &x = a.inputs[i].target, &y = b.inputs[i].target;
    EXPECT_EQ(a.inputs[i].tick, b.inputs[i].tick);
    EXPECT_EQ(x.mode, y.mode);
    EXPECT_EQ(x.pose.p, y.pose.p);
    EXPECT_EQ(x.pose.R.coeffs(), y.pose.R.coeffs());
    EXPECT_EQ(x.twist, y.twist);
    EXPECT_EQ(x.grip, y.grip);
    EXPECT_EQ(x.firm, y.firm);
  }
  ASSERT_EQ(a.changes.size(), b.changes.size());
  for (std::size_t i = 0; i < a.changes.size(); ++i) {
    EXPECT_EQ(a.changes[i].name, b.changes[i].name);
    EXPECT_EQ(a.changes[i].value, b.changes[i].value);
  }
  ASSERT_EQ(a.marks.size(), b.marks.size());
  for (std::size_t i = 0; i < a.marks.size(); ++i) {
    EXPECT_EQ(a.marks[i].kind, b.marks[i].kind);
    EXPECT_EQ(a.marks[i].text, b.marks[i].text);
  }
  ASSERT_EQ(a.hashes.size(), b.hashes.size());
  for (std::size_t i = 0; i < a.hashes.size(); ++i) EXPECT_EQ(a.hashes[i].hash, b.hashes[i].hash);
}

TEST(SessionFile, GivesASessionBackBitForBit) {
  const std::filesystem::path path = fresh_folder() / "session.h5";
  SessionWriter writer(path, {{"scene", "bolt"}});
  writer.write(some_log());
  writer.close();
  const SessionData read = read_session(path);
  EXPECT_EQ(read.notes.at("scene"), "bolt");
  expect_same(read.log, some_log());
}

// In parts, as a session grows; readable while it is written, and after a death.
TEST(SessionFile, GrowsAndIsReadableAtAnyMoment) {
  const std::filesystem::path path = fresh_folder() / "session.h5";
  const SessionLog all = some_log();
  SessionLog part{.takes = {{-1, 0, 20}}, .inputs = {all.inputs[0]}};
  {
    SessionWriter writer(path, {});
    writer.write(part);
    part.takes[0].ends = 60;
    part.inputs.push_back(all.inputs[1]);
    part.changes = all.changes;
    writer.write(part);
    writer.write(all);
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  expect_same(read_session(path.string() + ".tmp").log, all);
}

// Wherever a dying program cuts the journal, what was whole before is there, and fits together.
TEST(SessionFile, IsReadableWhereverItsJournalIsCut) {
  const std::filesystem::path folder = fresh_folder(), path = folder / "session.h5";
  const SessionLog all = some_log();
  {
    SessionWriter writer(path, {{"scene", "bolt"}});
    SessionLog part{.takes = {{-1, 0, 20}}, .inputs = {all.inputs[0]}};
    writer.write(part);
    writer.write(all);
  }
  const std::string bytes = content_of(path.string() + ".tmp");
  const std::size_t head = bytes.find('\n') + 1;
  std::size_t most = 0;
  for (std::size_t cut = head; cut <= bytes.size(); ++cut) {
    const SessionData read = read_session(write_bytes(folder / "cut.tmp", bytes.substr(0, cut)));
    EXPECT_EQ(read.notes.at("scene"), "bolt");
    EXPECT_GE(read.log.takes[0].ends, std::int64_t(most));
    most = std::size_t(read.log.takes[0].ends);
  }
  EXPECT_EQ(most, 70u);
  std::string spoilt = bytes;
  spoilt.insert(head, "{\"fly\": [1]}\n");
  expect_names(
      message_of<std::runtime_error>([&] { (void)read_session(write_bytes(folder / "cut.tmp", spoilt)); }),
      "cut.tmp:2: 'fly' is unknown");
}

// What a killed session left is no prey of the next.
TEST(SessionFile, KeepsWhatAKilledSessionLeft) {
  const std::filesystem::path folder = fresh_folder(), path = folder / "session.h5";
  for (int k = 0; k < 2; ++k) SessionWriter(path, {}).write(some_log());
  SessionWriter third(path, {});
  expect_same(read_session(folder / "session_left_1.h5").log, some_log());
  expect_same(read_session(folder / "session_left_2.h5").log, some_log());
}

TEST(SessionFile, RefusesWhatIsNoSession) {
  const std::filesystem::path path = fresh_folder() / "session.h5";
  expect_names(message_of<std::runtime_error>([&] { (void)read_session(path); }), "session.h5");
  std::ofstream(path) << "no HDF5";
  expect_names(message_of<std::runtime_error>([&] { (void)read_session(path); }), "session.h5");
  SessionLog spoilt = some_log();
  spoilt.marks[0].moment = 99;
  write_session(path, {.log = spoilt});
  expect_names(message_of<std::runtime_error>([&] { (void)read_session(path); }), "mark 0: moment = 99");
}

TEST(SessionFile, IsWrittenByOneSessionAlone) {
  const std::filesystem::path path = fresh_folder() / "session.h5";
  SessionWriter first(path, {});
  expect_names(message_of<std::runtime_error>([&] { SessionWriter second(path, {}); }), "session.h5.tmp");
}

}  // namespace
}  // namespace aussois
