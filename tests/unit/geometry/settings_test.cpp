// SPDX-License-Identifier: Apache-2.0
// What a table says of a struct's options is what checks, values, labels and refusals say.
#include "geometry/settings.hpp"

#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

enum class Colour { red, green };
constexpr Named<Colour> kColours[] = {{Colour::red, "red"}, {Colour::green, "green"}};

struct Lamp {
  double power = 1;  // [W]
  int bulbs = 2;
  bool dimmed = false;
};
void describe(SettingVisitor& visit, Lamp& o) {
  visit.begin("Lamp");
  visit.number({"power", "of a bulb", "W", range_open_below(0, 100)}, o.power);
  visit.count({"bulbs", "in it", "", range_from(1)}, o.bulbs);
  visit.toggle({.name = "dimmed", .what = "at night", .label = "dimmed"}, o.dimmed);
}

struct Room {
  Colour colour = Colour::red;
  Lamp lamp{};
  double height = 2.5;
};
void describe(SettingVisitor& visit, Room& o) {
  visit.begin("Room");
  visit.choice({.name = "colour", .what = "of its walls", .label = "% walls", .in_every_label = true},
               o.colour, kColours);
  visit.group("lamp", o.lamp);
  visit.number({"height", "of its walls", "m", positive_range(), nullptr, "height %"}, o.height);
}

std::string refusal(const Room& room) {
  return message_of([&] { check_ranges(room); });
}

TEST(Settings, CheckRangesAndNameTheMember) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({.lamp = {.power = 0}}), "Lamp::power = 0 must lie in (0, 100] W");
  EXPECT_EQ(refusal({.lamp = {.power = 100}}), "");
  EXPECT_EQ(refusal({.lamp = {.power = 101}}), "Lamp::power = 101 must lie in (0, 100] W");
  EXPECT_EQ(refusal({.lamp = {.power = std::nan("")}}), "Lamp::power = nan must lie in (0, 100] W");
  EXPECT_EQ(refusal({.lamp = {.bulbs = 0}}), "Lamp::bulbs = 0 must be at least 1");
  EXPECT_EQ(refusal({.height = inf}), "Room::height = inf must be finite and > 0 [m]")
      << "the owner is the room's again after the lamp";
  EXPECT_EQ(message_of([] { check_ranges(Room{.lamp = {.bulbs = 0}}, "room 3: "); }),
            "room 3: lamp.bulbs = 0 must be at least 1");
}

TEST(Settings, AreFoundByTheirPath) {
  EXPECT_EQ(setting_of<Room>("lamp.power").range.highest, 100);
  EXPECT_THROW(setting_of<Room>("lamp.switch"), std::out_of_range);
}

TEST(Settings, HaveOpenAndClosedEnds) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(contains({0, 1}, 0) && contains({0, 1}, 1));
  EXPECT_FALSE(contains(open_range(0, 1), 0) || contains(open_range(0, 1), 1));
  EXPECT_TRUE(contains(range_open_above(0, 1), 0) && !contains(range_open_above(0, 1), 1));
  EXPECT_TRUE(contains(range_above(0), inf) && !contains(range_above(0), 0));
  EXPECT_FALSE(contains(not_negative_range(), inf));
  EXPECT_TRUE(contains(range_from(0), inf));
  EXPECT_FALSE(contains({}, std::nan("")));
  EXPECT_EQ(range_text({}), "");
  EXPECT_EQ(range_text({0, 1}), "in [0, 1]");
  EXPECT_EQ(range_text(open_range(0, 2)), "in (0, 2)");
  EXPECT_EQ(range_text(range_from(1)), ">= 1");
  EXPECT_EQ(range_text(positive_range()), "> 0 and finite");
  EXPECT_EQ(range_text({.highest = 3}), "<= 3");
  EXPECT_EQ(range_order({.highest = 3}), "be <= 3");
  EXPECT_EQ(range_order(range_above(0)), "be > 0");
}

TEST(Settings, HavePathsAndValues) {
  std::string all;
  for (const SettingValue& value : values_of(Room{.colour = Colour::green}))
    all += value.path + " " + value.value + "\n";
  EXPECT_EQ(all, "colour green\nlamp.power 1\nlamp.bulbs 2\nlamp.dimmed false\nheight 2.5\n");
}

TEST(Settings, NameAMethodByWhatIsNotUsual) {
  EXPECT_EQ(label_of(Room{}), "red walls");
  EXPECT_EQ(label_of(Room{.colour = Colour::green, .lamp = {.power = 7, .dimmed = true}, .height = 3}),
            "green walls dimmed height 3");
}

TEST(Settings, AreRefusedWhereNothingReadsThem) {
  const std::vector<std::string> unread{"lamp.bulbs", "height"};
  EXPECT_NO_THROW(refuse_unread(Room{.lamp = {.power = 3}}, unread, "a cave"));
  EXPECT_EQ(message_of([&] { refuse_unread(Room{.lamp = {.bulbs = 3}}, unread, "a cave"); }),
            "lamp.bulbs = 3 is not read by a cave");
}

// Steps and depth are of houses of stone, woodworm is of all others. The cellar has choices of its own.
enum class Stuff { stone, wood, straw };
constexpr Named<Stuff> kStuffs[] = {{Stuff::stone, "stone"}, {Stuff::wood, "wood"}, {Stuff::straw, "straw"}};

struct Steps {
  int count = 9;
};
void describe(SettingVisitor& visit, Steps& o) {
  visit.begin("Steps");
  visit.count({.name = "count"}, o.count);
}
struct Cellar {
  Colour walls = Colour::red, floor = Colour::red;
  bool damp = false;
};
void describe(SettingVisitor& visit, Cellar& o) {
  visit.begin("Cellar");
  visit.choice({.name = "walls"}, o.walls, kColours);
  visit.choice({.name = "floor"}, o.floor, kColours);
  visit.toggle({.name = "damp", .only_for = "floor: green"}, o.damp);
}
struct House {
  Stuff stuff = Stuff::stone;
  Steps steps{};
  Cellar cellar{};
  double depth = 2;
  std::uint64_t woodworm = 1;
};
void describe(SettingVisitor& visit, House& o) {
  visit.begin("House");
  visit.choice({.name = "stuff"}, o.stuff, kStuffs);
  visit.group("steps", o.steps, "stone, brick");
  visit.group("cellar", o.cellar);
  visit.number({.name = "depth", .only_for = "limestone, stone"}, o.depth);
  visit.seed({.name = "woodworm", .only_for = "not limestone, stone"}, o.woodworm);
}
std::string unread_of(const House& house) {
  return message_of([&] { check_options(house); });
}

TEST(Settings, AreRefusedWhereAChoiceIsAnother) {
  EXPECT_EQ(unread_of({}), "");
  EXPECT_EQ(unread_of({.stuff = Stuff::wood}), "") << "the defaults stand";
  EXPECT_EQ(unread_of({.steps = {3}, .depth = 3}), "");
  EXPECT_EQ(unread_of({.stuff = Stuff::wood, .depth = 3}),
            "House::depth = 3 is not read by wood, only by limestone, stone")
      << "choices of the cellar count no more after it";
  EXPECT_EQ(unread_of({.stuff = Stuff::wood, .steps = {3}}),
            "Steps::count = 3 is not read by wood, only by stone, brick")
      << "a struct as a whole";
  EXPECT_EQ(message_of([] { check_options(Steps{3}); }), "") << "by itself nothing decides";
  EXPECT_EQ(unread_of({.cellar = {.walls = Colour::green, .damp = true}}),
            "Cellar::damp = true is not read by red, only by green");
  EXPECT_EQ(unread_of({.cellar = {.floor = Colour::green, .damp = true}}), "");
  EXPECT_EQ(unread_of({.woodworm = 0}), "House::woodworm = 0 is not read by stone");
  EXPECT_EQ(unread_of({.stuff = Stuff::straw, .woodworm = 7}), "");
}

struct Riddle {
  double answer = 42;
};
void describe(SettingVisitor& visit, Riddle& o) {
  visit.begin("Riddle");
  visit.number({.name = "answer", .only_for = "sphinx"}, o.answer);
}
TEST(Settings, NeedAChoiceThatDecides) {
  EXPECT_THROW(check_options(Riddle{7}), std::logic_error);
}

TEST(Settings, AreListedByWholeNames) {
  EXPECT_TRUE(is_listed("nsgs", "coloured_nsgs, nsgs") && is_listed("nsgs", "nsgs, admm"));
  EXPECT_FALSE(is_listed("nsgs", "coloured_nsgs") || is_listed("prox", "prox_2, sor_prox") ||
               is_listed("nsgs", ""));
}

}  // namespace
}  // namespace aussois
