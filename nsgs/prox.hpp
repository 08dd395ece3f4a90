// SPDX-License-Identifier: Apache-2.0
// The projection that prox steps are made of. Private to nsgs.
#pragma once

#include "nsgs/law.hpp"

namespace aussois {

/// argmin (x - y).S (x - y) over |x| <= radius with S = diag(s) > 0 (SORP-4): the prox of a ball in the
/// metric of S, which is that of an ellipsoid in the Euclidean one.
AnyRows nearest_in_ball(const AnyRows& y, const AnyRows& s, double radius);

}  // namespace aussois
