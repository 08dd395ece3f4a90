// SPDX-License-Identifier: Apache-2.0
// Towers: the scenes on which sweeping solvers show what a warm start and a second phase are worth.
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

constexpr double kEdge = 0.1, kDilation = 1e-3, kDensity = 1000;

struct Tower {
  Model model{};
  State state{};
};

// Cubes on a slab, each at rest on the one below; `top` times the density for the uppermost.
Tower tower(int cubes, double top) {
  Tower t;
  t.model.contact_law = {.mu = 0.5, .restitution = 0};
  const SimplicialComplex slab = make_box(1, 1, kEdge), cube = make_box(kEdge, kEdge, kEdge);
  const auto slab_shape = add(t.model, prepare(dilate(slab, kDilation))),
             cube_shape = add(t.model, prepare(dilate(cube, kDilation)));
  add(t.model, fixed_body("slab", slab_shape));
  for (int i = 0; i < cubes; ++i)
    add(t.model, solid_body("cube " + std::to_string(i), cube_shape,
                            mass_properties(cube, kDensity * (i + 1 == cubes ? top : 1))));
  t.state = rest_state(t.model);
  pose(t.state, 0).p.z() = -kEdge / 2;
  for (int i = 0; i < cubes; ++i)
    pose(t.state, BodyId::at(i + 1)).p.z() = kEdge / 2 + i * kEdge + 2 * kDilation * (i + 1);
  return t;
}

TEST(Stack, OfTenCubesNeedsNoMoreThanASweepPerStep) {
  Tower t = tower(10, 1);
  const MoreauJean scheme(t.model, {.h = 1e-3}, {.theta = 1});
  int sweeps = 0, solves = 0;
  for (int step = 0; step < 200; ++step) {
    const StepReport report = scheme.step(t.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    ASSERT_EQ(report.solve.status, SolveStatus::converged);
    if (step == 0) continue;
    sweeps = std::max(sweeps, report.solve.iterations);
    solves += report.solve.newton_iterations;
  }
  EXPECT_LE(sweeps, 1);
  EXPECT_LE(solves, 199);  // linear ones of Newton: less than one per step
  for (int b = 1; b <= 10; ++b) EXPECT_LT(twist(t.state, BodyId::at(b)).norm(), 1e-7) << b;
}

TEST(Stack, WithATopAHundredTimesHeavierIsSolvedAtEveryStep) {
  Tower t = tower(10, 100);
  const MoreauJean scheme(t.model, {.h = 1e-3, .solver = {.tolerance = 1e-10}}, {.theta = 1});
  for (int step = 0; step < 200; ++step) {
    const StepReport report = scheme.step(t.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    ASSERT_EQ(report.solve.status, SolveStatus::converged) << "step " << step;
    ASSERT_LE(report.solve.residual, 1e-10);
  }
  for (int b = 1; b <= 10; ++b) {
    EXPECT_LT(twist(t.state, BodyId::at(b)).norm(), 1e-6) << b;
    EXPECT_NEAR(pose(t.state, BodyId::at(b)).p.z(), kEdge / 2 + (b - 1) * kEdge + 2 * kDilation * b, 1e-7)
        << b;
  }
}

}  // namespace
}  // namespace aussois
