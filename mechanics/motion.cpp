// SPDX-License-Identifier: Apache-2.0
#include "mechanics/motion.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "lmd/motion_bound.hpp"
#include "mechanics/layout.hpp"
#include "mechanics/mechanism.hpp"
#include "mechanics/tree.hpp"

namespace aussois {

SE3 retract(const SE3& g, const Vec6& twist, double time) {
  return twist.isZero(0) ? g : pose_at({.g = g, .v = twist.head<3>(), .omega = twist.tail<3>()}, time);
}

State retract(const Model& model, State state, const VecX& v, double time) {
  PerBody<SE3> g = state.g;
  for (const BodyId b : g.ids()) g[b] = retract(g[b], body_part(v, b), time);
  state.q += time * v.tail(state.q.size());
  carry_poses(model, state.q, g);
  if (!model.joints.empty()) state.turns = counted_turns(model, state, g);
  state.g = std::move(g);
  return state;
}

Vec6 twist_between(const SE3& from, const SE3& to, double time) {
  Vec6 out;
  out << (to.p - from.p) / time, log_so3((from.R.conjugate() * to.R).normalized()) / time;
  return out;
}

VecX velocity_between(const State& state, const State& plain, const State& end, VecX v, double time) {
  if (end.q != plain.q) v.tail(end.q.size()) = (end.q - state.q) / time;
  for (const BodyId b : state.g.ids()) {
    const SE3 &g = pose(state, b), &to = pose(end, b), &led_to = pose(plain, b);
    if (to.p == led_to.p && to.R.coeffs() == led_to.R.coeffs()) continue;
    linear_part(v, b) = (to.p - g.p) / time;
    const Vec3 phi = log_so3((g.R.conjugate() * to.R).normalized());
    const double angle = phi.norm();
    if (angle == 0) continue;
    const double turns = std::round((time * angular_part(v, b).dot(phi) / angle - angle) / (2 * kPi));
    angular_part(v, b) = phi * ((1 + 2 * kPi * turns / angle) / time);
  }
  return v;
}

void lead_body(const Model& model, State& state, BodyId body, const SE3& target, double time) {
  require_field(model.bodies.contains(body), "lead_body: body", body,
                ("lie in [0, " + to_string(model.bodies.next()) + ")").c_str());
  const RigidBody& led = model.bodies[body];
  require(std::holds_alternative<DrivenMotion>(led.motion),
          "lead_body: body " + to_string(body) + " (" + led.name + ") must be driven");
  require_field(time > 0, "lead_body: time", time, "be positive [s]");
  twist(state, body) = twist_between(pose(state, body), checked_pose(target, "lead_body: target"), time);
}

VecX prescribed_velocity(const Model& model, const State& state, double h) {
  VecX v = VecX::Zero(state.v.size());
  for (const BodyId b : model.bodies.ids()) {
    const Motion& motion = model.bodies[b].motion;
    if (const auto* moved = std::get_if<PrescribedMotion>(&motion))
      body_part(v, b) = twist_between(pose(state, b), trajectory_point(moved->path, state.t + h).pose, h);
    else if (std::holds_alternative<DrivenMotion>(motion))
      body_part(v, b) = twist(state, b);
  }
  for (const BlockId i : model.coordinates.ids()) {
    const std::vector<PointMass>& points = model.coordinates[i].points;
    const int first = points.empty() ? 0 : first_speed(model, i);
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto at = Eigen::Index(first) + 3 * Eigen::Index(k);
      const Vec3 all = state.v.segment<3>(at);
      v.segment<3>(at) = all - without_held(points[k], all);
    }
  }
  return v;
}

PerBody<SE3> moved_poses(const Model& model, const State& state, const VecX& v, double time) {
  PerBody<SE3> g(state.g.size());
  for (const BodyId b : g.ids()) {
    const auto* moved = std::get_if<PrescribedMotion>(&model.bodies[b].motion);
    g[b] = moved ? trajectory_point(moved->path, state.t + time).pose
                 : retract(pose(state, b), body_part(v, b), time);
  }
  return g;
}

State state_after(const Model& model, const State& state, const VecX& v_path, const VecX& v_end, double h) {
  State next{.t = state.t + h,
             .h = h,
             .h_next = state.h_next,
             .g = moved_poses(model, state, v_path, h),
             .q = state.q + h * v_path.tail(state.q.size()),
             .v = v_end,
             .turns = state.turns,
             .r = state.r,
             .a = {},
             .u = state.u,
             .memory = {}};
  carry_poses(model, next.q, next.g);
  carry_twists(model, next.g, next.v);
  if (!model.joints.empty()) next.turns = counted_turns(model, state, next.g);
  return next;
}

VecX with_carried(const Model& model, const State& state, VecX v, double time) {
  if (!carries_bodies(model)) return v;
  const PerBody<SE3> end = retract(model, state, v, time).g;
  for (const BodyId b : model.bodies.ids())
    if (is_carried(model.bodies[b])) body_part(v, b) = twist_between(pose(state, b), end[b], time);
  return v;
}

const char* to_string(GroupUpdate update) {
  return name_of(update, kGroupUpdates);
}
VecX path_velocity(GroupUpdate update, const Model& model, const State& state, const VecX& v, double h) {
  VecX out = v;
  for (const BodyId b : model.bodies.ids()) {
    if (update == GroupUpdate::exponential) break;  // (LIE-1)
    const Vec3 omega = angular_part(v, b);
    const double half = h / 2 * omega.norm();
    if (!is_dynamic(model.bodies[b]) || half == 0) continue;
    if (update == GroupUpdate::cayley) {
      angular_part(out, b) *= std::atan(half) / half;  // (LIE-2)
    } else {
      const Vec3 axis = pose(state, b).R * omega.normalized(), along = axis * axis.dot(linear_part(v, b));
      linear_part(out, b) = along + stumpff(1, half * half) * (linear_part(v, b) - along);  // (LIE-3)
    }
  }
  return with_carried(model, state, std::move(out), h);
}

}  // namespace aussois
