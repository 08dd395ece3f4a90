// SPDX-License-Identifier: Apache-2.0
// Bodies on joints: the heavy top on its tip, a closed chain of rods that spins as one, a pendulum against
// its wall, a slider-crank that bounces in its slot.
#include <cmath>

#include "examples/scenes/mechanisms.hpp"

namespace aussois {
namespace {

/// Centre of mass and its velocity, of the body that is looked at.
MotionSample centre_of_mass(const CaseScene& s, const State& state) {
  return {.q = pose(state, s.body).p, .v = twist(state, s.body).head<3>()};
}

// D3. A disk of 15 kg at the end of a massless rod of 1 m along the body's y, which turns about the world's
// origin.
struct HeavyTop {
  double m = 15;
  Vec3 X = Vec3::UnitY();                      // centre of mass, seen from the tip, in the body [m]
  Vec3 J = Vec3(0.234375, 0.46875, 0.234375);  // about the centre of mass, principal [kg m^2]
  Vec3 omega = Vec3(0, 150, -4.61538);         // at the start, in the body [rad/s]
};

// About the tip: J_O omega' = X x R^T m g - omega x J_O omega, with J_O = J + m (|X|^2 - X X^T).
ExactMotion heavy_top(const HeavyTop& top, double t_end) {
  constexpr double kStride = 2e-4;
  const Vec3 J_O = top.J + top.m * Vec3(1, 0, 1);
  VecX start(7);
  start << 1, 0, 0, 0, top.omega;
  const auto rates = [top, J_O](double, const VecX& y) -> VecX {
    const Quat q(y[0], y[1], y[2], y[3]);
    const Vec3 w = y.tail<3>();
    const Quat turn = q * Quat(0, w[0] / 2, w[1] / 2, w[2] / 2);
    const Vec3 weight = q.normalized().conjugate() * Vec3(0, 0, -top.m * kGravity);
    VecX rate(7);
    rate << turn.w(), turn.vec(), (top.X.cross(weight) - w.cross(J_O.cwiseProduct(w))).cwiseQuotient(J_O);
    return rate;
  };
  const auto y = ode_solution(rates, start, t_end, kStride);
  return {.pieces = {{0, [y, X = top.X](double t) {
                        const VecX at = y(t);
                        const Quat R = Quat(at[0], at[1], at[2], at[3]).normalized();
                        return MotionSample{.q = R * X, .v = R * Vec3(at.tail<3>()).cross(X)};
                      }}}};
}

CaseScene heavy_top_scene(const HeavyTop& top) {
  CaseScene s;
  s.body = add(s.model, RigidBody{.name = "top", .mass = top.m, .inertia = top.J.asDiagonal()});
  s.state = rest_state(s.model);
  pose(s.state, s.body).p = top.X;
  twist(s.state, s.body) << top.omega.cross(top.X), top.omega;
  add(s.model, joint_at(JointKind::spherical, "tip", s.body, kWorld, s.state.g, SE3{}));
  return s;
}

// C10.
ExactMotion turning(int rods, double omega) {
  const double r = 0.5 / std::tan(kPi / rods);
  return {.pieces = {{0, [=](double t) {
                        const Vec3 p = r * Vec3(std::cos(omega * t), std::sin(omega * t), 0);
                        return MotionSample{.q = p, .v = omega * Vec3::UnitZ().cross(p)};
                      }}}};
}

// C2, up to shortly before the fourth impact. In steps of a microsecond the joints, which hold to rounding,
// still need velocities of 1e-11 m/s and more: a solver cannot reach less.
Case slider_crank_case(const char* name, const char* what, double h, CaseScene (*scene)(double mu),
                       MotionSample (*observe)(const CaseScene&, const State&)) {
  return {.name = name,
          .what = what,
          .t_end = 8e-3,
          .h = h,
          .tolerance = 1e-10,
          .bounces = true,
          .at_once = true,
          .scene = [scene] { return scene(0); },
          .observe = observe,
          .exact = slider_crank_motion};
}

}  // namespace

std::vector<Case> mechanism_cases() {
  constexpr int kRods = 6;
  constexpr double kOmega = 3;
  return {{.name = "heavy_top",
           .what = "a spinning top on its tip (D3)",
           .t_end = 0.2,
           .h = 1e-3,
           .smooth = true,
           .scene = [] { return heavy_top_scene({}); },
           .observe = centre_of_mass,
           .exact = [](double until) { return heavy_top({}, until); }},
          {.name = "spinning_chain",
           .what = "a closed chain of six rods spins as a hexagon (C10)",
           .t_end = 2,
           .h = 5e-2,
           .smooth = true,
           .scene = [] { return spinning_chain(kRods, kOmega, JointKind::spherical); },
           .observe = centre_of_mass,
           .exact = [](double) { return turning(kRods, kOmega); }},
          {.name = "double_pendulum",
           .what = "two masses on rods, the lower one against a wall (C6)",
           .t_end = 3,
           .h = 5e-3,
           .bounces = true,
           .scene = double_pendulum,
           .observe = [](const CaseScene&,
                         const State& state) { return MotionSample{.q = state.q, .v = state.v}; },
           .exact = double_pendulum_motion},
          slider_crank_case("slider_crank", "a slider-crank with clearance, of bodies in space (C2)", 1e-4,
                            slider_crank_of_bodies, slider_of_bodies),
          slider_crank_case("slider_crank_angles", "the same in three angles of its own (C2)", 2e-5,
                            slider_crank_of_angles, slider_of_angles)};
}

}  // namespace aussois
