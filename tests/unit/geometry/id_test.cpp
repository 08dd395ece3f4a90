// SPDX-License-Identifier: Apache-2.0
// Ids of one kind find items of their table; ids of another kind and numbers do not.
#include "geometry/id.hpp"

#include <concepts>
#include <sstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace aussois {
namespace {

using AppleId = Id<struct AppleTag>;
using PearId = Id<struct PearTag>;
using Apples = Table<AppleId, std::string>;

template <class Items, class Index>
concept found_by = requires(Items items, Index index) {
  items[index];
};

static_assert(!std::convertible_to<AppleId, PearId> && !std::convertible_to<AppleId, int>);
static_assert(!std::equality_comparable_with<AppleId, PearId>);
static_assert(found_by<Apples, AppleId> && !found_by<Apples, PearId>);

TEST(Id, IsNoneUntilItIsSet) {
  EXPECT_FALSE(AppleId());
  EXPECT_EQ(AppleId().index(), -1);
  EXPECT_TRUE(AppleId(0));
  EXPECT_LT(AppleId(), AppleId(0));
}

TEST(Id, OfANumberOfRunTimeSaysSo) {
  for (const int k : {-1, 0, 7}) EXPECT_EQ(AppleId::at(k).index(), k);
  EXPECT_EQ(AppleId::at(std::size_t(7)), AppleId(7));
}

TEST(Id, IsWrittenAsItsIndex) {
  std::ostringstream text;
  text << AppleId(3);
  EXPECT_EQ(text.str(), "3");
  EXPECT_EQ(to_string(AppleId(1) + 2), "3");
}

TEST(Table, GivesAndTakesIds) {
  Apples apples;
  EXPECT_EQ(apples.append("russet"), AppleId(0));
  EXPECT_EQ(apples.next(), AppleId(1));
  EXPECT_EQ(apples.append("pippin"), AppleId(1));
  EXPECT_EQ(apples[1], "pippin");
  EXPECT_EQ(apples.at(AppleId::at(0U)), "russet");
  EXPECT_TRUE(apples.contains(1) && !apples.contains(2) && !apples.contains({}));
  EXPECT_THROW(apples.at(2), std::out_of_range);
  EXPECT_THROW(apples.at({}), std::out_of_range);
}

TEST(Table, ListsItsIdsInOrder) {
  const Apples apples(3);
  std::vector<int> seen;
  for (const AppleId id : apples.ids()) seen.push_back(id.index());
  EXPECT_EQ(seen, (std::vector{0, 1, 2}));
  for (const AppleId id : Apples().ids()) FAIL() << id;
}

}  // namespace
}  // namespace aussois
