// SPDX-License-Identifier: Apache-2.0
// What is kept with a key is found with that key, and with no other.
#include "examples/common/kept_json.hpp"

#include <cmath>
#include <limits>

#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

const Json kKey{{"case", "ball"}, {"h", 0.1}, {"program", 0xfedcba9876543210u}};

std::optional<int> answer_in(const std::filesystem::path& path, const Json& key) {
  return read_kept(path, key, [](const Json& json) { return json.at("answer").get<int>(); });
}

}  // namespace

TEST(KeptJson, IsFoundWithItsKeyOnly) {
  const std::filesystem::path path = fresh_folder() / "kept.json";
  EXPECT_FALSE(answer_in(path, kKey));
  write_kept(path, kKey, {{"answer", 42}, {"case", "the key wins"}});
  EXPECT_EQ(
      content_of(path),
      "{\n  \"case\": \"ball\",\n  \"h\": 0.1,\n  \"program\": 18364758544493064720,\n  \"answer\": 42\n}\n");
  EXPECT_EQ(answer_in(path, kKey), 42);
  EXPECT_EQ(answer_in(path, {}), 42);
  for (const auto& [name, value] : kKey.items()) {
    Json other = kKey;
    other[name] = 7;
    EXPECT_FALSE(answer_in(path, other)) << name;
  }
  Json more = kKey;
  more["seed"] = 1;
  EXPECT_FALSE(answer_in(path, more));
}

namespace {

struct Lamp {
  double power = 1 / 3.0;
  int bulbs = 2, watched_by = 1;
  bool dimmed = false;
};
void describe(SettingVisitor& visit, Lamp& o) {
  visit.begin("Lamp");
  visit.number({"power"}, o.power);
  visit.count({"bulbs"}, o.bulbs);
  visit.toggle({"dimmed"}, o.dimmed);
  visit.count({.name = "watched_by", .changes_nothing = true}, o.watched_by);
}

}  // namespace

TEST(KeptJson, HasTheOptionsThatItDependsOn) {
  EXPECT_EQ(settings_json(Lamp{}).dump(), R"({"power":0.3333333333333333,"bulbs":2,"dimmed":false})");
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(settings_json(Lamp{.power = inf, .watched_by = 7}).dump(),
            R"({"power":"inf","bulbs":2,"dimmed":false})");
}

TEST(KeptJson, IsNothingIfItIsDamaged) {
  const std::filesystem::path path = fresh_folder() / "kept.json";
  write_kept(path, kKey, {{"answer", 42}});
  const std::string whole = content_of(path);
  for (std::size_t size = 0; size + 2 < whole.size(); ++size) {
    write_bytes(path, whole.substr(0, size));
    EXPECT_FALSE(answer_in(path, kKey)) << size;
  }
  for (const char* text : {"7", "[]", "null", "\xff", "{\"answer\": \"42\"}"}) {
    write_bytes(path, text);
    EXPECT_FALSE(answer_in(path, {})) << text;
  }
  write_kept(path, kKey, {{"answer", 42}});
  EXPECT_EQ(content_of(path), whole);
  EXPECT_EQ(names_in(path.parent_path()), std::set<std::string>{"kept.json"});
}

TEST(KeptJson, HasEveryNumberToTheLastBit) {
  const double least = std::numeric_limits<double>::denorm_min();
  for (const double x : {0.0, 1.0 / 3, 0.1 + 0.2, -1e300, least, HUGE_VAL, -HUGE_VAL}) {
    const Json back = Json::parse(file_text(number_json(x)));
    EXPECT_EQ(number_in(back), x);
    EXPECT_EQ(back.is_number(), std::isfinite(x));
  }
  EXPECT_TRUE(std::signbit(number_in(Json::parse(file_text(number_json(-0.0))))));
  EXPECT_TRUE(std::isnan(number_in(Json::parse(file_text(number_json(std::nan("")))))));
  EXPECT_EQ(message_of([] { number_in("12 m"); }), "'12 m' is not a number");
  EXPECT_THROW(number_in({}), std::exception);
}

TEST(KeptJson, SaysWhereItCannotWrite) {
  const std::filesystem::path path = fresh_folder() / "no such folder" / "kept.json";
  EXPECT_NE(message_of<std::runtime_error>([&] { write_kept(path, kKey, {}); }).find(path.string()),
            std::string::npos);
}

}  // namespace aussois
