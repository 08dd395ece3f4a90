// SPDX-License-Identifier: Apache-2.0
// C6: the scene in its two angles, and the motion by another integrator.
#include <cmath>

#include <Eigen/LU>

#include "examples/scenes/mechanisms.hpp"

namespace aussois {
namespace {

constexpr double kWall = -0.2, kRestitution = 0.5;
const Vec2 kStart(0.8, 1.2);

Mat2 mass(const Vec2& q) {
  const double c = std::cos(q[0] - q[1]);
  return (Mat2() << 2, c, c, 1).finished();
}
Vec2 force(const Vec2& q, const Vec2& v) {
  const double s = std::sin(q[0] - q[1]);
  return {-s * v[1] * v[1] - 2 * kGravity * std::sin(q[0]), s * v[0] * v[0] - kGravity * std::sin(q[1])};
}
double gap(const Vec2& q) {
  return std::sin(q[0]) + std::sin(q[1]) - kWall;
}
Vec2 gradient(const Vec2& q) {
  return {std::cos(q[0]), std::cos(q[1])};
}

}  // namespace

CaseScene double_pendulum() {
  CaseScene s;
  const auto forces = [](double, const VecX& q, const VecX& v) {
    const double sine = std::sin(q[0] - q[1]);
    CoordinateForce out{.f = force(q, v), .C = MatX::Zero(2, 2)};
    out.C(0, 1) = 2 * sine * v[1], out.C(1, 0) = -2 * sine * v[0];
    return out;
  };
  const auto height = [](const VecX& q) { return -kGravity * (2 * std::cos(q[0]) + std::cos(q[1])); };
  const auto wall = [](const Model&, const State& state, double) {
    return GapRows{.gap = gap(state.q), .J = gradient(state.q).transpose()};
  };
  add(s.model, Coordinates{.name = "pendulum",
                           .size = 2,
                           .mass = [](const VecX& q) -> MatX { return mass(q); },
                           .force = forces,
                           .potential = height});
  add(s.model,
      GapFunction{
          .name = "wall", .block = 0, .evaluate = wall, .law = {.mu = 0, .restitution = kRestitution}});
  s.state = rest_state(s.model);
  s.state.q = kStart;
  return s;
}

ExactMotion double_pendulum_motion(double t_end) {
  constexpr double kStride = 1e-3;  // of the integration [s]
  constexpr double kClear = 1e-2;   // the wall is not met again sooner [s]
  const auto rates = [](double, const VecX& y) -> VecX {
    VecX rate(4);
    rate << y.tail<2>(), mass(y.head<2>()).inverse() * force(y.head<2>(), y.tail<2>());
    return rate;
  };
  ExactMotion out;
  VecX y(4);
  y << kStart, 0, 0;
  for (double begin = 0; begin < t_end;) {
    const auto at = ode_solution(rates, y, t_end - begin, kStride);
    out.pieces.push_back({begin, [=](double t) {
                            const VecX now = at(t - begin);
                            return MotionSample{.q = now.head<2>(), .v = now.tail<2>()};
                          }});
    const double hit =
        first_root([&](double s) { return gap(at(s).head<2>()); }, kClear, t_end - begin, kStride);
    if (hit > t_end - begin) break;
    y = at(hit), begin += hit;
    const Vec2 J = gradient(y.head<2>()), turn = mass(y.head<2>()).inverse() * J;
    y.tail<2>() -= (1 + kRestitution) * J.dot(y.tail<2>()) / J.dot(turn) * turn;  // (MCH-3)
  }
  return out;
}

}  // namespace aussois
