// SPDX-License-Identifier: Apache-2.0
// The work of each joint, by what gave it, and the time of its forces, in every scheme (MJT-16), (MJT-17).
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "integrators/run.hpp"
#include "tests/support/gear_pair.hpp"
#include "tests/support/one_axis.hpp"
#include "tests/support/scheme_variants.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

void add(const JointWork& step, JointWork& sum) {
  sum.locked += step.locked;
  sum.couplings += step.couplings;
  sum.stops += step.stops;
  sum.friction += step.friction;
  sum.motors += step.motors;
  sum.springs += step.springs;
  sum.supports += step.supports;
}

class JointWorkInEveryScheme : public ::testing::TestWithParam<SchemeVariant> {
 protected:
  const SchemeVariant& v = GetParam();
  const bool event_driven = v.name == "event_driven", paoli = v.name == "schatzman_paoli",
             alpha = v.name == "generalised_alpha", cayley = v.options.step.update == GroupUpdate::cayley,
             first_order = scheme_traits(v.name, v.options).smooth < 2,
             stops_bounce = scheme_traits(v.name, v.options).restitution;
  const double rounding = event_driven ? 5e-8 : 1e-12;

  // Of each joint, over a run whose every step closes: the joints' work is that of the ledger.
  Table<JointId, JointWork> work(const Model& model, State& state, double h, double t_end) const {
    SchemeOptions o = v.options;
    o.step.h = h;
    Table<JointId, JointWork> out(model.joints.size());
    advance(make_scheme(v.name, model, o), state, t_end, [&](const StepReport& r) {
      double total = 0;
      for (const JointId j : out.ids()) {
        add(r.joints[j].work, out[j]);
        total += r.joints[j].work.total();
      }
      EXPECT_NEAR(total, r.energy.joint_work + r.energy.law_work, rounding) << "t = " << r.t;
      EXPECT_NEAR(r.energy.residual(), 0, rounding) << "t = " << r.t;
    });
    return out;
  }
  double kinetic(const OneAxis& s) const { return energy(s.model, s.state).kinetic; }
};

// 1/4 J at 0.8 rad/s^2.
TEST_P(JointWorkInEveryScheme, OfDryFrictionIsTheKineticEnergyThatItTook) {
  OneAxis w(JointKind::revolute);
  w.axis().friction = 0.4;
  w.state.v[4] = 1;
  const JointWork of = work(w.model, w.state, 1e-2, 2)[0];
  EXPECT_NEAR(of.friction, -0.25, rounding);
  EXPECT_NEAR(of.total(), of.friction, rounding);
}

// Torque times angle. Angles under Cayley's map are short of the mean speeds by their cube; the first torque
// of schatzman_paoli acts for half a step (SP-2).
TEST_P(JointWorkInEveryScheme, OfAnEffortMotorIsTorqueTimesAngle) {
  OneAxis w(JointKind::revolute);
  w.axis().motor = {.kind = MotorKind::effort, .target = [](double) { return 3; }};
  const JointWork of = work(w.model, w.state, 1e-2, 1)[0];
  EXPECT_NEAR(of.motors, 3 * w.q(), cayley ? 3e-3 : paoli ? 5e-4 : rounding);
  EXPECT_NEAR(of.total(), of.motors, rounding);
}

// What drives alone gives all the energy that there is.
TEST_P(JointWorkInEveryScheme, OfASpeedOrPositionMotorIsTheKineticEnergy) {
  for (const bool speed : {true, false}) {
    OneAxis w(JointKind::revolute);
    w.axis().motor = speed ? Motor{.kind = MotorKind::speed, .target = [](double t) { return std::sin(t); }}
                           : Motor{.kind = MotorKind::position, .target = [](double t) { return t * t; }};
    const JointWork of = work(w.model, w.state, 1e-2, 0.5)[0];
    EXPECT_NEAR(of.motors, kinetic(w), alpha ? 1e-7 : rounding);  // the damping of its other parts
    EXPECT_GT(of.motors, 0.05);
    EXPECT_NEAR(of.total(), of.motors, rounding);
  }
  if (event_driven) return;
  OneAxis limited(JointKind::revolute);
  limited.axis().motor = {.kind = MotorKind::speed, .target = [](double) { return 4; }, .limit = 5};
  const JointWork of = work(limited.model, limited.state, 1e-2, 1)[0];
  EXPECT_NEAR(of.motors, 4, 1e-11);
  EXPECT_NEAR(of.total(), of.motors, rounding);
}

// (1 - e^2) of the energy in each impact, or all of it but what the midpoint rule, which alone pushes an
// overlap out, may keep of that: the square of correction_speed.
TEST_P(JointWorkInEveryScheme, OfStopsIsWhatImpactsLose) {
  OneAxis s(JointKind::prismatic);
  s.axis() = {.lower = -0.1, .upper = 0.2, .restitution = stops_bounce ? 0.8 : 0};
  s.state.v[0] = 1;
  const JointWork of = work(s.model, s.state, 1e-3, 1)[0];
  const double pushed_out = v.name == "passive_midpoint" ? StepOptions{}.correction_speed : 0;
  EXPECT_NEAR(of.stops, stops_bounce ? std::pow(0.8, 4) - 1 : -1,
              1e-11 + (stops_bounce ? 0 : pushed_out * pushed_out));
  EXPECT_NEAR(of.total(), of.stops, rounding);
}

TEST_P(JointWorkInEveryScheme, OfSpringsIsWhatTheirPotentialLost) {
  OneAxis w(JointKind::revolute);
  w.axis() = {.stiffness = 50, .rest = 0.5};
  const double before = spring_energy(w.model, w.state);
  const JointWork of = work(w.model, w.state, 1e-3, 0.1)[0];
  const double lost = before - spring_energy(w.model, w.state);
  EXPECT_GT(lost, 0.5 * before);
  EXPECT_NEAR(of.springs, lost, (event_driven ? 1e-9 : first_order ? 0.02 : 1e-4) * before);
  EXPECT_NEAR(of.total(), of.springs, rounding);
}

// Gears carry what the motor of one wheel gives to the other one.
TEST_P(JointWorkInEveryScheme, OfGearsGoesFromOneJointToTheOther) {
  GearPair gears;
  Model& model = gears.model;
  State& state = gears.state;
  const std::vector<JointWork> of = work(model, state, 1e-2, 0.5);
  const double second = 1.5 * std::pow(joint_speed(model, state, 1), 2);
  EXPECT_GT(second, 0.5);
  EXPECT_NEAR(of[1].couplings, second, rounding);
  EXPECT_NEAR(of[0].couplings, -second,
              v.options.passive_midpoint.mean_joints ? 2e-4 : rounding);  // O(h^2) (MJT-15)
}

// A swinging loop with one hinge too many: what joints lock works by what a step leaves only, nothing at the
// midpoint, where rounding and projection remain, and what a scheme of order one loses elsewhere.
TEST_P(JointWorkInEveryScheme, OfAClosedLoopIsNothingOrWhatTheSchemeLoses) {
  Model model;
  for (int i = 0; i < 3; ++i)
    add(model, RigidBody{.name = "rod", .mass = 1, .inertia = Vec3(1e-3, 0.1, 0.1).asDiagonal()});
  State state = rest_state(model);
  const SE3 upright = rotation(Vec3::UnitY(), -kPi / 2);
  state.g[0] = {upright.R, Vec3(0, 0, 0.5)};
  state.g[1] = {upright.R, Vec3(1, 0, 0.5)};
  state.g[2].p = Vec3(0.5, 0, 1);
  const auto hinge = [&](BodyId a, BodyId b, double x, double z) {
    add(model, joint_at(JointKind::revolute, "hinge", a, b, state.g, translation(x, 0, z) * kAboutY));
  };
  hinge(0, kWorld, 0, 0), hinge(1, kWorld, 1, 0), hinge(0, 2, 0, 1), hinge(1, 2, 1, 1);
  for (const BodyId crank : {BodyId(0), BodyId(1)}) twist(state, crank) << 0.5, 0, 0, 0, 1, 0;
  twist(state, 2) << 1, 0, 0, 0, 0, 0;
  const auto locked = [&](double h) {
    State swings = state;
    double all = 0;
    for (const JointWork& of : work(model, swings, h, 0.4)) {
      all += std::abs(of.locked);
      EXPECT_EQ(of.total(), of.locked);
    }
    return all;
  };
  const double fine = locked(1e-3);
  EXPECT_LT(fine, event_driven ? 1e-9 : first_order || paoli ? 1e-3 : 2e-5);
  if (!event_driven && fine > 1e-12) {
    EXPECT_GT(std::log2(locked(2e-3) / fine), (first_order || paoli ? 1 : 2) - 0.2);
  }
}

// All kinds at once, on a base that is moved: the sums of the ledger are kept in each step (see work()), and
// what the base gives is the work of its forces.
TEST_P(JointWorkInEveryScheme, OfAMachineOnAMovedBaseAddsUp) {
  Model model;
  Trajectory path;
  for (int i = 0; i <= 100; ++i) {
    path.t.push_back(0.01 * i);
    path.pose.push_back(translation(0.1 * std::sin(0.06 * i), 0, 0));
  }
  add(model, prescribed_body("base", -1, path));
  for (int i = 0; i < 2; ++i)
    add(model, RigidBody{.name = "arm", .mass = 1, .inertia = Vec3(1e-3, 0.1, 0.1).asDiagonal()});
  State state = rest_state(model);
  state.g[1].p = Vec3(0.5, 0, 0);
  state.g[2].p = Vec3(1.5, 0, 0);
  add(model, joint_at(JointKind::revolute, "shoulder", 1, 0, state.g, kAboutY));
  add(model, joint_at(JointKind::revolute, "elbow", 2, 1, state.g, translation(1, 0, 0) * kAboutY));
  model.joints[0].axis[0] = {
      .lower = -0.2, .upper = 0.3, .restitution = stops_bounce ? 0.5 : 0, .friction = 0.2};
  model.joints[0].axis[0].motor = {.kind = MotorKind::effort, .target = [](double t) { return 2 + t; }};
  model.joints[1].axis[0] = {.friction = 0.1, .stiffness = 3, .damping = 0.2, .rest = 0.4};
  state = consistent_state(model, state);
  const std::vector<JointWork> of = work(model, state, 2e-3, 0.6);
  EXPECT_LT(of[0].stops, -0.01);
  EXPECT_LT(of[0].friction, -0.01);
  EXPECT_LT(of[1].friction, -0.01);
  EXPECT_GT(std::abs(of[0].motors), 0.1);
  EXPECT_GT(std::abs(of[1].springs), 0.01);
  EXPECT_GT(std::abs(of[0].supports), 0.01);
  EXPECT_EQ(of[1].supports, 0);
}

// A rod swings from the horizontal: its hinge carries m (a - g), by the angle at the time that the report
// names, whether joints are projected or stabilised. Worst of the second half of a swing, against its
// equation of motion by the midpoint rule. Of order two, where the scheme is: the impulse that drift takes
// stands in the force.
TEST_P(JointWorkInEveryScheme, ForcesBelongToTheTimeThatIsTold) {
  const auto off = [&](double h, bool project) {
    Model model;
    model.gravity = Vec3(0, 0, -9.81);
    add(model, RigidBody{.name = "rod", .mass = 2, .inertia = Vec3(1e-3, 2.0 / 12, 2.0 / 12).asDiagonal()});
    State state = rest_state(model);
    state.g[0].p.x() = 0.5;
    add(model, joint_at(JointKind::revolute, "hinge", 0, kWorld, state.g, kAboutY));
    SchemeOptions o = v.options;
    o.step.h = h;
    o.step.joints.project = project;
    constexpr double kPull = 1.5 * 9.81;          // angular acceleration when horizontal [rad/s^2]
    double t = 0, angle = 0, speed = 0, out = 0;  // down from the horizontal
    advance(make_scheme(v.name, model, o), state, 0.4, [&](const StepReport& r) {
      EXPECT_NEAR(r.t_joints, alpha ? r.t : paoli ? std::max(r.t - r.h, r.h / 4) : r.t - r.h / 2, 1e-12);
      for (const double dt = (r.t_joints - t) / 10; t < r.t_joints - dt / 2; t += dt) {
        const double middle = speed + dt / 2 * kPull * std::cos(angle);
        speed += dt * kPull * std::cos(angle + dt / 2 * speed), angle += dt * middle;
      }
      t = r.t_joints;
      const Vec3 out_of(std::cos(angle), 0, -std::sin(angle)), along(-std::sin(angle), 0, -std::cos(angle));
      const Vec3 a = 0.5 * (kPull * std::cos(angle) * along - speed * speed * out_of);
      if (t > 0.2) out = std::max(out, (r.joints[0].force - 2 * (a - model.gravity)).norm());
    });
    return out;
  };
  const bool first = first_order || paoli;
  for (const bool project : {true, false}) {
    if (!project && v.name == "event_driven") continue;  // always projects
    const double fine = off(5e-3, project);              // of 40 N
    EXPECT_LT(fine, first ? 0.6 : 8e-3) << project;
    EXPECT_GT(std::log2(off(1e-2, project) / fine), first ? 0.9 : 1.95) << project;
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, JointWorkInEveryScheme, ::testing::ValuesIn(variants_with_joints()),
                         [](const auto& v) { return test_name(v.param); });

}  // namespace
}  // namespace aussois
