// SPDX-License-Identifier: Apache-2.0
// What all couplings to a handle share: where it will be, springs with a limit, and critical dampers (VC-3),
// (VC-4), (VC-6).
#pragma once

#include "lmd/body_id.hpp"
#include "mechanics/rigid_body.hpp"
#include "mechanics/trajectory.hpp"

namespace aussois {

struct Model;
struct State;

/// Where a body that is not dynamic will be at time t.
TrajectoryPoint handle_at(const Model& model, const State& state, BodyId handle, double t);

/// A pull after its limit.
struct LimitedPull {
  Vec3 pull = Vec3::Zero();
  bool saturated = false;
};
/// Scaled back as a whole vector (VC-4).
LimitedPull limited_pull(const Vec3& pull, double limit);

/// Energy of a spring whose force stops growing at `limit` (VC-6).
double limited_spring_energy(double x, double k, double limit);

/// Dampers that are critical for a body alone, in rotation for its mean moment of inertia (VC-3).
struct CriticalDampers {
  double translation = 0, rotation = 0;  // [N s/m], [N m s]
};
CriticalDampers critical_dampers(const RigidBody& body, double stiffness, double rotation_stiffness);

}  // namespace aussois
