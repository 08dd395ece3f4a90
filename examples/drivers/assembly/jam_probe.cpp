// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/jam_probe.hpp"

#include <cmath>

#include "integrators/run.hpp"
#include "mechanics/model.hpp"

namespace aussois {
namespace {

struct Push {
  Vec6 along = Vec6::Zero();
  std::string name{};
};

std::vector<Push> pushes() {
  std::vector<Push> out;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      std::string name{sign > 0 ? '+' : '-', char('x' + axis)}, screw = sign > 0 ? "right" : "left";
      out.push_back({sign * Vec6::Unit(axis), name});
      out.push_back({sign * Vec6::Unit(3 + axis), "turn " + name});
      (screw += "-handed screw ") += char('x' + axis);
      out.push_back({Vec6::Unit(axis) + sign * Vec6::Unit(3 + axis), screw});
    }
  return out;
}

// The wrench turns with the part.
ForceLaw push_law(BodyId body, const Vec3& force, const Vec3& torque) {
  return {.name = "push", .add_to = [=](const Model&, const State& state, double, GeneralisedForce& sum) {
            linear_part(sum.f, body) += pose(state, body).R * force;
            angular_part(sum.f, body) += torque;
          }};
}

}  // namespace

JamProbe probe_jam(const SessionStage& stage, const JamOptions& options) {
  const Port& port = stage.port();
  const SE3 start = pose(stage.state(), port.body);
  JamProbe out;
  for (const Push& push : pushes()) {
    Model model = stage.model();
    add(model,
        push_law(port.body, options.force * push.along.head<3>(), options.torque * push.along.tail<3>()));
    State state = stage.state();
    set_port_hold(state, port.place, {.gains = {0, 0, 0, 0}});
    state.v.setZero();
    SchemeOptions chosen = stage.options().options;
    chosen.step.h = stage.parameters().tick;
    const Scheme scheme = make_scheme(stage.options().scheme, model, chosen);
    (void)run(scheme, state, state.t + options.time, [](const StepReport&) { return true; });
    const SE3& end = pose(state, port.body);
    const double way = (end.p - start.p).norm() + options.radius * angle_between(end.R, start.R);
    if (way > out.way) out.way = way, out.push = push.along, out.name = push.name;
  }
  out.wedged = out.way <= options.enough;
  return out;
}

}  // namespace aussois
