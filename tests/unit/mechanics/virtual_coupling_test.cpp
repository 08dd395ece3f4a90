// SPDX-License-Identifier: Apache-2.0
// doc/theory/virtual_coupling.md.
#include "mechanics/virtual_coupling.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry/number_text.hpp"
#include "mechanics/model.hpp"
#include "mechanics/state.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// A fixed body first, so that row offsets are seen.
Model one_part(const Vec3& moments = {0.02, 0.03, 0.04}, double mass = 2) {
  Model model;
  add(model, fixed_body("ground", -1));
  add(model, {.name = "part", .mass = mass, .inertia = moments.asDiagonal()});
  return model;
}

// A target that passes `pose` with `twist` at t = 0, one second before and after.
Trajectory path_through(const SE3& pose, const Vec6& twist) {
  Trajectory path;
  for (const double t : {-1.0, 1.0}) {
    path.t.push_back(t);
    path.pose.push_back({pose.R * exp_so3(t * twist.tail<3>()), pose.p + t * twist.head<3>()});
  }
  return path;
}

Vec6 random_twist(Random& random, double half) {
  Vec6 twist;
  twist << random.vector(half), random.vector(half);
  return twist;
}

GeneralisedForce force_of(const ForceLaw& law, const Model& model, const State& state, double t) {
  GeneralisedForce sum;
  sum.f = VecX::Zero(velocity_count(model));
  law.add_to(model, state, t, sum);
  return sum;
}

MatX dense(const std::vector<Triplet>& triplets) {
  MatX result = MatX::Zero(12, 12);
  for (const Triplet& entry : triplets) result(entry.row(), entry.col()) += entry.value();
  return result;
}

TEST(VirtualCoupling, PullIsTheOneByHand) {
  const Model model = one_part({0.01, 0.02, 0.03}, 4);  // mean moment 0.02
  State state = rest_state(model);
  twist(state, 1) << 1, 0, 0, 0, 0, 1;
  const Trajectory path{
      {0, 1},
      {translation(0, 3, 0) * rotation({1, 0, 0}, 0.5), translation(0, 3, 0) * rotation({1, 0, 0}, 0.5)}};
  const VirtualCouplingOptions options{.stiffness = 100, .rotation_stiffness = 8, .damping_ratio = 0.5};
  const CouplingWrench wrench = coupling_wrench(model, state, 1, path, options, 0.25);
  EXPECT_LT((wrench.force - Vec3(-20, 300, 0)).norm(), 1e-12);  // c = 2 * 0.5 * sqrt(100 * 4)
  EXPECT_LT((wrench.torque - Vec3(4, 0, -0.4)).norm(), 1e-12);  // c_R = 2 * 0.5 * sqrt(8 * 0.02)
  EXPECT_FALSE(wrench.saturated);
  const VecX f = force_of(virtual_coupling(model, 1, path, options), model, state, 0.25).f;
  EXPECT_EQ(f.head<6>(), Vec6::Zero());
  EXPECT_EQ(f.segment<3>(6), wrench.force);
  EXPECT_EQ(f.segment<3>(9), wrench.torque);
}

class CouplingRandom : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  Random random{GetParam()};
  Model model = one_part();
  VirtualCouplingOptions options{.stiffness = 50, .rotation_stiffness = 3, .damping_ratio = 0.7};
  SE3 target = random.pose(1);
  State state = rest_state(model);

  // A rotation error of at most 3 rad: at pi the shorter way round jumps and there is no derivative.
  void SetUp() override {
    state.g[1].p = random.vector();
    state.g[1].R = (target.R * exp_so3(random.vector_of_length(0, 3))).normalized();
    twist(state, 1) = random_twist(random, 2);
  }
  State displaced(int k, double e) const {  // along the twist coordinates: R <- R exp(delta)
    State other = state;
    if (k < 3)
      other.g[1].p[k] += e;
    else
      other.g[1].R = other.g[1].R * exp_so3(e * Vec3::Unit(k - 3));
    return other;
  }
};

// Central differences: truncation e^2 times a third derivative that grows to 1 / (2 pi - |phi|)^3, rounding
// 1e-16 / e.
TEST_P(CouplingRandom, DerivativesAreFiniteDifferences) {
  const ForceLaw law = virtual_coupling(model, 1, path_through(target, random_twist(random, 1)), options);
  const GeneralisedForce at = force_of(law, model, state, 0);
  MatX K = MatX::Zero(12, 12), C = MatX::Zero(12, 12);
  const double e = 1e-5;
  for (int k = 0; k < 6; ++k) {
    K.col(6 + k) =
        -(force_of(law, model, displaced(k, e), 0).f - force_of(law, model, displaced(k, -e), 0).f) / (2 * e);
    State faster = state, slower = state;
    faster.v[6 + k] += e;
    slower.v[6 + k] -= e;
    C.col(6 + k) = -(force_of(law, model, faster, 0).f - force_of(law, model, slower, 0).f) / (2 * e);
  }
  EXPECT_LT((dense(at.K) - K).cwiseAbs().maxCoeff(), 1e-7) << dense(at.K) << "\n\n" << K;
  EXPECT_LT((dense(at.C) - C).cwiseAbs().maxCoeff(), 1e-8) << dense(at.C) << "\n\n" << C;
}

TEST_P(CouplingRandom, PullIsMinusTheGradientOfItsPotential) {
  options.damping_ratio = 0;
  options.force_limit = random.uniform(10, 100);  // some limited, some not
  options.torque_limit = random.uniform(1, 8);
  const ForceLaw law = virtual_coupling(model, 1, path_through(target, Vec6::Zero()), options);
  const VecX f = force_of(law, model, state, 0).f;
  const double e = 1e-5;
  for (int k = 0; k < 6; ++k) {
    const double slope =
        (law.potential(model, displaced(k, e), 0) - law.potential(model, displaced(k, -e), 0)) / (2 * e);
    EXPECT_NEAR(f[6 + k], -slope, 1e-6) << k;
  }
}

TEST_P(CouplingRandom, LimitsKeepTheDirection) {
  const Trajectory path = path_through(target, random_twist(random, 1));
  const CouplingWrench free = coupling_wrench(model, state, 1, path, options, 0);
  options.force_limit = 0.5 * free.force.norm();
  options.torque_limit = 0.25 * free.torque.norm();
  const CouplingWrench held = coupling_wrench(model, state, 1, path, options, 0);
  EXPECT_LT((held.force - 0.5 * free.force).norm(), 1e-12);
  EXPECT_LT((held.torque - 0.25 * free.torque).norm(), 1e-12);
  EXPECT_FALSE(free.saturated);
  EXPECT_TRUE(held.saturated);
}

TEST_P(CouplingRandom, ALimitedPullHasNoStiffness) {
  const Trajectory path = path_through(target, random_twist(random, 1));
  const GeneralisedForce free = force_of(virtual_coupling(model, 1, path, options), model, state, 0);
  const double force = free.f.segment<3>(6).norm(), torque = free.f.segment<3>(9).norm();

  VirtualCouplingOptions weak = options;
  weak.force_limit = 0.9 * force;
  GeneralisedForce held = force_of(virtual_coupling(model, 1, path, weak), model, state, 0);
  for (const auto& [some, all] : {std::pair{&held.K, &free.K}, std::pair{&held.C, &free.C}}) {
    EXPECT_EQ(dense(*some).block(6, 6, 3, 3), MatX::Zero(3, 3));
    EXPECT_EQ(dense(*some).block(9, 9, 3, 3), dense(*all).block(9, 9, 3, 3));
  }
  weak = options;
  weak.torque_limit = 0.9 * torque;
  held = force_of(virtual_coupling(model, 1, path, weak), model, state, 0);
  for (const auto& [some, all] : {std::pair{&held.K, &free.K}, std::pair{&held.C, &free.C}}) {
    EXPECT_EQ(dense(*some).block(9, 9, 3, 3), MatX::Zero(3, 3));
    EXPECT_EQ(dense(*some).block(6, 6, 3, 3), dense(*all).block(6, 6, 3, 3));
  }
}

TEST_P(CouplingRandom, StiffnessHasTheSkewPartOfTheManual) {
  const ForceLaw law = virtual_coupling(model, 1, path_through(target, Vec6::Zero()), options);
  const Mat3 K = dense(force_of(law, model, state, 0).K).block<3, 3>(9, 9);
  const Vec3 phi = log_so3(state.g[1].R.conjugate() * target.R);
  EXPECT_LT((K - K.transpose() + options.rotation_stiffness * skew(phi)).norm(), 1e-12);
  const double half = phi.norm() / 2;
  const Vec3 axis = phi.normalized();
  const Mat3 along = axis * axis.transpose();
  const Mat3 symmetric =
      options.rotation_stiffness * (along + half / std::tan(half) * (Mat3::Identity() - along));
  EXPECT_LT((0.5 * (K + K.transpose()) - symmetric).norm(), 1e-11);
}

// The world seen from another place: forces turn with it, torques in the body do not change.
TEST_P(CouplingRandom, DoesNotDependOnTheFrameOfTheWorld) {
  const Trajectory path = path_through(target, random_twist(random, 1));
  const SE3 g = random.pose(2);
  State moved = state;
  moved.g[1] = g * state.g[1];
  moved.v.segment<3>(6) = g.R * Vec3(state.v.segment<3>(6));
  Trajectory moved_path = path;
  for (SE3& pose : moved_path.pose) pose = g * pose;
  const CouplingWrench here = coupling_wrench(model, state, 1, path, options, 0);
  const CouplingWrench there = coupling_wrench(model, moved, 1, moved_path, options, 0);
  EXPECT_LT((there.force - g.R * here.force).norm(), 1e-11);
  EXPECT_LT((there.torque - here.torque).norm(), 1e-11);
}

TEST_P(CouplingRandom, HasNoLagAtConstantSpeed) {
  const Trajectory path = path_through(target, random_twist(random, 1));
  for (const double t : {-0.7, 0.0, 0.4}) {
    const TrajectoryPoint point = trajectory_point(path, t);
    state.g[1] = point.pose;
    twist(state, 1) = point.twist;
    const CouplingWrench wrench = coupling_wrench(model, state, 1, path, options, t);
    EXPECT_LT(wrench.force.norm(), 1e-12);
    EXPECT_LT(wrench.torque.norm(), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, CouplingRandom, ::testing::Range<std::uint64_t>(1, 101));

// Semi-implicit Euler for a body with a spherical inertia J.
void advance(const Model& model, State& state, const Trajectory& path, const VirtualCouplingOptions& options,
             double h) {
  const CouplingWrench wrench = coupling_wrench(model, state, 1, path, options, state.t);
  state.v.segment<3>(6) += h * wrench.force / model.bodies[1].mass;
  state.v.segment<3>(9) += h * wrench.torque / model.bodies[1].inertia(0, 0);
  state.g[1].p += h * state.v.segment<3>(6);
  state.g[1].R = (state.g[1].R * exp_so3(h * state.v.segment<3>(9))).normalized();
  state.t += h;
}

// From rest, the part catches up with a target that moves at constant speed, and no lag remains: 40 time
// constants of sqrt(m / k) = sqrt(J / k_R) = 0.01 s leave exp(-40) of the start. A damper against the world
// would leave c v / k = 0.01 m.
TEST(VirtualCoupling, CatchesUpWithAMovingTarget) {
  const Model model = one_part({0.01, 0.01, 0.01}, 1);
  const VirtualCouplingOptions options{.stiffness = 1e4, .rotation_stiffness = 100};
  const Vec6 speed = (Vec6() << 0.5, 0, 0, 0, 0, 2).finished();
  const Trajectory path = path_through(SE3{}, speed);
  State state = rest_state(model);
  double largest_lag = 0;
  while (state.t < 0.4) {
    advance(model, state, path, options, 1e-4);
    largest_lag = std::max(largest_lag, (trajectory_point(path, state.t).pose.p - state.g[1].p).norm());
  }
  const SE3 lag = inverse(state.g[1]) * trajectory_point(path, state.t).pose;
  EXPECT_GT(largest_lag, 1e-3);  // it did have to catch up: v sqrt(m / k) / e = 1.8 mm
  EXPECT_LT(lag.p.norm(), 1e-12);
  EXPECT_LT(log_so3(lag.R).norm(), 1e-12);
}

// Critical damping, released at x0: x = x0 (1 + w t) exp(-w t) with w = sqrt(k / m). First-order integration
// at w h = 1e-3.
TEST(VirtualCoupling, ReturnsCritically) {
  const Model model = one_part({0.01, 0.01, 0.01}, 1);
  const VirtualCouplingOptions options{.stiffness = 100, .rotation_stiffness = 1};
  const Trajectory path = path_through(SE3{}, Vec6::Zero());
  State state = rest_state(model);
  state.g[1] = translation(0.3, 0, 0) * rotation({0, 1, 0}, 0.8);
  const double w = 10, h = 1e-4;
  for (int i = 1; i <= 5000; ++i) {
    advance(model, state, path, options, h);
    const double x = (1 + w * h * i) * std::exp(-w * h * i);
    ASSERT_NEAR(state.g[1].p.x(), 0.3 * x, 0.3 * 1e-3) << i;
    ASSERT_NEAR(log_so3(state.g[1].R).y(), 0.8 * x, 0.8 * 1e-3) << i;
  }
}

TEST(VirtualCoupling, RefusesOptionsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate(VirtualCouplingOptions{}));
  const auto refuses = [](const VirtualCouplingOptions& o, const char* field, double value,
                          const char* bound) {
    EXPECT_EQ(message_of([&] { validate(o); }), std::string("VirtualCouplingOptions::") + field + " = " +
                                                    number_text(value) + " must " + bound);
  };
  for (const double bad : {0.0, -1.0, nan}) {
    refuses({.stiffness = bad}, "stiffness", bad, "be finite and > 0 [N/m]");
    refuses({.rotation_stiffness = bad}, "rotation_stiffness", bad, "be finite and > 0 [N m/rad]");
    refuses({.force_limit = bad}, "force_limit", bad, "be > 0 [N]");
    refuses({.torque_limit = bad}, "torque_limit", bad, "be > 0 [N m]");
  }
  for (const double bad : {-0.1, kInf, nan})
    refuses({.damping_ratio = bad}, "damping_ratio", bad, "be finite and >= 0");
  refuses({.stiffness = kInf}, "stiffness", kInf, "be finite and > 0 [N/m]");
}

TEST(VirtualCoupling, RefusesWhatItCannotPull) {
  const Model model = one_part();
  const Trajectory path = path_through(SE3{}, Vec6::Zero());
  const auto refusal = [&](BodyId body, const Trajectory& p, const VirtualCouplingOptions& o = {}) {
    return message_of([&] { virtual_coupling(model, body, p, o); });
  };
  EXPECT_EQ(refusal(0, path).find("virtual_coupling: body 0 ("), 0U) << refusal(0, path);
  EXPECT_NE(refusal(0, path).find(") must be dynamic"), std::string::npos) << refusal(0, path);
  EXPECT_EQ(refusal(2, path), "virtual_coupling: body = 2 must lie in [0, 2)");
  EXPECT_EQ(refusal(-1, path), "virtual_coupling: body = -1 must lie in [0, 2)");
  EXPECT_NE(refusal(1, Trajectory{}), "");
  EXPECT_EQ(refusal(1, path, {.stiffness = -1}).find("VirtualCouplingOptions::stiffness = -1 must "), 0U);
}

}  // namespace
}  // namespace aussois
