// SPDX-License-Identifier: Apache-2.0
// Energy and momentum of elastic bodies in flight (PMI-9) to (PMI-12).
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/cable.hpp"
#include "mechanics/model.hpp"
#include "mechanics/sheet.hpp"
#include "mechanics/solid.hpp"

namespace aussois {
namespace {

enum class Elastic { cable, solid, sheet };

struct Flying {
  Model model{};
  State state{};
};

// At rest without stress, thrown with a velocity that bends, twists, stretches and turns it.
Flying flying(Elastic kind) {
  Flying out;
  out.model.gravity = Vec3::Zero();
  Model& model = out.model;
  const auto thrown = [](const Vec3& x) {
    return Vec3(1 + 2 * x.y() * x.y(), 3 * x.x() - x.z(), 4 * x.x() * x.x() + x.y());
  };
  const auto throw_points = [&](BlockId block, const auto& places) {
    for (std::size_t i = 0; i < places.size(); ++i)
      out.state.v.segment<3>(first_speed(model, block) + 3 * Eigen::Index(i)) = thrown(places[i]);
  };
  if (kind == Elastic::cable) {
    const Cable cable = add_cable(
        model, {.nodes = frames_along(points_along({{0, 0, 0}, {1, 0, 0}}, 11)),
                .section = beam_section({.radius = 0.02, .young = 1e5, .poisson = 0.3, .density = 1000})});
    out.state = rest_state(model);
    lay(cable, out.state);
    for (const BodyId node : cable.nodes) linear_part(out.state.v, node) = thrown(out.state.g[node].p);
  } else if (kind == Elastic::solid) {
    const Solid solid = add_solid(model, make_box_mesh({1, 0.2, 0.2}, {5, 1, 1}, CellKind::tets),
                                  {.materials = {{.young = 1e6, .density = 1000}}});
    out.state = rest_state(model);
    throw_points(solid.points, solid.mesh->points);
  } else {
    const Sheet sheet = add_sheet(model, make_plate(1, 1, 4, 4),
                                  {.material = {.young = 1e5, .density = 1000}, .thickness = 0.01});
    out.state = rest_state(model);
    throw_points(sheet.points, sheet.mesh->vertices);
  }
  return out;
}

struct Kept {
  double energy = 0, linear = 0, angular = 0, strained = 0;  // relative; the largest potential over all
};
Kept kept(Elastic kind, double h, MiddleForce forces) {
  Flying now = flying(kind);
  const PassiveMidpoint scheme(now.model, {.h = h, .update = GroupUpdate::cayley}, {.forces = forces});
  const double E = energy(now.model, now.state).total();
  const Momentum P = momentum(now.model, now.state);
  Kept out;
  for (int k = 0; k < 100; ++k) {
    EXPECT_TRUE(scheme.step(now.state).ok()) << k;
    const Energy e = energy(now.model, now.state);
    const Momentum off = momentum(now.model, now.state) - P;
    out.energy = std::max(out.energy, std::abs(e.total() / E - 1));
    out.linear = std::max(out.linear, off.linear.norm() / P.linear.norm());
    out.angular = std::max(out.angular, off.angular.norm() / P.angular.norm());
    out.strained = std::max(out.strained, e.laws / E);
  }
  return out;
}

class ConservingForces : public testing::TestWithParam<Elastic> {};

// In steps so long that a linearised force gains or loses.
TEST_P(ConservingForces, KeepEnergyAndMomentumToRounding) {
  const Kept now = kept(GetParam(), 5e-3, MiddleForce::conserving),
             linear = kept(GetParam(), 5e-3, MiddleForce::linear);
  EXPECT_GT(now.strained, 0.02);  // that there is something to keep
  EXPECT_GT(linear.energy, 1e-4);
  EXPECT_LT(now.energy, 1e-12);
  EXPECT_LT(now.linear, 1e-12);
  EXPECT_LT(now.angular, 1e-12);
}

// Halved steps quarter the difference. The thin nodes of a cable turn fast.
TEST_P(ConservingForces, AreOfOrderTwo) {
  std::vector<State> ends;
  const double longest = GetParam() == Elastic::cable ? 2e-4 : 2e-3;
  for (const double h : {longest, longest / 2, longest / 4}) {
    Flying now = flying(GetParam());
    const PassiveMidpoint scheme(now.model, {.h = h, .update = GroupUpdate::cayley},
                                 {.forces = MiddleForce::conserving});
    while (now.state.t < 0.05 - h / 2) ASSERT_TRUE(scheme.step(now.state).ok());
    ends.push_back(now.state);
  }
  const auto apart = [](const State& a, const State& b) {
    double sum = (a.q - b.q).squaredNorm();
    for (const BodyId i : a.g.ids()) sum += (a.g[i].p - b.g[i].p).squaredNorm();
    return std::sqrt(sum);
  };
  EXPECT_NEAR(std::log2(apart(ends[0], ends[1]) / apart(ends[1], ends[2])), 2, 0.15);
}

INSTANTIATE_TEST_SUITE_P(Of, ConservingForces,
                         testing::Values(Elastic::cable, Elastic::solid, Elastic::sheet),
                         [](const testing::TestParamInfo<Elastic>& of) -> std::string {
                           return of.param == Elastic::cable   ? "a_cable"
                                  : of.param == Elastic::solid ? "a_solid"
                                                               : "a_sheet";
                         });

// What a law takes as a damper is taken: no correction gives it back.
TEST(ConservingForce, OfADampedSolidOnlyTakesEnergy) {
  Flying now;
  now.model.gravity = Vec3::Zero();
  const Solid solid = add_solid(now.model, make_box_mesh({1, 0.2, 0.2}, {5, 1, 1}, CellKind::tets),
                                {.materials = {{.young = 1e6, .density = 1000, .viscosity = 1e3}}});
  now.state = rest_state(now.model);
  for (std::size_t i = 0; i < solid.mesh->points.size(); ++i)
    now.state.v[first_speed(now.model, solid.points) + 3 * Eigen::Index(i)] = 5 * solid.mesh->points[i].x();
  const PassiveMidpoint scheme(now.model, {.h = 5e-3}, {.forces = MiddleForce::conserving});
  const Vec3 momenta = momentum(now.model, now.state).linear;
  const double first = energy(now.model, now.state).total();
  double last = first;
  for (int k = 0; k < 100; ++k) {
    const StepReport report = scheme.step(now.state);
    ASSERT_TRUE(report.ok());
    const Energy e = energy(now.model, now.state);
    ASSERT_LE(e.total(), last * (1 + 1e-13));
    EXPECT_NEAR(report.energy.numerical_work / first, 0, 1e-13);
    last = e.total();
  }
  EXPECT_LT(last, 0.9 * first);
  const double scale = 40 * 5;  // mass times the largest speed
  EXPECT_LT((momentum(now.model, now.state).linear - momenta).norm(), 1e-13 * scale);
}

// A clamped cable of one element and of ten, bent and let go; and one that is laid under tension and stays.
TEST(ConservingForce, OfAClampedCableKeepsItsEnergy) {
  for (const int elements : {1, 10})
    for (const double speed : {1.0, 0.0}) {
      Model model;
      model.gravity = Vec3::Zero();
      const Cable cable = add_cable(
          model, {.nodes = frames_along(points_along({{0, 0, 0}, {1, 0, 0}}, elements + 1)),
                  .section = beam_section({.radius = 0.02, .young = 1e6, .poisson = 0.3, .density = 1000})});
      model.bodies[cable.nodes.front()].motion = FixedMotion{};
      if (speed == 0) model.bodies[cable.nodes.back()].motion = FixedMotion{};
      if (speed == 0 && elements == 1) continue;
      State state = rest_state(model);
      lay(cable, state);
      if (speed > 0)
        linear_part(state.v, cable.nodes.back()) << 0, speed, 0.3 * speed;
      else
        for (const BodyId node : cable.nodes) pose(state, node).p.x() *= 1.05;
      const double E = energy(model, state).total();
      const PassiveMidpoint scheme(model, {.h = 2e-3, .update = GroupUpdate::cayley},
                                   {.forces = MiddleForce::conserving});
      for (int k = 0; k < 200; ++k) {
        ASSERT_TRUE(scheme.step(state).ok()) << elements << " elements, step " << k;
        ASSERT_NEAR(energy(model, state).total() / E, 1, 1e-11) << elements << " elements, step " << k;
      }
    }
}

// A damped cable under tension, plucked: what is left of its motion is small beside the potential.
TEST(ConservingForce, OfATautCableOnlyTakesEnergy) {
  Model model;
  model.gravity = Vec3::Zero();
  const Cable cable = add_cable(
      model, {.nodes = frames_along(points_along({{0, 0, 0}, {1, 0, 0}}, 11)),
              .section = beam_section(
                  {.radius = 0.02, .young = 1e6, .poisson = 0.3, .density = 1000, .damping_time = 5e-3})});
  for (const BodyId end : {cable.nodes.front(), cable.nodes.back()}) model.bodies[end].motion = FixedMotion{};
  State state = rest_state(model);
  lay(cable, state);
  for (const BodyId node : cable.nodes) pose(state, node).p.x() *= 1.05;
  linear_part(state.v, cable.nodes[5]) << 0, 1, 0;
  const PassiveMidpoint scheme(model, {.h = 5e-3, .update = GroupUpdate::cayley},
                               {.forces = MiddleForce::conserving});
  double last = energy(model, state).total();
  for (int k = 0; k < 500; ++k) {
    ASSERT_TRUE(scheme.step(state).ok()) << k;
    const double now = energy(model, state).total();
    ASSERT_LT(now, last * (1 + 1e-12)) << k;
    last = now;
  }
}

// A law of one's own without derivatives, between bodies of unlike masses that go round each other.
TEST(ConservingForce, OfASpringBetweenTwoBodiesKeepsTheirMomentaToo) {
  Model model;
  model.gravity = Vec3::Zero();
  for (const double mass : {1.0, 3.0})
    add(model, RigidBody{.name = "body", .mass = mass, .inertia = 0.1 * mass * Mat3::Identity()});
  const auto apart = [](const State& state) { return Vec3(state.g[1].p - state.g[0].p); };
  add(model, ForceLaw{.name = "spring",
                      .add_to =
                          [apart](const Model&, const State& state, double, GeneralisedForce& force) {
                            const Vec3 pull = 10 * apart(state).squaredNorm() * apart(state);
                            linear_part(force.f, 0) += pull;
                            linear_part(force.f, 1) -= pull;
                          },
                      .potential = [apart](const Model&, const State& state,
                                           double) { return 2.5 * std::pow(apart(state).norm(), 4); },
                      .passive = true,
                      .internal = true});
  State state = rest_state(model);
  pose(state, 1).p.x() = 1;
  twist(state, 0) << 1, -3, 0, 1, 0, 2;
  twist(state, 1) << 0, 2, 1, 0, 3, 0;
  const double E = energy(model, state).total();
  const Momentum P = momentum(model, state);
  const PassiveMidpoint scheme(model, {.h = 0.01, .update = GroupUpdate::cayley},
                               {.forces = MiddleForce::conserving});
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(scheme.step(state).ok());
  const Momentum off = momentum(model, state) - P;
  EXPECT_NEAR(energy(model, state).total() / E, 1, 1e-11);
  EXPECT_LT(off.linear.norm(), 1e-12);
  EXPECT_LT(off.angular.norm(), 1e-11);
}

// A stiffening spring to a place in the world, which may give momentum.
TEST(ConservingForce, OfASpringKeepsItsEnergyInFifteenStepsAPeriod) {
  Model model;
  model.gravity = Vec3::Zero();
  add(model, RigidBody{.name = "body", .mass = 1, .inertia = Mat3::Identity()});
  add(model, ForceLaw{.name = "spring",
                      .add_to =
                          [](const Model&, const State& state, double, GeneralisedForce& force) {
                            const double x = state.g[0].p.x();
                            force.f[0] -= 100 * x * x * x;
                            force.K.emplace_back(0, 0, 300 * x * x);
                          },
                      .potential = [](const Model&, const State& state,
                                      double) { return 25 * std::pow(state.g[0].p.x(), 4); },
                      .passive = true});
  const auto lost = [&](MiddleForce forces) {
    State state = rest_state(model);
    pose(state, 0).p.x() = 1;
    const double E = energy(model, state).total();
    const PassiveMidpoint scheme(model, {.h = 0.05}, {.forces = forces});
    double worst = 0;
    for (int k = 0; k < 1000; ++k) {
      EXPECT_TRUE(scheme.step(state).ok());
      worst = std::max(worst, std::abs(energy(model, state).total() / E - 1));
    }
    return worst;
  };
  EXPECT_LT(lost(MiddleForce::conserving), 1e-11);
  EXPECT_GT(lost(MiddleForce::linear), 1e-2);
}

}  // namespace
}  // namespace aussois
