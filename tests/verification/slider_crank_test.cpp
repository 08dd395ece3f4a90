// SPDX-License-Identifier: Apache-2.0
// C2, a slider-crank with clearance (doc/theory/mechanism_benchmarks.md).
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "examples/scenes/study.hpp"
#include "tests/support/reference.hpp"

namespace aussois {
namespace {

/// Centre of the slider and half its length times its tilt, from a row of the reference.
Vec3 slider_at(const ReferenceRow& row) {
  const double th1 = row.at("th1_rad"), th2 = row.at("th2_rad");
  return {kCrankLength * std::cos(th1) + kConnectingRodLength * std::cos(th2),
          kCrankLength * std::sin(th1) + kConnectingRodLength * std::sin(th2),
          kSliderLength / 2 * row.at("th3_rad")};
}

// Both corners of the upper side at once: 2.6925028 ms, 0.8416123 m/s (verification by another integrator).
TEST(SliderCrank, FirstImpactOfTheExactMotionIsThatOfTheReference) {
  const ExactMotion exact = slider_crank_motion(8e-3);
  ASSERT_EQ(exact.pieces.size(), 4u);
  const double t = exact.pieces[1].begin;
  EXPECT_NEAR(t, 2.6925028e-3, 5e-11);
  EXPECT_NEAR(exact.pieces[0].at(t).v[1], 0.8416123, 5e-8);
  for (std::size_t k = 1; k < 4; ++k) {
    const double hit = exact.pieces[k].begin;
    EXPECT_NEAR(exact.pieces[k].at(hit).q[1], 1e-3, 1e-14);
    EXPECT_NEAR(exact.pieces[k].at(hit).v[1], -0.4 * exact.pieces[k - 1].at(hit).v[1], 1e-12);
  }
}

// Another code, at a fixed step of 5 ns: through the end of infinitely many impacts, and while the wall
// guides.
TEST(SliderCrank, ExactMotionAgreesWithTheFineSteps) {
  REFERENCE(rows, "slider_crank_mu0.csv");
  REFERENCE(events, "slider_crank_mu0_events.csv");
  const ExactMotion exact = slider_crank_motion(0.02);
  double worst = 0;
  for (const ReferenceRow& row : rows)
    worst = std::max(worst, (evaluate(exact, row.at("t_s")).q - slider_at(row)).norm());
  EXPECT_LT(worst, 2e-8);                             // the reference grants 4e-7 rad of a rod of 0.3 m
  for (std::size_t k = 0; k < events.size(); k += 2)  // two corners each
    EXPECT_NEAR(exact.pieces[k / 2 + 1].begin, events[k].at("t_s"), 4e-7) << k;
}

struct Strokes {
  std::vector<double> impacts{};  // [s], middles of their steps
  double worst = 0;               // distance of the slider from the reference [m]
};

struct Rule {
  bool of_bodies = true;
  ImpactLaw law = ImpactLaw::newton;
  double late = 0;  // of the impacts, at most [s]
};

/// With friction, h = 10 us, until 8 ms.
Strokes run(const Rule& rule, const std::vector<ReferenceRow>& rows) {
  const CaseScene s = (rule.of_bodies ? slider_crank_of_bodies : slider_crank_of_angles)(0.01);
  const auto observe = rule.of_bodies ? slider_of_bodies : slider_of_angles;
  const Scheme scheme = make_scheme("moreau_jean", s.model,
                                    {.h = 1e-5,
                                     .theta = 0.5,
                                     .impact = {.law = rule.law},
                                     .normal = {.law = NormalLaw::moreau},
                                     .solver = {.tolerance = 1e-12},
                                     .advancement = {.certify = false}});
  State state = s.state;
  Strokes out;
  double rising = 0;
  for (const ReferenceRow& row : rows) {
    if (row.at("t_s") > 8e-3) break;
    while (state.t < row.at("t_s") - 1e-9) {
      const StepReport report = scheme.step(state, row.at("t_s") - state.t);
      EXPECT_TRUE(report.ok()) << report.reason;
      if (!report.ok()) return out;
      const double now = observe(s, state).v[1];
      if (rising > 0.05 && now < 0) out.impacts.push_back(state.t - report.h / 2);
      rising = now;
    }
    out.worst = std::max(out.worst, (observe(s, state).q - slider_at(row)).norm());
  }
  return out;
}

// Newton's law within the step speaks of the normal velocity in the directions of its start. In angles those
// turn by 0.03 m/s in a step, in bodies they do not: an impact apart from the step is what angles want.
TEST(SliderCrank, WithFrictionMeetsTheFineSteps) {
  REFERENCE(rows, "slider_crank_mu001.csv");
  REFERENCE(events, "slider_crank_mu001_events.csv");
  for (const Rule& rule : {Rule{true, ImpactLaw::poisson, 1e-5},
                           {false, ImpactLaw::poisson, 1e-5},
                           {true, ImpactLaw::newton, 3.5e-5},
                           {false, ImpactLaw::newton, 2.6e-4}}) {
    SCOPED_TRACE(std::string(rule.of_bodies ? "bodies, " : "angles, ") + to_string(rule.law));
    const Strokes strokes = run(rule, rows);
    ASSERT_EQ(strokes.impacts.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(strokes.impacts[k], events[2 * k].at("t_s"), rule.late) << "impact " << k;
    EXPECT_LT(strokes.worst, 2e-5);
  }
}

// Every scheme and setting at one step: errors of first order, three impacts of up to 1.2 m/s.
TEST(SliderCrank, RunsInEveryScheme) {
  int runs = 0;
  for (const char* name : {"slider_crank", "slider_crank_angles"}) {
    const Case& c = case_named(name);
    const ExactMotion exact = c.exact(c.t_end);
    for (const SchemeVariant& variant : scheme_variants()) {
      if (!applies(c, scheme_traits(variant.name, variant.options))) continue;
      SchemeOptions options = variant.options;
      options.h = 2e-5, options.solver.tolerance = 1e-12, options.advancement.certify = false;
      const Errors errors = errors_of(run_case(c, variant.name, options, 1), exact);
      EXPECT_LT(errors[q_max], 3e-4) << name << ", " << label(variant.name, options);
      EXPECT_LT(errors[v_graph], 0.1) << name << ", " << label(variant.name, options);
      ++runs;
    }
  }
  EXPECT_GT(runs, 30);
}

// Struck one after the other, the corners tilt the slider: what follows is another motion, not a worse one.
TEST(SliderCrank, LeavesTheWallTiltedWhenItsCornersAreStruckInTurn) {
  for (const ImpactOrder order : {ImpactOrder::simultaneous, ImpactOrder::sequential}) {
    const CaseScene s = slider_crank_of_bodies(0);
    const Scheme scheme = make_scheme("moreau_jean", s.model,
                                      {.h = 1e-5,
                                       .theta = 0.5,
                                       .impact = {.order = order},
                                       .normal = {.law = NormalLaw::moreau},
                                       .solver = {.tolerance = 1e-12},
                                       .advancement = {.certify = false}});
    State state = s.state;
    double tilting = 0;  // [rad/s]; the corners that were struck last are soon struck again
    while (state.t < 2.75e-3) {
      ASSERT_TRUE(scheme.step(state, kInf).ok());
      tilting = std::max(tilting, std::abs(slider_of_bodies(s, state).v[2]));
    }
    if (order == ImpactOrder::simultaneous) {
      EXPECT_LT(tilting, 1e-9);
    } else {
      EXPECT_GT(tilting, 0.05);
    }
  }
}

}  // namespace
}  // namespace aussois
