// SPDX-License-Identifier: Apache-2.0
// C2, Flores, Leine, Glocker 2010: the scenes, and the motion by other means (MCH-1) to (MCH-4).
#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "examples/scenes/mechanisms.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr double kRestitution = 0.4;
constexpr double kClearance = 1e-3;                          // on either side [m]
constexpr double kLinkMass[] = {0.038, 0.038, 0.076};        // crank, rod, slider [kg]
constexpr double kLinkInertia[] = {7.4e-5, 5.9e-4, 2.7e-6};  // about their centres [kg m^2]
constexpr double kStride = 1e-4;                             // of the integration [s]
constexpr double kLastSpeed = 1e-6;                          // what leaves a wall slower stays [m/s]
constexpr double kSpeed[] = {150, -75};                      // of crank and rod at the start [rad/s]
constexpr double kHalfLength = kSliderLength / 2, kHalfHeight = kSliderHeight / 2;  // [m]

// Lagrange's equations of the two angles that move the slider's centre (MCH-1).
constexpr double kMixed = (kLinkMass[1] / 2 + kLinkMass[2]) * kCrankLength * kConnectingRodLength;
Mat2 mass(const Vec2& th) {
  const double mixed = kMixed * std::cos(th[1] - th[0]);
  Mat2 M;
  M << kLinkInertia[0] + (kLinkMass[0] / 4 + kLinkMass[1] + kLinkMass[2]) * kCrankLength * kCrankLength,
      mixed, mixed,
      kLinkInertia[1] + (kLinkMass[1] / 4 + kLinkMass[2]) * kConnectingRodLength * kConnectingRodLength;
  return M;
}
const Vec2 kWeight = kGravity * Vec2((kLinkMass[0] / 2 + kLinkMass[1] + kLinkMass[2]) * kCrankLength,
                                     (kLinkMass[1] / 2 + kLinkMass[2]) * kConnectingRodLength);
Vec2 force(const Vec2& th, const Vec2& w) {
  const double s = kMixed * std::sin(th[0] - th[1]);
  return {-s * w[1] * w[1] - kWeight[0] * std::cos(th[0]), s * w[0] * w[0] - kWeight[1] * std::cos(th[1])};
}
// Of the slider's centre.
double height(const Vec2& th) {
  return kCrankLength * std::sin(th[0]) + kConnectingRodLength * std::sin(th[1]);
}
Vec2 gradient(const Vec2& th) {
  return {kCrankLength * std::cos(th[0]), kConnectingRodLength * std::cos(th[1])};
}

MotionSample slider(const Vec3& th, const Vec3& w) {
  const Vec2 dz = gradient(th.head<2>());
  return {.q = Vec3(dz.sum(), height(th.head<2>()), kHalfLength * th[2]),
          .v = Vec3(-kCrankLength * std::sin(th[0]) * w[0] - kConnectingRodLength * std::sin(th[1]) * w[1],
                    dz.dot(w.head<2>()), kHalfLength * w[2])};
}

// Accelerations, and the force of the wall on the slider, which keeps its height if it is `closed` (MCH-2).
struct Rates {
  Vec2 acceleration = Vec2::Zero();
  double force = 0;   // upwards [N]
  double height = 0;  // second derivative [m/s^2]
};
Rates rates_of(const VecX& y, bool closed) {
  const Vec2 th = y.head<2>(), w = y.tail<2>(), dz = gradient(th);
  const Mat2 inverse = mass(th).inverse();
  const double bend =
      -kCrankLength * std::sin(th[0]) * w[0] * w[0] - kConnectingRodLength * std::sin(th[1]) * w[1] * w[1];
  Rates out{.acceleration = inverse * force(th, w)};
  if (closed) out.force = -(dz.dot(out.acceleration) + bend) / dz.dot(inverse * dz);
  out.acceleration += out.force * inverse * dz;
  out.height = dz.dot(out.acceleration) + bend;
  return out;
}
std::function<VecX(double, const VecX&)> ode(bool closed) {
  return [closed](double, const VecX& y) -> VecX {
    VecX rate(4);
    rate << y.tail<2>(), rates_of(y, closed).acceleration;
    return rate;
  };
}

VecX after_impact(VecX y, double restitution) {  // (MCH-3)
  const Vec2 dz = gradient(y.head<2>()), turn = mass(y.head<2>()).inverse() * dz;
  y.tail<2>() -= (1 + restitution) * dz.dot(y.tail<2>()) / dz.dot(turn) * turn;
  return y;
}

// What follows at a wall: 1 the upper one, -1 the lower one, 0 none.
struct Hop {
  bool closed = false;      // stays
  double stride = kStride;  // a fraction of the time to the next impact on the same wall [s]
};
Hop hop_of(const VecX& y, double wall) {
  const double leaves = -wall * gradient(y.head<2>()).dot(y.tail<2>());
  const double pull = wall * rates_of(y, false).height;  // towards the wall, of what moves freely [m/s^2]
  if (wall == 0 || pull <= 0) return {};
  return {.closed = leaves < kLastSpeed, .stride = std::min(kStride, 2 * leaves / pull / 10)};
}

// The wall would have to pull, or the slider meets the same wall again, or the other one.
double end_of(const Hop& hop, const std::function<VecX(double)>& at, double wall, double left) {
  const auto push = [&](double s) { return -wall * rates_of(at(s), true).force; };
  const auto gap = [&](double s) { return kClearance - std::abs(height(at(s).head<2>())); };
  return hop.closed ? first_root(push, 0, left, kStride) : first_root(gap, hop.stride, left, hop.stride);
}

Coordinates angles() {
  const auto mass_of_all = [](const VecX& q) -> MatX {
    MatX M = MatX::Zero(3, 3);
    M.topLeftCorner<2, 2>() = mass(q.head<2>());
    M(2, 2) = kLinkInertia[2];
    return M;
  };
  const auto all_forces = [](double, const VecX& q, const VecX& v) {
    const double s = kMixed * std::sin(q[0] - q[1]);
    CoordinateForce out{.f = VecX::Zero(3), .C = MatX::Zero(3, 3)};
    out.f.head<2>() = force(q.head<2>(), v.head<2>());
    out.C(0, 1) = 2 * s * v[1], out.C(1, 0) = -2 * s * v[0];
    return out;
  };
  return {.name = "slider crank",
          .size = 3,
          .mass = mass_of_all,
          .force = all_forces,
          .potential = [](const VecX& q) { return kWeight.dot(Vec2(std::sin(q[0]), std::sin(q[1]))); }};
}

// The corner at (x, z) of the slider and the wall on its side.
GapFunction corner(double x, double z, double mu) {
  const auto evaluate = [x, z](const Model&, const State& state, double) {
    const Vec2 th = state.q.head<2>();
    const double s = std::sin(state.q[2]), c = std::cos(state.q[2]), side = z > 0 ? 1 : -1;
    GapRows out{.gap = kHalfHeight + kClearance - side * (height(th) + s * x + c * z), .J = MatX(2, 3)};
    out.J << -side * gradient(th).transpose(), -side * (c * x - s * z),  //
        -kCrankLength * std::sin(th[0]), -kConnectingRodLength * std::sin(th[1]), -s * x - c * z;
    return out;
  };
  return {.name = "corner", .block = 0, .evaluate = evaluate, .law = {.mu = mu, .restitution = kRestitution}};
}

}  // namespace

ExactMotion slider_crank_motion(double t_end) {
  ExactMotion out;
  VecX y(4);
  y << 0, 0, kSpeed[0], kSpeed[1];
  double begin = 0, wall = 0;
  while (begin < t_end) {
    const Hop hop = hop_of(y, wall);
    if (hop.closed) y = after_impact(y, 0);
    const double left = t_end - begin;
    const auto at = ode_solution(ode(hop.closed), y, left, kStride);
    out.pieces.push_back({begin, [=](double t) {
                            const VecX now = at(t - begin);
                            return slider({now[0], now[1], 0}, {now[2], now[3], 0});
                          }});
    const double until = end_of(hop, at, wall, left);
    if (until > left) break;
    y = at(until), begin += until;
    wall = hop.closed ? 0 : height(y.head<2>()) > 0 ? 1 : -1;
    if (!hop.closed) y = after_impact(y, kRestitution);
  }
  return out;
}

MotionSample slider_of_bodies(const CaseScene& s, const State& state) {
  const SE3& g = pose(state, s.body);
  const Vec6 v = twist(state, s.body);
  const Vec3 along = g.R * Vec3::UnitX();
  return {.q = Vec3(g.p.x(), g.p.z(), kHalfLength * std::atan2(along.z(), along.x())),
          .v = Vec3(v[0], v[2], -kHalfLength * v[4])};
}

MotionSample slider_of_angles(const CaseScene&, const State& state) {
  return slider(state.q, state.v);
}

CaseScene slider_crank_of_bodies(double mu) {
  constexpr double kDilation = 1e-2, kWidth = 0.02;  // of the walls, and of the slider across the plane [m]
  CaseScene s;
  s.model.contact_law = {.mu = mu, .restitution = kRestitution};
  const auto box = add(s.model, prepare(dilate(make_box(kSliderLength, kWidth, kSliderHeight), 0)));
  const auto plate = add(s.model, prepare(dilate(make_plate(2, 0.2), kDilation)));
  const char* names[] = {"crank", "rod", "slider"};
  for (int i = 0; i < 3; ++i)
    s.body = add(s.model, RigidBody{.name = names[i],
                                    .shape = i == 2 ? box : ShapeId(),
                                    .mass = kLinkMass[i],
                                    .inertia = kLinkInertia[i] * Mat3::Identity()});
  for (const char* name : {"upper wall", "lower wall"}) add(s.model, fixed_body(name, plate));
  s.state = rest_state(s.model);
  const double x[] = {kCrankLength / 2, kCrankLength + kConnectingRodLength / 2,
                      kCrankLength + kConnectingRodLength},
               joint_x[] = {0, kCrankLength, kCrankLength + kConnectingRodLength};
  for (int i = 0; i < 3; ++i) pose(s.state, BodyId::at(i)).p.x() = x[i];
  for (const int side : {1, -1})
    pose(s.state, BodyId::at(side > 0 ? 3 : 4)).p =
        Vec3(kConnectingRodLength, 0, side * (kHalfHeight + kClearance + kDilation));
  for (int i = 0; i < 3; ++i)  // about -y: raises what points along x
    add(s.model, joint_at(JointKind::revolute, "hinge", BodyId::at(i), BodyId::at(i - 1), s.state.g,
                          translation(joint_x[i], 0, 0) * rotation(Vec3::UnitX(), kPi / 2)));
  twist(s.state, 0) << 0, 0, kSpeed[0] * kCrankLength / 2, 0, -kSpeed[0], 0;
  twist(s.state, 1) << 0, 0, kSpeed[0] * kCrankLength + kSpeed[1] * kConnectingRodLength / 2, 0, -kSpeed[1],
      0;
  twist(s.state, 2) << 0, 0, kSpeed[0] * kCrankLength + kSpeed[1] * kConnectingRodLength, 0, 0, 0;
  return s;
}

CaseScene slider_crank_of_angles(double mu) {
  CaseScene s;
  add(s.model, angles());
  for (const double z : {kHalfHeight, -kHalfHeight})
    for (const double x : {-kHalfLength, kHalfLength}) add(s.model, corner(x, z, mu));
  s.state = rest_state(s.model);
  s.state.v << kSpeed[0], kSpeed[1], 0;
  return s;
}

}  // namespace aussois
