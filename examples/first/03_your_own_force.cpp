// SPDX-License-Identifier: Apache-2.0
// A force law of your own: a body sinks in oil, whose drag -c v balances its weight at m g / c.
#include <cstdio>

#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace au = aussois;

int main() {
  const double mass = 0.2, drag = 4;  // [kg], [N s/m]
  au::Model model;
  const auto body =
      add(model, au::RigidBody{.name = "sinker", .mass = mass, .inertia = au::Mat3::Identity()});
  au::ForceLaw oil;
  oil.name = "drag of the oil";
  oil.add_to = [=](const au::Model&, const au::State& state, double, au::GeneralisedForce& sum) {
    au::linear_part(sum.f, body) -= drag * au::linear_part(state.v, body);
    const int first = au::first_velocity(body);
    au::add_block(sum.C, first, first,
                  drag * au::Mat3::Identity());  // -df/dv: the law is integrated implicitly
  };
  add(model, oil);

  au::State state = rest_state(model);
  const au::MoreauJean scheme(model, {.h = 1e-2});
  if (!run_until(scheme, state, 1.0).ok()) return 1;
  const double speed = -au::linear_part(state.v, body).z(), expected = mass * 9.81 / drag;
  std::printf("sinks at %.6f m/s, weight / drag is %.6f m/s\n", speed, expected);
  return std::abs(speed - expected) < 1e-6 ? 0 : 1;
}
