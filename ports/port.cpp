// SPDX-License-Identifier: Apache-2.0
#include "ports/port.hpp"

#include <algorithm>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "geometry/so3.hpp"
#include "mechanics/model.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

// The least of the dilations that it can meet, with its own.
double least_dilations(const Model& model, BodyId body) {
  const auto radius = [&](BodyId b) { return model.shapes[model.bodies[b].shape]->radius; };
  double least = kInf;
  for (const BodyId b : model.bodies.ids())
    if (b != body && model.bodies[b].shape) least = std::min(least, radius(b));
  return least == kInf ? kInf : least + (model.bodies[body].shape ? radius(body) : 0);
}

double reach_of(const Model& model, BodyId body) {
  const RigidBody& b = model.bodies[body];
  if (!b.shape) return 0;
  const LmdShape& shape = *model.shapes[b.shape];
  return (b.g_bs * shape.centre).norm() + shape.bounding_radius + shape.radius;
}

PortGains grown(const PortGains& now, const PortGains& full, double part) {
  const auto grow = [part](double a, double b) { return std::min(b, a + part * b); };
  return {grow(now.stiffness, full.stiffness), grow(now.damping, full.damping),
          grow(now.rotation_stiffness, full.rotation_stiffness),
          grow(now.rotation_damping, full.rotation_damping)};
}

// The part of a motion that fits into a stride.
double fitting(const Model& model, const Port& port, const Vec6& twist, double tick) {
  const double reach = reach_of(model, port.body),
               way = tick * (twist.head<3>().norm() + reach * twist.tail<3>().norm()),
               longest = port.options.stride * least_dilations(model, port.body);
  return way > longest ? longest / way : 1;
}

double elastic(const State& state, const Port& port) {
  return port_energy({pose(state, port.body), twist(state, port.body)},
                     {pose(state, port.handle), twist(state, port.handle)}, port_hold(state, port.place),
                     port.options.limits);
}

// A hand that says a speed does not lead the handle on where the spring is at its limit: it would have to
// come back all the way.
void stay_at_limit(const State& state, const Port& port, const PortHold& hold, Vec6& twist) {
  const SE3 &g = pose(state, port.body), &handle = pose(state, port.handle);
  const Vec3 d = handle.p - g * hold.grip;
  const auto drop = [](const Vec3& stretch, double k, double limit, Vec3 speed) {
    if (!(k * stretch.norm() >= limit)) return speed;
    const Vec3 along = stretch.normalized();
    speed -= std::max(0.0, speed.dot(along)) * along;
    return speed;
  };
  twist.head<3>() = drop(d, hold.gains.stiffness, port.options.limits.force, twist.head<3>());
  const Quat turn = (g.R.conjugate() * handle.R).normalized();  // from the body to the handle
  const Vec3 phi = log_so3(turn), spin = turn * Vec3(twist.tail<3>());
  twist.tail<3>() =
      turn.conjugate() * drop(phi, hold.gains.rotation_stiffness, port.options.limits.torque, spin);
}

void let_go(const Model& model, State& state, const Port& port, double tick) {
  PortHold hold = port_hold(state, port.place);
  const PortGains full = critical_gains(model.bodies[port.body], port.options.gains.stiffness,
                                        port.options.gains.rotation_stiffness);
  const double part = tick / port.options.ramp;
  if (hold.gains.stiffness > 0)
    hold = {.gains = {0, 0, 0, 0}, .brake = full.damping, .rotation_brake = full.rotation_damping};
  else
    hold.brake = std::max(0.0, hold.brake - part * full.damping),
    hold.rotation_brake = std::max(0.0, hold.rotation_brake - part * full.rotation_damping);
  set_port_hold(state, port.place, hold);
  twist(state, port.handle).setZero();
}

}  // namespace

void describe(SettingVisitor& visit, PortOptions& o) {
  visit.begin("PortOptions");
  visit.group("gains", o.gains);
  visit.group("limits", o.limits);
  visit.number({"ramp", "time in which a hand takes hold", "s", positive_range()}, o.ramp);
  visit.number({"stride", "largest way of a handle in a tick, in sums of dilations", "-", positive_range()},
               o.stride);
}

void validate(const PortOptions& options) {
  check_ranges(options);
}

Port add_port(Model& model, BodyId body, const PortOptions& options) {
  validate(options);
  require_field(model.bodies.contains(body), "add_port: body", body,
                ("lie in [0, " + to_string(model.bodies.next()) + ")").c_str());
  require(has_inertia(model.bodies[body]), "add_port: body " + to_string(body) + " (" +
                                               model.bodies[body].name + ") must be dynamic or carried");
  require_field(options.gains.stiffness > 0, "PortGains::stiffness", options.gains.stiffness,
                "be positive: it tells whether a hand holds");
  Port out{.body = body, .options = options};
  const PortGains critical =
      critical_gains(model.bodies[body], options.gains.stiffness, options.gains.rotation_stiffness);
  PortGains& gains = out.options.gains;
  if (gains.damping == 0) gains.damping = critical.damping;
  if (gains.rotation_damping == 0) gains.rotation_damping = critical.rotation_damping;
  RigidBody handle = fixed_body("handle of " + model.bodies[body].name, {});
  handle.motion = DrivenMotion{};
  out.handle = add(model, std::move(handle));
  out.place = add_port_law(model, body, out.handle, options.limits);
  return out;
}

double follow(const Model& model, State& state, const Port& port, const PortTarget& target, double tick) {
  require_field(tick > 0, "follow: tick", tick, "be positive [s]");
  if (target.mode == PortTarget::Mode::none) {
    let_go(model, state, port, tick);
    return 0;
  }
  const bool was_held = is_held(state, port);
  PortHold hold = port_hold(state, port.place);
  const SE3& g = pose(state, port.body);
  const SE3 from = was_held ? pose(state, port.handle) : SE3{g.R, g * target.grip};
  Vec6 asked = target.mode == PortTarget::Mode::pose
                   ? twist_between(from, checked_pose(target.pose, "PortTarget::pose"), tick)
                   : target.twist;
  require(target.grip.allFinite(), "PortTarget::grip must be finite");
  require(asked.allFinite(), "PortTarget::twist must be finite");
  if (was_held && target.mode == PortTarget::Mode::twist) stay_at_limit(state, port, hold, asked);
  pose(state, port.handle) = from;
  twist(state, port.handle) = fitting(model, port, asked, tick) * asked;
  if (!was_held) set_port_hold(state, port.place, hold = {.gains = {0, 0, 0, 0}, .grip = target.grip});
  PortGains full = port.options.gains;
  if (!target.firm) full.rotation_stiffness = full.rotation_damping = 0;
  const double before = elastic(state, port);
  hold.gains = grown(hold.gains, full, tick / port.options.ramp);
  set_port_hold(state, port.place, hold);
  return std::max(0.0, elastic(state, port) - before);
}

PortPull port_pull(const State& state, const Port& port) {
  return port_pull({pose(state, port.body), twist(state, port.body)},
                   {pose(state, port.handle), twist(state, port.handle)}, port_hold(state, port.place),
                   port.options.limits);
}

bool is_at_limit(const PortPull& pull, const PortLimits& limits) {
  constexpr double kRounding = 1e-9;
  return pull.force.norm() >= (1 - kRounding) * limits.force ||
         pull.torque.norm() >= (1 - kRounding) * limits.torque;
}

bool is_held(const State& state, const Port& port) {
  return port_hold(state, port.place).gains.stiffness > 0;
}

}  // namespace aussois
