// SPDX-License-Identifier: Apache-2.0
// doc/theory/trees.md: mechanisms in joint coordinates move as in maximal ones.
#include "examples/scenes/trees.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/mechanism.hpp"
#include "mechanics/tree.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_tree.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

// The largest distance [m] and angle [rad] between the poses of the same bodies.
double difference(const State& a, const State& b) {
  double out = 0;
  for (const BodyId i : a.g.ids())
    out = std::max({out, (a.g[i].p - b.g[i].p).norm(), a.g[i].R.angularDistance(b.g[i].R)});
  return out;
}

// All that take trees.
constexpr const char* kSchemes[] = {"moreau_jean",       "moreau_jean_projected", "d1_minus_linear",
                                    "generalised_alpha", "schatzman_paoli",       "event_driven"};

SchemeOptions certified_options() {
  SchemeOptions out = mechanism_options(1e-3);
  out.step.advancement.certify = true;
  return out;
}

CaseScene random_scene(bool floats, bool in_tree) {
  Random random(5);
  RandomTree tree = random_tree(random, 6, floats);
  const State there = random_state(random, tree.model);
  for (Model* model : {&tree.model, &tree.maximal})
    for (Joint& joint : model->joints)
      for (int i = 0; i < axis_count(joint.kind); ++i)
        joint.axis[std::size_t(i)].stiffness = 5, joint.axis[std::size_t(i)].damping = 0.3;
  if (in_tree) return {.model = tree.model, .state = there};
  CaseScene out{.model = tree.maximal, .state = rest_state(tree.maximal)};
  out.state.g = there.g;
  out.state.v = there.v.head(out.state.v.size());
  return out;
}

// By the same differential equation, integrated to its tolerance; joints of all six kinds, with springs.
TEST(JointCoordinates, MoveAsMaximalOnes) {
  for (const bool floats : {false, true}) {
    const SchemeOptions options = mechanism_options(0.05);
    const State a = run_scene(random_scene(floats, true), "event_driven", options, 0.2),
                b = run_scene(random_scene(floats, false), "event_driven", options, 0.2);
    EXPECT_LT(difference(a, b), 1e-9) << floats;
  }
}

// To the tolerance of the differential equation, on bases that are fixed and that float.
TEST(JointCoordinates, BalanceTheLedgersOfTheReference) {
  for (const bool floats : {false, true}) {
    SchemeOptions options = mechanism_options(0.05);
    options.event_driven.ode = {.relative = 1e-11, .absolute = 1e-11};
    int steps = 0;
    run_scene(random_scene(floats, true), "event_driven", options, 0.2,
              [&](const State&, const StepReport& report) {
                ++steps;
                EXPECT_LT(std::abs(report.energy.residual()), 1e-8) << floats;
                EXPECT_LT(report.momentum.residual().linear.norm(), 1e-8) << floats;
                EXPECT_LT(report.momentum.residual().angular.norm(), 1e-8) << floats;
              });
    EXPECT_GT(steps, 3);
  }
}

TEST(JointCoordinates, CloseLoopsByEquations) {
  const TreeScene bar = four_bar();
  const SchemeOptions options = mechanism_options(0.05);
  double off = 0;
  const CaseScene tree = in_joint_coordinates(bar);
  const State a = run_scene(tree, "event_driven", options, 0.5, [&](const State& state, const StepReport&) {
    off = std::max(off, joint_error(tree.model, state).translation);
  });
  const State b = run_scene(bar.bodies, "event_driven", options, 0.5);
  EXPECT_LT(difference(a, b), 2e-9);
  EXPECT_LT(off, 1e-10);
}

// Against the reference above, on floating and fixed bases.
TEST(JointCoordinates, ConvergeToTheOrderOfTheScheme) {
  for (const bool floats : {false, true}) {
    const CaseScene scene = random_scene(floats, true);
    const State exact = run_scene(scene, "event_driven", mechanism_options(0.05), 0.2);
    for (const char* name : {"moreau_jean", "moreau_jean_projected", "d1_minus_linear", "generalised_alpha",
                             "schatzman_paoli"}) {
      const auto error = [&](double h) {
        return difference(run_scene(scene, name, mechanism_options(h), 0.2), exact);
      };
      EXPECT_GT(std::log2(error(4e-3) / error(2e-3)), std::string(name) == "schatzman_paoli" ? 0.9 : 1.85)
          << name << floats;
    }
  }
}

// A peg pressed on a plate and slid over it: certified, audited, balanced, the same bits on any number of
// threads and with a fresh scheme from every seventh step on.
TEST(JointCoordinates, TouchCertifiedAndBalancedOnAnyThreads) {
  const TreeScene arm = arm_with_peg();
  const CaseScene scene = in_joint_coordinates(arm);
  const auto run = [&](int threads, int every, PathAudit* audit) {
    const auto scheme = [&] {
      return MoreauJean(scene.model, {.h = 2e-3, .threads = threads}, {.theta = 1});
    };
    State state = scene.state;
    MoreauJean steps = scheme();
    int contacts = 0;
    for (int k = 1; k <= 250; ++k) {
      const State before = state;
      const StepReport report = steps.step(state);
      EXPECT_TRUE(report.ok()) << report.reason;
      EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
      EXPECT_LT(report.momentum.residual().linear.norm(), 1e-12);
      EXPECT_LT(report.momentum.residual().angular.norm(), 1e-12);
      contacts = std::max(contacts, int(report.contacts.size()));
      if (audit) audit_path(scene.model, before, state, report, 1, *audit);
      if (every > 0 && k % every == 0) steps = scheme();
    }
    EXPECT_GT(contacts, 0);
    EXPECT_LT(joint_error(arm.bodies.model, state).translation, 1e-14) << "no drift";
    return state;
  };
  PathAudit audit;
  const State once = run(1, 0, &audit);
  EXPECT_EQ(audit.violations, 0);
  for (const auto& [threads, every] : {std::pair(2, 0), std::pair(8, 0), std::pair(1, 7)})
    EXPECT_EQ(hash(run(threads, every, nullptr)), hash(once)) << threads << ", " << every;
}

// An arm that turns about z lies on a floor: no force of the floor moves its angle.
TEST(JointCoordinates, TouchWhatTheyCannotPushAgainst) {
  for (const std::string scheme : kSchemes) {
    constexpr double kDilation = 1e-3;
    CaseScene scene;
    Model& model = scene.model;
    const MassProperties mass = mass_properties(make_box(0.4, 0.04, 0.04), 1000);
    const ShapeId rod = add(model, prepare(dilate(make_box(0.4, 0.04, 0.04), kDilation)));
    scene.body = add(model, solid_body("arm", rod, mass));
    add(model, fixed_body("floor", add(model, prepare(dilate(make_plate(2, 2), kDilation)))));
    scene.state = rest_state(model);
    pose(scene.state, scene.body).p = {0.3, 0, 0.02 + 2 * kDilation};
    const JointId hinge =
        add(model, joint_at(JointKind::revolute, "hinge", scene.body, kWorld, scene.state.g, SE3{}));
    const State maximal = scene.state;
    add_tree(model, "tree", {hinge});
    scene.state = in_joint_coordinates(model, maximal);
    scene.state.v.tail<1>()[0] = 3;
    const State end = run_scene(scene, scheme, certified_options(), 0.1);
    EXPECT_NEAR(end.q[0], 0.3, 1e-9) << scheme;
    EXPECT_NEAR(end.v.tail<1>()[0], 3, 1e-9) << scheme;
  }
}

// The last of three turntables rests on the first: their columns cancel each other.
TEST(JointCoordinates, TouchALinkThatTheyCannotPushAgainst) {
  for (const std::string scheme : kSchemes) {
    constexpr double kDilation = 1e-3;
    CaseScene scene;
    Model& model = scene.model;
    const auto box = [&](const char* name, double side, double height) {
      const SimplicialComplex k = make_box(side, side, height);
      return add(model,
                 solid_body(name, add(model, prepare(dilate(k, kDilation))), mass_properties(k, 1000)));
    };
    const BodyId table = box("table", 0.6, 0.02);
    const BodyId arm = add(model, RigidBody{.name = "arm", .mass = 0.1, .inertia = 1e-4 * Mat3::Identity()});
    scene.body = box("cube", 0.05, 0.05);
    scene.state = rest_state(model);
    pose(scene.state, arm).p = {0.05, 0, 0.1};
    pose(scene.state, scene.body).p = {0.1, 0.03, 0.035 + 2 * kDilation};
    std::vector<JointId> joints;
    const auto hinge = [&](const char* name, BodyId a, BodyId b, const Vec3& at) {
      joints.push_back(add(model, joint_at(JointKind::revolute, name, a, b, scene.state.g,
                                           translation(at.x(), at.y(), at.z()))));
    };
    hinge("first", table, kWorld, Vec3::Zero());
    hinge("second", arm, table, Vec3(0.01, 0, 0.1));
    hinge("third", scene.body, arm, Vec3(0.1, 0.02, 0.1));
    const State maximal = scene.state;
    add_tree(model, "tree", joints);
    scene.state = in_joint_coordinates(model, maximal);
    scene.state.v.tail<3>() << 0.5, 1, -2;
    carry(model, scene.state);
    const double before = energy(model, scene.state).total();
    const State end = run_scene(scene, scheme, certified_options(), 0.05);
    EXPECT_TRUE(end.v.allFinite()) << scheme;
    EXPECT_NEAR(energy(model, end).total(), before, 0.05 * energy(model, scene.state).kinetic)
        << scheme << ": no impulse without limit; steps of 1 ms";
    EXPECT_NEAR(pose(end, scene.body).p.z(), 0.035 + 2 * kDilation, 1e-12) << scheme;
  }
}

// Dampers that are far too stiff for a scheme that takes forces as they are: a status, and no exception.
TEST(JointCoordinates, EndAsAStatusWhereTheyDiverge) {
  CaseScene scene = in_joint_coordinates(arm_with_peg());
  for (Joint& joint : scene.model.joints) joint.axis[0].damping = 20;
  const Scheme scheme = make_scheme("d1_minus_linear", scene.model, mechanism_options(5e-4));
  State state = scene.state;
  StepReport last;
  for (int k = 0; k < 50 && last.ok(); ++k) last = scheme.step(state, 5e-4);
  EXPECT_EQ(last.status, StepStatus::not_finite) << last.reason;
}

TEST(JointCoordinates, AreRefusedWhereRowsAreOnTwists) {
  const CaseScene scene = in_joint_coordinates(four_bar());
  EXPECT_EQ(message_of([&] { PassiveMidpoint(scene.model, {}, {}); }),
            "passive_midpoint: body 0 (crank) is carried by a tree; only bodies with poses of their own may");
  EXPECT_NE(message_of([&] {
              MoreauJean(
                  scene.model, {},
                  {.contacts = ContactsAt::end, .newton = {.max_iterations = 5, .gap_hessians = true}});
            }).find("NewtonOptions::gap_hessians: body 0 (crank)"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
