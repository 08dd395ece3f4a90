// SPDX-License-Identifier: Apache-2.0
#include "geometry/shared_array.hpp"

#include <string>

#include <gtest/gtest.h>

namespace aussois {

TEST(SharedArray, SharesItsElementsWithItsCopies) {
  const SharedArray<std::string> a = std::vector<std::string>{"one", "two"};
  SharedArray<std::string> b;
  b = a;
  EXPECT_EQ(b.data(), a.data());
  EXPECT_EQ(b, a);
  EXPECT_EQ(b, (SharedArray<std::string>{"one", "two"}));
  EXPECT_FALSE(b == (SharedArray<std::string>{"one"}));
}

TEST(SharedArray, TakesTheElementsOfAVectorWithoutACopy) {
  std::vector<int> elements = {1, 2, 3};
  const int* const place = elements.data();
  const SharedArray<int> array = std::move(elements);
  EXPECT_EQ(array.data(), place);
  EXPECT_EQ(array.size(), 3U);
  EXPECT_EQ(array.front(), 1);
  EXPECT_EQ(array.back(), 3);
}

TEST(SharedArray, KeepsTheOwnerOfItsElements) {
  auto owner = std::make_shared<std::vector<int>>(std::vector{5, 6, 7});
  const std::weak_ptr<std::vector<int>> watched = owner;
  SharedArray<int> tail(std::span<const int>(*owner).last(2), owner);
  owner.reset();
  EXPECT_EQ(tail, (SharedArray<int>{6, 7}));
  tail = {};
  EXPECT_TRUE(watched.expired());
}

TEST(SharedArray, IsEmptyWhenItWasMovedFrom) {
  SharedArray<int> a{1, 2};
  const SharedArray<int> b = std::move(a);
  EXPECT_TRUE(a.empty());  // NOLINT(bugprone-use-after-move): what is promised
  EXPECT_EQ(a.begin(), a.end());
  EXPECT_EQ(b.size(), 2U);
}

TEST(SharedArray, GivesACopyToChange) {
  const SharedArray<int> before{3, 1, 2};
  std::vector<int> copy = before.to_vector();
  copy[0] = 9;
  EXPECT_EQ(before[0], 3);
  EXPECT_EQ(SharedArray<int>(copy), (SharedArray<int>{9, 1, 2}));
  EXPECT_TRUE(SharedArray<int>(std::vector<int>{}).empty());
}

}  // namespace aussois
