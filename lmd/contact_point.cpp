// SPDX-License-Identifier: Apache-2.0
#include "lmd/contact_point.hpp"

#include <algorithm>

namespace aussois {

ContactKey key_of(const ContactPoint& contact) {
  const Feature &a = contact.a, &b = contact.b;
  return {{a.body, b.body, a.dim, a.region, b.dim, b.region}};
}

double smallest_gap(const ContactSet& contacts) {
  double gap = kInf;
  for (const ContactPoint& contact : contacts.points) gap = std::min(gap, contact.gap);
  return gap;
}

}  // namespace aussois
