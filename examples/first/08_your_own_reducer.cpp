// SPDX-License-Identifier: Apache-2.0
// A reducer of your own, for a gear (a cylinder with sixty corners) on a table: the problem begins with the
// contacts that lie farthest out along two diagonals. Contacts that would close are let back in, so the gear
// rests whatever is chosen.
#include <algorithm>
#include <cstdio>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  const au::SimplicialComplex gear = au::make_cylinder(0.1, 0.04, 60);  // stands on sixty corners
  add(model, au::fixed_body("table", add(model, prepare(dilate(au::make_plate(1, 1), 1e-3)))));
  const auto body =
      add(model, solid_body("gear", add(model, prepare(dilate(gear, 1e-3))), mass_properties(gear, 7800)));

  au::StepOptions options{.h = 5e-3};
  options.reduction.reducer = au::Reducer::selector;
  options.reduction.selector = [](const au::ReductionInput& input,
                                  const au::Clusters&) {  // the ends of both diagonals
    std::vector<int> kept;
    for (const au::Vec3& way :
         {au::Vec3(1, 1, 0), au::Vec3(-1, 1, 0), au::Vec3(1, -1, 0), au::Vec3(-1, -1, 0)}) {
      const auto along = [&](const au::ContactPoint& c) { return way.dot(c.x_a); };
      const auto& points = input.contacts.points;
      if (!points.empty()) kept.push_back(int(std::ranges::max_element(points, {}, along) - points.begin()));
    }
    std::ranges::sort(kept);
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
  };
  const au::MoreauJean scheme(model, options);
  au::State state = rest_state(model);
  pose(state, body).p.z() = 0.02 + 2e-3;
  int found = 0, kept = 0;
  const au::StepReport last = run_until(scheme, state, 0.5, [&](const au::StepReport& report) {
    found = std::max(found, report.contacts_found), kept = std::max(kept, report.contacts_kept);
  });
  std::printf("%d of %d contacts in the problem; at rest within %.1e m/s\n", kept, found, state.v.norm());
  return last.ok() && state.v.norm() < 1e-6 ? 0 : 1;
}
