// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/jam_probe.hpp"

#include <algorithm>
#include <cmath>

#include "integrators/run.hpp"
#include "mechanics/model.hpp"

namespace aussois {
namespace {

constexpr double kFree = 20;  // times what counts as free: farther is not looked

struct Push {
  Vec6 along = Vec6::Zero();
  std::string name{};
};

std::vector<Push> pushes() {
  std::vector<Push> out;
  for (int axis = 0; axis < 3; ++axis)
    for (const double way : {1.0, -1.0}) {
      const std::string name{way > 0 ? '+' : '-', char('x' + axis)};
      out.push_back({way * Vec6::Unit(axis), name});
      out.push_back({way * Vec6::Unit(3 + axis), "turn " + name});
      for (const double sense : {1.0, -1.0}) {
        std::string screw = sense > 0 ? "right-handed screw " : "left-handed screw ";
        out.push_back({way * (Vec6::Unit(axis) + sense * Vec6::Unit(3 + axis)), screw += name});
      }
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
    add(model, push_law(port.body, options.force * push.along.head<3>(),
                        std::min(options.torque, options.force * options.radius) * push.along.tail<3>()));
    State state = stage.state();
    set_port_hold(state, port.place, {.gains = {0, 0, 0, 0}});
    state.v.setZero();
    SchemeOptions chosen = stage.options().options;
    chosen.step.h = stage.parameters().tick;
    const Scheme scheme = make_scheme(stage.options().scheme, model, chosen);
    double way = 0;
    (void)run(scheme, state, state.t + options.time, [&](const StepReport&) {
      const SE3& now = pose(state, port.body);
      way = (now.p - start.p).norm() + options.radius * angle_between(now.R, start.R);
      return way < kFree * options.enough;  // a part that is free needs no more
    });
    if (way > out.way) out.way = way, out.push = push.along, out.name = push.name;
  }
  out.wedged = out.way <= options.enough;
  return out;
}

}  // namespace aussois
