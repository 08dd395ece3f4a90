// SPDX-License-Identifier: Apache-2.0
// Fades gaps so that contacts enter and leave at their angle limit as gently as at the distance threshold
// (KIN-10), for users of Newton methods. A pure function of each contact; no force is weighted, hard
// constraints stay hard.
#pragma once

#include <algorithm>
#include <vector>

#include "lmd/contact_point.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges; alpha_query is beyond alpha0.
struct GapFade {
  double alpha0 = 2 * kPi / 180;         // contacts inside this angle keep their gap [rad]
  double alpha_query = 2.5 * kPi / 180;  // LmdOptions::alpha of the query that found the contacts [rad]; the
                                         // band between the two is best 0.5 degrees or wider
  double delta = 1e-4;                   // added to the gap where a contact enters: the bound of the relative
                                         // displacement in the step [m]
};
void validate(const GapFade& fade);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, GapFade& fade);

/// 0 up to 0, 1 from 1 on, 3 x^2 - 2 x^3 between: C1.
inline double smooth_step(double x) {
  const double y = std::clamp(x, 0.0, 1.0);
  return y * y * (3 - 2 * y);
}

struct FadedGap {
  double gap = 0;           // [m]
  double margin_slope = 0;  // derivative with respect to the contact's angle_margin, never positive [m/rad];
                            // with respect to the contact's own gap it is 1
};

/// One per contact, in order. C1 in (gap, angle_margin); throws like validate.
std::vector<FadedGap> faded_gaps(const ContactSet& contacts, const GapFade& fade);

}  // namespace aussois
