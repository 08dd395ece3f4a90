// SPDX-License-Identifier: Apache-2.0
// C3, the woodpecker toy (doc/theory/mechanism_benchmarks.md): impacts, sticking and slipping at a sleeve.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "integrators/scheme.hpp"
#include "tests/support/reference.hpp"

namespace aussois {
namespace {

struct Pecking {
  std::vector<double> beak{};  // times of its impacts [s]
  std::vector<Vec3> q{};       // at the times asked for
};

Pecking run(double h, double t_end, const std::vector<double>& times) {
  const CaseScene s = woodpecker();
  const Scheme scheme = make_scheme(
      "moreau_jean", s.model,
      {.h = h, .theta = 0.5, .normal = {.law = NormalLaw::moreau}, .solver = {.tolerance = 1e-12}});
  State state = s.state;
  Pecking out;
  bool touched = false;
  std::size_t next = 0;
  while (state.t < t_end - 1e-9) {
    const double until = next < times.size() ? times[next] : t_end;
    const StepReport report = scheme.step(state, until - state.t);
    EXPECT_TRUE(report.ok()) << report.reason << " at t = " << state.t;
    if (!report.ok()) break;
    const bool pushes = std::ranges::any_of(
        report.gaps, [](const StepGap& gap) { return gap.index == 0 && gap.impulse.x() > 0; });
    if (pushes && !touched) out.beak.push_back(state.t - report.h / 2);
    touched = pushes;
    if (next < times.size() && state.t > until - 1e-9) out.q.push_back(state.q), ++next;
  }
  return out;
}

// Over a whole period; first order, and the reference grants 2e-4 of its own.
TEST(Woodpecker, FollowsTheFineSteps) {
  REFERENCE(rows, "woodpecker.csv");
  std::vector<double> times;
  for (const ReferenceRow& row : rows)
    if (row.at("t_s") < 0.1501) times.push_back(row.at("t_s"));
  ASSERT_EQ(times.size(), 150u);
  const Pecking bird = run(1e-5, 0.15, times);
  ASSERT_EQ(bird.q.size(), times.size());
  for (std::size_t k = 0; k < times.size(); ++k) {
    const Vec3 q(rows[k].at("y_m"), rows[k].at("phiM_rad"), rows[k].at("phiS_rad"));
    EXPECT_LT((bird.q[k] - q).lpNorm<Eigen::Infinity>(), 4e-4) << "t = " << times[k];
  }
}

TEST(Woodpecker, PecksEvery146Milliseconds) {
  const Pecking bird = run(2e-5, 0.6, {});
  ASSERT_EQ(bird.beak.size(), 4u);
  EXPECT_NEAR(bird.beak[0], 0.0810135, 2e-5);
  for (std::size_t k = 1; k < 4; ++k)
    EXPECT_NEAR(bird.beak[k] - bird.beak[k - 1], 0.1459, 2e-4) << "peck " << k;  // 0.14 %
}

// Between two pecks the sleeve hangs on the pole by friction alone, and after them it is where it fell to.
TEST(Woodpecker, SticksOnThePoleBetweenItsPecks) {
  const CaseScene s = woodpecker();
  const Scheme scheme = make_scheme(
      "moreau_jean", s.model,
      {.h = 2e-5, .theta = 0.5, .normal = {.law = NormalLaw::moreau}, .solver = {.tolerance = 1e-12}});
  State state = s.state;
  double stuck = 0;
  while (state.t < 0.15) {
    ASSERT_TRUE(scheme.step(state, kInf).ok());
    if (std::abs(state.v[0]) < 1e-8 && std::abs(state.v[1]) < 1e-8) stuck += 2e-5;
  }
  EXPECT_GT(stuck, 0.03);
}

}  // namespace
}  // namespace aussois
