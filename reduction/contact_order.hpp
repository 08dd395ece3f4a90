// SPDX-License-Identifier: Apache-2.0
// An order of contacts that does not depend on how their set is stored, and its parts by body pair.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

/// Indices into the set: body pairs one after the other, the deepest contact of a pair first; then by
/// features and the coordinates of the mid point.
std::vector<int> canonical_order(const ContactSet& found);

/// The same, a list for each body pair.
std::vector<std::vector<int>> contacts_by_pair(const ContactSet& found);

inline bool same_pair(const ContactPoint& a, const ContactPoint& b) {
  return a.a.body == b.a.body && a.b.body == b.b.body;
}

/// Neighbours that are the same as the first of them, run by run.
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
