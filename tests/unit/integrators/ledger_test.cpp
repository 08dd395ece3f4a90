// SPDX-License-Identifier: Apache-2.0
// Where energy and momentum of a step went, of every scheme of the registry.
#include <cmath>

#include "examples/scenes/outside_judge.hpp"
#include "examples/scenes/springs.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/scheme_variants.hpp"

namespace aussois {
namespace {

/// The variants of the registry, and the reference.
std::vector<SchemeVariant> every_scheme() {
  std::vector<SchemeVariant> out = scheme_variants();
  out.push_back({"event_driven", {}});
  return out;
}

/// Worst of a run: what poses and velocities did against what the report says was done to them, relative to
/// the momentum or energy that is there.
struct Off {
  double linear = 0;   // forces, contacts, joints: no scheme adds momentum
  double kinetic = 0;  // all works
  double height = 0;   // the work of gravity
  double turned = 0;   // what the scheme makes of the angular momentum, over what may_turn allows
  double lost = 0;     // likewise of what the states did, where nothing comes from outside
  double largest = 0;  // numerical angular momentum [N m s]
};

// Arms are off by h v at most and attitudes by h omega while impulses act; the bodies are cubes, whose
// momentum does not turn by itself [N m s].
double may_turn(const Model& model, const State& before, const State& after, const StepReport& report) {
  double v = 0, omega = 0, impulses = 0, torques = 0;
  for (const BodyId b : model.bodies.ids()) {
    const Vec6 was = twist(before, b), is = twist(after, b);
    const RigidBody& body = model.bodies[b];
    if (!is_dynamic(body)) continue;
    v = std::max({v, was.head<3>().norm(), is.head<3>().norm()});
    omega = std::max({omega, was.tail<3>().norm(), is.tail<3>().norm()});
    impulses += body.mass * (is - was).head<3>().norm();
    torques += (body.inertia * (is - was).tail<3>()).norm();
  }
  for (const StepContact& c : report.contacts)
    impulses += c.impulse.norm(), torques += kSide * c.impulse.norm();
  for (const StepJoint& j : report.joints) {
    impulses += report.h * j.force.norm();
    torques += report.h * (j.torque.norm() + kSide * j.force.norm());
  }
  return report.h * (v * impulses + omega * torques);
}

/// One step against the states before and after; `p`, `L` and `E` count as one.
StepReport judged_step(const Model& model, const Scheme& scheme, State& state, double p, double L, double E,
                       Off& off) {
  const State start = state;
  const Judged before = judged_from_outside(model, state);
  StepReport report = scheme.step(state, kInf);
  const Judged now = judged_from_outside(model, state);
  const MomentumLedger& m = report.momentum;
  const EnergyLedger& e = report.energy;
  const Vec3 given = m.forces.linear + m.contacts.linear + m.joints.linear;
  const double work =
      e.gravity_work + e.law_work + e.contact_work + e.gyroscopic_work + e.joint_work + e.numerical_work;
  const double allowed = may_turn(model, start, state, report) + 1e-13 * L;
  off.linear = std::max(off.linear, (now.linear - before.linear - given).norm() / p);
  off.kinetic = std::max(off.kinetic, std::abs(now.kinetic - before.kinetic - work) / E);
  off.height = std::max(off.height, std::abs(before.height - now.height - e.gravity_work) / E);
  off.turned = std::max(off.turned, m.numerical.angular.norm() / allowed);
  off.lost = std::max(off.lost, (now.angular - before.angular).norm() / allowed);
  off.largest = std::max(off.largest, m.numerical.angular.norm());
  return report;
}

// A block slides on a plate and another one, of another law, on the first: what each contact took adds up to
// the work of its law, and all of them to the work of contacts.
TEST(Ledger, SharesTheWorkOfContactsOutAmongContactsAndTheirLaws) {
  for (const SchemeVariant& variant : every_scheme()) {
    const std::string name = label(variant.name, variant.options);
    Scene s = block_on_plate(0.3, 0, 0);
    const State below = s.state;
    const auto rider = add(s.model, s.model.bodies[s.block]);
    s.model.pair_laws[{s.block, rider}] = {.mu = 0.05, .restitution = 0.2};
    drop_refused_restitution(s.model, variant);
    s.state = rest_state(s.model);
    pose(s.state, s.block) = pose(below, s.block);
    pose(s.state, rider).p.z() = pose(below, s.block).p.z() + kSide + 2 * kRadius;
    twist(s.state, s.block).head<2>() = Eigen::Vector2d(1, 0.5);
    twist(s.state, rider).head<2>() = Eigen::Vector2d(1.5, 0.5);
    const std::vector<ContactLaw> laws = contact_laws(s.model);
    ASSERT_EQ(laws.size(), 2U);
    SchemeOptions options = variant.options;
    options.step.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, s.model, options);
    for (int k = 0; k < 20; ++k) {
      const StepReport report = scheme.step(s.state, kInf);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      double sum[2] = {0, 0};
      for (const StepContact& c : report.contacts)
        sum[std::max(c.point.a.body, c.point.b.body) == rider] += c.work;
      const double part = report.h / options.step.h;  // implicit loops may cut a step
      EXPECT_LT(sum[0], -1e-3 * part) << name;
      EXPECT_LT(sum[1], -1e-5 * part) << name;
      ASSERT_EQ(report.law_work.size(), 2U);
      for (const int i : {0, 1}) EXPECT_NEAR(report.law_work[i], sum[i], 1e-15) << name;
      const double off = variant.name == "event_driven" ? 1e-11 : 1e-13;
      EXPECT_NEAR(sum[0] + sum[1], report.energy.contact_work, off) << name;
    }
  }
}

// A spinning block on a spring hits a plate that stands still, with friction and restitution. The reference
// closes to what its tolerance of 1e-10 in every component of every internal step adds up to.
TEST(Ledger, ExplainsWhatWeightSpringsAndImpactsDidInEveryScheme) {
  const double stiffest = 40, fastest = 2, h = 2e-3;  // [N/m], [m/s], [s]
  for (const SchemeVariant& variant : every_scheme()) {
    const std::string name = label(variant.name, variant.options);
    Scene s = block_on_plate(0.4, 0.5, 0.2, 0.03);
    drop_refused_restitution(s.model, variant);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
    twist(s.state, s.block) << 0.5, 0.2, -1, 3, -2, 1;
    add(s.model, spring(s.block, Vec3(30, 20, stiffest)));
    const double E = energy(s.model, s.state).total(), p = 1, L = 0.1;  // 1 kg, 1 m/s, 0.1 m from the origin
    SchemeOptions options = variant.options;
    options.step.h = h;
    const Scheme scheme = make_scheme(variant.name, s.model, options);
    Off off;
    double met = 0;
    for (int k = 0; k < 50; ++k) {
      const StepReport report = judged_step(s.model, scheme, s.state, p, L, E, off);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      met += report.momentum.contacts.linear.norm();
      EXPECT_NE(report.energy.law_work, 0) << name;
    }
    EXPECT_GT(met, 0.5) << name;
    const bool reference = variant.name == "event_driven", paoli = variant.name == "schatzman_paoli";
    const double rounding = reference ? 1e-8 : 1e-13;
    // Its forces are those of where the body would be without the impact (GA-10)
    const double shifted = variant.name == "generalised_alpha" ? stiffest * h * h * fastest / p : 0;
    EXPECT_LT(off.linear, 1e-13 + shifted) << name;
    EXPECT_LT(off.kinetic, rounding) << name;
    // The path of gravity's work is not that of the body: half a kick, arcs, projection
    const bool elsewhere =
        paoli || options.step.update == GroupUpdate::screw || variant.name == "moreau_jean_projected";
    EXPECT_LT(off.height, elsewhere ? kGravity * fastest * h / E : rounding) << name;
    EXPECT_LE(off.turned, 0.51) << name;  // h (1 - theta) v x m dv, theta at least 1/2
    if ((variant.name == "moreau_jean" && options.moreau_jean.theta == 1) || paoli) {  // h v+ x m v+ = 0
      EXPECT_LT(off.largest, 1e-13) << name;
    }
  }
}

// Two linked blocks hit two loose ones, no gravity: nothing comes from outside.
TEST(Ledger, KnowsThatWhatActsInsideCancelsInEveryScheme) {
  Model model;
  model.gravity.setZero();
  model.contact_law.mu = 0.4;
  const SimplicialComplex box = make_box(kSide, kSide, kSide);
  const ShapeId shape = add(model, prepare(dilate(box, kRadius)));
  for (int i = 0; i < 4; ++i) add(model, solid_body("block", shape, mass_properties(box, kDensity)));
  State start = rest_state(model);
  start.g[1].p = Vec3(0.13, 0, 0);
  start.g[2].p = Vec3(0.02, 0.03, 0.12);
  start.g[3].p = Vec3(0.15, 0.02, 0.121);
  add(model, joint_at(JointKind::spherical, "link", 1, 0, start.g, translation(0.065, 0, 0)));
  add(model, joint_at(JointKind::revolute, "hinge", 3, 2, start.g, translation(0.085, 0.02, 0.12)));
  twist(start, 0) << 0, 0, 1, 0.5, 1, 0.2;
  start = consistent_state(model, start);
  start.v = consistent_velocity(model, start);
  const Judged first = judged_from_outside(model, start);
  const double E = first.kinetic, p = first.linear.norm(), L = first.angular.norm();
  for (const SchemeVariant& variant : every_scheme()) {
    const std::string name = label(variant.name, variant.options);
    State state = start;
    SchemeOptions options = variant.options;
    options.step.h = 2e-3;
    model.contact_law.restitution = 0.5;
    drop_refused_restitution(model, variant);
    const Scheme scheme = make_scheme(variant.name, model, options);
    double met = 0;
    Off off;
    for (int k = 0; k < 60; ++k) {
      const StepReport report = judged_step(model, scheme, state, p, L, E, off);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      const MomentumLedger& m = report.momentum;
      EXPECT_LT(m.contacts.linear.norm() + m.joints.linear.norm(), 1e-13 * p) << name;
      if (options.moreau_jean.contacts ==
          ContactsAt::start) {  // else with other arms than those of the start
        EXPECT_LT(m.contacts.angular.norm(), 1e-13 * L) << name << ", step " << k;
      }
      for (const StepContact& c : report.contacts) met += c.impulse.norm();
    }
    EXPECT_GT(met, 0.1 * p) << name;
    const double closes = variant.name == "event_driven" ? 1e-8 : 1e-13;
    EXPECT_LT(off.linear, 1e-13) << name;
    EXPECT_LT(off.kinetic, closes) << name;
    const Judged last = judged_from_outside(model, state);
    EXPECT_LT((last.linear - first.linear).norm(), 60 * 1e-13 * p) << name;
    EXPECT_LE(off.turned, 1) << name;
    EXPECT_LE(off.lost, 1) << name;
  }
}

// A free top at theta = 1 and steps of 0.1 s loses per cents of its angular momentum, as poses and velocities
// have it, while every step of the ledger closes. What closes it is named numerical, and shrinks as the step.
TEST(Ledger, ThatClosesIsNoProofThatMomentumIsKept) {
  Model model;
  model.gravity.setZero();
  add(model, RigidBody{.name = "top", .mass = 2, .inertia = Vec3(0.1, 0.2, 0.3).asDiagonal()});
  State start = rest_state(model);
  twist(start, 0).tail<3>() << 0.3, 1, 0.2;
  const Vec3 first = judged_from_outside(model, start).angular;
  const auto drift = [&](double h) {
    State state = start;
    const Scheme scheme = make_scheme("moreau_jean", model, {.step = {.h = h}, .moreau_jean = {.theta = 1}});
    Vec3 numerical = Vec3::Zero();
    while (state.t < 10 - h / 2) {
      const StepReport report = scheme.step(state, kInf);
      EXPECT_TRUE(report.ok()) << report.reason;
      EXPECT_LT(report.momentum.residual().angular.norm(), 1e-14 * first.norm());
      EXPECT_EQ(report.momentum.forces.angular, Vec3::Zero());
      numerical += report.momentum.numerical.angular;
    }
    const Vec3 lost = judged_from_outside(model, state).angular - first;
    EXPECT_LT((lost - numerical).norm(), 1e-12 * first.norm());
    return lost.norm() / first.norm();
  };
  const double coarse = drift(0.1), fine = drift(0.025);
  EXPECT_GT(coarse, 0.01);
  EXPECT_GT(std::log2(coarse / fine) / 2, 0.8);
}

}  // namespace
}  // namespace aussois
