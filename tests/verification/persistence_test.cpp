// SPDX-License-Identifier: Apache-2.0
// Tests T-4.5 and T-4.7 of the specification of persistence: what a warm start saves, and that it has one
// result.
#include <algorithm>

#include <Eigen/Geometry>

#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"

namespace aussois {
namespace {

/// Ten prisms of eight corners on a plate, every other turned by an eighth of the pitch: sixteen contacts
/// between two of them.
Scene stack_of_ten() {
  Scene s;
  s.model.contact_law = {.mu = 0.5, .restitution = 0};
  std::vector<Vec2> octagon;
  for (int i = 0; i < 8; ++i) octagon.push_back({0.05 * std::cos(kPi * i / 4), 0.05 * std::sin(kPi * i / 4)});
  const SimplicialComplex prism = make_extrusion(octagon, 0.05);
  const int plate = add(s.model, prepare(dilate(make_plate(1, 1), kRadius)));
  const int shape = add(s.model, prepare(dilate(prism, kRadius)));
  s.ground = add(s.model, fixed_body("ground", plate));
  for (int i = 0; i < 10; ++i)
    s.block = add(s.model, solid_body("box " + std::to_string(i), shape, mass_properties(prism, kDensity)));
  s.state = rest_state(s.model);
  for (int i = 0; i < 10; ++i)
    pose(s.state, i + 1) = translation(0, 0, 0.025 + 0.05 * i + 2 * kRadius * (i + 1)) *
                           rotation(Vec3::UnitZ(), i % 2 ? kPi / 8 : 0.0);
  return s;
}

/// Every other contact of a cluster by angle about its middle, which half depends on `odd`.
ContactSelector every_other(bool odd) {
  return [odd](const ReductionInput& input, const Clusters& clusters) {
    std::vector<int> kept;
    for (const std::vector<int>& cluster : clusters) {
      Vec3 middle = Vec3::Zero();
      for (const int i : cluster)
        middle += input.contacts.points[std::size_t(i)].x_a / double(cluster.size());
      std::vector<int> order = cluster;
      std::ranges::sort(order, {}, [&](int i) {
        const Vec3 d = input.contacts.points[std::size_t(i)].x_a - middle;
        return std::atan2(d.y(), d.x());
      });
      for (std::size_t k = odd ? 1 : 0; k < order.size(); k += 2) kept.push_back(order[k]);
    }
    return kept;
  };
}

/// Sweeps of 60 steps at rest, after 60 to come to rest; the selection changes every ten steps, or never.
int sweeps(const PersistenceOptions& persistence, bool switching) {
  Scene s = stack_of_ten();
  int total = 0;
  for (int step = 0; step < 120; ++step) {
    MoreauJeanOptions options{
        .h = 1e-3, .persistence = persistence, .solver = {.method = Method::nsgs, .tolerance = 1e-8}};
    if (switching)
      options.reduction = {.reducer = Reducer::selector, .selector = every_other(step / 10 % 2 == 1)};
    const MoreauJean scheme(s.model, options);
    const StepReport report = scheme.step(s.state);
    EXPECT_TRUE(report.ok()) << report.reason;
    if (step >= 60) total += report.solve.iterations;
  }
  return total;
}

// T-4.5
TEST(WarmStart, SavesSweepsOfAStackAtRest) {
  const PersistenceOptions cold{.matching = Matching::none};
  for (const bool switching : {false, true}) {
    const int without = sweeps(cold, switching), with = sweeps({}, switching);
    const std::string name = switching ? "switching" : "resting";
    ::testing::Test::RecordProperty(name + "_cold", without);
    ::testing::Test::RecordProperty(name + "_warm", with);
    EXPECT_GE(without, (switching ? 3 : 5) * with) << name;
    if (switching)
      ::testing::Test::RecordProperty("switching_without_redistribution",
                                      sweeps({.redistribute = false}, true));
  }
}

// T-4.7
TEST(Anchors, GiveTheSameBitsForAnyThreadsAndAFreshScheme) {
  Scene s = block_on_plate(0.5, 0, std::atan(0.45), 1e-3);
  const auto run_with = [&](int threads, bool fresh) {
    const MoreauJeanOptions options{.h = 1e-3, .persistence = {.anchors = true}, .threads = threads};
    const MoreauJean scheme(s.model, options);
    State state = s.state;
    for (int step = 0; step < 200; ++step) {
      const StepReport report = fresh ? MoreauJean(s.model, options).step(state) : scheme.step(state);
      EXPECT_TRUE(report.ok()) << report.reason;
    }
    const auto& contacts = state.memory.contacts;
    EXPECT_TRUE(std::ranges::any_of(contacts, [](const RememberedContact& c) { return c.held; }));
    return hash(state);
  };
  const std::uint64_t reference = run_with(1, false);
  EXPECT_EQ(run_with(3, false), reference);
  EXPECT_EQ(run_with(1, true), reference);
}

TEST(Anchors, LetGoOfWhatSlidesAndOpens) {
  Scene s = block_on_plate(0.3, 0, std::atan(0.45));
  const MoreauJean with(s.model, {.h = 1e-3, .persistence = {.anchors = true}}),
      without(s.model, {.h = 1e-3});
  State a = s.state, b = s.state;
  for (int step = 0; step < 100; ++step) {
    ASSERT_TRUE(with.step(a).ok() && without.step(b).ok());
    for (const RememberedContact& c : a.memory.contacts) EXPECT_EQ(c.held && step > 1, false) << "it slides";
  }
  EXPECT_LT((a.g[std::size_t(s.block)].p - b.g[std::size_t(s.block)].p).norm(), 1e-9);
}

TEST(Anchors, AreRefusedBySchemesWithoutThem) {
  const Scene s = block_on_plate(0.5, 0, 0);
  for (const std::string& name : scheme_names()) {
    SchemeOptions options{.persistence = {.anchors = true}};
    if (name == "schatzman_paoli") options.normal.law = NormalLaw::gap_over_step;
    if (name.starts_with("moreau_jean"))
      EXPECT_NO_THROW(make_scheme(name, s.model, options)) << name;
    else
      EXPECT_THROW(make_scheme(name, s.model, options), std::invalid_argument) << name;
  }
}

}  // namespace
}  // namespace aussois
