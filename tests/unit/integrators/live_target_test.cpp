// SPDX-License-Identifier: Apache-2.0
// Targets that are set between steps: a body that is led, and one that is pulled after a handle.
#include "integrators/scheme.hpp"
#include "mechanics/virtual_coupling.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scheme_variants.hpp"

namespace aussois {
namespace {

constexpr double kStep = 1e-3;  // [s], also between the rows of paths

Trajectory swing(int rows) {
  Trajectory path;
  for (int k = 0; k <= rows; ++k) {
    const double t = kStep * k;
    path.t.push_back(t);
    path.pose.push_back({exp_so3(Vec3(0, 0, 0.3 * std::sin(4 * t))),
                         Vec3(0.05 * std::sin(6 * t), 0.02 * t, 0.01 * (1 - std::cos(5 * t)))});
  }
  return path;
}

double difference(const State& a, const State& b) {
  double worst = (a.v - b.v).lpNorm<Eigen::Infinity>();
  for (const BodyId i : a.g.ids())
    worst = std::max({worst, (a.g[i].p - b.g[i].p).norm(), angle_between(a.g[i].R, b.g[i].R)});
  return worst;
}

class LiveTarget : public ::testing::TestWithParam<SchemeVariant> {};

// A plate that swings under a block: as recorded, and led from row to row.
TEST_P(LiveTarget, LedFromRowToRowMovesAsTheRecordedPath) {
  constexpr int kSteps = 60;
  Scene recorded = block_on_plate(0.5, 0, 0);
  const Trajectory path = path_of_attached_frame(swing(kSteps), pose(recorded.state, recorded.ground));
  recorded.model.bodies[recorded.ground].motion = PrescribedMotion{path};
  Scene led = recorded;
  led.model.bodies[led.ground].motion = DrivenMotion{};
  SchemeOptions options = GetParam().options;
  options.step.h = kStep;
  const Scheme along = make_scheme(GetParam().name, recorded.model, options),
               live = make_scheme(GetParam().name, led.model, options);
  int compared = 0;
  for (; compared < kSteps; ++compared) {
    lead_body(led.model, led.state, led.ground, path.pose[compared + 1], kStep);
    const StepReport a = along.step(recorded.state, kInf), b = live.step(led.state, kInf);
    ASSERT_TRUE(a.ok() && b.ok()) << a.reason << b.reason;
    if (a.h < kStep) break;  // rows and steps part; what came before counts
    // Poses of a path are read, those of a body that is led add up
    EXPECT_LT(difference(recorded.state, led.state), 1e-9) << "step " << compared;
  }
  EXPECT_GE(compared, kSteps / 2);
}

INSTANTIATE_TEST_SUITE_P(Registry, LiveTarget, ::testing::ValuesIn(scheme_variants()),
                         [](const auto& tested) { return test_name(tested.param); });

TEST(LiveTarget, AHandleThatIsLedPullsAsAPathDoes) {
  constexpr int kSteps = 200;
  const Trajectory path = swing(kSteps);
  const VirtualCouplingOptions spring{.stiffness = 800, .rotation_stiffness = 2};
  Model recorded, led;
  for (Model* model : {&recorded, &led})
    add(*model, {.name = "part", .mass = 2, .inertia = Vec3(0.02, 0.03, 0.04).asDiagonal()});
  add(recorded, virtual_coupling(recorded, 0, path, spring));
  const auto handle = add(led, driven_body("hand"));
  add(led, virtual_coupling(led, 0, handle, spring));
  State a = rest_state(recorded), b = rest_state(led);
  const MoreauJean along(recorded, {.h = kStep}, {.theta = 0.5}), live(led, {.h = kStep}, {.theta = 0.5});
  for (int k = 0; k < kSteps; ++k) {
    lead_body(led, b, handle, path.pose[k + 1], kStep);
    const double within = a.t + kStep / 2;
    EXPECT_LT((coupling_wrench(recorded, a, 0, path, spring, within).force -
               coupling_wrench(led, b, 0, handle, spring, within).force)
                  .norm(),
              1e-6);
    ASSERT_TRUE(along.step(a).ok() && live.step(b).ok());
    EXPECT_LT((twist(a, 0) - twist(b, 0)).norm(), 1e-9);
  }
  EXPECT_GT(twist(a, 0).norm(), 0.01);
}

// Nothing but the state says where it goes: it goes on until it is led elsewhere.
TEST(LiveTarget, GoesOnAsItWasLed) {
  Model model;
  const auto hand = add(model, driven_body("hand"));
  State state = rest_state(model);
  lead_body(model, state, hand, {exp_so3(Vec3(0, 0, 0.1)), Vec3(1, 2, 3)}, 0.5);
  const MoreauJean scheme(model, {.h = 0.1}, {.theta = 1});
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(scheme.step(state).ok());
  EXPECT_LT((pose(state, hand).p - Vec3(2, 4, 6)).norm(), 1e-12);
  EXPECT_LT(angle_between(pose(state, hand).R, exp_so3(Vec3(0, 0, 0.2))), 1e-12);
}

TEST(LiveTarget, IsRefusedForBodiesThatAreNotLed) {
  Model model;
  add(model, {.name = "part", .mass = 2, .inertia = Mat3::Identity()});
  const auto hand = add(model, driven_body("hand"));
  State state = rest_state(model);
  EXPECT_EQ(message_of([&] { lead_body(model, state, 0, {}, 1); }),
            "lead_body: body 0 (part) must be driven");
  EXPECT_EQ(message_of([&] { lead_body(model, state, 2, {}, 1); }), "lead_body: body = 2 must lie in [0, 2)");
  EXPECT_EQ(message_of([&] { lead_body(model, state, hand, {}, 0); }),
            "lead_body: time = 0 must be positive [s]");
  EXPECT_EQ(message_of([&] { (void)virtual_coupling(model, 0, 0); }),
            "virtual_coupling: handle = 0 must lie in [0, 2) and not be the body");
  EXPECT_EQ(message_of([&] { (void)virtual_coupling(model, hand, 0); }),
            "virtual_coupling: handle 0 (part) must not be dynamic");
}

}  // namespace
}  // namespace aussois
