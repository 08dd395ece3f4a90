// SPDX-License-Identifier: Apache-2.0
// A network that predicts which places of a part carry load [Kim2019], as a reducer for any simulation
// (NET-2).
#pragma once

#include <vector>

#include "reduction/network.hpp"
#include "reduction/selection.hpp"

namespace aussois {

struct LearnedSelector {
  Network network{};           // one output per place
  std::vector<Vec3> places{};  // on the part, in its body frame [m]
  int keep = 3;                // number of places to choose, >= 1
};
/// Throws std::invalid_argument naming the field.
void validate(const LearnedSelector& selector);

/// True if the triangle of the three points is no higher than 1e-6 of its longest side.
bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

/// The `keep` most probable places, the most probable first, ties by index; the third is the next one that is
/// not in line with the first two. Fewer if there are no more.
std::vector<int> chosen_places(const VecX& probability, const std::vector<Vec3>& places, int keep = 3);

/// The input of the network, 24 numbers: position of the centre of mass, columns of the rotation, v, omega,
/// force and torque of everything but contacts and joints, in the frames and units of BodyLoad.
inline constexpr int kLoadInputs = 24;
VecX input_of(const BodyLoad& load);

/// For ReductionOptions::selector. From every cluster that touches `body` (index of the posed shape) and has
/// more contacts than `keep`, it keeps the contact nearest to each chosen place. Of other clusters it keeps
/// all contacts. Throws std::invalid_argument if the selector is invalid or its network does not have 24
/// inputs. The returned function throws it if the input lacks the body's load.
ContactSelector contact_selector(LearnedSelector selector, BodyId body);

}  // namespace aussois
