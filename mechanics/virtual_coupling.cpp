// SPDX-License-Identifier: Apache-2.0
#include "mechanics/virtual_coupling.hpp"

#include <cmath>

#include "geometry/settings.hpp"
#include "mechanics/handle.hpp"
#include "mechanics/model.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

// What is missing to the target (VC-1).
struct CouplingError {
  Vec3 d = Vec3::Zero(), d_dot = Vec3::Zero();  // position and velocity, world [m], [m/s]
  Vec3 phi = Vec3::Zero(), a = Vec3::Zero();  // rotation and the target's rotation speed, body [rad], [rad/s]
  Vec3 phi_dot = Vec3::Zero();                // rotation speed, body [rad/s]
};

CouplingError coupling_error(const State& state, BodyId body, const TrajectoryPoint& target) {
  const SE3& g = pose(state, body);
  const Vec6 v = twist(state, body);
  const Quat R_error = g.R.conjugate() * target.pose.R;
  CouplingError error;
  error.d = target.pose.p - g.p;
  error.d_dot = target.twist.head<3>() - v.head<3>();
  error.phi = log_so3(R_error);
  error.a = R_error * target.twist.tail<3>();
  error.phi_dot = error.a - v.tail<3>();
  return error;
}

using Target = std::function<TrajectoryPoint(const Model&, const State&, double t)>;

CriticalDampers damping(const RigidBody& body, const VirtualCouplingOptions& options) {  // (VC-3)
  CriticalDampers out = critical_dampers(body, options.stiffness, options.rotation_stiffness);
  out.translation *= options.damping_ratio, out.rotation *= options.damping_ratio;
  return out;
}

struct Pull {
  LimitedPull force{}, torque{};
};
Pull pull_of(const CouplingError& error, const CriticalDampers& gain,
             const VirtualCouplingOptions& options) {  // (VC-2)
  return {.force =
              limited_pull(options.stiffness * error.d + gain.translation * error.d_dot, options.force_limit),
          .torque = limited_pull(options.rotation_stiffness * error.phi + gain.rotation * error.phi_dot,
                                 options.torque_limit)};
}

}  // namespace

void describe(SettingVisitor& visit, VirtualCouplingOptions& o) {
  visit.begin("VirtualCouplingOptions");
  visit.number({"stiffness", "stiffness of the coupling in translation", "N/m", positive_range()},
               o.stiffness);
  visit.number({"rotation_stiffness", "stiffness of the coupling in rotation", "N m/rad", positive_range()},
               o.rotation_stiffness);
  visit.number(
      {"damping_ratio", "damping of the coupling, relative to the critical damping of the body alone", "-",
       not_negative_range(), "--damping-ratio"},
      o.damping_ratio);
  visit.number({"force_limit", "largest force of the coupling", "N", range_above(0), "--force-limit"},
               o.force_limit);
  visit.number({"torque_limit", "largest torque of the coupling", "N m", range_above(0), "--torque-limit"},
               o.torque_limit);
}

void validate(const VirtualCouplingOptions& options) {
  check_ranges(options);
}

namespace {

CouplingWrench wrench_towards(const Model& model, const State& state, BodyId body,
                              const TrajectoryPoint& target, const VirtualCouplingOptions& options) {
  const CriticalDampers gain = damping(model.bodies.at(body), options);
  const Pull pull = pull_of(coupling_error(state, body, target), gain, options);
  return {.force = pull.force.pull,
          .torque = pull.torque.pull,
          .saturated = pull.force.saturated || pull.torque.saturated};
}

ForceLaw coupling_towards(const Model& model, BodyId body, Target target,
                          const VirtualCouplingOptions& options) {
  require_field(model.bodies.contains(body), "virtual_coupling: body", body,
                ("lie in [0, " + to_string(model.bodies.next()) + ")").c_str());
  const RigidBody& pulled = model.bodies[body];
  require(has_inertia(pulled),
          "virtual_coupling: body " + to_string(body) + " (" + pulled.name + ") must be dynamic or carried");
  validate(options);

  ForceLaw law;
  law.name = "virtual coupling of " + pulled.name;
  law.potential = [body, target, options](const Model& m, const State& state, double t) {
    const CouplingError error = coupling_error(state, body, target(m, state, t));
    return limited_spring_energy(error.d.norm(), options.stiffness, options.force_limit) +
           limited_spring_energy(error.phi.norm(), options.rotation_stiffness, options.torque_limit);
  };
  law.add_to = [body, target = std::move(target), options](const Model& m, const State& state, double t,
                                                           GeneralisedForce& sum) {
    const CouplingError error = coupling_error(state, body, target(m, state, t));
    const CriticalDampers gain = damping(m.bodies[body], options);
    const Pull pull = pull_of(error, gain, options);
    const int force = first_velocity(body), torque = force + 3;  // first rows
    linear_part(sum.f, body) += pull.force.pull;
    angular_part(sum.f, body) += pull.torque.pull;
    if (!pull.force.saturated) {  // (VC-5)
      add_block(sum.K, force, force, options.stiffness * Mat3::Identity());
      add_block(sum.C, force, force, gain.translation * Mat3::Identity());
    }
    if (!pull.torque.saturated) {
      add_block(sum.K, torque, torque,
                options.rotation_stiffness * dexp_left_inverse(error.phi) - gain.rotation * skew(error.a));
      add_block(sum.C, torque, torque, gain.rotation * Mat3::Identity());
    }
  };
  return law;
}

}  // namespace

CouplingWrench coupling_wrench(const Model& model, const State& state, BodyId body, const Trajectory& path,
                               const VirtualCouplingOptions& options, double t) {
  return wrench_towards(model, state, body, trajectory_point(path, t), options);
}

CouplingWrench coupling_wrench(const Model& model, const State& state, BodyId body, BodyId handle,
                               const VirtualCouplingOptions& options, double t) {
  return wrench_towards(model, state, body, handle_at(model, state, handle, t), options);
}

ForceLaw virtual_coupling(const Model& model, BodyId body, Trajectory path,
                          const VirtualCouplingOptions& options) {
  validate(path);
  return coupling_towards(
      model, body,
      [path = std::move(path)](const Model&, const State&, double t) { return trajectory_point(path, t); },
      options);
}

ForceLaw virtual_coupling(const Model& model, BodyId body, BodyId handle,
                          const VirtualCouplingOptions& options) {
  require_field(model.bodies.contains(handle) && handle != body, "virtual_coupling: handle", handle,
                ("lie in [0, " + to_string(model.bodies.next()) + ") and not be the body").c_str());
  require(!is_dynamic(model.bodies[handle]), "virtual_coupling: handle " + to_string(handle) + " (" +
                                                 model.bodies[handle].name + ") must not be dynamic");
  return coupling_towards(
      model, body,
      [handle](const Model& m, const State& state, double t) { return handle_at(m, state, handle, t); },
      options);
}

}  // namespace aussois
