// SPDX-License-Identifier: Apache-2.0
#include "geometry/parallel.hpp"

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace aussois {
namespace {

TEST(ParallelFor, CallsEachIndexOnceForAnyNumberOfThreads) {
  for (const int threads : {-1, 0, 1, 2, 3, 7}) {
    for (const int n : {0, 1, 2, 1000}) {
      std::vector<int> calls(std::size_t(n), 0);
      parallel_for(n, threads, [&](int i) { ++calls[i]; });
      EXPECT_EQ(calls, std::vector<int>(std::size_t(n), 1)) << threads << " threads";
    }
  }
}

TEST(ParallelFor, GivesTheSameSumToTheLastBitWhenPlacesAreJoinedInOrder) {
  const auto sum = [](int threads) {
    std::vector<double> places(10000);
    parallel_for(10000, threads, [&](int i) { places[i] = std::sin(i) * std::pow(10.0, i % 30); });
    return std::accumulate(places.begin(), places.end(), 0.0);
  };
  const double expected = sum(1);
  for (const int threads : {2, 3, 5}) EXPECT_EQ(sum(threads), expected);
}

TEST(ParallelFor, RethrowsWhatACallThrows) {
  for (const int threads : {1, 2}) {
    const auto run = [&] {
      parallel_for(100, threads, [](int i) {
        if (i == 57) throw std::runtime_error("57");
      });
    };
    EXPECT_THROW(run(), std::runtime_error);
  }
}

}  // namespace
}  // namespace aussois
