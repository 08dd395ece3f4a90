// SPDX-License-Identifier: Apache-2.0
// A door on a hinge: a motor opens it at 1 rad/s until a stop holds it.
#include <cmath>
#include <cstdio>

#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/mechanism.hpp"

namespace au = aussois;

int main() {
  au::Model model;
  const au::SimplicialComplex leaf = au::make_box(0.8, 0.04, 2.0);  // [m]
  const auto door = add(model, solid_body("door", {}, mass_properties(leaf, 600)));
  au::Joint hinge{.name = "hinge", .kind = au::JointKind::revolute, .body_a = door};  // to the world, about z
  hinge.frame_a = {au::Quat::Identity(), au::Vec3(-0.4, 0, 0)};  // at the edge of the door
  hinge.frame_b = {au::Quat::Identity(), au::Vec3(-0.4, 0, 0)};
  hinge.axis[0] = {
      .upper = 1.5,  // [rad]
      .motor = {.kind = au::MotorKind::speed, .target = [](double) { return 1.0; }, .limit = 50}};
  const auto joint = add(model, hinge);

  au::State state = rest_state(model);
  const au::MoreauJean scheme(model, {.h = 5e-3});
  double next = 0;
  const au::StepReport last = run_until(scheme, state, 2.0, [&](const au::StepReport& report) {
    if (report.t < next) return;
    std::printf("%.2f s  %.3f rad  %.3f rad/s  %6.2f N m on the axis\n", report.t,
                joint_coordinate(model, state, joint, 0), joint_speed(model, state, joint, 0),
                report.joints[joint].effort[0]);
    next += 0.25;
  });
  std::printf("open by %.4f rad\n", joint_coordinate(model, state, joint, 0));
  return last.ok() && std::abs(joint_coordinate(model, state, joint, 0) - 1.5) < 1e-6 ? 0 : 1;
}
