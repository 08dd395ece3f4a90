// SPDX-License-Identifier: Apache-2.0
// A network that says which places of a part carry [Kim2019], as a reducer for any simulation (NET-2).
#pragma once

#include <vector>

#include "reduction/network.hpp"
#include "reduction/selection.hpp"

namespace aussois {

struct LearnedSelector {
  Network network{};           // one output per place
  std::vector<Vec3> places{};  // on the part, in its body frame [m]
  int keep = 3;                // places that are chosen, >= 1
};
/// Throws std::invalid_argument naming the field.
void validate(const LearnedSelector& selector);

/// True where the triangle of the three points is flatter than 1e-6 of its longest side.
bool on_a_line(const Vec3& a, const Vec3& b, const Vec3& c);

/// The `keep` most probable places, the most probable first, ties by index; the third is the next one that
/// does not lie on a line with the first two. Fewer if there are no more.
std::vector<int> chosen_places(const VecX& probability, const std::vector<Vec3>& places, int keep = 3);

/// What the network is asked, 24 numbers: place of the centre of mass, columns of the rotation, v, omega,
/// force and torque of all but contacts and joints, in the frames and units of BodyLoad.
inline constexpr int kLoadInputs = 24;
VecX input_of(const BodyLoad& load);

/// For ReductionOptions::selector. Of every cluster that touches `body` (index of the posed shape) and has
/// more contacts than `keep`, it keeps one contact per chosen place, the nearest; all contacts of other
/// clusters. Throws std::invalid_argument for a selector that is not valid or whose network has not 24
/// inputs; when called, if the input does not know the body's load.
ContactSelector contact_selector(LearnedSelector selector, int body);

}  // namespace aussois
