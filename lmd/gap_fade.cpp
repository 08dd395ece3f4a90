// SPDX-License-Identifier: Apache-2.0
#include "lmd/gap_fade.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "geometry/settings.hpp"
#include "lmd/lmd_options.hpp"

namespace aussois {

void describe(SettingVisitor& visit, GapFade& o) {
  const Range alpha = setting_of<LmdOptions>("alpha").range;
  visit.begin("GapFade");
  visit.number({"alpha0", "angle inside which contacts keep their gap", "rad", alpha}, o.alpha0);
  visit.number({"alpha_query", "LmdOptions::alpha of the query", "rad", alpha}, o.alpha_query);
  visit.number({"delta", "what is added to the gap where a contact enters", "m", not_negative_range()},
               o.delta);
}

void validate(const GapFade& fade) {
  check_ranges(fade);
  require_field(fade.alpha_query > fade.alpha0, "GapFade::alpha_query", fade.alpha_query,
                ("be more than alpha0 = " + number_text(fade.alpha0) + " rad").c_str());
}

std::vector<FadedGap> faded_gaps(const ContactSet& contacts, const GapFade& fade) {
  validate(fade);
  const double band = fade.alpha_query - fade.alpha0;
  std::vector<FadedGap> out;
  out.reserve(contacts.points.size());
  for (const ContactPoint& c : contacts.points) {
    const double x = std::clamp(1 - c.angle_margin / band, 0.0, 1.0);  // 0 inside alpha0, 1 at alpha_query
    out.push_back({c.gap + fade.delta * smooth_step(x), -fade.delta * 6 * x * (1 - x) / band});
  }
  return out;
}

}  // namespace aussois
