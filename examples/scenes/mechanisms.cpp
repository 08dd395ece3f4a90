// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/mechanisms.hpp"

#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "geometry/primitives.hpp"

namespace aussois {
namespace {

/// A rod of 1 m and 1 kg along the body's x.
RigidBody rod(double radius) {
  return {.name = "rod", .mass = 1, .inertia = Vec3(radius * radius / 2, 1.0 / 12, 1.0 / 12).asDiagonal()};
}

/// u = wn . v, wt . v of a contact with the gap b + wn . q of a block of coordinates.
GapFunction flat_contact(const char* name, double b, const Vec3& wn, const Vec3& wt, const ContactLaw& law) {
  return {.name = name,
          .block = 0,
          .evaluate =
              [=](const Model&, const State& state, double) {
                GapRows out{.gap = b + wn.dot(Vec3(state.q)), .J = MatX(2, 3)};
                out.J << wn.transpose(), wt.transpose();
                return out;
              },
          .law = law};
}

/// From the point x_b of a body to a fixed point of the world; k (|d| - l0) along d (MCH-6).
ForceLaw spring_to_world(BodyId body, const Vec3& x_b, const Vec3& x_w, double k, double l0) {
  const auto cross = [](const Vec3& x) -> Mat3 {
    Mat3 out;
    out << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
    return out;
  };
  const auto add_to = [=](const Model&, const State& state, double, GeneralisedForce& out) {
    const SE3& g = pose(state, body);
    const Vec3 d = g * x_b - x_w, n = d.normalized(), pull = -k * (d.norm() - l0) * n;
    const Mat3 R = g.R.toRotationMatrix(), turn = -R * cross(x_b);  // of the point by omega
    const Vec3 pull_b = R.transpose() * pull;
    const int at = first_velocity(body);
    out.f.segment<3>(at) += pull;
    out.f.segment<3>(at + 3) += x_b.cross(pull_b);
    const Mat3 K = k * (Mat3::Identity() - l0 / d.norm() * (Mat3::Identity() - n * n.transpose()));
    add_block(out.K, at, at, K);
    add_block(out.K, at, at + 3, K * turn);
    add_block(out.K, at + 3, at, turn.transpose() * K);
    add_block(out.K, at + 3, at + 3, turn.transpose() * K * turn - cross(x_b) * cross(pull_b));
  };
  return {.name = "spring", .add_to = add_to, .potential = [=](const Model&, const State& state, double) {
            const double longer = (pose(state, body) * x_b - x_w).norm() - l0;
            return k * longer * longer / 2;
          }};
}

}  // namespace

CaseScene woodpecker() {  // masses, inertias and lengths of sleeve M and bird S, beak at h_S, l_S
  constexpr double r_O = 2.5e-3, r_M = 3.1e-3, h_M = 5.8e-3, l_M = 0.010, l_G = 0.015, h_S = 0.02,
                   l_S = 0.0201;
  constexpr double m_M = 3e-4, m_S = 4.5e-3, J_M = 5e-9, J_S = 7e-7, c = 0.0056, mu = 0.3;
  Mat3 M, K = Mat3::Zero();
  M << m_S + m_M, m_S * l_M, m_S * l_G,                   //
      m_S * l_M, J_M + m_S * l_M * l_M, m_S * l_M * l_G,  //
      m_S * l_G, m_S * l_M * l_G, J_S + m_S * l_G * l_G;
  K.bottomRightCorner<2, 2>() << c, -c, -c, c;
  const Vec3 weight = kGravity * Vec3(m_S + m_M, m_S * l_M, m_S * l_G);
  CaseScene s;
  add(s.model,
      Coordinates{.name = "woodpecker",
                  .size = 3,
                  .mass = [M](const VecX&) -> MatX { return M; },
                  .force = [=](double, const VecX& q,
                               const VecX&) { return CoordinateForce{.f = -weight - K * Vec3(q), .K = K}; },
                  .potential = [=](const VecX& q) { return weight.dot(Vec3(q)) + q.dot(K * q) / 2; }});
  add(s.model, flat_contact("beak", l_M + l_G - l_S - r_O, {0, 0, -h_S}, {1, l_M, l_G - l_S},
                            {.mu = mu, .restitution = 0.5}));
  for (const int end : {1, -1})
    add(s.model, flat_contact(end > 0 ? "lower end" : "upper end", r_M - r_O, {0, end * h_M, 0}, {1, r_M, 0},
                              {.mu = mu}));
  s.state = rest_state(s.model);
  s.state.q << 0, -0.1036, -0.2788;
  s.state.v << -0.3411, 0, -7.4583;
  return s;
}

CaseScene squeezer() {
  const double mass[] = {.04325, .00365, .02373, .00706, .07050, .00706, .05498};
  const double inertia[] = {2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5};
  const Vec3 A(-0.06934, -0.00227, 0), B(-0.03635, 0.03273, 0), C(0.014, 0.072, 0);
  const auto [beta, theta, gamma, phi, delta, Omega, epsilon] = kSqueezerStart;
  // Frames at the joints that bodies 1 to 7 turn in; x along the body (1, 2, 5, 6) or minus y (3, 4, 7).
  const auto frame = [](const Vec3& p, double angle) {
    return translation(p.x(), p.y(), p.z()) * rotation(Vec3::UnitZ(), angle);
  };
  const SE3 crank = frame(Vec3::Zero(), beta), coupler = frame(crank * Vec3(7e-3, 0, 0), beta + theta);
  const SE3 lever = frame(B, gamma), fifth = frame(A, delta), seventh = frame(A, epsilon);
  const SE3 fourth = frame(fifth * Vec3(0.04, 0, 0), phi + delta);
  const SE3 sixth = frame(seventh * Vec3(0, -0.04, 0), Omega + epsilon);
  const SE3 knee = frame(coupler * Vec3(-0.028, 0, 0), 0);  // where 2, 3, 4 and 6 meet
  const SE3 frames[] = {crank, coupler, lever, fourth, fifth, sixth, seventh};
  const Vec3 centre[] = {{9.2e-4, 0, 0},        {-0.0115, 0, 0}, {0.01043, -0.01874, 0}, {0, -0.00579, 0},
                         {0.02308, 0.00916, 0}, {0.00579, 0, 0}, {0.00449, -0.01228, 0}};
  const char* names[] = {"K1", "K2", "K3", "K4", "K5", "K6", "K7"};
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  for (int i = 0; i < 7; ++i)
    add(s.model, RigidBody{.name = names[i], .mass = mass[i], .inertia = inertia[i] * Mat3::Identity()});
  s.state = rest_state(s.model);
  for (int i = 0; i < 7; ++i) pose(s.state, BodyId::at(i)) = frames[i] * SE3{Quat::Identity(), centre[i]};
  const auto hinge = [&](const char* name, BodyId of, BodyId to, const SE3& at) {
    add(s.model, joint_at(JointKind::revolute, name, of, to, s.state.g, at));
  };
  hinge("beta", 0, kWorld, crank), hinge("theta", 1, 0, coupler), hinge("gamma", 2, kWorld, lever);
  hinge("phi", 3, 4, fourth), hinge("delta", 4, kWorld, fifth);
  hinge("Omega", 5, 6, sixth), hinge("epsilon", 6, kWorld, seventh);
  for (const BodyId i : {BodyId(2), BodyId(3), BodyId(5)}) hinge("knee", i, 1, knee);
  s.model.joints[0].axis[0].motor = {.kind = MotorKind::effort, .target = [](double) { return 0.033; }};
  const Vec3 D = Vec3(0.02, -0.018, 0) - centre[2];
  add(s.model, spring_to_world(2, D, C, 4530, 0.07785));
  return s;
}

CaseScene four_bars(int windows) {
  constexpr double kRadius = 1e-2;
  const SE3 upright = rotation(Vec3::UnitY(), -kPi / 2);  // x of the rod points up
  const SE3 along_y = rotation(Vec3::UnitX(), -kPi / 2);
  CaseScene s;
  for (int i = 0; i < 2 * windows + 1; ++i) add(s.model, rod(kRadius));
  s.state = rest_state(s.model);
  const int cranks = windows + 1;
  for (int i = 0; i < cranks; ++i) {
    pose(s.state, BodyId::at(i)) = {upright.R, Vec3(i, 0, 0.5)};
    twist(s.state, BodyId::at(i)) << 0.5, 0, 0, 0, 1, 0;
  }
  for (int i = 0; i < windows; ++i) {
    pose(s.state, BodyId::at(cranks + i)).p = Vec3(i + 0.5, 0, 1);
    twist(s.state, BodyId::at(cranks + i))[0] = 1;
  }
  const auto hinge = [&](int of, int to, double x, double z) {
    add(s.model, joint_at(JointKind::revolute, "hinge", BodyId::at(of), BodyId::at(to), s.state.g,
                          translation(x, 0, z) * along_y));
  };
  for (int i = 0; i < cranks; ++i) hinge(i, -1, i, 0);
  for (int i = 0; i < windows; ++i) hinge(cranks + i, i, i, 1), hinge(cranks + i, i + 1, i + 1, 1);
  s.body = BodyId::at(cranks);
  return s;
}

CaseScene bricard() {
  const Vec3 corner[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
  const Vec3 axis[] = {Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX()};
  CaseScene s;
  s.model.gravity = Vec3(0, -kGravity, 0);
  for (int i = 0; i < 5; ++i) add(s.model, rod(kBricardRadius));
  s.state = rest_state(s.model);
  for (int i = 0; i < 5; ++i)
    pose(s.state, BodyId::at(i)) = {Quat::FromTwoVectors(Vec3::UnitX(), corner[i + 1] - corner[i]),
                                    (corner[i] + corner[i + 1]) / 2};
  for (int i = 0; i < 6; ++i)
    add(s.model, joint_at(JointKind::revolute, "hinge", BodyId::at(i < 5 ? i : -1), BodyId::at(i - 1),
                          s.state.g, {Quat::FromTwoVectors(Vec3::UnitZ(), axis[i % 3]), corner[i]}));
  s.body = 2;
  return s;
}

Vec3 bricard_corner(const State& state) {
  return pose(state, 2) * Vec3(0.5, 0, 0);
}

CaseScene spinning_chain(int rods, double omega, JointKind kind) {
  const SE3 along_y = rotation(Vec3::UnitZ(), kPi / 2);  // x of the rod along its way
  const double r = 0.5 / std::tan(kPi / rods);
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  for (int i = 0; i < rods; ++i) add(s.model, rod(1e-2));
  s.state = rest_state(s.model);
  for (int i = 0; i < rods; ++i) {
    pose(s.state, BodyId::at(i)) =
        rotation(Vec3::UnitZ(), 2 * kPi * i / rods) * translation(r, 0, 0) * along_y;
    twist(s.state, BodyId::at(i)) << Vec3(0, 0, omega).cross(pose(s.state, BodyId::at(i)).p),
        Vec3(0, 0, omega);
  }
  for (const BodyId i : s.state.g.ids())  // at its end
    add(s.model, joint_at(kind, "joint", i, BodyId::at((i.index() + 1) % rods), s.state.g,
                          pose(s.state, i) * translation(0.5, 0, 0)));
  s.body = 0;
  return s;
}

CaseScene bead_column(int beads) {
  constexpr double kRadius = 0.05, kDilation = 1e-2;
  CaseScene s;
  s.model.contact_law = {.mu = 0.3};
  const auto plate = add(s.model, prepare(dilate(make_plate(1, 1), kDilation)));
  const auto bead = add(s.model, prepare(dilate(make_point(), kRadius)));
  add(s.model, fixed_body("plate", plate));
  for (int i = 0; i < beads; ++i)
    s.body = add(
        s.model,
        RigidBody{
            .name = "bead", .shape = bead, .mass = 1, .inertia = 0.4 * kRadius * kRadius * Mat3::Identity()});
  s.state = rest_state(s.model);
  for (int i = 0; i < beads; ++i)
    pose(s.state, BodyId::at(i + 1)).p = Vec3(0.03, 0.02, kDilation + kRadius * (1 + 2 * i));
  return s;
}

}  // namespace aussois
