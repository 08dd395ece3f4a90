// SPDX-License-Identifier: Apache-2.0
#include "mechanics/handle.hpp"

#include <cmath>
#include <variant>

#include "mechanics/model.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/state.hpp"

namespace aussois {

TrajectoryPoint handle_at(const Model& model, const State& state, BodyId handle, double t) {
  const Vec6 v = twist(state, handle);
  const RigidBody& body = model.bodies[handle];
  if (const auto* moved = std::get_if<PrescribedMotion>(&body.motion))
    return trajectory_point(moved->path, t);
  if (!is_moved(body)) return {.pose = pose(state, handle)};
  return {retract(pose(state, handle), v, t - state.t), v};
}

LimitedPull limited_pull(const Vec3& pull, double limit) {
  const double size = pull.norm();
  return size > limit ? LimitedPull{pull * (limit / size), true} : LimitedPull{pull, false};
}

double limited_spring_energy(double x, double k, double limit) {
  return k * x <= limit ? 0.5 * k * x * x : limit * (x - 0.5 * limit / k);
}

CriticalDampers critical_dampers(const RigidBody& body, double stiffness, double rotation_stiffness) {
  return {.translation = 2 * std::sqrt(stiffness * body.mass),
          .rotation = 2 * std::sqrt(rotation_stiffness * body.inertia.trace() / 3)};
}

}  // namespace aussois
