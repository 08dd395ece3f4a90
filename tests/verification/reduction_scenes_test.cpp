// SPDX-License-Identifier: Apache-2.0
// What reduction does to the physics: blocks, cylinders and rings on a plane, solved with all contacts and
// with those kept; drilling friction of a disc. T_3_n: doc/theory/reduction.md.
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/frame.hpp"
#include "integrators/pose/reduced_solve.hpp"
#include "reduction/learned_selector.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/flat_contacts.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// One solve of a body of 1 kg, at rest `height` above the plane z = 0 that its contacts lie in.
struct Solved {
  VecX v{};                                          // at the end of the step
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();  // impulses about its centre, world
};
Solved solve_with(const ContactSet& contacts, const std::vector<int>& kept, double height, double mu,
                  const Vec3& gravity, const Vec6& twist_before = Vec6::Zero()) {
  Model model;
  model.gravity = gravity;
  model.contact_law = {.mu = mu};
  add(model, RigidBody{.name = "block", .mass = 1, .inertia = Vec3(2e-2, 3e-2, 4e-2).asDiagonal()});
  add(model, RigidBody{.name = "ground", .motion = FixedMotion{}});
  State state = rest_state(model);
  pose(state, 0).p.z() = height;
  twist(state, 0) = twist_before;
  const double h = 1e-3;
  const Layout dofs = layout(model);
  const FreeMotion free = free_motion(model, state, dofs, h, 0.5);
  const std::vector<ContactRow> rows =
      contact_rows(model, state, layout(model), contacts, prescribed_velocity(model, state, h), h, {});
  const FrictionProblem problem = contact_problem(free, dofs, rows, kept);
  const FrictionSolution solution =
      solve(problem, VecX::Zero(problem.H.cols()), {.tolerance = 1e-13, .max_iterations = 20000});
  EXPECT_EQ(solution.report.status, SolveStatus::converged);
  const VecX impulse = problem.H * solution.r;
  return {.v = solution.v, .force = impulse.head<3>(), .moment = impulse.tail<3>()};
}

std::vector<int> all_of(const ContactSet& set) {
  std::vector<int> all(set.points.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = int(i);
  return all;
}

TEST(ReducedBlock, T_3_6_MovesWithTheHullAsWithAllOfTwoHundredContacts) {
  int rocking = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    std::vector<Vec2> points;
    for (int i = 0; i < 200; ++i) points.push_back({random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.05)});
    const ContactSet set = flat(points);
    Vec6 v;
    for (double& x : v) x = random.uniform(-1, 1);
    v[2] = -1;
    v.tail<3>() *= 20;  // one corner comes first
    const Selection hull = reduce(set, {.reducer = Reducer::hull_exact});
    ASSERT_LT(hull.kept.size(), 40u);
    const Solved all = solve_with(set, all_of(set), 0.1, 0, {0, 0, -9.81}, v),
                 few = solve_with(set, hull.kept, 0.1, 0, {0, 0, -9.81}, v);
    EXPECT_LT((all.v - few.v).norm(), 1e-9 * v.norm()) << "seed " << seed;
    EXPECT_LT((all.force - few.force).norm(), 1e-9 * all.force.norm());
    EXPECT_LT((all.moment - few.moment).norm(), 1e-9 * all.moment.norm());
    rocking += all.v.tail<3>().head<2>().norm() > 1e-3;  // it does not just lie down
  }
  EXPECT_GT(rocking, 3);
}

// The tilt of gravity at which a body begins to topple towards `angle`, by bisection.
double falling_angle(const ContactSet& set, const std::vector<int>& kept, double height, double angle) {
  double stands = 0, falls = 1.2;
  for (int i = 0; i < 14; ++i) {
    const double tilt = (stands + falls) / 2;
    const Vec3 gravity =
        9.81 * Vec3(std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), -std::cos(tilt));
    const Solved end = solve_with(set, kept, height, 5, gravity);
    (end.v.tail<3>().norm() < 1e-9 ? stands : falls) = tilt;
  }
  return (stands + falls) / 2;
}

ContactSet rim(int n, double radius) {
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i)
    points.push_back(radius * Vec2(std::cos(2 * kPi * i / n), std::sin(2 * kPi * i / n)));
  return flat(points);
}

// A cylinder of 64 facets and a torus, upright on a plane: both touch it in a ring of points.
TEST(ReducedCylinder, T_3_7_FallsAtATiltThatItsMarginPromises) {
  const double radius = 0.05, height = 0.08;
  const ContactSet cylinder = rim(64, radius), torus = rim(48, radius);
  double worst_change = 0;
  for (const ContactSet* set : {&cylinder, &torus})
    for (const Reducer which : {Reducer::extreme_points, Reducer::hull_margin, Reducer::hull_area_loss}) {
      const Selection selection = reduce(*set, {.reducer = which});
      for (const double angle : {0.1, 0.9, 2.3, 4.0}) {
        const double full = falling_angle(*set, all_of(*set), height, angle),
                     kept = falling_angle(*set, selection.kept, height, angle);
        EXPECT_LE(kept, full + 1e-3) << to_string(which);  // bisection: 7e-5
        EXPECT_LE(full - kept, (1 - selection.loss.margin) * radius / height + 1e-3) << to_string(which);
        worst_change = std::max(worst_change, full - kept);
      }
    }
  EXPECT_GT(worst_change, 0.05);  // the sample is not hollow: some fall much too early
}

struct Upright {
  Model model{};
  BodyId body{};
  State state{};
  double mass = 0, inertia = 0;  // about the axis
};
Upright upright_cylinder(int facets, double radius, double height, double mu, double tilt) {
  Upright s;
  s.model.gravity = 9.81 * Vec3(std::sin(tilt), 0, -std::cos(tilt));
  s.model.contact_law = {.mu = mu};
  const SimplicialComplex cylinder = make_cylinder(radius, height, facets);
  const MassProperties mass = mass_properties(cylinder, 1000);
  const auto plate = add(s.model, prepare(dilate(make_plate(6, 6), kRadius)));
  const ShapeId shape = add(s.model, prepare(dilate(cylinder, kRadius)));
  add(s.model, fixed_body("ground", plate));
  s.body = add(s.model, solid_body("cylinder", shape, mass));
  s.state = rest_state(s.model);
  pose(s.state, s.body).p.z() = height / 2 + 2 * kRadius;
  s.mass = mass.mass, s.inertia = mass.inertia(2, 2);
  return s;
}

// In a step nothing is lost (decision record 0007): what a reducer left out and closes comes back.
TEST(ReducedCylinder, T_3_7_StandsInAStepAsLongAsWithAllContacts) {
  const double radius = 0.05, height = 0.16, tips = std::atan(radius * std::cos(kPi / 64) / (height / 2));
  for (const Reducer which : {Reducer::extreme_points, Reducer::hull_margin, Reducer::load_carrier,
                              Reducer::wrench_cone, Reducer::direction_set}) {
    Upright s = upright_cylinder(64, radius, height, 2, 0.98 * tips);
    const MoreauJean scheme(s.model, {.h = 1e-3, .reduction = {.reducer = which}}, {.theta = 1});
    const Quat upright = pose(s.state, s.body).R;
    double speed = 0, tilt = 0, margin = 1;
    StepReport report;
    while (s.state.t < 0.2 - 1e-9) {
      report = scheme.step(s.state, 0.2 - s.state.t);
      ASSERT_TRUE(report.ok()) << report.reason;
      speed = std::max(speed, twist(s.state, s.body).norm());
      tilt = std::max(tilt, pose(s.state, s.body).R.angularDistance(upright));
      margin = std::min(margin, report.loss.margin);
    }
    EXPECT_LT(report.contacts_kept, report.contacts_found) << to_string(which);
    if (which ==
        Reducer::hull_margin) {  // less than the load's 0.98 may be kept: it rocks onto what re-enters
      EXPECT_GE(margin, 0.9);
      EXPECT_LT(tilt, 0.01 * 2 * kRadius / (2 * radius));  // alone, what is kept lets it fall by 1e-2
    } else {
      EXPECT_LT(speed, 1e-6) << to_string(which);
    }
  }
}

TEST(SpinningDisc, T_3_9_OfAPatchIsSlowedByEvenPressure) {
  const double radius = 0.1, height = 0.02, mu = 0.3, t_end = 0.05, omega = 40;
  for (const FrictionAt at : {FrictionAt::patches, FrictionAt::contacts})
    for (const Reducer which : {Reducer::hull_margin, Reducer::none}) {
      Upright s = upright_cylinder(64, radius, height, mu, 0);
      twist(s.state, s.body)[5] = omega;
      const MoreauJean scheme(
          s.model,
          {.h = 1e-3, .reduction = {.reducer = which, .friction = at}, .solver = {.tolerance = 1e-11}},
          {.theta = 1});
      run(scheme, s.state, t_end);
      const double torque = s.inertia * (omega - twist(s.state, s.body)[5]) / t_end,
                   even = 2.0 / 3 * mu * s.mass * 9.81 * radius;
      EXPECT_NEAR(torque / even, at == FrictionAt::patches ? 1 : 1.5, 0.02) << to_string(which);
      EXPECT_LT(twist(s.state, s.body).head<5>().norm(), 1e-6);
    }
}

TEST(SlidingDisc, OfAPatchIsSlowedAsByContacts) {
  for (const FrictionAt at : {FrictionAt::patches, FrictionAt::contacts}) {
    Upright s = upright_cylinder(64, 0.1, 0.02, 0.3, 0);
    twist(s.state, s.body)[0] = 1;
    const MoreauJean scheme(
        s.model, {.h = 1e-3, .reduction = {.friction = at}, .solver = {.tolerance = 1e-11}}, {.theta = 1});
    const StepReport report = run(scheme, s.state, 0.05);
    EXPECT_NEAR(twist(s.state, s.body)[0], 1 - 0.3 * 9.81 * 0.05, 1e-6);
    EXPECT_LT(std::abs(report.energy.residual()), 1e-12);
    EXPECT_LT(report.momentum.residual().linear.norm(), 1e-12);
  }
}

// Warm started, without drift, at any angle below the one of friction.
TEST(RestingDisc, OfAPatchStaysOnASlopeAndDrillsBelowItsLimitNotAtAll) {
  Upright s = upright_cylinder(64, 0.1, 0.02, 0.3, 0.25);
  const double limit = 2.0 / 3 * 0.3 * s.mass * 9.81 * std::cos(0.25) * 0.1;
  add(s.model,
      ForceLaw{.name = "twist", .add_to = [limit](const Model&, const State&, double, GeneralisedForce& f) {
                 f.f[11] += 0.4 * limit;  // with the slope's 0.25 / 0.3 inside the ellipsoid
               }});
  const MoreauJean scheme(s.model, {.h = 1e-3, .reduction = {.friction = FrictionAt::patches}}, {.theta = 1});
  const StepReport report = run(scheme, s.state, 0.1);
  EXPECT_LT(twist(s.state, s.body).norm(), 1e-7);
  EXPECT_LE(report.solve.iterations, 20);
}

// A selector sees the bodies, what acts on them and what contacts carried, in any scheme; what it leaves out
// and would be needed comes back.
TEST(ReductionInAStep, AsksASelectorOfOnesOwn) {
  Upright s = upright_cylinder(12, 0.05, 0.06, 0.5, 0.1);
  int asked = 0;
  double carried = 0;
  Vec6 wrench = Vec6::Zero();
  const ContactSelector one = [&](const ReductionInput& input, const Clusters& clusters) {
    ++asked;
    carried = 0;
    for (std::size_t i = 0; i < input.impulse.size(); ++i)
      carried += input.impulse[i].dot(input.contacts.points[i].normal) / input.h;
    wrench = input.bodies[s.body].wrench;
    EXPECT_EQ(input.mu.front(), 0.5);
    return std::vector<int>{clusters.front().front()};
  };
  const MoreauJean scheme(
      s.model, {.h = 1e-3, .reduction = {.reducer = Reducer::selector, .min_margin = 0.6, .selector = one}},
      {.theta = 1});
  const StepReport report = run(scheme, s.state, 0.05);
  EXPECT_GE(asked, 50);
  EXPECT_LT(twist(s.state, s.body).norm(), 1e-6);
  EXPECT_GE(report.contacts_kept, 4);  // it names one
  EXPECT_GE(report.loss.margin, 0.6 - 1e-9);
  EXPECT_NEAR(std::abs(carried), s.mass * 9.81 * std::cos(0.1), 1e-3 * s.mass * 9.81);
  EXPECT_LT((wrench.head<3>() - s.mass * s.model.gravity).norm(), 1e-12);
}

// Memory of what was kept is part of the state: a run, and the same run by a fresh scheme in every step.
TEST(ReductionInAStep, HasTheSameBitsByAFreshSchemeInEveryStep) {
  for (const Reducer which : {Reducer::hull_margin, Reducer::extreme_points, Reducer::load_carrier}) {
    Upright s = upright_cylinder(64, 0.05, 0.06, 0.3, 0.1);
    twist(s.state, s.body)[5] = 20;  // it turns: corners change
    State again = s.state;
    const StepOptions options{.h = 1e-3, .reduction = {.reducer = which, .friction = FrictionAt::patches}};
    const MoreauJean scheme(s.model, options, {.theta = 1});
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(scheme.step(s.state).ok());
      ASSERT_TRUE(MoreauJean(s.model, options, {.theta = 1}).step(again).ok());
      ASSERT_EQ(hash(s.state), hash(again)) << to_string(which) << ", step " << k;
    }
  }
}

// Two columns on a plate and a third on one of them, all of 32 sides: three pairs of rims and faces that
// touch everywhere, none with a principal direction. The second turns about its axis.
struct Columns {
  Model model{};
  State state{};
};
Columns columns() {
  Columns s;
  s.model.gravity = 9.81 * Vec3(0.02, 0.01, -1);
  s.model.contact_law = {.mu = 0.3};
  const SimplicialComplex cylinder = make_cylinder(0.05, 0.06, 32);
  const auto plate = add(s.model, prepare(dilate(make_plate(6, 6), kRadius)));
  const ShapeId shape = add(s.model, prepare(dilate(cylinder, kRadius)));
  add(s.model, fixed_body("ground", plate));
  for (int i = 0; i < 3; ++i)
    add(s.model, solid_body("column " + std::to_string(i), shape, mass_properties(cylinder, 1000)));
  s.state = rest_state(s.model);
  pose(s.state, 1).p = {0, 0, 0.03 + 2 * kRadius};
  pose(s.state, 2).p = {0.2, 0, 0.03 + 2 * kRadius};
  pose(s.state, 3).p = {0.004, -0.003, 0.09 + 4 * kRadius};
  twist(s.state, 2)[5] = 8;
  return s;
}

// Eight places of the lower rim of the first column, and a network that turns with its torque.
ContactSelector learned_rim() {
  Random random(2);
  LearnedSelector out;
  Network& n = out.network;
  n.mean = VecX::Zero(kLoadInputs), n.scale = VecX::Ones(kLoadInputs);
  n.W1 = MatX::Zero(4, kLoadInputs), n.b1 = VecX::Zero(4), n.W2 = MatX::Zero(8, 4), n.b2 = VecX::Zero(8);
  for (double& w : n.W1.reshaped()) w = random.uniform(-1, 1);
  for (double& w : n.W2.reshaped()) w = random.uniform(-1, 1);
  for (int i = 0; i < 8; ++i)
    out.places.push_back({0.05 * std::cos(i * kPi / 4), 0.05 * std::sin(i * kPi / 4), -0.03});
  return contact_selector(out, 1);
}

ReductionOptions reduction_by(const std::string& name) {
  return {.reducer = reducer(name), .selector = name == "selector" ? learned_rim() : ContactSelector{}};
}

class EveryReducerInAScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryReducerInAScene, HasTheSameBitsForAnyThreadsAndAFreshScheme) {
  const Columns s = columns();
  const bool keeps_all = GetParam() == "none" || GetParam() == "hull_exact";  // every contact is a corner
  const auto states = [&](int threads, bool fresh) {
    StepOptions options{.h = 1e-3, .reduction = reduction_by(GetParam())};
    options.threads = options.lmd.threads = threads;
    const MoreauJean kept(s.model, options, {.theta = 1});
    State state = s.state;
    std::vector<std::uint64_t> out;
    int fewer = 0;
    for (int k = 0; k < 12; ++k) {
      const StepReport report =
          fresh ? MoreauJean(s.model, options, {.theta = 1}).step(state) : kept.step(state);
      EXPECT_TRUE(report.ok()) << report.reason << ", step " << k;
      fewer += report.contacts_kept < report.contacts_found;
      out.push_back(hash(state));
    }
    EXPECT_EQ(fewer > 6, !keeps_all);
    return out;
  };
  const std::vector<std::uint64_t> one = states(1, false);
  for (const int threads : {2, 4}) EXPECT_EQ(states(threads, false), one) << threads << " threads";
  EXPECT_EQ(states(1, true), one) << "fresh schemes";
}

// The whole scene turned and moved, gravity with it: the same contacts are solved, and bodies move alike. The
// columns lean by a millionth, each its own way, so that no rounding says which contact is the deepest. (A
// learned selector looks at the world's frame, as its network was taught. The wrenches of a rim tie, and
// rounding may tell which of them wrench_cone takes; not how the bodies move.)
TEST_P(EveryReducerInAScene, T_3_3_ChoosesTheSameWhenTheSceneIsTurned) {
  if (GetParam() == "selector") GTEST_SKIP() << "a learned selector is taught in the world's frame";
  const StepOptions options{.h = 1e-3, .reduction = reduction_by(GetParam())};
  const auto solved = [](const State& state) {
    std::vector<ContactKey> keys;
    for (const RememberedContact& c : state.memory.contacts)
      if (c.solved) keys.push_back(c.key);
    return keys;
  };
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Columns s = columns();
    for (std::size_t b = 1; b < s.state.g.size(); ++b)
      s.state.g[BodyId::at(b)].R *= exp_so3(1e-6 * random.vector(1));
    Columns turned = s;
    const SE3 turn{random.rotation(), random.vector(1)};
    turned.model.gravity = turn.R * s.model.gravity;
    for (SE3& g : turned.state.g) g = turn * g;
    for (const BodyId b : s.state.g.ids())  // velocities of centres are the world's
      twist(turned.state, b).head<3>() = turn.R * Vec3(twist(s.state, b).head<3>());
    ASSERT_TRUE(MoreauJean(s.model, options, {.theta = 1}).step(s.state).ok());
    ASSERT_TRUE(MoreauJean(turned.model, options, {.theta = 1}).step(turned.state).ok());
    EXPECT_GT(solved(s.state).size(), 9u) << "nothing touches: the test says nothing";
    if (GetParam() != "wrench_cone") {
      EXPECT_EQ(solved(s.state), solved(turned.state)) << "seed " << seed;
    }
    for (const BodyId b : s.state.g.ids())
      EXPECT_LT((turn * s.state.g[b].p - turned.state.g[b].p).norm(), 1e-10) << "seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Names, EveryReducerInAScene, ::testing::ValuesIn(reducer_names()),
                         [](const auto& name) { return name.param; });

// Whatever is reduced together, the cylinder stands, by the same bits for any threads and a fresh scheme.
TEST(ReductionInAStep, StandsByAnyClusteringAndHasTheSameBits) {
  for (const std::string& name : clustering_names()) {
    Upright s = upright_cylinder(64, 0.05, 0.06, 0.3, 0.1);
    State again = s.state;
    StepOptions options{.h = 1e-3, .reduction = {.clustering = {.rule = clustering(name)}}};
    const MoreauJean scheme(s.model, options, {.theta = 1});
    options.threads = 3;
    int kept = 64;
    for (int k = 0; k < 20; ++k) {
      const StepReport report = scheme.step(s.state);
      ASSERT_TRUE(report.ok()) << name << ": " << report.reason;
      ASSERT_TRUE(MoreauJean(s.model, options, {.theta = 1}).step(again).ok());
      ASSERT_EQ(hash(s.state), hash(again)) << name << ", step " << k;
      kept = std::min(kept, report.contacts_kept);
    }
    EXPECT_LT(twist(s.state, s.body).norm(), 1e-6) << name;
    EXPECT_LT(kept, 64) << name;
  }
}

}  // namespace
}  // namespace aussois
