// SPDX-License-Identifier: Apache-2.0
// A cable: it falls across a peg, drapes over it and hangs there by friction.
#include <cstdio>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/cable.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  model.contact_law.mu = 0.4;
  const au::SimplicialComplex peg =
      transformed_complex(au::make_cylinder(0.03, 0.1, 48), au::rotation(au::Vec3::UnitX(), au::kPi / 2));
  add(model, au::fixed_body("peg", add(model, prepare(au::dilate(peg, 1e-3)))));

  const double radius = 3e-3;  // [m]
  const au::BeamSection rubber = au::beam_section(
      {.radius = radius, .young = 5e6, .poisson = 0.45, .density = 1200, .damping_time = 5e-3});
  const au::Cable cable =
      add_cable(model, {.nodes = au::frames_along(au::points_along({{-0.2, 0, 0.05}, {0.2, 0, 0.05}}, 41)),
                        .section = rubber,
                        .radius = radius});

  au::State state = rest_state(model);
  lay(cable, state);
  const au::MoreauJean scheme(model, {.h = 2e-3}, {.theta = 1});
  au::Vec3 on_cable = au::Vec3::Zero();  // impulse of the peg in the last step [N s]
  const au::StepReport last = run_until(scheme, state, 4.0, [&](const au::StepReport& report) {
    on_cable.setZero();
    for (const au::StepContact& c : report.contacts)
      on_cable += (c.point.a.body == cable.surface ? 1 : -1) * c.impulse;
  });
  if (!last.ok()) return 1;

  const double weight = rubber.mass_per_length * 0.4 * au::kGravity, force = on_cable.z() / last.h;
  std::printf("the peg bears %.6f N of a cable of %.6f N; its end is at z = %.3f m\n", force, weight,
              pose(state, cable.nodes.back()).p.z());
  return std::abs(force - weight) < 1e-2 * weight ? 0 : 1;
}
