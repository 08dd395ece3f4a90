// SPDX-License-Identifier: Apache-2.0
// Every clustering as the first half of a reduction: what reducers may count on, and what tells each of them
// from the others.
#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "reduction/mean_contacts.hpp"
#include "reduction/reduce.hpp"
#include "tests/support/flat_contacts.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// Contacts of two pairs with all that a clustering may look at.
struct Known {
  ContactSet set{};
  std::vector<double> mu{};
  std::vector<char> kept_before{};
  ReductionInput input() const { return {.contacts = set, .kept_before = kept_before, .mu = mu}; }
};
Known random_contacts(std::uint64_t seed, int n) {
  Random random(seed);
  const Vec3 normals[] = {Vec3::UnitX(), Vec3(0, 0.6, 0.8), -Vec3::UnitX(), Vec3::UnitZ()};
  Known out;
  for (int i = 0; i < n; ++i) {
    const Vec3 at{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    const Vec3 off{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)};
    add(out.set, at, (normals[random.index(4)] + off).normalized(), random.uniform(-1e-4, 1e-4));
    out.set.points.back().b.body = BodyId(1) + random.index(2);
    out.mu.push_back(random.index(2) == 0 ? 0.2 : 0.8);
    out.kept_before.push_back(char(random.index(2)));
  }
  return out;
}

class EveryClustering : public ::testing::TestWithParam<std::string> {
 protected:
  ClusteringOptions options() const { return {.rule = clustering(GetParam())}; }
};

TEST_P(EveryClustering, PutsEachContactIntoOneGroupOfItsPairTheDeepestFirst) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Known known = random_contacts(seed, 60);
    std::vector<int> seen;
    const auto point = [&](int i) -> const ContactPoint& { return known.set.points[i]; };
    for (const std::vector<int>& group : clusters_of(known.input(), options())) {
      ASSERT_FALSE(group.empty());
      for (const int i : group) {
        EXPECT_EQ(point(i).b.body, point(group.front()).b.body);
        EXPECT_GE(point(i).gap, point(group.front()).gap);
      }
      seen.insert(seen.end(), group.begin(), group.end());
    }
    std::sort(seen.begin(), seen.end());
    std::vector<int> all(60);
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(seen, all) << "seed " << seed;
  }
}

// Or their plane would be anything (CLU-5).
TEST_P(EveryClustering, NeverHoldsNormalsThatCancel) {
  double least = 1;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Known known = random_contacts(seed, 60);
    for (const std::vector<int>& group : clusters_of(known.input(), options())) {
      Vec3 sum = Vec3::Zero();
      for (const int i : group) sum += known.set.points[i].normal;
      least = std::min(least, sum.norm() / double(group.size()));
    }
  }
  EXPECT_GE(least, 0.5);
  EXPECT_LT(least, 1);  // the sample is not hollow
}

TEST_P(EveryClustering, ReducesWhateverTheOrderOfTheSetBitForBit) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Known known = random_contacts(seed, 60);
    std::vector<int> order(60);
    std::iota(order.begin(), order.end(), 0);
    Random random(seed + 1000);
    for (int i = 59; i > 0; --i) std::swap(order[i], order[random.index(i + 1)]);
    Known shuffled;
    for (const int i : order) {
      shuffled.set.points.push_back(known.set.points[i]);
      shuffled.mu.push_back(known.mu[i]);
      shuffled.kept_before.push_back(known.kept_before[i]);
    }
    const Selection a = reduce(known.input(), {.clustering = options()}),
                    b = reduce(shuffled.input(), {.clustering = options()});
    std::vector<int> back;
    for (const int i : b.kept) back.push_back(order[i]);
    std::sort(back.begin(), back.end());
    ASSERT_EQ(a.kept, back) << "seed " << seed;
    EXPECT_EQ(a.cluster_count, b.cluster_count);
    EXPECT_EQ(a.loss.margin, b.loss.margin);
    for (std::size_t i = 0; i < order.size(); ++i)
      EXPECT_EQ(a.cluster[order[i]], b.cluster[i]) << "seed " << seed;
  }
}

TEST_P(EveryClustering, BearsNothingOnePointAndOnePlace) {
  const ReductionOptions o{.clustering = options()};
  EXPECT_TRUE(reduce(ContactSet{}, o).kept.empty());
  EXPECT_EQ(reduce(flat({{1, 2}}), o).kept, std::vector<int>{0});
  const Selection one_place = reduce(flat(std::vector<Vec2>(9, Vec2(1, 2))), o);
  EXPECT_FALSE(one_place.kept.empty());
  EXPECT_EQ(one_place.loss.margin, 1);
}

// Ten contacts on a line that is no axis: every group keeps its two ends, whatever the groups are.
TEST_P(EveryClustering, KeepsTheEndsOfEveryPartOfALine) {
  Known line;
  for (const int i : {3, 0, 7, 5, 9, 1, 2, 8, 4, 6}) add(line.set, {0.06 * i, -0.08 * i, 0}, Vec3::UnitZ());
  const Selection selection = reduce(line.input(), {.clustering = options(), .min_per_cluster = 1});
  EXPECT_NEAR(selection.loss.margin, 1, 1e-12);
  for (const int end : {1, 4}) EXPECT_TRUE(std::ranges::binary_search(selection.kept, end));
  std::vector<int> in_group(std::size_t(selection.cluster_count), 0);
  for (const int c : selection.cluster) ++in_group[c];
  std::size_t corners = 0;  // besides, the deepest by order, which is an inner one perhaps
  for (const int n : in_group) corners += std::size_t(std::min(n, 2));
  EXPECT_GE(selection.kept.size(), corners);
  EXPECT_LE(selection.kept.size(), corners + in_group.size());
}

TEST_P(EveryClustering, RefusesWhatIsNoNumberByItsContact) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto message = [&](auto&& spoil) {
    Known known = random_contacts(1, 20);
    spoil(known.set.points[3]);
    return message_of([&] { reduce(known.input(), {.clustering = options()}); });
  };
  EXPECT_NE(message([&](ContactPoint& c) { c.x_a.y() = nan; }).find("contact 3"), std::string::npos);
  EXPECT_NE(message([&](ContactPoint& c) { c.gap = nan; }).find("contact 3"), std::string::npos);
  EXPECT_NE(message([&](ContactPoint& c) { c.normal.x() = nan; }).find("contact 3"), std::string::npos);
  EXPECT_EQ(message([](ContactPoint&) {}), "");
}

INSTANTIATE_TEST_SUITE_P(Clusterings, EveryClustering, ::testing::ValuesIn(clustering_names()),
                         [](const auto& param) { return param.param; });

std::set<std::set<int>> groups_of(const Clusters& clusters) {
  std::set<std::set<int>> out;
  for (const std::vector<int>& group : clusters) out.insert({group.begin(), group.end()});
  return out;
}
std::set<std::set<int>> groups_of(const Known& known, const ClusteringOptions& options) {
  return groups_of(clusters_of(known.input(), options));
}

// Two feet of nine contacts each, 20 cm apart, on one plane.
Known two_feet() {
  Known out;
  for (const double side : {-0.1, 0.1})
    for (const Vec2& x : grid(3, 3, 0.02, 0.02)) add(out.set, {side + x.x(), x.y(), 0}, Vec3::UnitZ());
  return out;
}
const std::set<std::set<int>> kBoth = {{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17}},
                              kEach = {{0, 1, 2, 3, 4, 5, 6, 7, 8}, {9, 10, 11, 12, 13, 14, 15, 16, 17}};

TEST(Clustering, TellsFeetApartByPlaceAndNotByNormal) {
  for (const Clustering rule : {Clustering::angle, Clustering::cube_map})
    EXPECT_EQ(groups_of(two_feet(), {.rule = rule}), kBoth) << to_string(rule);
  EXPECT_EQ(groups_of(two_feet(), {.rule = Clustering::normals, .k = 2}), kBoth);
  for (const Clustering rule :
       {Clustering::position_normal_friction, Clustering::position_depth, Clustering::kmc, Clustering::kmcw})
    EXPECT_EQ(groups_of(two_feet(), {.rule = rule, .k = 2}), kEach) << to_string(rule);
}

// Then each foot keeps its four corners, where one patch of both keeps those of the whole.
TEST(Clustering, DecidesWhatIsReducedByItself) {
  const ContactSet set = two_feet().set;
  EXPECT_EQ(reduce(set, {.reducer = Reducer::hull_exact}).kept, (std::vector<int>{0, 6, 11, 17}));
  EXPECT_EQ(
      reduce(set, {.reducer = Reducer::hull_exact, .clustering = {.rule = Clustering::kmc, .k = 2}}).kept,
      (std::vector<int>{0, 2, 6, 8, 9, 11, 15, 17}));
}

// 0.1 m for a difference of mu of one: 0.8 against 0 is 8 cm, farther than the foot is long.
TEST(Clustering, InSevenDimensionsSeesFriction) {
  Known foot;
  for (const Vec2& x : grid(4, 2, 0.06, 0.01)) {
    foot.mu.push_back(foot.set.points.size() % 2 == 0 ? 0 : 0.8);
    add(foot.set, {x.x(), x.y(), 0}, Vec3::UnitZ());
  }
  EXPECT_EQ(groups_of(foot, {.rule = Clustering::position_normal_friction, .k = 2}),
            (std::set<std::set<int>>{{0, 2, 4, 6}, {1, 3, 5, 7}}));
  EXPECT_NE(groups_of(foot, {.rule = Clustering::kmcw, .k = 2}),
            (std::set<std::set<int>>{{0, 2, 4, 6}, {1, 3, 5, 7}}));
}

// Contacts at 0, 4, 6.45 and 9 cm, seeds at 4 and 9: 6.45 is nearer to 4, and leaves for 9 once the mean of
// 0, 4 and 6.45 is taken. If the one at 4 is deep, the mean is there, and 6.45 stays.
TEST(Clustering, ByDepthGoesWhereThePressureIs) {
  Known line;
  for (const double x : {0.0, 0.04, 0.0645, 0.09})
    add(line.set, {x, 0, 0}, Vec3::UnitZ(), x == 0.04 ? -1e-3 : 0);
  EXPECT_EQ(groups_of(line, {.rule = Clustering::kmcw, .k = 2}), (std::set<std::set<int>>{{0, 1}, {2, 3}}));
  EXPECT_EQ(groups_of(line, {.rule = Clustering::position_depth, .k = 2}),
            (std::set<std::set<int>>{{0, 1, 2}, {3}}));
}

// A square may be cut in two ways; (CLU-9) stays with that of the last problem.
TEST(Clustering, OfKmcwStartsWhereTheLastProblemHadItsContacts) {
  Known square;
  for (const Vec2& x : grid(6, 6, 0.05, 0.05)) add(square.set, {x.x(), x.y(), 0}, Vec3::UnitZ());
  std::set<int> left, right, below, above;
  for (int i = 0; i < 36; ++i) {
    (i % 6 < 3 ? left : right).insert(i);
    (i / 6 < 3 ? below : above).insert(i);
  }
  const auto after = [&](const std::vector<int>& kept) {
    square.kept_before.assign(36, 0);
    for (const int i : kept) square.kept_before[i] = 1;
    return groups_of(square, {.rule = Clustering::kmcw, .k = 2});
  };
  EXPECT_EQ(after({6, 12, 18, 24, 11, 17, 23, 29}), (std::set<std::set<int>>{left, right}));
  EXPECT_EQ(after({1, 2, 3, 4, 31, 32, 33, 34}), (std::set<std::set<int>>{below, above}));
}

TEST(Clustering, ByRandomSeedsIsThatOfItsSeed) {
  Known ring;
  for (int i = 0; i < 40; ++i)
    add(ring.set, {0.1 * std::cos(2 * kPi * i / 40), 0.1 * std::sin(2 * kPi * i / 40), 0}, Vec3::UnitZ());
  std::set<std::set<std::set<int>>> different;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const ClusteringOptions options{.rule = Clustering::kmc, .random_seed = seed};
    EXPECT_EQ(groups_of(ring, options), groups_of(ring, options));
    different.insert(groups_of(ring, options));
  }
  EXPECT_GT(different.size(), 3u);
}

TEST(Clustering, IsCheckedAtTheDoor) {
  EXPECT_EQ(message_of([] { clustering("magic"); }),
            "clustering = magic must be one of angle, cube_map, normals, position_normal_friction, "
            "position_depth, kmc, kmcw");
  for (const std::string& name : clustering_names()) EXPECT_EQ(to_string(clustering(name)), name);
  EXPECT_EQ(message_of([] { reduce(ContactSet{}, {.clustering = {.k = 0}}); }),
            "ClusteringOptions::k = 0 must be at least 1");
  EXPECT_NE(
      message_of([] { reduce(ContactSet{}, {.clustering = {.angle = 2}}); }).find("ClusteringOptions::angle"),
      std::string::npos);
  EXPECT_NE(
      message_of([] { reduce(ContactSet{}, {.clustering = {.cube = {.cells = 0}}}); }).find("CubeMapOptions"),
      std::string::npos);
}

}  // namespace
}  // namespace aussois
