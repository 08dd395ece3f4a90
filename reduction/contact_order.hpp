// SPDX-License-Identifier: Apache-2.0
// An order of contacts that does not depend on how their set is stored, and its parts for each body pair.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

/// Indices into the set: one body pair after the other, the deepest contact of a pair first, then by features
/// and by the coordinates of the mid point.
std::vector<int> canonical_order(const ContactSet& found);

/// The same order, as one list per body pair.
std::vector<std::vector<int>> contacts_by_pair(const ContactSet& found);

inline bool same_pair(const ContactPoint& a, const ContactPoint& b) {
  return a.a.body == b.a.body && a.b.body == b.b.body;
}

/// Splits a sequence into runs of neighbours that are the same as the first of their run.
template <class T, class Same>
std::vector<std::span<T>> runs_of(std::span<T> sequence, const Same& same) {
  std::vector<std::span<T>> out;
  for (auto first = sequence.begin(); first != sequence.end();) {
    const auto last = std::find_if(first, sequence.end(), [&](const T& x) { return !same(*first, x); });
    out.emplace_back(first, last);
    first = last;
  }
  return out;
}

}  // namespace aussois
