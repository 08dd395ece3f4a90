// SPDX-License-Identifier: Apache-2.0
// A solid: a cube of rubber falls onto a floor, comes to rest, and bears its own weight.
#include <cstdio>

#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/solid.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  model.contact_law.mu = 0.5;
  add(model, au::fixed_body("floor", add(model, prepare(au::dilate(au::make_plate(1, 1), 1e-3)))));

  const double side = 0.1, density = 1000;
  const au::Material rubber{.young = 1e5, .poisson = 0.45, .density = density, .viscosity = 500};
  const au::Solid cube = add_solid(
      model, au::make_box_mesh(au::Vec3::Constant(side), {3, 3, 3}),
      {.name = "cube", .materials = {rubber}, .place = au::translation(0, 0, 0.06), .radius = 1e-3});

  au::State state = rest_state(model);
  const au::MoreauJean scheme(model, {.h = 2e-3}, {.theta = 1});
  double on_cube = 0;  // impulse of the floor in the last step, upwards [N s]
  const au::StepReport last = run_until(scheme, state, 1.0, [&](const au::StepReport& report) {
    on_cube = 0;
    for (const au::StepContact& c : report.contacts)
      on_cube += (c.point.a.body == cube.surface ? 1 : -1) * c.impulse.z();
  });
  if (!last.ok()) return 1;

  double top = 0;  // how far its top has come down [m]
  const std::vector<au::Vec3> places = solid_places(model, state, cube);
  for (std::size_t i = 0; i < places.size(); ++i)
    top = std::max(top, cube.mesh->points[i].z() - places[i].z() - 0.008);  // it fell by 8 mm
  const double weight = density * side * side * side * au::kGravity, force = on_cube / last.h;
  std::printf("the floor bears %.5f N of a cube of %.5f N; its top has sunk by %.2f mm more\n", force, weight,
              1e3 * top);
  return std::abs(force - weight) < 1e-3 * weight ? 0 : 1;
}
