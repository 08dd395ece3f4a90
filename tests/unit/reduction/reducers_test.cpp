// SPDX-License-Identifier: Apache-2.0
// Every reducer against its promise, against brute force, and on what is not a patch at all. T_3_n: see
// doc/theory/reduction.md; the figures of T_3_1 are those of its table.
#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "reduction/direction_set.hpp"
#include "reduction/extreme_points.hpp"
#include "reduction/hull_area_loss.hpp"
#include "reduction/hull_exact.hpp"
#include "reduction/learned_selector.hpp"
#include "reduction/load_carrier.hpp"
#include "reduction/mean_contacts.hpp"
#include "reduction/reduce.hpp"
#include "reduction/wrench_cone.hpp"
#include "tests/support/flat_contacts.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

std::vector<Vec2> ring(int n, double turn = 0) {
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i)
    points.push_back({std::cos(2 * kPi * i / n + turn), std::sin(2 * kPi * i / n + turn)});
  return points;
}
std::vector<Vec2> disc_points() {  // 48 on the rim, some inside
  std::vector<Vec2> points = ring(48);
  Random random(3);
  for (int i = 0; i < 60; ++i) points.push_back(Vec2{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)});
  return points;
}
std::vector<Vec2> normal_points(Random& random, int n) {  // by Box and Muller
  std::vector<Vec2> points;
  for (int i = 0; i < n; ++i) {
    const double radius = std::sqrt(-2 * std::log(1 - random.uniform(0, 1)));
    const double angle = random.uniform(0, 2 * kPi);
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return points;
}
std::vector<Vec2> l_shape() {  // arms as wide as a fifth of their length
  return {{0, 0}, {1, 0}, {0, 1}, {0.2, 1}, {1, 0.2}, {0.2, 0.2}};
}

using PatchRule = std::function<std::vector<int>(const PlanarPatch&)>;
struct Figures {
  double area = 0, margin = 0, kept = 0;
};
Figures figures(const PatchRule& rule, const std::vector<Vec2>& points) {
  const PlanarPatch patch = planar_patch(points);
  const std::vector<int> kept = rule(patch);
  const LossReport loss = loss_of(patch, kept);
  return {loss.area, loss.margin, double(kept.size())};
}
Figures mean_of_random(const PatchRule& rule) {
  Random random(1);
  Figures mean;
  const int trials = 1000;
  for (int i = 0; i < trials; ++i) {
    const Figures one = figures(rule, normal_points(random, 40));
    mean.area += one.area / trials;
    mean.margin += one.margin / trials;
    mean.kept += one.kept / trials;
  }
  return mean;
}
constexpr double kAny = -kInf;
void expect_near(const Figures& found, double area, double margin, double kept, const char* what) {
  EXPECT_NEAR(found.area, area, 0.02) << what;
  if (margin != kAny) {
    EXPECT_NEAR(found.margin, margin, 0.02) << what;
  }
  EXPECT_NEAR(found.kept, kept, 0.1) << what;
}
// One row of the table: {area, margin, kept} of each family; a margin of kAny is that of another test.
void expect_row(const PatchRule& rule, const Figures& disc, const Figures& aligned,
                const Figures& rotated_one, const Figures& random, const Figures& l) {
  const auto expect = [](const Figures& found, const Figures& row, const char* what) {
    expect_near(found, row.area, row.margin, row.kept, what);
  };
  expect(figures(rule, disc_points()), disc, "disc");
  expect(figures(rule, grid(6, 4, 0.3, 0.1)), aligned, "rectangle, aligned");
  expect(figures(rule, rotated(grid(6, 4, 0.3, 0.1), 0.3)), rotated_one, "rectangle, rotated");
  expect(mean_of_random(rule), random, "40 random points");
  expect(figures(rule, l_shape()), l, "L");
}

TEST(ReducerTable, T_3_1_FourExtremesAsPublished) {
  expect_row([](const PlanarPatch& p) { return extreme_points(p, 0, true); }, {.64, .71, 4}, {.50, 0, 3},
             {1, 1, 4}, {.74, .53, 3.9}, {.74, .52, 3});
}
TEST(ReducerTable, T_3_1_FourExtremesWithTheTieRule) {
  expect_row([](const PlanarPatch& p) { return extreme_points(p, 1e-9); }, {.64, .71, 4}, {1, 1, 4},
             {1, 1, 4}, {.74, .53, 3.9}, {.88, .65, 4});
}
// On a disc all triangles are equal and rounding chooses.
TEST(ReducerTable, T_3_1_LeastAreaRemovedToFour) {
  expect_row([](const PlanarPatch& p) { return least_area_removed(p, 4); }, {.60, kAny, 4}, {1, 1, 4},
             {1, 1, 4}, {.83, .64, 4}, {.88, .65, 4});
}
TEST(ReducerTable, T_3_1_LeastAreaRemovedToSix) {
  expect_row([](const PlanarPatch& p) { return hull_area_loss(p, 6); }, {.80, kAny, 6}, {1, 1, 4}, {1, 1, 4},
             {.98, .93, 6}, {1, 1, 5});
}
// Which of the equal ones goes first decides: corners off by 1e-12 give any margin between.
TEST(ReducerTable, T_3_1_OnADiscRoundingChoosesAmongEqualTriangles) {
  for (const auto& [corners, lowest, highest] : {std::tuple{4, 0.32, 0.66}, std::tuple{6, 0.66, 0.83}}) {
    double least = 1, most = 0;
    Random random(31);
    for (int trial = 0; trial < 2000; ++trial) {
      std::vector<Vec2> points = ring(48);
      for (Vec2& x : points) x *= 1 + 1e-12 * random.uniform(-1, 1);
      const double margin =
          figures([n = corners](const PlanarPatch& p) { return least_area_removed(p, n); }, points).margin;
      least = std::min(least, margin), most = std::max(most, margin);
    }
    EXPECT_NEAR(least, lowest, 0.02) << corners;
    EXPECT_NEAR(most, highest, 0.02) << corners;
  }
}
// No eight points of a disc do better than .900 and .924.
TEST(ReducerTable, T_3_1_BestMarginOfEight) {
  expect_row([](const PlanarPatch& p) { return hull_margin(p, {.margin = 1, .max_corners = 8}); },
             {.90, .92, 8}, {1, 1, 4}, {1, 1, 4}, {1, .99, 7.3}, {1, 1, 5});
}
// Greedy removal is not the best of four: the largest quadrilateral of a disc is a square.
TEST(ReducerTable, T_3_1_LargestQuadrilateralOfADiscIsASquare) {
  const Figures found = figures([](const PlanarPatch& p) { return hull_area_loss(p, 4); }, disc_points());
  expect_near(found, 2 / kPi, std::sqrt(0.5), 4, "disc");
}

// k-means takes what is inside for as much as the rim, so its figures are those of these points. The oracle
// is Lloyd's iteration as textbooks have it, from starts of its own.
using Means = std::function<std::vector<Vec2>(const std::vector<Vec2>& points, int k, std::uint64_t seed)>;
std::vector<Vec2> our_means(const std::vector<Vec2>& points, int k, std::uint64_t seed) {
  const MatX centres = mean_contacts(flat(points), {}, {}, {.k = k, .seeding = SeedRandom{seed}}).centres;
  std::vector<Vec2> out;
  for (const auto& centre : centres.colwise()) out.push_back(centre.head<2>());
  return out;
}
std::vector<Vec2> lloyds_means(const std::vector<Vec2>& points, int k, std::uint64_t seed) {
  Random random(seed + 1000);
  std::vector<Vec2> centres;
  while (int(centres.size()) < k) {
    const Vec2& next = points[std::size_t(random.uniform(0, double(points.size())))];
    if (std::ranges::find(centres, next) == centres.end()) centres.push_back(next);
  }
  for (std::vector<Vec2> last; last != centres;) {
    last = centres;
    std::vector<Vec2> sum(centres.size(), Vec2::Zero());
    std::vector<int> count(centres.size(), 0);
    for (const Vec2& x : points) {
      const auto nearest = std::ranges::min_element(last, {}, [&](const Vec2& c) { return (c - x).norm(); });
      sum[std::size_t(nearest - last.begin())] += x;
      ++count[std::size_t(nearest - last.begin())];
    }
    for (std::size_t c = 0; c < centres.size(); ++c)
      if (count[c] > 0) centres[c] = sum[c] / count[c];
  }
  return centres;
}
Figures figures_of_means(const std::vector<Vec2>& points, const std::vector<Vec2>& centres) {
  std::vector<Vec2> all = points;  // the means stand beside them, inside: the hull remains
  std::vector<int> part;
  for (const Vec2& centre : centres) {
    part.push_back(int(all.size()));
    all.push_back(centre);
  }
  const LossReport loss = loss_of(planar_patch(all), part);
  return {loss.area, loss.margin, double(part.size())};
}
template <class Points>
Figures mean_of_means(int k, const Points& points, const Means& means) {
  Figures mean;
  constexpr int kTrials = 400;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const std::vector<Vec2> all = points(seed);
    const Figures one = figures_of_means(all, means(all, k, seed));
    mean.area += one.area / kTrials, mean.margin += one.margin / kTrials, mean.kept += one.kept / kTrials;
  }
  return mean;
}
std::vector<Vec2> filled_disc() {
  std::vector<Vec2> points = ring(48);
  constexpr int kInside = 400;  // by the golden angle, evenly
  for (int i = 0; i < kInside; ++i) {
    const double radius = std::sqrt((i + 0.5) / kInside), angle = i * kPi * (3 - std::sqrt(5.0));
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return points;
}
void expect_means(int k, const Figures& disc, const Figures& aligned, const Figures& rotated_one,
                  const Figures& random, const Figures& l) {
  const auto expect = [&](const Figures& row, const char* what, const auto& points) {
    const Figures ours = mean_of_means(k, points, our_means), lloyds = mean_of_means(k, points, lloyds_means);
    expect_near(ours, row.area, row.margin, row.kept, what);
    expect_near(ours, lloyds.area, lloyds.margin, lloyds.kept, what);
  };
  expect(disc, "disc", [](std::uint64_t) { return filled_disc(); });
  expect(aligned, "rectangle, aligned", [](std::uint64_t) { return grid(6, 4, 0.3, 0.1); });
  expect(rotated_one, "rectangle, rotated", [](std::uint64_t) { return rotated(grid(6, 4, 0.3, 0.1), 0.3); });
  expect(random, "40 random points", [](std::uint64_t seed) {
    Random numbers(seed);
    return normal_points(numbers, 40);
  });
  expect(l, "L", [](std::uint64_t) { return l_shape(); });
}
TEST(ReducerTable, T_3_1_MeansOfThreeClusters) {
  expect_means(3, {.14, .29, 3}, {.06, .06, 3}, {.06, .06, 3}, {.12, .14, 3}, {.50, .60, 3});
}
TEST(ReducerTable, T_3_1_MeansOfFourClusters) {
  expect_means(4, {.26, .44, 4}, {.21, .20, 4}, {.21, .20, 4}, {.22, .24, 4}, {.72, .75, 4});
}

TEST(ReducerTable, T_3_2_ASquareOfFourCornersKeepsThemAndThePaperLosesOne) {
  const ContactSet square = flat({{0, 0}, {1, 0}, {0, 1}, {1, 1}});
  for (const std::string& name : reducer_names()) {
    if (name == "selector") continue;
    ReductionOptions options{.reducer = reducer(name)};
    if (name != "none") options.min_per_cluster = 1;
    const Selection kept = reduce(square, options);
    EXPECT_EQ(kept.kept, (std::vector<int>{0, 1, 2, 3})) << name;
  }
  const Selection paper =
      reduce(square, {.reducer = Reducer::extreme_points, .min_per_cluster = 1, .paper_exact = true});
  EXPECT_LT(paper.kept.size(), 4u);
  EXPECT_LE(paper.loss.margin, 1e-12);
}

// Three bodies whose torques a learned selector can tell apart.
PerBody<BodyLoad> loads() {
  PerBody<BodyLoad> out(3);
  for (BodyLoad& load : out) load.wrench.tail<3>() << 0.3, -0.2, double(&load - out.data());
  return out;
}
// Eight places of body 0 and a network of random weights, which looks at what stands in the body's frame:
// then it does not see that a scene is turned.
ContactSelector learned() {
  Random random(5);
  LearnedSelector out;
  Network& n = out.network;
  n.mean = VecX::Zero(kLoadInputs), n.scale = VecX::Ones(kLoadInputs);
  n.W1 = MatX::Zero(6, kLoadInputs), n.b1 = VecX::Zero(6), n.W2 = MatX::Zero(8, 6), n.b2 = VecX::Zero(8);
  for (double& w : n.W1.rightCols<3>().reshaped()) w = random.uniform(-1, 1);  // torque, in the body
  for (double& w : n.W2.reshaped()) w = random.uniform(-1, 1);
  for (int i = 0; i < 8; ++i)
    out.places.push_back(0.7 * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
  return contact_selector(out, 0);
}

// What any reducer is asked here: contacts with impulses and friction.
struct Known {
  ContactSet set{};
  std::vector<Vec3> impulse{};
  std::vector<double> mu{};
  std::vector<char> kept_before{};
  PerBody<BodyLoad> bodies = loads();
  ReductionInput input() const {
    return {.contacts = set, .kept_before = kept_before, .impulse = impulse, .mu = mu, .bodies = bodies};
  }
};
Known random_contacts(Random& random, int n, double mu) {
  const Vec3 normals[] = {Vec3::UnitX(), Vec3(0, 0.6, 0.8), -Vec3::UnitX()};
  Known k;
  for (int i = 0; i < n; ++i) {
    const Vec3 normal = normals[random.index(3)];
    const Vec3 at{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    add(k.set, at, normal, i % 3 == 0 ? 0 : random.uniform(0, 1e-4));
    k.set.points.back().b.body = BodyId(1) + random.index(2);
    const bool before = random.index(3) == 0;
    k.kept_before.push_back(before);
    k.impulse.push_back(before ? Vec3(random.uniform(0, 1) * normal) : Vec3::Zero());
    k.mu.push_back(mu);
  }
  return k;
}

class EveryReducer : public ::testing::TestWithParam<std::string> {
 protected:
  ReductionOptions options() const {
    return {.reducer = reducer(GetParam()), .selector = is_learned() ? learned() : ContactSelector{}};
  }
  bool is_learned() const { return GetParam() == "selector"; }
  Selection reduced(const ContactSet& set) const {
    return reduce({.contacts = set, .bodies = loads()}, options());
  }
};

TEST_P(EveryReducer, T_3_3_DoesNotDependOnTheOrderOfTheSet) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Known known = random_contacts(random, 60, 0.3);
    std::vector<std::size_t> order(60);
    for (std::size_t i = 0; i < 60; ++i) order[i] = i;
    for (std::size_t i = 59; i > 0; --i) std::swap(order[i], order[random.index(int(i) + 1)]);
    Known shuffled;
    for (const std::size_t i : order) {
      shuffled.set.points.push_back(known.set.points[i]);
      shuffled.impulse.push_back(known.impulse[i]);
      shuffled.mu.push_back(known.mu[i]);
      shuffled.kept_before.push_back(known.kept_before[i]);
    }
    shuffled.bodies = known.bodies;
    const Selection a = reduce(known.input(), options()), b = reduce(shuffled.input(), options());
    std::vector<int> back;
    for (const int i : b.kept) back.push_back(int(order[i]));
    std::sort(back.begin(), back.end());
    ASSERT_EQ(a.kept, back) << "seed " << seed;
    EXPECT_EQ(a.loss.margin, b.loss.margin);  // bit for bit
    EXPECT_EQ(a.loss.torsion, b.loss.torsion);
    EXPECT_EQ(a.kept.size() < 60u, GetParam() != "none");  // the sample is not hollow
  }
}

// Without poses, so the wrench cone is asked without friction; with both it is below.
TEST_P(EveryReducer, T_3_3_MovesWithTheBodies) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    Known known = random_contacts(random, 60, 0);
    const Selection a = reduce(known.input(), options());
    const SE3 turn{random.rotation(), random.vector(1)};
    known.set = moved(known.set, turn.R, turn.p);
    for (Vec3& r : known.impulse) r = turn.R * r;
    for (BodyLoad& load : known.bodies) load.g_wb = turn * load.g_wb;
    EXPECT_EQ(reduce(known.input(), options()).kept, a.kept) << "seed " << seed;
  }
}

// Patches without a principal direction: a disc and a square take their axis from body A, so that the choice
// is that of the relative pose, whatever the scene is turned by.
TEST_P(EveryReducer, T_3_3_MovesWithTheBodiesOnADiscAndASquare) {
  std::vector<Vec2> disc = ring(48, 0.02);
  const std::vector<Vec2> inner = ring(16, 0.3);
  for (const Vec2& x : inner) disc.push_back(0.5 * x);
  int by_the_world = 0;
  for (const std::vector<Vec2>& points : {disc, grid(7, 7, 1, 1)})
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
      Random random(seed);
      const Quat R = random.rotation();
      const ContactSet set = moved(flat(points), R, random.vector(1));
      std::vector<SE3> g = {{random.rotation(), random.vector(1)}, {random.rotation(), random.vector(1)}};
      const std::vector<double> mu(points.size(), 0.3);
      const auto kept = [&](const ContactSet& contacts, std::span<const SE3> poses) {
        PerBody<BodyLoad> bodies = loads();
        for (std::size_t b = 0; b < poses.size(); ++b) bodies[BodyId::at(b)].g_wb = poses[b];
        return reduce({.contacts = contacts, .mu = mu, .g = poses, .bodies = bodies}, options()).kept;
      };
      const std::vector<int> before = kept(set, g), before_by_the_world = kept(set, {});
      const SE3 turn{random.rotation(), random.vector(1)};
      const ContactSet turned = moved(set, turn.R, turn.p);
      for (SE3& pose : g) pose = turn * pose;
      ASSERT_EQ(kept(turned, g), before) << "seed " << seed;
      by_the_world += kept(turned, {}) != before_by_the_world;
    }
  // The sample is not hollow: by axes of the world those that look along an axis choose otherwise.
  const bool chooses = is_learned() || GetParam() == "extreme_points" || GetParam() == "hull_area_loss" ||
                       GetParam() == "direction_set" || GetParam() == "wrench_cone";
  EXPECT_EQ(by_the_world > 5, chooses) << by_the_world;
}

TEST_P(EveryReducer, T_3_3_TakesNoDuplicates) {
  if (GetParam() == "none") return;
  std::vector<Vec2> points = rotated(grid(6, 4, 0.3, 0.1), 0.3);
  const std::vector<int> once = reduced(flat(points)).kept;
  const std::vector<Vec2> again = points;
  points.insert(points.end(), again.begin(), again.end());
  EXPECT_EQ(reduced(flat(points)).kept, once);
}

TEST_P(EveryReducer, T_3_4_KeepsTheTwoEndsOfALine) {
  if (GetParam() == "none") return;
  std::vector<Vec2> points;
  for (const int i : {3, 0, 7, 5, 9, 1, 2, 8, 4, 6}) points.push_back({0.6 * i, -0.8 * i});
  ContactSet set = flat(points);
  set.points[1].gap = -1e-6;  // an end is the deepest
  const Selection selection = reduced(set);
  if (is_learned()) {  // it promises no ends, but the deepest, three places at most, and the truth about them
    EXPECT_TRUE(std::ranges::binary_search(selection.kept, 1));
    EXPECT_LE(selection.kept.size(), 4u);
    EXPECT_EQ(selection.loss.margin, measure_loss(set, selection).margin);
    EXPECT_LT(selection.loss.margin, 1);
    return;
  }
  EXPECT_EQ(selection.kept, (std::vector<int>{1, 4}));
  EXPECT_NEAR(selection.loss.margin, 1, 1e-12);
  EXPECT_EQ(selection.loss.area, 1);
}

TEST_P(EveryReducer, T_3_5_TakesWhatIsNoPatch) {
  EXPECT_TRUE(reduced(ContactSet{}).kept.empty());
  EXPECT_EQ(reduced(flat({{1, 2}})).kept, (std::vector<int>{0}));
  const ContactSet one_place = flat(std::vector<Vec2>(9, Vec2(0.3, -0.7)));
  const Selection selection = reduced(one_place);
  EXPECT_EQ(selection.kept.size(), GetParam() == "none" ? 9u : 1u);
  EXPECT_EQ(selection.kept.front(), 0);
  EXPECT_EQ(selection.loss.margin, 1);
  ContactSet bad = flat(grid(6, 4, 1, 1));
  bad.points[3].x_a.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message_of([&] { reduced(bad); }).find("contact 3"), std::string::npos);
}

TEST_P(EveryReducer, KeepsTheDeepestOfEveryCluster) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Known known = random_contacts(random, 60, 0.3);
    const Selection selection = reduce(known.input(), options());
    EXPECT_EQ(selection.loss.depth, 0);
    std::vector<double> deepest(std::size_t(selection.cluster_count), kInf), kept = deepest;
    for (std::size_t i = 0; i < 60; ++i) {
      double& gap = deepest[selection.cluster[i]];
      gap = std::min(gap, known.set.points[i].gap);
    }
    for (const int i : selection.kept) {
      double& gap = kept[selection.cluster[i]];
      gap = std::min(gap, known.set.points[i].gap);
    }
    EXPECT_EQ(kept, deepest);
  }
}

TEST_P(EveryReducer, MeetsTheMarginDemanded) {
  if (GetParam() == "none") GTEST_SKIP() << "it keeps every contact, and takes no margin";
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Known known = random_contacts(random, 60, 0.3);
    ReductionOptions demanding = options();
    for (const double margin : {0.5, 0.95, 1.0}) {
      demanding.min_margin = margin;
      EXPECT_GE(reduce(known.input(), demanding).loss.margin, margin - 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Names, EveryReducer, ::testing::ValuesIn(reducer_names()),
                         [](const auto& name) { return name.param; });

// All choices of `count` corners, by brute force.
double best_margin(const PlanarPatch& patch, std::size_t count) {
  double best = -kInf;
  const std::size_t h = patch.hull.size();
  for (unsigned choice = 0; choice < 1u << h; ++choice) {
    std::vector<int> part;
    for (std::size_t i = 0; i < h; ++i)
      if (choice >> i & 1) part.push_back(patch.hull[i]);
    if (part.size() == count) best = std::max(best, margin_of(patch, part).value);
  }
  return best;
}

TEST(HullMarginRule, IsTheBestOfAllChoicesOfItsSize) {
  int reduced = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const PlanarPatch patch = planar_patch(normal_points(random, 60));
    if (patch.hull.size() > 12) continue;
    for (const double wanted : {0.7, 0.9, 0.99}) {
      const std::vector<int> kept =
          hull_margin(patch, {.margin = wanted, .min_corners = 3, .max_corners = 100});
      const double margin = margin_of(patch, kept).value;
      EXPECT_GE(margin, wanted - 1e-9);
      EXPECT_GE(margin, best_margin(patch, kept.size()) - 1e-3);  // twelve halvings of what is left
      EXPECT_TRUE(kept.size() == 3 || best_margin(patch, kept.size() - 1) < wanted);  // no fewer would do
      reduced += kept.size() < patch.hull.size();
    }
  }
  EXPECT_GT(reduced, 100);
}

TEST(HullMarginRule, KeepsItsBounds) {
  const PlanarPatch patch = planar_patch(ring(100));
  for (const int most : {4, 5, 8, 17}) {
    const std::vector<int> kept = hull_margin(patch, {.margin = 1, .min_corners = 3, .max_corners = most});
    EXPECT_EQ(int(kept.size()), most);
    EXPECT_GE(margin_of(patch, kept).value, std::cos(kPi * std::ceil(100.0 / most) / 100) - 1e-3);
  }
  EXPECT_EQ(hull_margin(patch, {.margin = 0.1, .min_corners = 6}).size(), 6u);
}

TEST(HullAreaLossRule, FindsTheLargestQuadrilateral) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const PlanarPatch patch = planar_patch(normal_points(random, 40));
    const std::size_t h = patch.hull.size();
    double best = 0;
    for (std::size_t a = 0; a < h; ++a)
      for (std::size_t b = 0; b < a; ++b)
        for (std::size_t c = 0; c < b; ++c)
          for (std::size_t d = 0; d < c; ++d) {
            const std::vector<int> four = {patch.hull[a], patch.hull[b], patch.hull[c], patch.hull[d]};
            best = std::max(best, loss_of(patch, four).area);
          }
    ASSERT_GE(h, 4u) << "seed " << seed;
    EXPECT_NEAR(loss_of(patch, largest_quadrilateral(patch)).area, best, 1e-9) << "seed " << seed;
  }
}

TEST(DirectionSet, OfFourIsThatOfExtremesAndADiscKeepsCosine) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const PlanarPatch patch = planar_patch(normal_points(random, 40));
    EXPECT_EQ(direction_set(patch, 4, 1e-9), extreme_points(patch, 1e-9));
  }
  const PlanarPatch disc = planar_patch(ring(240));
  for (const int q : {3, 4, 6, 8, 12})
    EXPECT_NEAR(margin_of(disc, direction_set(disc, q, 0)).value, std::cos(kPi / q), 1e-9) << q;
}

TEST(LoadCarrier, IsATriangleAboutTheCentreOfPressure) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    const PlanarPatch patch = planar_patch(normal_points(random, 40));
    std::vector<double> load(40);
    for (double& f : load) f = random.uniform(0, 1);
    Vec2 centre = Vec2::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < 40; ++i) centre += load[i] * patch.x[i], sum += load[i];
    centre /= sum;
    const std::vector<int> kept = load_carrier(patch, load);
    ASSERT_EQ(kept.size(), 3u);
    Mat3 A;
    for (int k = 0; k < 3; ++k) A.col(k) << patch.x[kept[k]], 1;
    const Vec3 weight = A.inverse() * Vec3(centre.x(), centre.y(), 1);
    EXPECT_GE(weight.minCoeff(), -1e-9);
    // No corner of the hull is outside the circle through the three: the farthest-point triangle.
    const Vec2 a = patch.x[kept[0]], b = patch.x[kept[1]], c = patch.x[kept[2]];
    Mat2 sides;
    sides << (b - a).transpose(), (c - a).transpose();
    const Vec2 middle = sides.inverse() * Vec2((b.squaredNorm() - a.squaredNorm()) / 2,
                                               (c.squaredNorm() - a.squaredNorm()) / 2);
    for (const int i : patch.hull) EXPECT_LE((patch.x[i] - middle).norm(), (a - middle).norm() * (1 + 1e-9));
  }
}

TEST(LoadCarrier, StaysUntilAnotherContactCarries) {
  const PlanarPatch patch = planar_patch(ring(12));
  std::vector<double> load(12, 0);
  EXPECT_EQ(load_carrier(patch, load), hull_exact(patch));  // nothing is known
  EXPECT_EQ(load_carrier(patch, {}), hull_exact(patch));
  load[0] = load[4] = 1, load[7] = 0.5;
  EXPECT_EQ(load_carrier(patch, load), (std::vector<int>{0, 4, 7}));  // not the triangle that it would choose
  load[8] = 0.1;  // it had to help: the load has left the triangle
  const std::vector<int> now = load_carrier(patch, load);
  EXPECT_EQ(now.size(), 3u);
  EXPECT_NE(now, (std::vector<int>{0, 4, 7}));
}

TEST(CheapestCombination, IsThatOfAllVertices) {
  int exists = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    const int n = 8;
    Generators G(3, n);
    VecX cost(n);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < 3; ++i) G(i, j) = random.uniform(-0.3, 1);
      cost[j] = random.uniform(0, 1);
    }
    const Vec3 g{random.uniform(-0.5, 1), random.uniform(-0.5, 1), random.uniform(-0.5, 1)};
    double best = kInf;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < a; ++b)
        for (int c = 0; c < b; ++c) {
          Mat3 B;
          B << G.col(a), G.col(b), G.col(c);
          const Vec3 lambda = B.inverse() * g;
          if (lambda.minCoeff() >= 0) best = std::min(best, lambda.dot(Vec3(cost[a], cost[b], cost[c])));
        }
    const Combination found = cheapest_combination(G, g, cost);
    ASSERT_EQ(found.exists, best < kInf) << "seed " << seed;
    if (!found.exists) {  // a plane that has all generators on one side and g on the other
      EXPECT_GT(found.dual.dot(g), 1e-10);
      EXPECT_LE((found.dual.transpose() * G).maxCoeff(), 1e-9);
      continue;
    }
    ++exists;
    EXPECT_NEAR(found.cost, best, 1e-9);
    EXPECT_NEAR(found.dual.dot(g), best, 1e-9);
    ShortVector sum = Vec3::Zero();
    for (std::size_t k = 0; k < found.column.size(); ++k) sum += found.weight[k] * G.col(found.column[k]);
    EXPECT_LT((sum - g).norm(), 1e-9);
  }
  EXPECT_GT(exists, 50);
  EXPECT_LT(exists, 300);
}

// 500 sets of two to four normals: the certificate of linear programs holds, and so do 10^4 fresh directions
// of wrenches for each.
TEST(WrenchConeRule, T_3_8_KeepsEveryWrenchUpToItsFactor) {
  int dropped = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    Random random(seed);
    std::vector<Vec3> normals(2 + seed % 3);
    for (Vec3& n : normals) n = random.rotation() * Vec3::UnitZ();
    Known known;
    for (int i = 0; i < 16; ++i) {
      const Vec3 at{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      add(known.set, 0.1 * at, normals[std::size_t(i) % normals.size()]);
      known.mu.push_back(seed % 2 ? 0.4 : 0);
    }
    const double loss = seed % 5 ? 0.1 : 0.3;
    const Selection selection = reduce(known.input(), {.reducer = Reducer::wrench_cone, .wrench_loss = loss});
    dropped += 16 - int(selection.kept.size());
    std::vector<int> all(16);
    for (int i = 0; i < 16; ++i) all[i] = i;
    const UnitWrenches wrenches = unit_wrenches(known.input(), all);
    EXPECT_LE(wrench_factor(wrenches, selection.kept), 1 / (1 - loss) + 1e-8) << "seed " << seed;
    MatX d(10000, 6);
    for (double& x : d.reshaped()) x = random.uniform(-1, 1);
    VecX h_all = VecX::Zero(d.rows()), h_kept = h_all;
    for (int m = 0; m < 16; ++m) {
      const int first = wrenches.first[m], end = wrenches.first[std::size_t(m) + 1];
      const VecX reach = (d * wrenches.g.middleCols(first, end - first)).rowwise().maxCoeff();
      h_all = h_all.cwiseMax(reach);
      if (std::ranges::binary_search(selection.kept, m)) h_kept = h_kept.cwiseMax(reach);
    }
    EXPECT_GE((h_kept - (1 - loss) * h_all).minCoeff(), -1e-9) << "seed " << seed;
  }
  EXPECT_GT(dropped, 500);
}

// All normals parallel, no friction: unit wrenches are the points of the plane, and their hull about the
// mean.
// Pyramids of friction turn with body A. Those that stand in the world choose otherwise now and then.
TEST(WrenchConeRule, ChoosesTheSameInATurnedSceneWithFriction) {
  const ReductionOptions options{.reducer = Reducer::wrench_cone};
  int otherwise = 0, dropped = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    Known known = random_contacts(random, 40, 0.4);
    for (ContactPoint& c : known.set.points) {
      c.b.body = 1;
      const Vec3 off{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      c.normal = (c.normal + 0.3 * off).normalized();
    }
    std::vector<SE3> g = {{random.rotation(), Vec3::Zero()}, {random.rotation(), Vec3::UnitX()}};
    std::vector<int> all(40);
    for (int i = 0; i < 40; ++i) all[i] = i;
    const auto kept_with = [&](std::span<const SE3> poses) {
      ReductionInput input = known.input();
      input.g = poses;
      const Selection selection = reduce(input, options);
      EXPECT_LE(wrench_factor(unit_wrenches(input, all), selection.kept),
                1 / (1 - options.wrench_loss) + 1e-8)
          << "seed " << seed;
      return selection.kept;
    };
    const std::vector<int> before = kept_with(g), by_the_world = kept_with({});
    const Quat R = random.rotation();
    known.set = moved(known.set, R, Vec3(1, 2, 3));
    for (SE3& pose : g) pose = SE3{R, Vec3(1, 2, 3)} * pose;
    EXPECT_EQ(kept_with(g), before) << "seed " << seed;
    otherwise += kept_with({}) != by_the_world ? 1 : 0;
    dropped += 40 - int(before.size());
  }
  EXPECT_GT(otherwise, 5);  // the sample is not hollow
  EXPECT_GT(dropped, 50);
}

// Normals of real contacts differ in their last digits, which must not look like a direction of their own.
TEST(WrenchConeRule, DoesNotSeeTheRoundingOfNormals) {
  Known known;
  for (const Vec2& p : ring(32)) {
    add(known.set, {0.05 * p.x(), 0.05 * p.y(), 0}, Vec3::UnitZ());
    known.mu.push_back(0.3);
  }
  Random random(1);
  const Quat turn = random.rotation();
  known.set = moved(known.set, turn, random.vector(1));
  const std::vector<int> exact = reduce(known.input(), {.reducer = Reducer::wrench_cone}).kept;
  EXPECT_LT(exact.size(), 16u);
  for (const double noise : {1e-15, 1e-13, 1e-11}) {
    Known noisy = known;
    for (ContactPoint& c : noisy.set.points) c.normal = (c.normal + noise * random.vector(1)).normalized();
    EXPECT_EQ(reduce(noisy.input(), {.reducer = Reducer::wrench_cone}).kept, exact) << noise;
  }
}

// A contact inside of four others is made of theirs, friction and all: pyramids of one normal stand alike.
TEST(WrenchConeRule, LeavesOutWhatLiesWithinAPatchWithFriction) {
  Known known;
  for (const Vec2& p : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1), Vec2(0.4, 0.3)}) {
    add(known.set, {p.x(), p.y(), 0}, Vec3::UnitZ());
    known.mu.push_back(0.7);
  }
  const Quat R(0.3, 0.4, 0.5, std::sqrt(0.5));
  known.set = moved(known.set, R, Vec3::Zero());
  const std::vector<SE3> g = {{Quat(0.8, 0, 0.6, 0), Vec3::Zero()}, {}};
  ReductionInput input = known.input();
  input.g = g;
  EXPECT_EQ(reduce(input, {.reducer = Reducer::wrench_cone, .wrench_loss = 0}).kept,
            (std::vector<int>{0, 1, 2, 3}));
}

TEST(ReductionInput, NeedsAPoseForEveryBodyOrNone) {
  const ContactSet set = flat({{0, 0}, {1, 0}});
  const std::vector<SE3> g(1);
  EXPECT_EQ(message_of([&] { reduce({.contacts = set, .g = g}, {}); }),
            "ReductionInput::g: 1 poses for a contact of body 1");
}

TEST(WrenchConeRule, OfOnePlaneIsTheMargin) {
  Known known;
  for (const Vec2& p : ring(64)) add(known.set, {p.x(), p.y(), 0}, Vec3::UnitZ());
  for (const double loss : {0.05, 0.1, 0.3}) {
    const Selection selection = reduce(known.input(), {.reducer = Reducer::wrench_cone, .wrench_loss = loss});
    EXPECT_GE(selection.loss.margin, 1 - loss - 1e-9);
    EXPECT_LE(selection.kept.size(), std::size_t(2 * kPi / std::acos(1 - loss)));  // at best half as many
  }
}

TEST(WrenchConeRule, SeesThatAPartCannotCarry) {
  Known known;
  for (const Vec2& p : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1)})
    add(known.set, {p.x(), p.y(), 0}, Vec3::UnitZ());
  const UnitWrenches wrenches = unit_wrenches(known.input(), std::vector<int>{0, 1, 2, 3});
  EXPECT_EQ(wrench_factor(wrenches, std::vector<int>{0, 1, 2, 3}), 1);
  EXPECT_EQ(wrench_factor(wrenches, std::vector<int>{0, 1, 2}), kInf);
}

// A disc that turns under its own frame: the corners stay where they were on the body, without memory they
// wander.
TEST(Hysteresis, KeepsTheCornersOfATurningDisc) {
  for (const Reducer which :
       {Reducer::extreme_points, Reducer::hull_area_loss, Reducer::hull_margin, Reducer::direction_set}) {
    int exchanged_with = 0, exchanged_without = 0;
    for (const bool memory : {true, false}) {
      std::vector<int> before;
      Random random(5);
      for (int step = 0; step < 360; ++step) {
        std::vector<Vec2> points = ring(50, step * kPi / 180);
        for (Vec2& p : points) p += 1e-3 * Vec2{random.uniform(-1, 1), random.uniform(-1, 1)};
        const ContactSet set = flat(points);
        ReductionInput input{.contacts = set};
        if (memory && !before.empty()) {
          input.kept_before.assign(50, 0);
          for (const int i : before) input.kept_before[i] = 1;
        }
        const std::vector<int> kept = reduce(input, {.reducer = which}).kept;
        (memory ? exchanged_with : exchanged_without) += step > 0 && kept != before;
        before = kept;
      }
    }
    EXPECT_EQ(exchanged_with, 0) << to_string(which);
    EXPECT_GT(exchanged_without, 30) << to_string(which);
  }
}

TEST(Hysteresis, GivesWayToWhatIsBetter) {
  const ContactSet set = flat(ring(48));
  ReductionInput input{.contacts = set};
  input.kept_before.assign(48, 0);
  for (const int i : {0, 3, 6, 9, 12, 15, 18, 21}) input.kept_before[i] = 1;  // one half of the rim
  for (const Reducer which : {Reducer::extreme_points, Reducer::hull_area_loss, Reducer::hull_margin})
    EXPECT_GT(reduce(input, {.reducer = which}).loss.margin, 0.7) << to_string(which);
}

// Of a square: at each corner a contact of the face and, farther out, two of its edges with other normals,
// open by `open`.
ContactSet corners_of_three(double open) {
  ContactSet set;
  for (const Vec2& side : {Vec2(1, 1), Vec2(-1, 1), Vec2(-1, -1), Vec2(1, -1)}) {
    add(set, {side.x(), side.y(), 0}, Vec3::UnitZ());
    for (const Vec2& out : {Vec2(side.x(), 0), Vec2(0, side.y())})
      add(set, {side.x() + 1e-5 * out.x(), side.y() + 1e-5 * out.y(), 0},
          Vec3(0.01 * out.x(), 0.01 * out.y(), 1).normalized(), open);
  }
  return set;
}

TEST(OnePlace, IsHeldByItsDeepestContact) {
  for (const Reducer which : {Reducer::extreme_points, Reducer::hull_exact, Reducer::hull_area_loss,
                              Reducer::hull_margin, Reducer::direction_set}) {
    EXPECT_EQ(reduce(corners_of_three(4e-8), {.reducer = which}).kept, (std::vector<int>{0, 3, 6, 9}))
        << to_string(which);
    const std::vector<int> outer = reduce(corners_of_three(-4e-8), {.reducer = which}).kept;
    EXPECT_EQ(std::ranges::count_if(outer, [](int i) { return i % 3 == 0; }), 0) << to_string(which);
  }
}

TEST(OnePlace, IsHeldOnByWhatWasKeptThereIfNothingIsDeeper) {
  for (const double open : {0.0, 1e-15, 4e-8}) {
    const ContactSet set = corners_of_three(open);
    ReductionInput input{.contacts = set};
    input.kept_before.assign(12, 0);
    const std::vector<int> before{1, 5, 7, 11};
    for (const int i : before) input.kept_before[i] = 1;
    EXPECT_EQ(std::ranges::includes(reduce(input).kept, before), open < 1e-9) << open;
    EXPECT_FALSE(std::ranges::includes(reduce(input, {.hysteresis = 0}).kept, before)) << "no memory";
  }
}

// Rim points resist drilling 1.5 times as much as even pressure does, centres of a clustering at 0.6 r 0.9
// times.
TEST(LossOfTorsion, IsThatOfTheArms) {
  std::vector<Vec2> points = ring(480);
  for (const Vec2& p : ring(3)) points.push_back(0.6 * p);
  const PlanarPatch patch = planar_patch(points);
  EXPECT_NEAR(patch.drilling_radius, 2.0 / 3, 1e-4);
  EXPECT_NEAR(loss_of(patch, std::vector<int>{0, 120, 240, 360}).torsion, 1.5, 1e-3);
  EXPECT_NEAR(loss_of(patch, std::vector<int>{480, 481, 482}).torsion, 0.9, 1e-3);
  // a square of side 2: (sqrt 2 + asinh 1) / 3
  EXPECT_NEAR(planar_patch({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}).drilling_radius,
              (std::sqrt(2) + std::asinh(1)) / 3, 1e-14);
}

TEST(LossOfHausdorff, IsTheDistanceOfTheDroppedCorner) {
  const PlanarPatch patch = planar_patch({{0, 0}, {2, 0}, {2, 1}, {0, 1}});
  EXPECT_NEAR(loss_of(patch, std::vector<int>{0, 1, 2}).hausdorff, 2 / std::sqrt(5), 1e-14);
  EXPECT_NEAR(loss_of(patch, std::vector<int>{0, 1}).hausdorff, 1, 1e-14);
  EXPECT_EQ(loss_of(patch, std::vector<int>{0, 1, 2, 3}).hausdorff, 0);
}

}  // namespace
}  // namespace aussois
