// SPDX-License-Identifier: Apache-2.0
// The same motion by every time-stepping scheme: a ball falls for half a second. The path is a parabola;
// which scheme is on it?
#include <cmath>
#include <cstdio>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  const auto shape = add(model, prepare(dilate(au::make_point(), 0.05)));
  const auto ball = add(model, solid_body("ball", shape, wire_mass_properties(au::make_point(), 0.05, 1000)));
  const double h = 0.01, exact = -9.81 / 2 * 0.5 * 0.5;  // [s], [m]
  bool all = true;
  for (const au::SchemeVariant& variant : au::scheme_variants()) {
    au::SchemeOptions options = variant.options;
    options.step.h = h;
    const au::Scheme scheme = make_scheme(variant.name, model, options);
    au::State state = rest_state(model);
    all = run_until(scheme, state, 0.5).ok() && all;
    const double off = pose(state, ball).p.z() - exact;
    std::printf("%-60s off by %8.1e m\n", label(variant.name, options).c_str(), off);
    const bool second = scheme_traits(variant.name, options).smooth == 2;
    all = all && std::abs(off) < (second ? 1e-12 : 9.81 / 2 * h * 0.5 + 1e-12);  // a parabola, or polygons
  }
  return all ? 0 : 1;
}
