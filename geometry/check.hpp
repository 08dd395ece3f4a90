// SPDX-License-Identifier: Apache-2.0
// Reports the two kinds of error: the caller's (an exception at the interface) and our own (an assertion).
#pragma once

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "geometry/number_text.hpp"

namespace aussois {

/// Throws std::invalid_argument with `text` unless `condition` holds.
inline void require(bool condition, const std::string& text) {
  if (!condition) throw std::invalid_argument(text);
}
inline void require(bool condition, const char* text) {  // costs nothing where it holds
  if (!condition) throw std::invalid_argument(text);
}

/// Throws std::invalid_argument "field = value must ..." unless `condition` holds; `bound` names the bound.
template <class Value>
void require_field(bool condition, const char* field, const Value& value, const char* bound) {
  if (condition) return;
  std::ostringstream text;
  text << field << " = ";
  if constexpr (std::is_floating_point_v<Value>)
    text << number_text(value);
  else
    text << value;
  text << " must " << bound;
  throw std::invalid_argument(text.str());
}

}  // namespace aussois

/// Asserts against our own mistakes, not the caller's; enabled unless NDEBUG is set.
#ifdef NDEBUG
#define AUSSOIS_ASSERT(condition) ((void)sizeof((condition) ? 1 : 0))
#else
#define AUSSOIS_ASSERT(condition) \
  ((condition)                    \
       ? (void)0                  \
       : (std::fprintf(stderr, "%s:%d: broken: %s\n", __FILE__, __LINE__, #condition), std::abort()))
#endif
