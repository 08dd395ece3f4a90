// SPDX-License-Identifier: Apache-2.0
// Joint coordinates: a motor lowers an arm of two links until its hand lies on a table.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/mechanism.hpp"
#include "mechanics/tree.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  model.contact_law.mu = 0.3;
  const au::SimplicialComplex box = au::make_box(0.4, 0.04, 0.04);
  const auto shape = add(model, prepare(au::dilate(box, 1e-3)));
  const auto upper = add(model, solid_body("upper arm", shape, mass_properties(box, 1000)));
  const auto fore = add(model, solid_body("forearm", shape, mass_properties(box, 1000)));
  const auto table =
      add(model, au::fixed_body("table", add(model, prepare(au::dilate(au::make_plate(2, 2), 1e-3)))));

  au::State state = rest_state(model);  // stretched along x
  pose(state, upper).p.x() = 0.2;
  pose(state, fore).p.x() = 0.6;
  pose(state, table).p.z() = -0.4;
  const au::SE3 about_y = au::rotation(au::Vec3::UnitX(), -au::kPi / 2);
  const auto shoulder =
      add(model, joint_at(au::JointKind::revolute, "shoulder", upper, au::kWorld, state.g, about_y));
  const auto elbow = add(model, joint_at(au::JointKind::revolute, "elbow", fore, upper, state.g,
                                         au::translation(0.4, 0, 0) * about_y));
  const auto target = [](double t) { return 0.5 * (1 - std::exp(-3 * t)); };
  model.joints[shoulder].axis[0].motor = {.kind = au::MotorKind::position, .target = target};
  model.joints[elbow].axis[0].damping = 0.2;  // [N m s]

  add_tree(model, "arm", {shoulder, elbow});
  state = in_joint_coordinates(model, state);
  const au::MoreauJean scheme(model, {.h = 2e-3}, {.theta = 1});
  double drift = 0;
  const au::StepReport last = run_until(scheme, state, 3.0, [&](const au::StepReport& report) {
    drift = std::max(drift, report.joint_error.translation);
  });
  const double led = joint_coordinate(model, state, shoulder);
  std::printf("shoulder at %.3f rad, elbow at %.3f rad, %zu contacts; joints were off by %.0e m at most\n",
              led, joint_coordinate(model, state, elbow), last.contacts.size(), drift);
  return last.ok() && !last.contacts.empty() && std::abs(led - target(3)) < 1e-9 && drift < 1e-14 ? 0 : 1;
}
