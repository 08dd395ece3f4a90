// SPDX-License-Identifier: Apache-2.0
// Which body a shape, a contact or a pose belongs to.
#pragma once

#include "geometry/id.hpp"

namespace aussois {

using BodyId = Id<struct BodyTag>;

/// A value for each body of a model.
template <class T>
using PerBody = Table<BodyId, T>;

/// Two bodies, in the order that their holder states.
struct BodyPair {
  BodyId a{}, b{};
  friend constexpr auto operator<=>(const BodyPair&, const BodyPair&) = default;
};

/// The pair with the smaller id first.
constexpr BodyPair ordered_pair(BodyId a, BodyId b) {
  return a < b ? BodyPair{a, b} : BodyPair{b, a};
}

}  // namespace aussois
