// SPDX-License-Identifier: Apache-2.0
// Where energy and momentum of a step went, of every scheme of the registry.
#include <cmath>

#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

double size(const Momentum& m) {
  return m.linear.norm() + m.angular.norm();
}

/// The variants of the registry, and the reference.
std::vector<SchemeVariant> every_scheme() {
  std::vector<SchemeVariant> out = scheme_variants();
  out.push_back({"event_driven", {}});
  return out;
}

/// Worst of a run, relative to the momentum or energy that is there.
struct Off {
  double linear = 0, angular = 0;  // residual of the momentum
  double states = 0;               // its change against the states
  double energy = 0;               // residual of the energy
  double kinetic = 0;              // its change against the states
};

/// One step, and what its ledgers leave open; `one` and `E` count as one.
StepReport balanced_step(const Model& model, const Scheme& scheme, State& state, const Momentum& one,
                         double E, Off& off) {
  const Momentum before = momentum(model, state);
  const double kinetic = energy(model, state).kinetic;
  const StepReport report = scheme.step(state, kInf);
  const Momentum residual = report.momentum.residual();
  const double p = one.linear.norm(), L = one.angular.norm();
  off.linear = std::max(off.linear, residual.linear.norm() / p);
  off.angular = std::max(off.angular, residual.angular.norm() / L);
  const Momentum change = momentum(model, state) - before - report.momentum.change;
  off.states = std::max({off.states, change.linear.norm() / p, change.angular.norm() / L});
  off.energy = std::max(off.energy, std::abs(report.energy.residual()) / E);
  off.kinetic = std::max(off.kinetic,
                         std::abs(energy(model, state).kinetic - kinetic - report.energy.kinetic_change) / E);
  return report;
}

// Steps balance to rounding; the reference's angular momentum and energy to what its tolerance of 1e-10 in
// every component of every internal step adds up to.
void expect_balance(const Off& off, const std::string& scheme) {
  const double rounding = 1e-13, integrated = scheme == "event_driven" ? 1e-8 : rounding;
  EXPECT_LT(off.linear, rounding) << scheme;
  EXPECT_LT(off.angular, integrated) << scheme;
  EXPECT_LT(off.states, rounding) << scheme;
  EXPECT_LT(off.energy, integrated) << scheme;
  EXPECT_LT(off.kinetic, rounding) << scheme;
}

TEST(Ledger, OfAFreeFallHasTheWorkOfGravityAndTheDampingOfTheta) {
  const double m = 2, g = 9.81, h = 0.01;
  for (const double theta : {0.5, 0.7, 1.0}) {
    Model model;
    add(model, RigidBody{.name = "body", .mass = m, .inertia = Mat3::Identity()});
    State state = rest_state(model);
    const MoreauJean scheme(model, {.h = h, .theta = theta});
    for (int k = 0; k < 10; ++k) {
      const double z = pose(state, 0).p.z();
      const StepReport report = scheme.step(state);
      EXPECT_NEAR(report.energy.gravity_work, m * g * (z - pose(state, 0).p.z()), 1e-14);
      EXPECT_NEAR(report.energy.numerical_work, -(theta - 0.5) * m * g * g * h * h, 1e-14);
      EXPECT_NEAR(report.momentum.forces.linear.z(), -m * g * h, 1e-15);
      EXPECT_NEAR(report.energy.residual(), 0, 1e-13);
    }
  }
}

// A block slides on a plate and another one, of another law, on the first: what each contact took adds up to
// the work of its law, and all of them to the work of contacts.
TEST(Ledger, SharesTheWorkOfContactsOutAmongContactsAndTheirLaws) {
  for (const SchemeVariant& variant : every_scheme()) {
    const std::string name = label(variant.name, variant.options);
    Scene s = block_on_plate(0.3, 0, 0);
    const State below = s.state;
    const int rider = add(s.model, s.model.bodies[std::size_t(s.block)]);
    s.model.pair_laws[{s.block, rider}] = {.mu = 0.05, .restitution = 0.2};
    s.state = rest_state(s.model);
    pose(s.state, s.block) = pose(below, s.block);
    pose(s.state, rider).p.z() = pose(below, s.block).p.z() + kSide + 2 * kRadius;
    twist(s.state, s.block).head<2>() = Eigen::Vector2d(1, 0.5);
    twist(s.state, rider).head<2>() = Eigen::Vector2d(1.5, 0.5);
    const std::vector<ContactLaw> laws = contact_laws(s.model);
    ASSERT_EQ(laws.size(), 2U);
    SchemeOptions options = variant.options;
    options.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, s.model, options);
    for (int k = 0; k < 20; ++k) {
      const StepReport report = scheme.step(s.state, kInf);
      ASSERT_TRUE(report.ok() || is_loop_left_open(report)) << name << ": " << report.reason;
      double sum[2] = {0, 0};
      for (const StepContact& c : report.contacts)
        sum[std::max(c.point.a.body, c.point.b.body) == rider] += c.work;
      const double part = report.h / options.h;  // implicit loops may cut a step
      EXPECT_LT(sum[0], -1e-3 * part) << name;
      EXPECT_LT(sum[1], -1e-5 * part) << name;
      ASSERT_EQ(report.law_work.size(), 2U);
      for (const int i : {0, 1}) EXPECT_NEAR(report.law_work[std::size_t(i)], sum[i], 1e-15) << name;
      const double off = variant.name == "event_driven" ? 1e-11 : 1e-13;
      EXPECT_NEAR(sum[0] + sum[1], report.energy.contact_work, off) << name;
    }
  }
}

// A linear spring in space, with its exact derivative.
ForceLaw spring(int body, const Vec3& stiffness) {
  return {.name = "spring",
          .add_to =
              [=](const Model&, const State& state, double, GeneralisedForce& force) {
                force.f.segment<3>(6 * Eigen::Index(body)) -= stiffness.cwiseProduct(pose(state, body).p);
                for (int i = 0; i < 3; ++i) force.K.emplace_back(6 * body + i, 6 * body + i, stiffness[i]);
              },
          .potential = [=](const Model&, const State& state,
                           double) { return stiffness.dot(pose(state, body).p.cwiseAbs2()) / 2; }};
}

// A spinning block on a spring hits a plate that stands still, with friction and restitution.
TEST(Ledger, BalancesWeightSpringsAndImpactsInEveryScheme) {
  for (const SchemeVariant& variant : every_scheme()) {
    const std::string name = label(variant.name, variant.options);
    Scene s = block_on_plate(0.4, 0.5, 0.2, 0.03);
    pose(s.state, s.block).R = exp_so3(Vec3(0.3, 0.2, 0.1));
    twist(s.state, s.block) << 0.5, 0.2, -1, 3, -2, 1;
    add(s.model, spring(s.block, Vec3(30, 20, 40)));
    const double E = energy(s.model, s.state).total();
    const Momentum one{Vec3(1, 0, 0), Vec3(0.1, 0, 0)};  // 1 kg at 1 m/s, 0.1 m from the origin
    SchemeOptions options = variant.options;
    options.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, s.model, options);
    Off off;
    double met = 0;
    for (int k = 0; k < 50; ++k) {
      const StepReport report = balanced_step(s.model, scheme, s.state, one, E, off);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      met += report.momentum.contacts.linear.norm();
      EXPECT_NE(report.energy.law_work, 0) << name;
    }
    EXPECT_GT(met, 0.5) << name;
    expect_balance(off, name);
  }
}

// Two linked blocks hit two loose ones, no gravity: nothing comes from outside.
TEST(Ledger, KnowsThatWhatActsInsideCancelsInEveryScheme) {
  Model model;
  model.gravity.setZero();
  model.contact_law = {.mu = 0.4, .restitution = 0.5};
  const SimplicialComplex box = make_box(kSide, kSide, kSide);
  const int shape = add(model, prepare(dilate(box, kRadius)));
  for (int i = 0; i < 4; ++i) add(model, solid_body("block", shape, mass_properties(box, kDensity)));
  State start = rest_state(model);
  start.g[1].p = Vec3(0.13, 0, 0);
  start.g[2].p = Vec3(0.02, 0.03, 0.12);
  start.g[3].p = Vec3(0.15, 0.02, 0.121);
  add(model, joint_at(JointKind::spherical, "link", 1, 0, start.g, translation(0.065, 0, 0)));
  add(model, joint_at(JointKind::revolute, "hinge", 3, 2, start.g, translation(0.085, 0.02, 0.12)));
  twist(start, 0) << 0, 0, 1, 0.5, 1, 0.2;
  start = consistent(model, start);
  start.v = consistent_velocity(model, start);
  const Momentum all = momentum(model, start);
  const double E = energy(model, start).total();
  for (const SchemeVariant& variant : every_scheme()) {
    const std::string name = label(variant.name, variant.options);
    State state = start;
    SchemeOptions options = variant.options;
    options.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, model, options);
    double met = 0;
    Off off;
    for (int k = 0; k < 60; ++k) {
      const StepReport report = balanced_step(model, scheme, state, all, E, off);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      const MomentumLedger& m = report.momentum;
      EXPECT_LT(m.contacts.linear.norm() + m.joints.linear.norm(), 1e-13 * size(all)) << name;
      if (options.contacts == ContactsAt::start) {  // else with other arms than those of the start
        EXPECT_LT(m.contacts.angular.norm(), 1e-13 * size(all)) << name << ", step " << k;
      }
      for (const StepContact& c : report.contacts) met += c.impulse.norm();
    }
    EXPECT_GT(met, 0.1 * all.linear.norm()) << name;
    expect_balance(off, name);
    EXPECT_LT((momentum(model, state).linear - all.linear).norm(), 60 * 1e-13 * all.linear.norm()) << name;
  }
}

// What the scheme makes of a free top's momentum stands in its own place: nothing where the midpoint rule
// keeps it, a defect of third order in a step where the gyroscopic torque is linearised.
TEST(Ledger, NamesWhatTheSchemeMakesOfAFreeTopsMomentum) {
  Model model;
  model.gravity.setZero();
  add(model, RigidBody{.name = "top", .mass = 2, .inertia = Vec3(0.1, 0.2, 0.3).asDiagonal()});
  State start = rest_state(model);
  pose(start, 0).p = Vec3(0.3, -0.2, 0.5);
  twist(start, 0) << 1, 2, -1, 0.3, 4, 0.2;
  const double L = momentum(model, start).angular.norm();
  const auto defect = [&](const std::string& name, const SchemeOptions& options) {
    State state = start;
    const Scheme scheme = make_scheme(name, model, options);
    double out = 0;
    for (int k = 0; k < 20; ++k) {
      const StepReport report = scheme.step(state, kInf);
      EXPECT_LT(report.momentum.residual().angular.norm(), 1e-14 * L) << name;
      EXPECT_EQ(size(report.momentum.forces), 0) << name;
      out = std::max(out, report.momentum.numerical.angular.norm() / L);
    }
    return out;
  };
  EXPECT_LT(defect("passive_midpoint", {.h = 1e-2, .update = GroupUpdate::cayley}), 1e-14);
  const double coarse = defect("moreau_jean", {.h = 1e-2}), fine = defect("moreau_jean", {.h = 5e-3});
  EXPECT_GT(fine, 1e-9);
  EXPECT_NEAR(std::log2(coarse / fine), 3, 0.2);
}

// At theta = 1/2 the work of weight and linear springs is what their potentials lost, step by step.
TEST(Ledger, ClosesAgainstTheEnergyOfLinearForcesAtTheMidpoint) {
  Model model;
  for (const double mass : {1.0, 3.0})
    add(model, RigidBody{.name = "ball", .mass = mass, .inertia = mass * Mat3::Identity()});
  add(model, spring(0, Vec3(200, 300, 400)));
  add(model, spring(1, Vec3(500, 100, 50)));
  State start = rest_state(model);
  pose(start, 0).p = Vec3(0.1, -0.2, 0.3);
  pose(start, 1).p = Vec3(-0.3, 0.1, 0.2);
  twist(start, 1) << 1, 2, -1, 0.3, 4, 0.2;
  add(model, joint_at(JointKind::prismatic, "slider", 0, -1, start.g, pose(start, 0)));
  model.joints[0].axis[0] = {.stiffness = 700, .rest = 0.05};
  start.v = consistent_velocity(model, start);
  const Energy first = energy(model, start);
  const double E = first.kinetic + first.laws;
  for (const SchemeVariant& variant : scheme_variants()) {
    const std::string name = label(variant.name, variant.options);
    const bool midpoint = variant.name == "passive_midpoint" ||
                          (variant.name.starts_with("moreau_jean") && variant.options.theta == 0.5);
    if (variant.options.update == GroupUpdate::screw) continue;  // its centres go on arcs
    if (!midpoint) continue;
    State state = start;
    SchemeOptions options = variant.options;
    options.h = 5e-3;
    options.solver.tolerance = 1e-14;
    const Scheme scheme = make_scheme(variant.name, model, options);
    double off = 0, whole = 0;
    for (int k = 0; k < 200; ++k) {
      const Energy before = energy(model, state);
      const StepReport report = scheme.step(state, kInf);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      const Energy now = energy(model, state);
      off = std::max({off, std::abs(report.energy.law_work - before.laws + now.laws),
                      std::abs(report.energy.gravity_work - before.gravity + now.gravity),
                      std::abs(now.kinetic - before.kinetic - report.energy.kinetic_change),
                      std::abs(now.total() - before.total()), std::abs(report.energy.residual())});
      whole = std::max(whole, std::abs(now.total() - first.total()));
    }
    EXPECT_LT(off, 1e-12 * E) << name;
    EXPECT_LT(whole, 1e-12 * E) << name;
  }
}

}  // namespace
}  // namespace aussois
