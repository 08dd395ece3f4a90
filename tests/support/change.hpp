// SPDX-License-Identifier: Apache-2.0
// Changes arrays that never change: puts a changed copy in their place.
#pragma once

#include <utility>
#include <vector>

#include "geometry/shared_array.hpp"

namespace aussois {

/// Calls f(std::vector<T>&).
template <class T, class F>
void change(SharedArray<T>& array, F&& f) {
  std::vector<T> copy = array.to_vector();
  f(copy);
  array = std::move(copy);
}

/// Calls f(T&) for each element.
template <class T, class F>
void change_each(SharedArray<T>& array, F&& f) {
  change(array, [&](std::vector<T>& all) {
    for (T& element : all) f(element);
  });
}

}  // namespace aussois
