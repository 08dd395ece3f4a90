// SPDX-License-Identifier: Apache-2.0
// What does not fit is refused at the door of every step, by name, and the state stays.
#include <gtest/gtest.h>

#include "geometry/number_text.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/gear_pair.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scheme_variants.hpp"

namespace aussois {
namespace {

struct TwoBalls {
  Model model{};
  State state{};
  TwoBalls() {
    const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
    for (int i = 0; i < 2; ++i) add(model, body(ball));
    state = rest_state(model);
    state.g[1].p.x() = 1;
  }
  static RigidBody body(ShapeId shape) {
    return {.name = "ball", .shape = shape, .mass = 1, .inertia = 1e-3 * Mat3::Identity()};
  }
};

void expect_refusal(const Model& model, State state, const std::string& part,
                    const std::function<void()>& after_making = {}) {
  for (const std::string& name : scheme_names()) {
    const Scheme scheme = make_scheme(name, model, {});
    if (after_making) after_making();
    const std::uint64_t before = hash(state);
    const std::string message = message_of([&] { EXPECT_FALSE(scheme.step(state, 1e-3).ok()); });
    EXPECT_NE(message.find(part), std::string::npos) << name << ": " << message;
    EXPECT_EQ(hash(state), before) << name;
    if (after_making) break;  // the model is another one now
  }
}

TEST(Step, RefusesAStateThatDoesNotFitItsModel) {
  const TwoBalls s;
  const auto with = [&](const auto& change, const char* part) {
    State state = s.state;
    change(state);
    expect_refusal(s.model, state, part);
  };
  with([](State& x) { x.v.conservativeResize(6); },
       "size of State::v = 6 must be 12, as in the model: see rest_state");
  with([](State& x) { x.v = VecX::Zero(18); }, "size of State::v = 18 must be 12");
  with([](State& x) { x.g.resize(1); }, "size of State::g = 1 must be 2");
  with([](State& x) { x.q = VecX::Zero(1); }, "size of State::q = 1 must be 0");
  with([](State& x) { x.turns = {0}; }, "size of State::turns = 1 must be 0");
  with([](State& x) { x.r = VecX::Zero(2); }, "size of State::r = 2 must be 0");
  with([](State& x) { x.a = VecX::Zero(2); }, "size of State::a = 2 must be 24");
  with([](State& x) { x.g[1].R.coeffs() *= 2; }, "State::g, body 1 (ball): |R| = 2 must be 1 within 1e-6");
}

// Features are remembered by number: those of another mesh may not exist.
TEST(Step, RefusesAMemoryOfFeaturesThatTheShapesLack) {
  const TwoBalls s;  // of one vertex each
  const auto with = [&](const ContactKey& key, const std::string& part) {
    State state = s.state;
    state.memory.contacts = {{.key = {0, 1, feature_word({0, 0}, {0, 0})}}, {.key = key}};
    expect_refusal(s.model, state, "State::memory, contact 1: " + part);
    EXPECT_NE(message_of([&] { validate(s.model, state); }).find(part), std::string::npos);
  };
  with({0, 1, feature_word({0, 0}, {0, 1})}, "vertex of body 1 (ball) = 1 must lie in [0, 1)");
  with({0, 1, feature_word({0, 7}, {0, 0})}, "vertex of body 0 (ball) = 7 must lie in [0, 1)");
  with({0, 1, feature_word({0, 0}, {1, 0})}, "chain of body 1 (ball) = 0 must lie in [0, 0)");
  with({0, 1, feature_word({2, 3}, {0, 0})}, "region of body 0 (ball) = 3 must lie in [0, 0)");
  with({0, 1, feature_word({3, 0}, {0, 0})},
       "dimension of the feature of body 0 (ball) = 3 must lie in [0, 2]");
  with({0, 2, feature_word({0, 0}, {0, 0})}, "its bodies must exist");
  with({-1, 1, feature_word({0, 0}, {0, 0})}, "its bodies must exist");
}

TEST(Step, RefusesAStateThatWasReachedWithAFinerMesh) {
  const auto can = [](int facets) {
    Scene s = block_on_plate(0.3, 0, 0);
    s.model.shapes[1] =
        std::make_shared<const LmdShape>(prepare(dilate(make_cylinder(kSide / 2, kSide, facets), kRadius)));
    return s;
  };
  Scene fine = can(64);
  ASSERT_TRUE(make_scheme("moreau_jean", fine.model, {}).step(fine.state, 1e-3).ok());
  ASSERT_GT(fine.state.memory.contacts.size(), 4U);
  const Scene coarse = can(4);
  expect_refusal(coarse.model, fine.state, "vertex of body 1 (block) = ");
  fine.state.memory = {};
  for (const std::string& name : scheme_names()) {
    State state = fine.state;
    EXPECT_EQ(message_of([&] { EXPECT_TRUE(make_scheme(name, coarse.model, {}).step(state, 1e-3).ok()); }),
              "");
  }
}

TEST(Step, RefusesAMemoryOfABodyThatHasNoShape) {
  TwoBalls s;
  s.model.bodies[1].shape = {};
  s.state.memory.contacts = {{.key = {0, 1, feature_word({0, 0}, {0, 0})}}};
  expect_refusal(s.model, s.state, "State::memory, contact 0: body 1 (ball) must have a shape");
}

TEST(Step, RefusesAModelThatHasChangedSinceTheSchemeWasMade) {
  for (const std::string& name : scheme_names()) {
    const auto refused = [&](const std::function<void(Model&)>& change) {
      TwoBalls s;
      const Scheme scheme = make_scheme(name, s.model, {});
      change(s.model);
      State old = s.state, fresh = rest_state(s.model);
      std::string message = message_of([&] { EXPECT_FALSE(scheme.step(old, 1e-3).ok()); });
      EXPECT_EQ(message_of([&] { EXPECT_FALSE(scheme.step(fresh, 1e-3).ok()); }), message);
      return message;
    };
    EXPECT_EQ(refused([](Model& m) { add(m, TwoBalls::body(0)); }),
              "model: number of bodies = 3 must be 2, as when the scheme was made: make a new one")
        << name;
    EXPECT_NE(refused([](Model& m) { m.bodies.pop_back(); }).find("number of bodies = 1"), std::string::npos);
    EXPECT_NE(refused([](Model& m) { m.bodies[1].motion = FixedMotion{}; }).find("motion of body 1 (ball)"),
              std::string::npos);
    EXPECT_NE(refused([](Model& m) {
                add(m, Joint{.kind = JointKind::spherical, .body_a = 0, .body_b = 1});
              }).find("number of joints = 1"),
              std::string::npos);
    EXPECT_NE(refused([](Model& m) {
                add(m, Coordinates{.name = "x", .size = 1, .mass = [](const VecX&) {
                                     return MatX(MatX::Identity(1, 1));
                                   }});
              }).find("blocks of coordinates = 1"),
              std::string::npos);
    const std::string shape = "model: shape of body 1 (ball) must stay, as when the scheme was made";
    EXPECT_NE(refused([](Model& m) { m.bodies[1].shape = {}; }).find(shape), std::string::npos);
    EXPECT_NE(refused([](Model& m) { m.bodies[1].shape = 7; }).find(shape), std::string::npos);
    EXPECT_NE(refused([](Model& m) {  // of the same size: what the scheme knew of it is gone
                m.shapes[0] = std::make_shared<const LmdShape>(prepare(dilate(make_point(), 0.05)));
              })
                  .find("model: shape of body 0 (ball) must stay"),
              std::string::npos);
    for (const auto& change : {+[](SE3& g) { g.p.x() = 0.01; }, +[](SE3& g) { g.R = Quat(0, 1, 0, 0); }})
      EXPECT_NE(
          refused([&](Model& m) { change(m.bodies[1].g_bs); }).find("model: g_bs of body 1 (ball) must stay"),
          std::string::npos);
  }
}

TEST(Step, RefusesAForceLawThatWritesOutsideOfTheVelocities) {
  const auto with = [](const std::function<void(GeneralisedForce&)>& writes, const std::string& part) {
    TwoBalls s;
    add(s.model,
        ForceLaw{.name = "spring",
                 .add_to = [=](const Model&, const State&, double, GeneralisedForce& out) { writes(out); }});
    expect_refusal(s.model, s.state, "force law (spring): GeneralisedForce::" + part);
  };
  with([](auto& out) { out.f.template segment<3>(12) += Vec3(1, 2, 3); },
       "f: entries 12 to 14 must lie in [0, 12)");
  with([](auto& out) { out.f.segment(10, 3).setZero(); }, "f: entries 10 to 12 must lie in [0, 12)");
  with([](auto& out) { out.f[-1] = 1; }, "f: entries -1 to -1 must lie in [0, 12)");
  with([](auto& out) { out.K.emplace_back(0, 12, 1); }, "K: entry (0, 12) must have both indices in [0, 12)");
  with([](auto& out) { out.C.emplace_back(-1, 0, 1); }, "C: entry (-1, 0) must have both indices in [0, 12)");
  TwoBalls s;
  add(s.model,
      ForceLaw{.name = "spring", .add_to = [](const Model&, const State&, double, GeneralisedForce& out) {
                 out.f = VecX::Zero(3);
               }});
  expect_refusal(s.model, s.state, "force law (spring): size of GeneralisedForce::f = 3 must stay 12");
}

TEST(Scheme, StepsAgainOnceTheShapeIsBack) {
  for (const std::string& name : scheme_names()) {
    TwoBalls s;
    const Scheme scheme = make_scheme(name, s.model, {});
    const auto other = std::make_shared<const LmdShape>(prepare(dilate(make_point(), 0.05)));
    const auto shape = std::exchange(s.model.shapes[0], other);
    EXPECT_NE(message_of([&] { EXPECT_FALSE(scheme.step(s.state, 1e-3).ok()); }), "") << name;
    s.model.shapes[0] = shape;
    EXPECT_TRUE(scheme.step(s.state, 1e-3).ok()) << name;
  }
}

// Through the integrator, which is C and calls back.
TEST(EventDriven, RefusesAForceLawThatWritesOutsideLaterInTheStep) {
  TwoBalls s;
  add(s.model,
      ForceLaw{.name = "late", .add_to = [](const Model&, const State&, double t, GeneralisedForce& out) {
                 if (t > 5e-4) out.f[12] = 1;
               }});
  const std::uint64_t before = hash(s.state);
  EXPECT_EQ(
      message_of([&] { EXPECT_FALSE(make_scheme("event_driven", s.model, {}).step(s.state, 1e-3).ok()); }),
      "force law (late): GeneralisedForce::f: entries 12 to 12 must lie in [0, 12)");
  EXPECT_EQ(hash(s.state), before);
}

TEST(Step, RefusesWhatGapFunctionsSayInTheWrongSizeByTheirName) {
  TwoBalls s;
  add(s.model, GapFunction{.name = "wall", .evaluate = [](const Model&, const State&, double) {
                             return GapRows{.gap = 1, .J = MatX::Zero(1, 3)};
                           }});
  expect_refusal(s.model, s.state, "gap function 0 (wall): J = 1 x 3 must be 1 x 12");
}

TEST(Joint, RefusesWhatActsAlongAnAxisThatItHasNot) {
  TwoBalls s;
  const auto message = [&](JointKind kind, int axis, const JointAxis& with) {
    Joint joint{.name = "j", .kind = kind, .body_a = 0, .body_b = kWorld};
    if (kind == JointKind::distance) joint.length = 1;
    joint.axis[axis] = with;
    return message_of([&] { add(s.model, joint); });
  };
  const Motor motor{.kind = MotorKind::speed, .target = [](double) { return 1.0; }};
  for (const JointAxis& axis :
       {JointAxis{.lower = 0}, JointAxis{.upper = 0}, JointAxis{.friction = 1}, JointAxis{.stiffness = 1},
        JointAxis{.damping = 1}, JointAxis{.motor = motor}}) {
    EXPECT_EQ(message(JointKind::revolute, 1, axis),
              "joint 0 (j): axis[1] has a stop, friction, spring or motor, but a revolute joint has 1 axes");
    EXPECT_NE(message(JointKind::spherical, 0, axis), "");
    EXPECT_NE(message(JointKind::distance, 2, axis), "");
  }
  EXPECT_EQ(message(JointKind::cylindrical, 1, {.friction = 1}), "");
}

TEST(StepOptions, RefuseThreadsThatAStepWouldOverrule) {
  const TwoBalls s;
  EXPECT_EQ(message_of([&] { make_scheme("moreau_jean", s.model, {.step = {.lmd = {.threads = 4}}}); }),
            "StepOptions::lmd.threads = 4 must not be set: StepOptions::threads is that of every stage");
  EXPECT_NE(message_of([&] {
              make_scheme("moreau_jean", s.model,
                          {.step = {.solver = {.for_all = [](int, const std::function<void(int)>&) {}}}});
            }).find("solver.for_all must be empty"),
            std::string::npos);
}

// Off on purpose is what a tolerance says; that steps do not project, or cannot, does not say it.
class FarOff : public ::testing::TestWithParam<SchemeVariant> {
 protected:
  static StepReport first_step(const Model& model, State state, const JointOptions& joints) {
    SchemeOptions o = GetParam().options;
    o.step.h = 1e-3;
    o.step.joints = joints;
    return make_scheme(GetParam().name, model, o).step(state, kInf);
  }
  // By more than the tolerance; `text` says by how much.
  static void expect_refused(const Model& model, const State& state, const std::string& text) {
    const bool always = GetParam().name == "event_driven";
    for (const bool project : {true, always}) {
      const StepReport report = first_step(model, state, {.project = project});
      EXPECT_EQ(report.status, StepStatus::refused) << project;
      EXPECT_EQ(report.reason, "start: " + text + ", at most 1e-06 is allowed; see consistent_state()")
          << project;
      EXPECT_TRUE(first_step(model, consistent_state(model, state), {.project = project}).ok()) << project;
    }
    State later = state;
    later.h = 1e-3;
    for (const auto& [begin, tolerance] : {std::pair(state, 0.2), std::pair(later, 1e-6)}) {
      const StepReport report = first_step(model, begin, {.project = always, .tolerance = tolerance});
      EXPECT_TRUE(report.ok()) << begin.h << ": " << report.reason;
    }
  }
};

TEST_P(FarOff, AJointAtTheStartIsRefused) {
  OneAxis s(JointKind::revolute);
  s.state.g[0].p.x() = 0.1;
  expect_refused(s.model, s.state, "joint 0 (axis) is off by 0.1 m and 0 rad");
}

TEST_P(FarOff, ACouplingAtTheStartIsRefused) {
  GearPair wheels;
  wheels.state.g[0].R = exp_so3(Vec3(0, 0.1, 0));
  expect_refused(wheels.model, wheels.state, "coupling 0 (gears) is off by 0.1 rad");
  OneAxis sliders(JointKind::prismatic);
  add(sliders.model, sliders.model.bodies[0]);
  sliders.state = rest_state(sliders.model);
  sliders.state.g[0].p.x() = 0.1;
  Joint second = sliders.model.joints[0];
  second.body_a = 1;
  add(sliders.model, second);
  add(sliders.model, Coupling{.name = "rods", .joint_1 = 0, .joint_2 = 1, .ratio = 1});
  expect_refused(sliders.model, sliders.state, "coupling 0 (rods) is off by 0.1 m");
}

INSTANTIATE_TEST_SUITE_P(Schemes, FarOff, ::testing::ValuesIn(variants_with_joints()),
                         [](const auto& v) { return test_name(v.param); });

// A loop on the time alone would not end.
TEST(RunUntil, EndsWithTheFirstReportThatIsNotOk) {
  TwoBalls s;
  int steps = 0;
  const auto count = [&](const StepReport&) { ++steps; };
  const MoreauJean scheme(s.model, {.h = 1e-2}, {.theta = 1});
  EXPECT_TRUE(run_until(scheme, s.state, 0.1, count).ok());
  EXPECT_EQ(steps, 10);
  EXPECT_NEAR(s.state.t, 0.1, 1e-15);
  EXPECT_EQ(run_until(scheme, s.state, 0.1, count).h, 0);
  EXPECT_EQ(steps, 10);
  s.state.g[1].p = s.state.g[0].p + Vec3(0.01, 0, 0);  // in each other
  EXPECT_EQ(run_until(scheme, s.state, 0.2, count).status, StepStatus::refused);
  EXPECT_EQ(steps, 11);
}

// A ball in oil: v = exp(-t), to a power of h that the law's derivative decides.
TEST(ForceLaw, WithoutItsDerivativesCostsAnOrder) {
  const auto order = [](bool with_C) {
    const auto error = [&](double h) {
      Model model{.gravity = Vec3::Zero()};
      add(model, TwoBalls::body(-1));
      add(model,
          ForceLaw{.name = "oil", .add_to = [=](const Model&, const State& s, double, GeneralisedForce& out) {
                     out.f.head<3>() -= s.v.head<3>();
                     if (with_C) add_block(out.C, 0, 0, Mat3::Identity());
                   }});
      State state = rest_state(model);
      state.v[0] = 1;
      EXPECT_TRUE(run_until(MoreauJean(model, {.h = h}), state, 1).ok());
      return std::abs(state.v[0] - std::exp(-1));
    };
    return std::log2(error(0.02) / error(0.01));
  };
  EXPECT_NEAR(order(true), 2, 0.05);
  EXPECT_NEAR(order(false), 1, 0.05);
}

// Three equal balls in line, the first with speed 1, plastic: by momentum, a third each, wherever in a step
// they meet, and however long the step is.
TEST(PlasticImpact, OfThreeBallsSharesTheMomentumInEveryScheme) {
  std::vector<SchemeVariant> variants = scheme_variants();
  for (const std::string& name : scheme_names()) variants.push_back({name, {}});
  for (const double theta : {0.5, 0.75})
    for (const ContactsAt at : {ContactsAt::midpoint, ContactsAt::end})
      for (const int iterations : {1, 50})
        variants.push_back({"moreau_jean",
                            {.moreau_jean = {.theta = theta,
                                             .law = NormalLaw::combined,
                                             .contacts = at,
                                             .newton = {.max_iterations = iterations}}}});
  for (const SchemeVariant& variant : variants)
    for (const double h : {1e-2, 1e-3, 1e-4})
      for (const double gap : {0.0, 0.15, 0.5, 0.9}) {  // of what the first moves in a step
        SchemeOptions options = variant.options;
        options.step.h = h;
        if (options.moreau_jean.gamma < 1) continue;  // bounces (MJ-10)
        const std::string name = label(variant.name, options);
        SCOPED_TRACE(name + ", h = " + number_text(h) + ", gap " + number_text(gap));
        Model model{.gravity = Vec3::Zero()};
        const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
        for (int i = 0; i < 3; ++i) add(model, TwoBalls::body(ball));
        State state = rest_state(model);
        for (int i = 0; i < 3; ++i) state.g[BodyId::at(i)].p.x() = 0.1 * i + (i == 0 ? 0 : gap * h);
        state.v[0] = 1;
        const Scheme scheme = make_scheme(variant.name, model, options);
        const StepReport last = run_until(scheme, state, 200 * h);
        EXPECT_TRUE(last.ok()) << last.reason;
        for (const int i : {0, 6, 12}) EXPECT_NEAR(state.v[i], 1. / 3, 1e-7);
        const double overlap = state.g[0].p.x() + 0.1 - state.g[1].p.x();
        const bool left = name.find(" moreau") != std::string::npos || variant.name == "d1_minus_linear";
        EXPECT_LE(overlap, (left ? h : 0) + 1e-12);  // Moreau's law leaves it (MJ-17)
      }
}

// The impact, the solve that stops what would close again, and the displacement (MJ-17): a sweep each.
TEST(Landing, TellsTheIterationsOfAllThatItSolved) {
  Model model;
  const auto plate = add(model, prepare(dilate(make_plate(6, 6), 1e-3)));
  const auto ball = add(model, prepare(dilate(make_point(), 0.05)));
  add(model, fixed_body("ground", plate));
  add(model, RigidBody{.name = "ball", .shape = ball, .mass = 1, .inertia = 1e-3 * Mat3::Identity()});
  State state = rest_state(model);
  state.g[1].p.z() = 0.052;
  state.v[8] = -1;
  const StepReport report =
      make_scheme("moreau_jean", model, {.step = {.h = 1.2e-3}, .moreau_jean = {.theta = 0.5}})
          .step(state, kInf);
  ASSERT_TRUE(report.ok()) << report.reason;
  EXPECT_EQ(report.contacts_kept, 1);
  EXPECT_EQ(report.solve.iterations, 3);
}

// Twenty sweeps of JOR reach the one per cent that was asked, and not the 1e-12 of the displacement: a step
// that such a solve ended would be halved.
TEST(Landing, DoesNotDependOnTheMethodThatIsStudied) {
  Scene s = block_on_plate(0.3, 0, 0, 1e-3);
  s.state.v[8] = -1;
  SchemeOptions options{.step = {.h = 2e-3}, .moreau_jean = {.theta = 0.5}};
  options.step.solver = {.method = Method::jor_prox, .tolerance = 1e-2, .max_iterations = 20};
  const StepReport report = make_scheme("moreau_jean", s.model, options).step(s.state, kInf);
  ASSERT_TRUE(report.ok()) << report.reason;
  EXPECT_EQ(report.h, options.step.h);
}

}  // namespace
}  // namespace aussois
