// SPDX-License-Identifier: Apache-2.0
// doc/theory/reduction.md, memory and warm start.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "reduction/warm_start.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

ContactPoint contact(int region_a, int region_b, const Vec3& x_a = Vec3::Zero(),
                     const Vec3& normal = Vec3::UnitZ()) {
  ContactPoint c;
  c.a = {.body = 0, .dim = 1, .simplex = region_a, .region = region_a};
  c.b = {.body = 1, .dim = 1, .simplex = region_b, .region = region_b};
  c.x_a = c.x_b = x_a;
  c.normal = normal;
  return c;
}

const PersistenceOptions kByKey{.matching = Matching::key};

TEST(WarmStart, GivesBackWhatWasRemembered) {
  const ContactSet set{{contact(3, 1), contact(1, 2), contact(2, 2)}};
  const std::vector<Vec3> r = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  const WarmStart start = warm_start(remember(set, r), set);
  EXPECT_EQ(start.impulse, r);
  EXPECT_EQ(start.counts.matched(), 3);
}

TEST(WarmStart, StartsFromZeroWhereNothingMatches) {
  const ContactMemory memory = remember({{contact(1, 1), contact(2, 1)}}, {{0, 0, 1}, {0, 0, 2}});
  const WarmStart start = warm_start(memory, {{contact(0, 1), contact(2, 1), contact(2, 5)}}, {}, kByKey);
  EXPECT_EQ(start.impulse, (std::vector<Vec3>{Vec3::Zero(), {0, 0, 2}, Vec3::Zero()}));
  EXPECT_EQ(start.counts.matched(), 1);
  EXPECT_EQ(warm_start({}, {{contact(0, 1)}}).impulse, (std::vector<Vec3>{Vec3::Zero()}));
  EXPECT_TRUE(warm_start(memory, {}).impulse.empty());
}

TEST(WarmStart, ScalesWithTheStep) {
  const ContactSet set{{contact(1, 1)}};
  EXPECT_EQ(warm_start(remember(set, {{1, 2, 4}}), set, {.scale = 0.5}).impulse[0], Vec3(0.5, 1, 2));
}

TEST(WarmStart, GivesBackTheDrillingImpulseScaled) {
  const ContactSet set{{contact(3, 1), contact(1, 2)}};
  const ContactMemory memory = remember(set, {{0, 0, 1}, {0, 0, 2}}, {.drilling = {0.25, -0.5}});
  const WarmStart start =
      warm_start(memory, {{contact(1, 2), contact(5, 5), contact(3, 1)}}, {.scale = 2}, kByKey);
  EXPECT_EQ(start.drilling, (std::vector<double>{-1, 0, 0.5}));
  EXPECT_EQ(warm_start(remember(set, {{0, 0, 1}, {0, 0, 2}}), set).drilling, (std::vector<double>{0, 0}));
  EXPECT_THROW(remember(set, {{0, 0, 1}, {0, 0, 2}}, {.drilling = {1}}), std::invalid_argument);
}

TEST(WarmStart, TurnsTheImpulseWithTheNormal) {
  const ContactMemory memory = remember({{contact(1, 1)}}, {{0.5, 0.25, 2}});
  const double angle = 0.3;  // about y: the minimal rotation leaves y alone
  const Vec3 normal(std::sin(angle), 0, std::cos(angle));
  const Vec3 tangent(std::cos(angle), 0, -std::sin(angle));
  const Vec3 r = warm_start(memory, {{contact(1, 1, Vec3::Zero(), normal)}}).impulse[0];
  EXPECT_LT((r - (0.5 * tangent + 0.25 * Vec3::UnitY() + 2 * normal)).norm(), 1e-15);
}

// Against Eigen's own two-vector rotation; so an impulse in the cone stays in the cone.
TEST(WarmStart, KeepsTheAngleToTheNormal) {
  Random random(11);
  int matched = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 old_normal = random.direction(), normal = random.direction();
    const Vec3 old_r = random.vector();
    const ContactMemory memory = remember({{contact(1, 1, Vec3::Zero(), old_normal)}}, {old_r});
    const WarmStart start = warm_start(memory, {{contact(1, 1, Vec3::Zero(), normal)}});
    EXPECT_EQ(start.counts.matched(), normal.dot(old_normal) > 0 ? 1 : 0) << "trial " << trial;
    if (start.counts.matched() == 0) continue;
    ++matched;
    const Vec3 expected = Quat::FromTwoVectors(old_normal, normal) * old_r;
    EXPECT_LT((start.impulse[0] - expected).norm(), 1e-14) << "trial " << trial;
    EXPECT_NEAR(start.impulse[0].dot(normal), old_r.dot(old_normal), 1e-14);
    EXPECT_NEAR(start.impulse[0].norm(), old_r.norm(), 1e-14);
  }
  EXPECT_GT(matched, 50);
}

TEST(WarmStart, DoesNotCarryAnImpulseRoundACorner) {
  const ContactMemory memory = remember({{contact(1, 1)}}, {{0, 0, 1}});
  for (const Vec3& normal : {Vec3(-Vec3::UnitZ()), Vec3(Vec3::UnitX())})
    EXPECT_EQ(warm_start(memory, {{contact(1, 1, Vec3::Zero(), normal)}}).counts.matched(), 0);
}

TEST(WarmStart, ClaimsEachRememberedContactOnce) {
  const ContactMemory memory = remember({{contact(1, 1, {0, 0, 0})}}, {{0, 0, 1}});
  const WarmStart start =
      warm_start(memory, {{contact(1, 1, {3, 0, 0}), contact(1, 1, {1, 0, 0}), contact(1, 1, {2, 0, 0})}});
  EXPECT_EQ(start.impulse, (std::vector<Vec3>{Vec3::Zero(), {0, 0, 1}, Vec3::Zero()}));
  EXPECT_EQ(start.counts.matched(), 1);
}

// Two crossings of one pair of chains move by more than the order of their coordinates can tell: nearest
// wins.
TEST(WarmStart, MatchesTheNearestOfEqualKeys) {
  const ContactMemory memory =
      remember({{contact(1, 1, {0, 0, 0}), contact(1, 1, {1, 0, 0}), contact(1, 1, {2, 0, 0})}},
               {{0, 0, 10}, {0, 0, 11}, {0, 0, 12}});
  EXPECT_EQ(memory.contacts.size(), 3u);
  const WarmStart start = warm_start(memory, {{contact(1, 1, {2.1, 0, 0}), contact(1, 1, {0.9, 0, 0})}});
  EXPECT_EQ(start.impulse, (std::vector<Vec3>{{0, 0, 12}, {0, 0, 11}}));
}

TEST(WarmStart, DoesNotDependOnTheOrderOfTheSets) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    ContactSet old, now;
    std::vector<Vec3> r;
    for (int i = 0; i < 30; ++i) {  // 9 keys for 30 contacts
      for (ContactSet* set : {&old, &now}) {
        const int a = random.index(3), b = random.index(3);
        set->points.push_back(contact(a, b, random.vector()));
      }
      r.push_back(random.vector());
    }
    const WarmStart start = warm_start(remember(old, r), now);
    EXPECT_GT(start.counts.matched(), 10);
    for (std::size_t i = 29; i > 0; --i) {
      const std::size_t j = std::size_t(random.index(int(i) + 1));
      std::swap(old.points[i], old.points[j]);
      std::swap(r[i], r[j]);
    }
    ContactSet reversed = now;
    std::reverse(reversed.points.begin(), reversed.points.end());
    WarmStart again = warm_start(remember(old, r), reversed);
    std::reverse(again.impulse.begin(), again.impulse.end());
    EXPECT_EQ(again.impulse, start.impulse) << "trial " << trial;
    EXPECT_EQ(again.counts.matched(), start.counts.matched());
  }
}

TEST(Remember, SortsByKeyThenByPlace) {
  const ContactMemory memory =
      remember({{contact(2, 0), contact(1, 1, {0, 2, 0}), contact(1, 1, {0, 1, 5}), contact(1, 0)}},
               {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  std::vector<double> order;
  for (const RememberedContact& c : memory.contacts) order.push_back(c.impulse.x());
  EXPECT_EQ(order, (std::vector<double>{4, 3, 2, 1}));
}

TEST(Remember, WantsOneImpulsePerContact) {
  EXPECT_THROW(remember({{contact(1, 1)}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
