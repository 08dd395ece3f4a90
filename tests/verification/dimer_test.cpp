// SPDX-License-Identifier: Apache-2.0
// C4 and C5: a dimer that bounces on both ends, and a rod that comes between the balls of one.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "examples/scenes/toys.hpp"
#include "integrators/find_ahead.hpp"
#include "integrators/moreau_jean.hpp"
#include "integrators/scheme.hpp"
#include "lmd/simplex_distance.hpp"
#include "tests/support/reference_series.hpp"

namespace aussois {
namespace {

SchemeOptions options(double h) {
  return {.h = h, .theta = 0.5, .normal = {.law = NormalLaw::moreau}, .solver = {.tolerance = 1e-12}};
}

/// Largest difference of the two end points from those of a series with columns t, x, z, angle, up to t_end.
double off_by(const CaseScene& s, const std::string& name, const SchemeOptions& o,
              const std::vector<std::vector<double>>& series, double t_end) {
  const Scheme scheme = make_scheme(name, s.model, o);
  const double half = Dimer{}.half;
  State state = s.state;
  double worst = 0;
  for (const std::vector<double>& row : series) {
    if (row[0] > t_end) break;
    while (state.t < row[0] - 1e-12) {
      const StepReport report = scheme.step(state, row[0] - state.t);
      EXPECT_TRUE(report.ok()) << name << ": " << report.reason << " at t = " << state.t;
      if (!report.ok()) return kInf;
    }
    const Vec3 q = dimer_pose(s, state);
    for (const double side : {-half, half})
      worst = std::max(worst, std::hypot(q[0] + side * std::cos(q[2]) - row[1] - side * std::cos(row[3]),
                                         q[1] + side * std::sin(q[2]) - row[2] - side * std::sin(row[3])));
  }
  return worst;
}

TEST(DimerC4, FollowsTheReferenceThroughItsImpacts) {
  const auto series = reference_series("dimer_drop.csv");
  if (series.empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder with references/dimer_drop.csv";
  const CaseScene s = dimer_drop();
  EXPECT_LT(off_by(s, "event_driven", options(1e-3), series, 0.2), 1e-6);  // the series is right to 2e-5
  EXPECT_LT(off_by(s, "moreau_jean", options(1e-4), series, 0.1), 1e-4);
  EXPECT_LT(off_by(s, "moreau_jean", options(1e-5), series, 0.1), 1e-5);
}

TEST(DimerC4, FollowsTheReferenceOnAVibratingPlate) {
  const auto series = reference_series("dimer_vibrated.csv");
  if (series.empty()) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder with references/dimer_vibrated.csv";
  const CaseScene s = dimer_on_vibrating_plate(0.9 * 9.81, 0.41);
  EXPECT_LT(off_by(s, "event_driven", options(1e-3), series, 0.09), 1e-5);  // rattles to rest from 0.07 s on
  EXPECT_LT(off_by(s, "moreau_jean", options(1e-4), series, 0.4), 1e-4);
  EXPECT_LT(off_by(s, "moreau_jean", options(2e-5), series, 0.4), 2e-5);
}

// By energy and geometry alone: it falls without turning until the lower end touches, at 54.53 ms; then both
// contacts couple.
TEST(DimerC4, TouchesWhenItsLowerEndIsDown) {
  const CaseScene s = dimer_drop();
  const Dimer d;
  const double t = std::sqrt(2 * (0.02 - d.half * std::sin(0.3) - d.radius) / 9.81);
  const Scheme scheme = make_scheme("event_driven", s.model, options(0.07));
  State state = s.state;
  const StepReport report = scheme.step(state, kInf);
  ASSERT_TRUE(report.ok()) << report.reason;
  ASSERT_EQ(report.events.size(), 2U);
  EXPECT_NEAR(report.events[0].t, t, 1e-9);
  EXPECT_NEAR(report.events[0].t, 0.05453325, 1e-6);
  EXPECT_NEAR(report.events[1].t, 0.0651325, 1e-6);  // the other end, of the shared series
}

// Below 1 g the plate never throws it: it comes to rest and does not drift. Sign and place of where it stops.
TEST(DimerC4, ComesToRestOnAPlateBelowGravity) {
  const CaseScene s = dimer_on_vibrating_plate(0.9 * 9.81, 0.61);
  const Scheme scheme = make_scheme("moreau_jean", s.model, options(1e-4));
  State state = s.state;
  double at = 0;
  while (state.t < 0.6) {
    ASSERT_TRUE(scheme.step(state, 0.6 - state.t).ok());
    if (state.t < 0.2 + 1e-9) at = dimer_pose(s, state)[0];
  }
  EXPECT_NEAR(at, 2.14e-4, 2e-5);
  EXPECT_NEAR((dimer_pose(s, state)[0] - at) / 0.4, 0, 1e-6);  // mean speed [m/s]
}

// C5. The minima of the distance, looked at along a path of the rod and back.
ContactSet contacts_at(const MoreauJean& scheme, const CaseScene& s, double x, double z) {
  State state = s.state;
  pose(state, s.body).p += Vec3(x, 0, z);
  return scheme.contacts(state, 0.05);
}

void expect_same(const ContactSet& a, const ContactSet& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(key_of(a.points[i]), key_of(b.points[i]));
    EXPECT_NEAR(a.points[i].gap, b.points[i].gap, 1e-12);
    EXPECT_LT((a.points[i].normal - b.points[i].normal).norm(), 1e-12);
  }
}

// Asked at one pose after the other, forward and backward, by those who remember what they saw: candidates
// kept from query to query, and a step that has the impulses of the last one.
TEST(DimerC5, ContactSetIsAFunctionOfThePose) {
  const CaseScene s = dimer_and_rod(0, 1e-3, 0);
  const StepOptions o{.h = 1e-3, .advancement = {.certify = false}};
  const StepSetting keeps = step_setting(s.model, o);
  std::vector<std::pair<double, double>> path;
  for (int k = -60; k <= 60; ++k) path.emplace_back(1e-3 * k, 0.012);  // above the balls
  for (int k = 0; k <= 40; ++k) path.emplace_back(0, 1e-3 * (12 - 0.3 * k));
  const std::size_t count = path.size();
  for (std::size_t k = count; k-- > 0;) path.push_back(path[k]);
  Estimate ahead{.v = VecX::Zero(s.state.v.size()), .meeting = {}};
  ahead.v[6 * s.body + 2] = -40;  // 50 mm in a step, enlarged
  ContactMemory memory;
  std::vector<ContactSet> forward;
  std::size_t found = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    SCOPED_TRACE(k);
    State state = s.state;
    pose(state, s.body).p += Vec3(path[k].first, 0, path[k].second);
    const StepSetting begins = step_setting(s.model, o);
    const ContactSet fresh = contacts_within(begins, state, 0.05);
    if (k < count)
      forward.push_back(fresh);
    else
      expect_same(fresh, forward[2 * count - 1 - k]);
    const Found alone = find_ahead(begins, state, ahead, o.h);
    state.memory = memory;
    const Found there = find_ahead(keeps, state, ahead, o.h);
    expect_same(there.contacts, alone.contacts);
    std::vector<StepPair> pairs = there.pairs;
    for (StepPair& pair : pairs) pair.threshold = 0.05, pair.rotation = 0;
    expect_same(contacts_of(s.model, state, pairs, keeps.options.lmd, *keeps.scratch), fresh);
    memory = remember(there.contacts, std::vector<Vec3>(there.contacts.points.size(), Vec3(0, 0.1, 1)),
                      {.g = there.g});
    found += there.contacts.points.size();
  }
  EXPECT_GT(found, 600U);
}

// Two sides and the bar: three minima wherever the rod's end is above the bar.
TEST(DimerC5, ThreeContactsBetweenTheBalls) {
  const CaseScene s = dimer_and_rod(0, 1e-3, 0);
  const MoreauJean scheme(s.model, {.h = 1e-3});
  for (int k = -24; k <= 24; ++k)
    EXPECT_EQ(contacts_at(scheme, s, 1e-3 * k, 0.012).points.size(), 3U) << k << " mm";
}

// Each gap is C1 along the path: its difference is the normal velocity.
TEST(DimerC5, GapsAreSmooth) {
  const CaseScene s = dimer_and_rod(0, 1e-3, 0);
  const MoreauJean scheme(s.model, {.h = 1e-3});
  const double d = 1e-6;
  int compared = 0;
  for (int k = -240; k <= 240; ++k) {
    const double x = 1e-4 * k;
    const ContactSet before = contacts_at(scheme, s, x - d, 0.012), now = contacts_at(scheme, s, x, 0.012),
                     after = contacts_at(scheme, s, x + d, 0.012);
    ASSERT_EQ(before.points.size(), now.points.size());
    ASSERT_EQ(after.points.size(), now.points.size());
    for (std::size_t i = 0; i < now.points.size(); ++i) {
      const ContactPoint& c = now.points[i];
      const double along = c.normal.x() * (c.a.body == s.body ? 1 : -1);
      EXPECT_NEAR((after.points[i].gap - before.points[i].gap) / (2 * d), along, 1e-6) << x;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

// How deep the rod is in balls and bar, from points and segments alone [m].
double depth(const CaseScene& s, const State& state) {
  const SE3& g = pose(state, s.body);
  const Vec3 rod[] = {g * Vec3(-kPushedRodLength / 2, 0, 0), g * Vec3(kPushedRodLength / 2, 0, 0)};
  const Vec3 bar[] = {Vec3(-kBallPlace, 0, 0), Vec3(kBallPlace, 0, 0)};
  double gap = closest_points(rod, bar).distance - kPushedRodRadius - kBarRadius;
  for (const Vec3& ball : bar) {
    const Vec3 along = rod[1] - rod[0];
    const double part = std::clamp((ball - rod[0]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    gap = std::min(gap, (ball - rod[0] - part * along).norm() - kPushedRodRadius - kBallRadius);
  }
  return -gap;
}

class EverySchemeAndRod : public ::testing::TestWithParam<std::string> {};

// Pushed in at 0.1 m/s beside the flank of a ball: over it, down to the bar, no deeper than h v. Any saved
// state leads to the same bits.
TEST_P(EverySchemeAndRod, StaysOutsideAndRestartsFromAnyState) {
  const double h = 1e-3, v = 0.1;
  const CaseScene s = dimer_and_rod(0.018, 0.012, v);
  const Scheme scheme = make_scheme(GetParam(), s.model, options(h));
  std::vector<State> saved = {s.state};
  bool ball = false, bar = false;
  for (int k = 0; k < 250; ++k) {
    State next = saved.back();
    const StepReport report = scheme.step(next, kInf);
    ASSERT_TRUE(report.ok()) << report.reason << " at t = " << next.t;
    for (const StepContact& c : report.contacts) {
      if (c.impulse.norm() == 0) continue;
      ball = ball || std::min(c.point.a.body, c.point.b.body) == 0;
      bar = bar || std::min(c.point.a.body, c.point.b.body) == 1;
    }
    EXPECT_LT(depth(s, next), h * v) << "t = " << next.t;
    saved.push_back(next);
  }
  EXPECT_TRUE(ball);
  EXPECT_TRUE(bar);
  for (const std::size_t from : {0U, 1U, 50U, 100U, 125U, 150U, 249U}) {
    const Scheme fresh = make_scheme(GetParam(), s.model, options(h));
    State state = saved[from];
    for (std::size_t k = from; k + 1 < saved.size() && k < from + 60; ++k) {
      ASSERT_TRUE(fresh.step(state, kInf).ok());
      ASSERT_EQ(hash(state), hash(saved[k + 1])) << "from " << from << " to " << k + 1;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Schemes, EverySchemeAndRod, ::testing::ValuesIn(scheme_names()),
                         [](const auto& name) { return name.param; });

}  // namespace
}  // namespace aussois
