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

// A block slides on a plate: what each contact took adds up to the work of all.
TEST(Ledger, SharesTheWorkOfContactsOut) {
  Scene s = block_on_plate(0.3, 0, 0);
  twist(s.state, s.block).head<2>() = Eigen::Vector2d(1, 0.5);
  const MoreauJean scheme(s.model, {.h = 2e-3, .theta = 0.5});
  for (int k = 0; k < 40; ++k) {
    const StepReport report = scheme.step(s.state);
    ASSERT_TRUE(report.ok());
    double sum = 0;
    for (const StepContact& c : report.contacts) sum += c.work;
    EXPECT_LT(sum, -1e-3);
    EXPECT_NEAR(sum, report.energy.contact_work, 1e-14);
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
  for (const SchemeVariant& variant : scheme_variants()) {
    const std::string name = label(variant.name, variant.options);
    State state = start;
    SchemeOptions options = variant.options;
    options.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, model, options);
    double met = 0;
    for (int k = 0; k < 60; ++k) {
      const StepReport report = scheme.step(state, kInf);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      const MomentumLedger& m = report.momentum;
      EXPECT_LT(size(m.residual()), 1e-13 * size(all)) << name << ", step " << k;
      EXPECT_LT(m.contacts.linear.norm() + m.joints.linear.norm(), 1e-13 * size(all)) << name;
      if (options.contacts == ContactsAt::start) {  // else with other arms than those of the start
        EXPECT_LT(m.contacts.angular.norm(), 1e-13 * size(all)) << name << ", step " << k;
      }
      for (const StepContact& c : report.contacts) met += c.impulse.norm();
    }
    EXPECT_GT(met, 0.1 * all.linear.norm()) << name;
    EXPECT_LT((momentum(model, state).linear - all.linear).norm(), 60 * 1e-13 * all.linear.norm()) << name;
  }
}

}  // namespace
}  // namespace aussois
