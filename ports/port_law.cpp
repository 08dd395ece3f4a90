// SPDX-License-Identifier: Apache-2.0
#include "ports/port_law.hpp"

#include "geometry/settings.hpp"
#include "geometry/so3.hpp"
#include "mechanics/handle.hpp"
#include "mechanics/model.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

constexpr int kPortSize = 9;  // numbers of a hold in State::u

// What is missing to the handle, and how fast that changes.
struct Missing {
  Mat3 R = Mat3::Identity();                         // of the body
  Vec3 spin = Vec3::Zero();                          // of the body, in its frame [rad/s]
  Vec3 d = Vec3::Zero(), d_rate = Vec3::Zero();      // of the grip, world [m], [m/s]
  Vec3 phi = Vec3::Zero(), phi_rate = Vec3::Zero();  // in the body [rad], [rad/s]
  Vec3 turning = Vec3::Zero();                       // of the handle, in the body [rad/s]
  Quat handle = Quat::Identity();
};
Missing missing(const TrajectoryPoint& body, const TrajectoryPoint& handle, const Vec3& grip) {
  const Quat rest = (body.pose.R.conjugate() * handle.pose.R).normalized();
  Missing out{.R = body.pose.R.toRotationMatrix(), .spin = body.twist.tail<3>(), .handle = handle.pose.R};
  out.d = handle.pose.p - body.pose * grip;
  out.d_rate = handle.twist.head<3>() - body.twist.head<3>() - out.R * out.spin.cross(grip);
  out.phi = log_so3(rest);
  out.turning = rest * Vec3(handle.twist.tail<3>());
  out.phi_rate = out.turning - out.spin;
  return out;
}
TrajectoryPoint point_of(const State& state, BodyId body) {
  return {pose(state, body), twist(state, body)};
}

struct Pull {
  LimitedPull force{}, torque{};  // world; in the body
};
Pull pull_of(const Missing& m, const PortGains& gains, const PortLimits& limits) {
  return {
      limited_pull(gains.stiffness * m.d + gains.damping * m.d_rate, limits.force),
      limited_pull(gains.rotation_stiffness * m.phi + gains.rotation_damping * m.phi_rate, limits.torque)};
}

// (PORT-8)
void add_derivatives(const Missing& m, const Pull& pull, const PortHold& o, BodyId body,
                     GeneralisedForce& sum) {
  const int at = first_velocity(body), turn = at + 3;
  const auto add = [&](const Mat3& by_p, const Mat3& by_R, std::vector<Triplet>& matrix) {
    const Mat3 arm = skew(o.grip) * m.R.transpose();
    add_block(matrix, at, at, by_p);
    add_block(matrix, at, turn, by_R);
    add_block(matrix, turn, at, arm * by_p);
    add_block(matrix, turn, turn, arm * by_R);
  };
  if (!pull.force.saturated) {
    const Mat3 carried = -m.R * skew(o.grip), spun = -m.R * skew(m.spin.cross(o.grip));
    add(o.gains.stiffness * Mat3::Identity(), o.gains.stiffness * carried + o.gains.damping * spun, sum.K);
    add(o.gains.damping * Mat3::Identity(), o.gains.damping * carried, sum.C);
    add_block(sum.K, turn, turn, -skew(o.grip) * skew(m.R.transpose() * pull.force.pull));
  }
  if (!pull.torque.saturated) {
    add_block(
        sum.K, turn, turn,
        o.gains.rotation_stiffness * dexp_left_inverse(m.phi) - o.gains.rotation_damping * skew(m.turning));
    add_block(sum.C, turn, turn, o.gains.rotation_damping * Mat3::Identity());
  }
}

void add_brake(const PortHold& hold, const State& state, BodyId body, GeneralisedForce& sum) {
  if (hold.brake == 0 && hold.rotation_brake == 0) return;
  const int at = first_velocity(body);
  linear_part(sum.f, body) -= hold.brake * linear_part(state.v, body);
  angular_part(sum.f, body) -= hold.rotation_brake * angular_part(state.v, body);
  add_block(sum.C, at, at, hold.brake * Mat3::Identity());
  add_block(sum.C, at + 3, at + 3, hold.rotation_brake * Mat3::Identity());
}

void check_port(const Model& model, BodyId body, BodyId handle, const PortLimits& limits) {
  for (const auto& [id, who] :
       {std::pair(body, "add_port_law: body"), std::pair(handle, "add_port_law: handle")})
    require_field(model.bodies.contains(id), who, id,
                  ("lie in [0, " + to_string(model.bodies.next()) + ")").c_str());
  const auto named = [&](BodyId id) { return to_string(id) + " (" + model.bodies[id].name + ")"; };
  require(has_inertia(model.bodies[body]),
          "add_port_law: body " + named(body) + " must be dynamic or carried");
  require(!has_inertia(model.bodies[handle]),
          "add_port_law: handle " + named(handle) + " must be neither dynamic nor carried");
  validate(limits);
}

}  // namespace

PortHold port_hold(const State& state, int place) {
  const auto u = state.u.segment<kPortSize>(place);
  return {.gains = {u[0], u[1], u[2], u[3]}, .grip = u.segment<3>(4), .brake = u[7], .rotation_brake = u[8]};
}

void set_port_hold(State& state, int place, const PortHold& hold) {
  validate(hold);
  const PortGains& g = hold.gains;
  state.u.segment<kPortSize>(place) << g.stiffness, g.damping, g.rotation_stiffness, g.rotation_damping,
      hold.grip, hold.brake, hold.rotation_brake;
}

void describe(SettingVisitor& visit, PortGains& o) {
  visit.begin("PortGains");
  visit.number({"stiffness", "stiffness of a port", "N/m", not_negative_range()}, o.stiffness);
  visit.number({"damping", "damping of a port", "N s/m", not_negative_range()}, o.damping);
  visit.number({"rotation_stiffness",
                "stiffness of a port in rotation; 0 with no rotation_damping: the body "
                "hangs by its grip",
                "N m/rad", not_negative_range()},
               o.rotation_stiffness);
  visit.number({"rotation_damping", "damping of a port in rotation", "N m s/rad", not_negative_range()},
               o.rotation_damping);
}

void describe(SettingVisitor& visit, PortLimits& o) {
  visit.begin("PortLimits");
  visit.number({"force", "largest force of a port", "N", range_above(0)}, o.force);
  visit.number({"torque", "largest torque of a port", "N m", range_above(0)}, o.torque);
}

void validate(const PortGains& gains) {
  check_ranges(gains);
}
void validate(const PortHold& hold) {
  validate(hold.gains);
  require(hold.grip.allFinite(), "PortHold::grip must be finite [m]");
  require_field(hold.brake >= 0, "PortHold::brake", hold.brake, "not be negative [N s/m]");
  require_field(hold.rotation_brake >= 0, "PortHold::rotation_brake", hold.rotation_brake,
                "not be negative [N m s/rad]");
}
void validate(const PortLimits& limits) {
  check_ranges(limits);
}

PortGains critical_gains(const RigidBody& body, double stiffness, double rotation_stiffness) {
  const CriticalDampers dampers = critical_dampers(body, stiffness, rotation_stiffness);
  return {.stiffness = stiffness,
          .damping = dampers.translation,
          .rotation_stiffness = rotation_stiffness,
          .rotation_damping = dampers.rotation};
}

PortPull port_pull(const TrajectoryPoint& body, const TrajectoryPoint& handle, const PortHold& hold,
                   const PortLimits& limits) {
  const Missing m = missing(body, handle, hold.grip);
  const Pull pull = pull_of(m, hold.gains, limits);
  return {pull.force.pull, m.R * pull.torque.pull};
}

double port_energy(const TrajectoryPoint& body, const TrajectoryPoint& handle, const PortHold& hold,
                   const PortLimits& limits) {
  const Missing m = missing(body, handle, hold.grip);
  return limited_spring_energy(m.d.norm(), hold.gains.stiffness, limits.force) +
         limited_spring_energy(m.phi.norm(), hold.gains.rotation_stiffness, limits.torque);
}

int add_port_law(Model& model, BodyId body, BodyId handle, const PortLimits& limits) {
  check_port(model, body, handle, limits);
  const int place = add_inputs(model, kPortSize);
  add(model, ForceLaw{.name = "port of " + model.bodies[body].name,
                      .add_to =
                          [=](const Model& now, const State& state, double t, GeneralisedForce& sum) {
                            const PortHold hold = port_hold(state, place);
                            const Missing m =
                                missing(point_of(state, body), handle_at(now, state, handle, t), hold.grip);
                            const Pull pull = pull_of(m, hold.gains, limits);
                            const Vec3 &f = pull.force.pull, &torque = pull.torque.pull;
                            linear_part(sum.f, body) += f;
                            angular_part(sum.f, body) += torque + hold.grip.cross(m.R.transpose() * f);
                            linear_part(sum.f, handle) -= f;
                            angular_part(sum.f, handle) -= m.handle.conjugate() * Vec3(m.R * torque);
                            add_derivatives(m, pull, hold, body, sum);
                            add_brake(hold, state, body, sum);
                          },
                      .potential =
                          [=](const Model& now, const State& state, double t) {
                            return port_energy(point_of(state, body), handle_at(now, state, handle, t),
                                               port_hold(state, place), limits);
                          },
                      .passive = true});
  return place;
}

}  // namespace aussois
