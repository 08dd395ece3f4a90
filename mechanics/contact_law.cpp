// SPDX-License-Identifier: Apache-2.0
#include "mechanics/contact_law.hpp"

#include "geometry/settings.hpp"

namespace aussois {

void describe(SettingVisitor& visit, ContactLaw& o) {
  visit.begin("ContactLaw");
  visit.number({"mu", "friction coefficient", "-", not_negative_range(), "--mu"}, o.mu);
  visit.number({"restitution", "Newton's restitution coefficient", "-", {0, 1}, "--restitution"},
               o.restitution);
  visit.number(
      {"contensou_radius", "radius of Coulomb-Contensou's ellipsoid; 0: contacts do not resist drilling", "m",
       not_negative_range()},
      o.contensou_radius);
}

}  // namespace aussois
