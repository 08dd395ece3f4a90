// SPDX-License-Identifier: Apache-2.0
#include "lmd/gap_fade.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"

namespace aussois {

void validate(const GapFade& fade) {
  require_field(fade.alpha0 >= 0 && fade.alpha0 <= 0.5, "GapFade::alpha0", fade.alpha0,
                "lie in [0, 0.5] rad");
  require_field(fade.alpha_query > fade.alpha0 && fade.alpha_query <= 0.5, "GapFade::alpha_query",
                fade.alpha_query, "lie in (alpha0, 0.5] rad");
  require_field(fade.delta >= 0 && std::isfinite(fade.delta), "GapFade::delta", fade.delta,
                "be finite and not negative [m]");
}

std::vector<FadedGap> faded_gaps(const ContactSet& contacts, const GapFade& fade) {
  validate(fade);
  const double band = fade.alpha_query - fade.alpha0;
  std::vector<FadedGap> out;
  out.reserve(contacts.points.size());
  for (const ContactPoint& c : contacts.points) {
    const double x = std::clamp(1 - c.angle_margin / band, 0.0, 1.0);  // 0 inside alpha0, 1 at alpha_query
    out.push_back({c.gap + fade.delta * x * x * (3 - 2 * x), -fade.delta * 6 * x * (1 - x) / band});
  }
  return out;
}

}  // namespace aussois
