// SPDX-License-Identifier: Apache-2.0
// A ball falls on a plate from half a metre and bounces with restitution 0.5.
#include <algorithm>
#include <cstdio>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  model.contact_law = {.mu = 0.3, .restitution = 0.5};
  const auto floor = add(model, prepare(dilate(au::make_plate(2, 2), 1e-3)));  // a square of 2 m, 1 mm thick
  const auto ball = add(model, prepare(dilate(au::make_point(), 0.05)));       // all within 5 cm of a point
  add(model, au::fixed_body("floor", floor));
  const auto body = add(model, solid_body("ball", ball, wire_mass_properties(au::make_point(), 0.05, 1000)));

  au::State state = rest_state(model);
  pose(state, body).p.z() = 0.55;  // [m]
  const au::MoreauJean scheme(model, {.h = 1e-3});
  double next = 0, highest = 0;
  const au::StepReport last = run_until(scheme, state, 2.0, [&](const au::StepReport& report) {
    if (report.t > 0.4) highest = std::max(highest, pose(state, body).p.z());  // after the first bounce
    if (report.t >= next) std::printf("%.1f s  %.4f m\n", report.t, pose(state, body).p.z()), next += 0.1;
  });
  std::printf("the first bounce reached %.3f m above rest\n", highest - 0.051);
  return last.ok() && highest > 0.174 && highest < 0.178 ? 0 : 1;  // a quarter of the height it fell from
}
