// SPDX-License-Identifier: Apache-2.0
// Keeps the lanes of the buckets that a descent used last.
#pragma once

#include <vector>

#include "lmd/cone_tree.hpp"

namespace aussois {

/// Lanes of the buckets of B last used: neighbouring buckets of A need the same ones.
template <class Lanes>
class RecentLanes {
 public:
  template <class Load>
  const Lanes& get(int first, const Load& load) {
    if (lanes_.empty()) lanes_.resize(kSize), first_.resize(kSize, -1);
    const std::size_t at = std::size_t(first / kBucket) % kSize;
    if (first_[at] != first) first_[at] = first, lanes_[at] = load();
    return lanes_[at];
  }

 private:
  static constexpr std::size_t kSize = 64;
  std::vector<Lanes> lanes_{};
  std::vector<int> first_{};
};

}  // namespace aussois
