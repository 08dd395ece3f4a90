// SPDX-License-Identifier: Apache-2.0
// doc/theory/reduction.md: clusters, extremes, layers, and what they lose.
#include "reduction/reduce.hpp"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/flat_contacts.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

const ReductionOptions kExtremes{.reducer = Reducer::extreme_points};
const std::vector<int> kGridCorners = {0, 5, 18, 23};  // of a grid of 6 x 4

TEST(Reduce, KeepsTheFourCornersOfAnAlignedRectangle) {
  EXPECT_EQ(reduce(flat(grid(6, 4, 0.3, 0.1))).kept, kGridCorners);
  EXPECT_EQ(reduce(flat(grid(6, 4, 0.1, 0.3))).kept, kGridCorners);
  EXPECT_EQ(reduce(flat(grid(6, 4, 0.1, 0.1))).kept, kGridCorners);  // more points along x: x is principal
  EXPECT_EQ(reduce(flat({{0, 0}, {1, 0}, {0, 1}, {1, 1}}), {.min_per_cluster = 1}).kept,
            (std::vector<int>{0, 1, 2, 3}));
}

TEST(Reduce, KeepsTheCornersOfARotatedRectangle) {
  for (int degree = 0; degree < 360; degree += 5) {
    EXPECT_EQ(reduce(flat(rotated(grid(6, 4, 0.3, 0.1), degree * kPi / 180))).kept, kGridCorners) << degree;
    EXPECT_EQ(reduce(flat(rotated(grid(6, 4, 0.3, 0.1), degree * kPi / 180)),
                     {.reducer = Reducer::extreme_points, .tie = 1e-9})
                  .kept,
              kGridCorners);
  }
}

// A mesh that is flat and straight only within 1e-5 of its size. With ties resolved to rounding only, noise
// chooses the corners and mostly loses one: that is why the default tie is what it is.
TEST(Reduce, KeepsTheCornersOfANoisyRectangle) {
  Random random(7);
  int lost_with_a_tight_tie = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vec2> points = grid(6, 4, 0.3, 0.1);
    for (Vec2& p : points) p += 3e-6 * Vec2{random.uniform(-1, 1), random.uniform(-1, 1)};
    const ContactSet set = flat(points);
    EXPECT_EQ(reduce(set).kept, kGridCorners) << "trial " << trial;
    EXPECT_EQ(reduce(set, kExtremes).kept, kGridCorners) << "trial " << trial;
    lost_with_a_tight_tie += reduce(set, {.reducer = Reducer::extreme_points, .tie = 1e-9}).loss.margin < 0.9;
  }
  EXPECT_GT(lost_with_a_tight_tie, 100);
}

std::vector<Vec2> disc(int rim, int inside, std::uint64_t seed) {
  std::vector<Vec2> points;
  for (int i = 0; i < rim; ++i) points.push_back({std::cos(2 * kPi * i / rim), std::sin(2 * kPi * i / rim)});
  Random random(seed);
  while (int(points.size()) < rim + inside) {
    const Vec2 p{random.uniform(-1, 1), random.uniform(-1, 1)};
    if (p.norm() < 0.95) points.push_back(p);
  }
  return points;
}

TEST(Reduce, KeepsTheBestSquareOfADisc) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ContactSet set = flat(disc(48, 100, seed));
    set.points.back().gap = -1e-9;  // the deepest is an inner point and kept besides
    const Selection selection = reduce(set, kExtremes);
    std::vector<int> rim;
    for (const int i : selection.kept)
      if (i < 48) rim.push_back(i);
    ASSERT_EQ(rim.size(), 4u) << "seed " << seed;
    for (std::size_t k = 1; k < 4; ++k) EXPECT_EQ(rim[k] - rim[k - 1], 12) << "seed " << seed;
  }
}

TEST(Reduce, KeepsTheEndsOfALine) {
  std::vector<Vec2> points;
  for (const int i : {3, 0, 7, 5, 9, 1, 2, 8, 4, 6}) points.push_back({0.6 * i, -0.8 * i});
  ContactSet set = flat(points);
  EXPECT_EQ(reduce(set).kept, (std::vector<int>{0, 1, 4}));  // the ends and the first of equally deep ones
  set.points[1].gap = -1e-6;
  EXPECT_EQ(reduce(set).kept, (std::vector<int>{1, 4}));
}

TEST(Reduce, KeepsOneOfCoincidentContacts) {
  EXPECT_EQ(reduce(flat(std::vector<Vec2>(9, Vec2(0.3, -0.7)))).kept, (std::vector<int>{0}));
}

TEST(Reduce, KeepsEachCornerOnceWhenContactsAreDoubled) {
  std::vector<Vec2> points = grid(6, 4, 0.3, 0.1);
  const std::vector<Vec2> once = points;
  points.insert(points.end(), once.begin(), once.end());
  EXPECT_EQ(reduce(flat(rotated(points, 0.3))).kept, kGridCorners);
}

TEST(Reduce, KeepsSmallSetsWhole) {
  EXPECT_TRUE(reduce({}).kept.empty());
  EXPECT_EQ(reduce({}).cluster_count, 0);
  EXPECT_EQ(reduce(flat({{1, 2}})).kept, (std::vector<int>{0}));
  EXPECT_EQ(reduce(flat({{0, 0}, {1, 0}, {2, 0}, {3, 0}})).kept, (std::vector<int>{0, 1, 2, 3}));
}

TEST(Reduce, KeepsEverythingWhenAskedTo) {
  const ContactSet set = flat(grid(6, 4, 1, 1));
  EXPECT_EQ(reduce(set, {.reducer = Reducer::none}).kept.size(), set.points.size());
}

TEST(Reduce, NeverPutsOppositeWallsIntoOneCluster) {
  ContactSet set;
  for (const Vec2& p : grid(6, 4, 0.3, 0.1)) {
    add(set, {p.x(), p.y(), 0}, Vec3::UnitZ());
    add(set, {p.x(), p.y(), 0.01}, -Vec3::UnitZ());
  }
  const Selection selection = reduce(set, {.clustering = {.angle = kPi / 2}});
  EXPECT_EQ(selection.cluster_count, 2);
  EXPECT_EQ(selection.kept.size(), 8u);
  for (std::size_t i = 0; i < set.points.size(); i += 2)
    EXPECT_NE(selection.cluster[i], selection.cluster[i + 1]);
}

TEST(Reduce, KeepsBodyPairsApart) {
  ContactSet set = flat(grid(6, 4, 1, 1));
  for (std::size_t i = 12; i < 24; ++i) set.points[i].b.body = 2;
  const Selection selection = reduce(set);
  EXPECT_EQ(selection.cluster_count, 2);
  EXPECT_EQ(selection.kept, (std::vector<int>{0, 5, 6, 11, 12, 17, 18, 23}));
}

TEST(Reduce, DoesNotChainRoundACylinder) {
  ContactSet set;
  const int n = 720;  // neighbours differ by half a degree, far less than the angle of a cluster
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * i / n;
    const Vec3 normal(std::cos(angle), std::sin(angle), 0);
    add(set, normal, normal);
  }
  const ReductionOptions options{.clustering = {.angle = 0.1}};
  const Selection selection = reduce(set, options);
  EXPECT_GE(selection.cluster_count, int(kPi / options.clustering.angle));  // a cluster spans at most 2 alpha
  EXPECT_LE(selection.cluster_count,
            int(2 * kPi / options.clustering.angle) + 1);  // seeds are farther apart than alpha
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) {
      if (selection.cluster[i] != selection.cluster[j]) continue;
      EXPECT_GE(set.points[i].normal.dot(set.points[j].normal), std::cos(0.2) - 1e-12);
    }
}

TEST(Reduce, ResolvesAnglesThatTheCosineCannot) {
  ContactSet set;
  for (int i = 0; i < 6; ++i) {  // alternating normals, 2e-9 rad apart
    const double angle = i % 2 == 0 ? 0 : 2e-9;
    add(set, {double(i), 0, 0}, {std::sin(angle), 0, std::cos(angle)});
  }
  EXPECT_EQ(reduce(set, {.clustering = {.angle = 1e-9}}).cluster_count, 2);
  EXPECT_EQ(reduce(set, {.clustering = {.angle = 3e-9}}).cluster_count, 1);
}

TEST(Reduce, KeepsClosedFeetUnderOpenCorners) {
  ContactSet set = flat(grid(6, 4, 0.6, 0.4));
  for (ContactPoint& c : set.points) c.gap = 1e-3;
  for (const int foot : {8, 9, 14}) set.points[foot].gap = 1e-9 * foot;  // three inner points of the grid
  EXPECT_EQ(reduce(set).kept, (std::vector<int>{0, 5, 8, 9, 14, 18, 23}));
  EXPECT_EQ(reduce(set, {.layer = 0}).kept, (std::vector<int>{0, 5, 8, 18, 23}));  // the deepest foot alone
}

// Random clusters with several normals, gaps and body pairs.
ContactSet random_set(Random& random, int n) {
  ContactSet set;
  const Vec3 normals[] = {Vec3::UnitX(), Vec3(0, 0.6, 0.8), -Vec3::UnitX()};
  for (int i = 0; i < n; ++i) {
    const Vec3 normal = normals[random.index(3)];
    const Vec3 point{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    add(set, point, normal, random.uniform(-1e-4, 1e-4));
    set.points.back().b.body = BodyId(1) + random.index(2);
  }
  return set;
}

std::vector<int> simplices_of(const ContactSet& set, const std::vector<int>& kept) {
  std::vector<int> result;
  for (const int i : kept) result.push_back(set.points[i].a.simplex);
  std::sort(result.begin(), result.end());
  return result;
}

class ReduceRandom : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(ReduceRandom, DoesNotDependOnTheOrderOfTheSet) {
  Random random(GetParam());
  ContactSet set = random_set(random, 60);
  for (std::size_t i = 0; i < set.points.size(); i += 3) set.points[i].gap = 0;  // ties in depth
  ContactSet shuffled = set;
  for (std::size_t i = shuffled.points.size() - 1; i > 0; --i)
    std::swap(shuffled.points[i], shuffled.points[random.index(int(i) + 1)]);
  const Selection a = reduce(set), b = reduce(shuffled);
  EXPECT_EQ(simplices_of(set, a.kept), simplices_of(shuffled, b.kept));
  for (std::size_t i = 0; i < set.points.size(); ++i)
    EXPECT_EQ(b.cluster[i], a.cluster[shuffled.points[i].a.simplex]);
  EXPECT_LT(a.kept.size(), set.points.size());  // the sample is not hollow: something is dropped
}

TEST_P(ReduceRandom, MovesWithTheBodies) {
  Random random(GetParam());
  const ContactSet set = random_set(random, 60);
  const Vec3 p{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  const Selection a = reduce(set), b = reduce(moved(set, random.rotation(), p));
  EXPECT_EQ(a.kept, b.kept);
  EXPECT_EQ(a.cluster, b.cluster);
}

TEST_P(ReduceRandom, AlwaysKeepsTheDeepest) {
  Random random(GetParam());
  const ContactSet set = random_set(random, 60);
  const Selection selection = reduce(set);
  for (int k = 0; k < selection.cluster_count; ++k) {
    int deepest = -1;
    for (int i = 0; i < int(set.points.size()); ++i)
      if (selection.cluster[i] == k && (deepest < 0 || set.points[i].gap < set.points[deepest].gap))
        deepest = i;
    EXPECT_TRUE(std::binary_search(selection.kept.begin(), selection.kept.end(), deepest)) << "cluster " << k;
  }
}

// The exact margin of (RED-7) against a scan of directions, which can only be larger, and not by much.
TEST_P(ReduceRandom, MarginIsThatOfAScanOfDirections) {
  Random random(GetParam());
  std::vector<Vec2> points;
  for (int i = 0; i < 12; ++i) points.push_back({random.uniform(-1, 1), random.uniform(-1, 1)});
  points.insert(points.end(),
                {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});  // the hull is a square with the centroid at zero
  const ContactSet set = flat(points);
  const Selection selection{.kept = {0, 1, 2, 3, 4}, .cluster = std::vector<int>(16, 0), .cluster_count = 1};
  double scan = kInf;
  for (int k = 0; k < 20000; ++k) {
    const Vec2 d(std::cos(2 * kPi * k / 20000), std::sin(2 * kPi * k / 20000));
    double h_S = -kInf, h_P = std::abs(d.x()) + std::abs(d.y());
    for (std::size_t i = 0; i < 5; ++i) h_S = std::max(h_S, d.dot(points[i]));
    scan = std::min(scan, h_S / h_P);
  }
  const double margin = measure_loss(set, selection).margin;
  EXPECT_LE(margin, scan + 1e-12);
  EXPECT_GE(margin, scan - 1e-3);  // slope of the quotient at most 3 per rad, directions 3.1e-4 rad apart
}

INSTANTIATE_TEST_SUITE_P(Seeds, ReduceRandom, ::testing::Range<std::uint64_t>(1, 101));

TEST(MeasureLoss, OfARectangleIsNothing) {
  for (const double angle : {0.0, 0.4, 1.2}) {
    const ContactSet set = flat(rotated(grid(6, 4, 0.3, 0.1), angle));
    const LossReport loss = measure_loss(set, reduce(set));
    EXPECT_NEAR(loss.margin, 1, 1e-12);
    EXPECT_NEAR(loss.area, 1, 1e-12);
  }
}

// A square in a regular polygon of 48 corners: 2 r^2 of 24 sin(7.5 degrees) r^2, and cos 45 degrees where the
// polygon has a corner.
TEST(MeasureLoss, OfADiscIsThatOfTheInscribedSquare) {
  ContactSet set = flat(disc(48, 100, 1));
  set.points.back().gap = -1e-9;
  const LossReport loss = reduce(set, kExtremes).loss;
  EXPECT_NEAR(loss.margin, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(loss.area, 2 / (24 * std::sin(7.5 * kPi / 180)), 1e-12);
}

// Corners (2,1) and (1,2) are tied along the diagonal and one is dropped. Hull 7/2, kept 3; centroid (19/21,
// 19/21); the new side has the normal (1, 2), support 4 - 3 * 19/21 against 5 - 3 * 19/21 of the full hull.
TEST(MeasureLoss, OfAnLIsTheOneByHand) {
  const ContactSet set = flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  const Selection selection = reduce(set, kExtremes);
  EXPECT_EQ(selection.kept.size(), 4u);
  const LossReport loss = measure_loss(set, selection);
  EXPECT_NEAR(loss.area, 6.0 / 7, 1e-12);
  EXPECT_NEAR(loss.margin, (4 - 3 * 19.0 / 21) / (5 - 3 * 19.0 / 21), 1e-12);
}

TEST(MeasureLoss, OfRandomPatchesIsThatOfTheTable) {
  Random random(1);
  double area = 0, margin = 0, kept = 0;
  const int trials = 1000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<Vec2> points;
    for (int i = 0; i < 40; ++i) {  // normal distribution by Box and Muller
      const double radius = std::sqrt(-2 * std::log(1 - random.uniform(0, 1)));
      const double angle = random.uniform(0, 2 * kPi);
      points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    ContactSet set = flat(points);
    set.points[reduce(set, kExtremes).kept.back()].gap = -1e-9;  // an extreme is the deepest: no fifth point
    const Selection selection = reduce(set, kExtremes);
    const LossReport loss = measure_loss(set, selection);
    area += loss.area / trials;
    margin += loss.margin / trials;
    kept += double(selection.kept.size()) / trials;
  }
  EXPECT_NEAR(area, 0.74, 0.03);
  EXPECT_NEAR(margin, 0.53, 0.03);
  EXPECT_NEAR(kept, 3.9, 0.1);  // one point is an extreme twice now and then
}

TEST(MeasureLoss, SeesALostCornerAndALostEnd) {
  const ContactSet square = flat({{0, 0}, {1, 0}, {0, 1}, {1, 1}});
  const Selection three{.kept = {0, 1, 2}, .cluster = {0, 0, 0, 0}, .cluster_count = 1};
  EXPECT_NEAR(measure_loss(square, three).margin, 0, 1e-12);  // the diagonal runs through the centroid
  EXPECT_NEAR(measure_loss(square, three).area, 0.5, 1e-12);
  const ContactSet line = flat(rotated({{0, 0}, {1, 0}, {2, 0}, {4, 0}}, 0.7));
  const Selection short_one{.kept = {0, 2}, .cluster = {0, 0, 0, 0}, .cluster_count = 1};
  EXPECT_NEAR(measure_loss(line, short_one).margin, 0, 1e-12);  // ends in the middle
  EXPECT_EQ(measure_loss(line, short_one).area, 1);
  const Selection nothing{.kept = {}, .cluster = {0, 0, 0, 0}, .cluster_count = 1};
  EXPECT_EQ(measure_loss(square, nothing).margin, -kInf);
}

TEST(Reduce, RefusesContactsThatAreNotNumbers) {
  ContactSet set = flat(grid(6, 4, 1, 1));
  set.points[3].x_a.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message_of([&] { reduce(set); }).find("contact 3"), std::string::npos);
  set = flat(grid(6, 4, 1, 1));
  set.points[2].gap = kInf;
  EXPECT_THROW(reduce(set), std::invalid_argument);
  set = flat(grid(6, 4, 1, 1));
  set.points[2].normal = Vec3::Zero();
  EXPECT_THROW(reduce(set), std::invalid_argument);
}

TEST(Reduce, RefusesOptionsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NO_THROW(validate(ReductionOptions{}));
  for (const double angle : {0.0, -1.0, 1.6, nan})
    EXPECT_THROW(validate(ReductionOptions{.clustering = {.angle = angle}}), std::invalid_argument);
  for (const double tie : {-1e-9, 0.2, nan})
    EXPECT_THROW(validate(ReductionOptions{.tie = tie}), std::invalid_argument);
  for (const double layer : {-1e-9, nan})
    EXPECT_THROW(validate(ReductionOptions{.layer = layer}), std::invalid_argument);
  EXPECT_THROW(validate(ReductionOptions{.min_per_cluster = 0}), std::invalid_argument);
}

TEST(Select, TakesTheContactsNamed) {
  const ContactSet set = flat(grid(6, 4, 1, 1));
  EXPECT_EQ(simplices_of(select(set, {2, 7}), {0, 1}), (std::vector<int>{2, 7}));
  EXPECT_THROW(select(set, {24}), std::invalid_argument);
  EXPECT_THROW(select(set, {-1}), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
