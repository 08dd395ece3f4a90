// SPDX-License-Identifier: Apache-2.0
// Messages against the tables of doc/live_protocol.md, and what is refused.
#include "io/live_message.hpp"

#include <cstring>
#include <map>
#include <regex>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

struct Place {
  std::size_t at = 0;
  std::string type{};
};
// The rows of the table whose last column is headed by `name`.
std::map<std::string, Place> table(const std::string& name) {
  const std::string text = content_of(std::string(AUSSOIS_SOURCE_DIR) + "/doc/live_protocol.md");
  std::size_t at = text.find("| at | type | " + name + " |\n");
  EXPECT_NE(at, std::string::npos);
  std::map<std::string, Place> out;
  const std::regex row(R"(\| (\d+) \| (\S+) \| (`?)(\w+).*)");
  for (at = text.find('\n', text.find('\n', at) + 1) + 1; text[at] == '|'; at = text.find('\n', at) + 1) {
    std::smatch found;
    const std::string line = text.substr(at, text.find('\n', at) - at);
    EXPECT_TRUE(std::regex_match(line, found, row)) << line;
    out[found[4]] = {std::stoul(found[1]), found[2]};
  }
  return out;
}
// What stands at a place, as numbers.
std::vector<double> values(const std::string& bytes, const Place& place) {
  const std::string scalar = place.type.substr(0, 3);
  const std::size_t n = place.type.size() > 3 ? std::stoul(place.type.substr(4)) : 1;
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) {
    const auto read = [&]<class T>(T value) {
      EXPECT_EQ(place.at % sizeof value, 0u);
      EXPECT_LE(place.at + (i + 1) * sizeof value, bytes.size());
      std::memcpy(&value, bytes.data() + place.at + i * sizeof value, sizeof value);
      out.push_back(double(value));
    };
    if (scalar == "u16")
      read(std::uint16_t{});
    else if (scalar == "u32")
      read(std::uint32_t{});
    else if (scalar == "u64")
      read(std::uint64_t{});
    else if (scalar == "i64")
      read(std::int64_t{});
    else if (scalar == "f32")
      read(float{});
    else if (scalar == "f64")
      read(double{});
    else
      ADD_FAILURE() << scalar;
  }
  return out;
}
void expect_table(const std::string& name, const std::string& bytes,
                  const std::map<std::string, std::vector<double>>& wanted) {
  const std::map<std::string, Place> places = table(name);
  EXPECT_EQ(places.size(), wanted.size());
  for (const auto& [field, value] : wanted) {
    ASSERT_TRUE(places.contains(field)) << field;
    const std::vector<double> found = values(bytes, places.at(field));
    ASSERT_EQ(found.size(), value.size()) << field;
    for (std::size_t i = 0; i < value.size(); ++i) EXPECT_FLOAT_EQ(float(found[i]), float(value[i])) << field;
  }
}

TEST(LiveMessage, FrameIsAsThePageSays) {
  LiveFrame frame{.t = 1.5,
                  .moment = 70,
                  .ends = 90,
                  .take = 2,
                  .flags = kLiveHeld | kLiveLimit,
                  .slow = 0.75,
                  .distance = 3e-5};
  frame.near_a = {1.5, 2, 3}, frame.near_b = {4, 5, 6.5}, frame.pull = {7, 8, 9}, frame.torque = {-1, -2, -3};
  frame.meshes = {translation(1, 2, 3), rotation(Vec3::UnitZ(), 1)};
  frame.contacts = {
      {.point = {2, 2, 2}, .normal = {0, 0, 1}, .force = {0, 1, 5}, .gap = -1e-6, .a = 1, .b = 0}};
  frame.all_contacts = 17;
  const std::string bytes = to_bytes(frame, {1, 1, 1}, 42, 5);
  EXPECT_EQ(bytes.size(), 128u + 2 * 28 + 44);
  expect_table("head", bytes,
               {{"kind", {1}}, {"version", {1}}, {"bytes", {double(bytes.size())}}, {"sequence", {42}}});
  expect_table("frame", bytes,
               {{"t", {1.5}},
                {"moment", {70}},
                {"take", {2}},
                {"flags", {17}},
                {"slow", {0.75}},
                {"distance", {3e-5}},
                {"near_a", {0.5, 1, 2}},
                {"near_b", {3, 4, 5.5}},
                {"pull", {7, 8, 9}},
                {"torque", {-1, -2, -3}},
                {"bodies", {2}},
                {"contacts", {1}},
                {"all_contacts", {17}},
                {"spare", {0}},
                {"skipped", {5}},
                {"ends", {90}}});
  const std::vector<double> contact = values(bytes, {128 + 56, "f32[10]"});
  EXPECT_EQ(contact, (std::vector<double>{1, 1, 1, 0, 0, 1, 0, 1, 5, double(-1e-6f)}));
  EXPECT_EQ(values(bytes, {128 + 56 + 40, "u16[2]"}), (std::vector<double>{1, 0}));
  EXPECT_EQ(values(bytes, {128, "f32[7]"}), (std::vector<double>{0, 1, 2, 0, 0, 0, 1}));
}

TEST(LiveMessage, MeshIsAsThePageSays) {
  const LiveMesh mesh{
      .hash = 99, .vertices = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, .faces = {{0, 1, 2}}, .wires = {{2, 0}}};
  const std::string bytes = to_bytes(mesh);
  EXPECT_EQ(bytes.size(), 64u + 36 + 12 + 8);
  expect_table(
      "mesh", bytes,
      {{"hash", {99}}, {"vertices", {3}}, {"faces", {1}}, {"wires", {1}}, {"spare", std::vector<double>(7)}});
  EXPECT_EQ(values(bytes, {64 + 36, "u32[5]"}), (std::vector<double>{0, 1, 2, 2, 0}));
}

LiveCommand push() {
  LiveCommand out{
      .mode = LiveCommand::Mode::pose, .firm = false, .drawn = 7, .pose = rotation(Vec3::UnitX(), 0.5)};
  out.pose.p = {3, 4, 5};
  out.grip = {0.1, 0.2, 0.3};
  return out;
}

TEST(LiveMessage, CommandIsAsThePageSaysAndReadsBack) {
  const Vec3 origin(1, 1, 1);
  const std::string bytes = to_bytes(push(), origin, 3);
  const Quat q = push().pose.R;
  expect_table("command", bytes,
               {{"mode", {1}},
                {"firm", {0}},
                {"drawn", {7}},
                {"values", {2, 3, 4, q.x(), q.y(), q.z(), q.w()}},
                {"grip", {0.1, 0.2, 0.3}},
                {"spare", {0}}});
  const LiveCommand back = live_command(bytes, origin);
  EXPECT_EQ(back.mode, LiveCommand::Mode::pose);
  EXPECT_FALSE(back.firm);
  EXPECT_EQ(back.drawn, 7u);
  EXPECT_EQ(back.pose.p, push().pose.p);
  EXPECT_EQ(back.grip, push().grip);
  LiveCommand turn{.mode = LiveCommand::Mode::twist};
  turn.twist << 1, 2, 3, 4, 5, 6;
  EXPECT_EQ(live_command(to_bytes(turn, origin, 1), origin).twist, turn.twist);
}

TEST(LiveMessage, RefusesWhatIsNoCommand) {
  const std::string good = to_bytes(push(), Vec3::Zero(), 1);
  const auto told = [&](std::size_t at, auto value) {
    std::string bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return message_of([&] { (void)live_command(bytes, Vec3::Zero()); });
  };
  expect_names(message_of([&] { (void)live_command(good.substr(1), Vec3::Zero()); }),
               "bytes = 119 must be 120");
  expect_names(message_of([&] { (void)live_command({}, Vec3::Zero()); }), "bytes = 0 must be 120");
  expect_names(told(0, std::uint16_t(1)), "kind = 1 must be 2");
  expect_names(told(2, std::uint16_t(2)), "version = 2 must be 1");
  expect_names(told(4, std::uint32_t(119)), "length in its head = 119");
  expect_names(told(16, std::uint32_t(3)), "mode = 3 must be 0, 1 or 2");
  expect_names(told(20, std::uint32_t(2)), "firm = 2");
  expect_names(told(32, kInf), "target [m] = inf must lie within 1000");
  expect_names(told(32, std::nan("")), "target [m] = nan");
  expect_names(told(40, 1e308), "target [m] = 1e+308");
  expect_names(told(80, 0.0), "command: pose");  // no unit quaternion
  expect_names(told(88, -kInf), "grip [m] = -inf");
  LiveCommand fast{.mode = LiveCommand::Mode::twist};
  fast.twist[0] = 1e3;
  expect_names(message_of([&] { (void)live_command(to_bytes(fast, Vec3::Zero(), 1), Vec3::Zero()); }),
               "speed [m/s] = 1000 must lie within 100");
}

// Whatever bytes come, a command is read or refused, and what is read is finite.
TEST(LiveMessage, SurvivesAnyBytes) {
  Random random(7);
  for (int k = 0; k < 100000; ++k) {
    std::string bytes = to_bytes(push(), Vec3::Zero(), 1);
    for (int n = random.index(6); n >= 0; --n) bytes[std::size_t(random.index(120))] = char(random.bits());
    try {
      const LiveCommand read = live_command(bytes, Vec3::Zero());
      ASSERT_TRUE(read.pose.p.allFinite() && read.twist.allFinite() && read.grip.allFinite());
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace
}  // namespace aussois
