// SPDX-License-Identifier: Apache-2.0
// Tests T-2.1 to T-2.13 of doc/theory/clustering.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "reduction/cube_map.hpp"
#include "reduction/kmeans.hpp"
#include "reduction/mean_contacts.hpp"
#include "reduction/normal_clusters.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr double kDegree = kPi / 180;

double angle(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Within `spread` of d.
Vec3 near(const Vec3& d, double spread, Random& random) {
  const Vec3 axis = d.cross(random.direction()).normalized();
  return exp_so3(spread * std::sqrt(random.uniform()) * axis) * d;
}

ContactSet contacts_of(const std::vector<Vec3>& normals) {
  ContactSet set;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    ContactPoint c;
    c.a.body = 0, c.b.body = 1;
    c.a.simplex = int(i);
    c.normal = normals[i];
    c.gap = -1e-3 * double(i % 7);
    set.points.push_back(c);
  }
  return set;
}

ContactSet shuffled(const ContactSet& set, Random& random, std::vector<int>& from) {
  from.resize(set.points.size());
  std::iota(from.begin(), from.end(), 0);
  for (int i = int(from.size()) - 1; i > 0; --i) std::swap(from[i], from[random.index(i + 1)]);
  ContactSet out;
  for (const int i : from) out.points.push_back(set.points[i]);
  return out;
}

TEST(CubeMap, T_2_1_HasEveryCellAndEachDirectionInOne) {
  for (const bool equi_angular : {false, true})
    for (const int cells : {1, 2, 3, 4, 7}) {
      std::set<int> seen;
      constexpr int kSamples = 60;
      for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0})
          for (int i = 0; i < kSamples; ++i)
            for (int j = 0; j < kSamples; ++j) {
              Vec3 d;
              d[axis] = sign;
              d[(axis + 1) % 3] = (2 * i + 1.0) / kSamples - 1,
                             d[(axis + 2) % 3] = (2 * j + 1.0) / kSamples - 1;
              const int cell = cube_cell(d.normalized(), {.cells = cells, .equi_angular = equi_angular});
              ASSERT_GE(cell, 0);
              ASSERT_LT(cell, 6 * cells * cells);
              EXPECT_EQ(cell / (cells * cells), 2 * axis + (sign < 0)) << "on its face";
              seen.insert(cell);
            }
      EXPECT_EQ(int(seen.size()), 6 * cells * cells);
    }
}

TEST(CubeMap, T_2_2_PutsAxesAndBordersWhereTheirLowestAxisSays) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Vec3 d = Vec3::Zero();
      d[axis] = sign;
      EXPECT_EQ(cube_cell(d, {.cells = 3}), (2 * axis + (sign < 0)) * 9 + 4) << "the middle cell";
    }
  EXPECT_EQ(cube_cell(Vec3(1, 1, 1).normalized(), {.cells = 4}) / 16, 0);
  EXPECT_EQ(cube_cell(Vec3(0, -1, 1).normalized(), {.cells = 4}) / 16, 3);
  // The corners of an icosahedron, by hand: (0, 1, phi) and its turns lie off the middle of z, x, y.
  const double phi = (1 + std::sqrt(5.0)) / 2;
  std::set<int> cells;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-phi, phi}) {
      const int face = b < 0;
      EXPECT_EQ(cube_cell(Vec3(0, a, b).normalized(), {.cells = 2}) / 4, 4 + face);
      EXPECT_EQ(cube_cell(Vec3(b, 0, a).normalized(), {.cells = 2}) / 4, face);
      EXPECT_EQ(cube_cell(Vec3(a, b, 0).normalized(), {.cells = 2}) / 4, 2 + face);
      for (const Vec3& d : {Vec3(0, a, b), Vec3(b, 0, a), Vec3(a, b, 0)})
        cells.insert(cube_cell(d.normalized(), {.cells = 2}));
    }
  EXPECT_EQ(cells.size(), 12u);
}

TEST(CubeMap, T_2_3_MergesABundleThatABorderSplits) {
  for (const Vec3& border : {Vec3(1, 0.5, 0.2), Vec3(1, 1, 0.1), Vec3(0.3, -1, 1), Vec3(-1, -0.1, 0)}) {
    Random random(5);
    std::vector<Vec3> bundle;
    for (int i = 0; i < 200; ++i) bundle.push_back(near(border.normalized(), 0.25 * kDegree, random));
    const CubeMap split = cube_map(bundle, {.cells = 4});
    EXPECT_EQ(split.groups, border.z() == 0 ? 4 / 2 : 2) << border.transpose();
    const CubeMap merged = cube_map(bundle, {.cells = 4, .merge = 2 * kDegree});
    EXPECT_EQ(merged.groups, 1) << border.transpose();
    EXPECT_TRUE(std::ranges::all_of(merged.label, [](int l) { return l == 0; }));
  }
  // Bundles of two cells that are far apart stay two.
  const std::vector<Vec3> apart = {Vec3(1, 0.1, 0.1).normalized(), Vec3(1, 0.7, 0.1).normalized()};
  EXPECT_EQ(cube_map(apart, {.cells = 4, .merge = 5 * kDegree}).groups, 2);
}

// T-2.4, and the solid angles of equi-angular cells.
TEST(CubeMap, T_2_4_HasCellsAsWideAsComputed) {
  constexpr int kCells = 4, kGrid = 12;
  std::vector<std::vector<Vec3>> cell(6 * kCells * kCells);
  for (int i = 0; i <= kCells * kGrid; ++i)
    for (int j = 0; j <= kCells * kGrid; ++j) {
      const double e = 1e-9;  // inside the cell
      const auto place = [&](int n) {
        const double u = 2.0 * n / (kCells * kGrid) - 1;
        return n % kGrid == 0 ? std::array{u - e, u + e} : std::array{u, u};
      };
      for (const double u : place(i))
        for (const double v : place(j))
          if (std::abs(u) <= 1 && std::abs(v) <= 1) {
            const Vec3 d = Vec3(1, u, v).normalized();
            cell[cube_cell(d, {.cells = kCells})].push_back(d);
          }
    }
  double widest = 0;
  for (const std::vector<Vec3>& in : cell)
    for (const Vec3& a : in)
      for (const Vec3& b : in) widest = std::max(widest, angle(a, b));
  EXPECT_NEAR(widest, std::acos(0.8), 1e-6);

  Random random(8);
  for (const bool equi_angular : {false, true}) {
    std::vector<int> count(6 * 8 * 8);
    for (int i = 0; i < 2000000; ++i)
      ++count[cube_cell(random.direction(), {.cells = 8, .equi_angular = equi_angular})];
    const auto [least, most] = std::ranges::minmax_element(count);
    const double ratio = double(*most) / *least;  // to sqrt(2) and 3 sqrt(3) as cells shrink; 3 % by sampling
    if (equi_angular) {
      EXPECT_LT(ratio, std::sqrt(2.0) * 1.04);
    } else {
      EXPECT_GT(ratio, 3.5);
    }
  }
}

TEST(NormalClusters, T_2_5_T_2_6_AreTheBundlesAndNeverOppositeOnes) {
  Random random(21);
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const std::vector<std::vector<Vec3>> scenes = {
      {z}, {z, x}, {x, y, z}, {z, -z}, {x, -x, y}, {x, -x, y, -y}, {x, -x, y, -y, z, -z}};
  for (const NormalClustering method : {NormalClustering::kmeans, NormalClustering::cube_map})
    for (const std::vector<Vec3>& bundles : scenes) {
      std::vector<Vec3> normals;
      std::vector<int> bundle;
      for (int i = 0; i < 30; ++i)
        for (std::size_t b = 0; b < bundles.size(); ++b) {
          normals.push_back(near(bundles[b], 2 * kDegree, random));
          bundle.push_back(int(b));
        }
      // One cell per face: then bundles are cells.
      NormalClusterOptions options{.method = method};
      if (method == NormalClustering::cube_map) options.cube.cells = 1;
      const NormalClusters found = cluster_normals(contacts_of(normals), options);
      const bool exact = method == NormalClustering::cube_map || bundles.size() <= 3;
      if (exact) {
        EXPECT_EQ(found.centre.size(), bundles.size());
      }
      for (std::size_t i = 0; i < normals.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const bool together = found.label[i] == found.label[j];
          if (bundle[i] == bundle[j]) {
            ASSERT_TRUE(together) << "a bundle is torn";
          } else if (exact || normals[i].dot(normals[j]) < -0.5) {
            ASSERT_FALSE(together);
          }
        }
    }
}

// Fewer groups than directions: k-means with k = 1 would average them to nothing.
TEST(NormalClusters, T_2_6_AreSplitByTheGuardWhereNormalsCancel) {
  const NormalClusters found =
      cluster_normals(contacts_of({Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitX(), -Vec3::UnitX()}), {.k = 1});
  EXPECT_EQ(found.label, (std::vector<int>{1, 0, 1, 0}));  // the last is the deepest
  EXPECT_EQ(found.splits, 1);
  EXPECT_EQ(found.centre, (std::vector<Vec3>{-Vec3::UnitX(), Vec3::UnitX()}));
}

TEST(NormalClusters, T_2_7_DoNotDependOnTheOrderOfTheSet) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    std::vector<Vec3> normals;
    for (int i = 0; i < 40; ++i) normals.push_back(random.direction());
    const ContactSet set = contacts_of(normals);
    std::vector<int> from;
    const ContactSet other = shuffled(set, random, from);
    for (const NormalClustering method : {NormalClustering::kmeans, NormalClustering::cube_map}) {
      const NormalClusters a = cluster_normals(set, {.method = method}),
                           b = cluster_normals(other, {.method = method});
      ASSERT_EQ(a.centre, b.centre) << "seed " << seed;
      for (std::size_t i = 0; i < from.size(); ++i)
        ASSERT_EQ(b.label[i], a.label[from[i]]) << "seed " << seed;
      for (std::size_t i = 0; i < normals.size(); ++i)
        ASSERT_LE(angle(normals[i], a.centre[a.label[i]]), 60 * kDegree + 1e-12);
    }
  }
}

TEST(NormalClusters, T_2_8_AreAtRestAfterThreeIterationsIfBundlesAreApart) {
  for (unsigned seed = 0; seed < 10000; ++seed) {
    Random random(seed);
    std::vector<Vec3> centre = {random.direction()};
    while (centre.size() < 3) {
      const Vec3 d = random.direction();
      if (std::ranges::all_of(centre, [&](const Vec3& c) { return angle(c, d) > 50 * kDegree; }))
        centre.push_back(d);
    }
    std::vector<Vec3> normals;
    for (int i = 0; i < 18; ++i) normals.push_back(near(centre[i % 3], 5 * kDegree, random));
    const NormalClusters found = cluster_normals(contacts_of(normals));
    ASSERT_TRUE(found.converged && found.iterations <= 3) << "seed " << seed;
    ASSERT_EQ(found.centre.size(), 3u) << "seed " << seed;
  }
}

TEST(NormalClusters, T_2_9_KeepTheirLabelsWhileNormalsTurnSlowly) {
  Random random(31);
  std::vector<Vec3> normals;
  for (const Vec3& b : {Vec3(1, 0, 0), Vec3(0, 1, 0.2), Vec3(-0.5, 0.1, 1)})
    for (int i = 0; i < 20; ++i) normals.push_back(near(b.normalized(), 4 * kDegree, random));
  const Vec3 axis = Vec3(0.3, -0.2, 0.9).normalized();
  NormalClusters last = cluster_normals(contacts_of(normals));
  const std::vector<int> label = last.label;
  ASSERT_EQ(last.centre.size(), 3u);
  for (int step = 1; step <= 360; ++step) {
    std::vector<Vec3> turned;
    for (const Vec3& n : normals) turned.push_back(exp_so3(step * kDegree * axis) * n);
    ContactSet set = contacts_of(turned);
    for (std::size_t i = 0; i < set.points.size(); ++i)  // and another contact is the deepest
      set.points[i].gap = -1e-3 * double((7 * i + std::size_t(step)) % set.points.size());
    last = cluster_normals(set, {}, last.centre);
    ASSERT_EQ(last.label, label) << "step " << step;
  }
}

TEST(NormalClusters, RefuseWhatIsNoNormal) {
  ContactSet set = contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  EXPECT_TRUE(cluster_normals({}).centre.empty());
  set.points[1].normal *= 2;
  EXPECT_NE(message_of([&] { cluster_normals(set); }).find("contact 1: the normal"), std::string::npos);
  set.points[1].normal /= 2;
  set.points[1].gap = std::nan("");
  EXPECT_NE(message_of([&] { cluster_normals(set); }).find("contact 1: the gap"), std::string::npos);
  set.points[1].gap = 0;
  set.points[1].b.body = 2;
  EXPECT_NE(message_of([&] { cluster_normals(set); }).find("contact 1 is of another pair"),
            std::string::npos);
  EXPECT_NE(message_of([&] { cluster_normals(set, {.k = 0}); }).find("NormalClusterOptions::k = 0"),
            std::string::npos);
  EXPECT_NE(message_of([] { cube_cell(Vec3::Zero()); }).find("unit length"), std::string::npos);
}

// Every contact once, of one pair and one bundle, the deepest first; whatever the order of the set.
TEST(NormalClusters, OfManyPairsAreWhatReducersTake) {
  Random random(9);
  ContactSet set;
  for (int pair = 0; pair < 3; ++pair)
    for (int i = 0; i < 20; ++i) {
      ContactPoint c;
      c.a.body = BodyId::at(pair), c.b.body = c.a.body + (1 + pair % 2);
      c.a.simplex = i;
      c.normal = near(i % 2 ? Vec3::UnitX() : Vec3::UnitZ(), 2 * kDegree, random);
      c.gap = random.uniform(-1e-3, 0);
      set.points.push_back(c);
    }
  std::vector<int> from;
  const ContactSet other = shuffled(set, random, from);
  const Clusters clusters = clusters_by_normals(set), again = clusters_by_normals(other);
  ASSERT_EQ(clusters.size(), 6u);
  ASSERT_EQ(again.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    ASSERT_EQ(clusters[k].size(), 10u);
    for (std::size_t i = 0; i < 10; ++i) {
      EXPECT_EQ(from[again[k][i]], clusters[k][i]);
      const ContactPoint &a = set.points[clusters[k][0]], &b = set.points[clusters[k][i]];
      EXPECT_LE(a.gap, b.gap);
      EXPECT_EQ(a.a.body, b.a.body);
      EXPECT_GT(a.normal.dot(b.normal), 0.9);
    }
  }
}

MatX random_points(Random& random, int dim, int n) {
  MatX out(dim, n);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < dim; ++k) out(k, i) = random.uniform(-1, 1) + (i % 3 == k ? 1 : 0);
  return out;
}

std::vector<KMeansSeeding> every_seeding(const MatX& points) {
  return {SeedFarthest{}, SeedRandom{7}, SeedPlusPlus{7}, SeedWarm{points.leftCols(2)}};
}

TEST(KMeans, T_2_10_T_2_11_T_2_12_DescendsToAFixedPointAndStaysThere) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const int dim = 2 + int(seed % 6);
    const MatX x = random_points(random, dim, 60);
    VecX w = VecX::Ones(60);
    if (seed % 2)
      for (double& weight : w) weight = random.uniform();
    for (const KMeansSeeding& seeding : every_seeding(x)) {
      const KMeans found = kmeans(x, w, {.k = 5, .seeding = seeding});
      ASSERT_TRUE(found.converged);
      for (std::size_t i = 1; i < found.objective.size(); ++i)
        ASSERT_LE(found.objective[i], found.objective[i - 1] * (1 + 1e-14)) << "seed " << seed;
      for (int c = 0; c < found.centres.cols(); ++c) {
        VecX sum = VecX::Zero(dim);
        double weight = 0;
        for (int i = 0; i < 60; ++i)
          if (found.label[i] == c) sum += w[i] * x.col(i), weight += w[i];
        if (weight > 0) {
          ASSERT_LT((found.centres.col(c) - sum / weight).norm(), 1e-12);
        }
      }
      for (int i = 0; i < 60; ++i)  // each at its nearest
        for (int c = 0; c < found.centres.cols(); ++c)
          ASSERT_LE((x.col(i) - found.centres.col(found.label[i])).norm(),
                    (x.col(i) - found.centres.col(c)).norm());
      const KMeans again = kmeans(x, w, {.k = 5, .seeding = SeedWarm{found.centres}});
      EXPECT_EQ(again.centres, found.centres);
      EXPECT_EQ(again.label, found.label);
      EXPECT_EQ(again.iterations, 1);
    }
  }
}

TEST(KMeans, HandlesFewAndEqualPoints) {
  EXPECT_EQ(kmeans(MatX(3, 0), {}).centres.cols(), 0);
  const MatX one = MatX::Ones(3, 1), same = MatX::Ones(3, 9);
  for (const KMeansSeeding& seeding : every_seeding(MatX::Ones(3, 2))) {
    EXPECT_EQ(kmeans(one, {}, {.seeding = seeding}).label, std::vector<int>{0});
    const KMeans found = kmeans(same, {}, {.seeding = seeding});
    EXPECT_EQ(found.objective.back(), 0);
    EXPECT_EQ(found.label, std::vector<int>(9, 0));
  }
  const KMeans weightless = kmeans(same, VecX::Zero(9), {.seeding = SeedPlusPlus{1}});
  EXPECT_EQ(weightless.centres.cols(), 1);
  EXPECT_EQ(weightless.label, std::vector<int>(9, 0));
}

TEST(KMeans, RefusesWhatIsNoNumber) {
  MatX x = MatX::Ones(2, 3);
  EXPECT_NE(message_of([&] { kmeans(x, VecX::Ones(2)); }).find("2 weights for 3 points"), std::string::npos);
  EXPECT_NE(message_of([&] { kmeans(x, -VecX::Ones(3)); }).find("at least 0"), std::string::npos);
  EXPECT_NE(message_of([&] { kmeans(x, {}, {.k = 0}); }).find("KMeansOptions::k = 0"), std::string::npos);
  EXPECT_NE(message_of([&] { kmeans(x, {}, {.seeding = SeedWarm{MatX::Ones(3, 1)}}); }).find("dimension 3"),
            std::string::npos);
  x(0, 0) = std::nan("");
  EXPECT_NE(message_of([&] { kmeans(x, {}); }).find("finite"), std::string::npos);
}

// Random and PlusPlus choose points as likely as they should, to four standard deviations.
TEST(KMeans, SeedsAreDrawnWithTheirProbabilities) {
  MatX x(1, 4);
  x << 0, 1, 2, 10;
  std::array<int, 4> random{}, far{};
  for (unsigned seed = 0; seed < 4000; ++seed) {
    const KMeansOptions none{.k = 2, .seeding = SeedRandom{seed}, .max_iterations = 0};
    for (int c = 0; c < 2; ++c) {
      const double at = kmeans(x, {}, none).centres(0, c);
      for (int i = 0; i < 4; ++i) random[i] += at == x(0, i);
    }
    const KMeans plus =
        kmeans(x, VecX::Unit(4, 0), {.k = 2, .seeding = SeedPlusPlus{seed}, .max_iterations = 0});
    EXPECT_EQ(plus.centres.cols(), 1) << "only one point weighs";
    const MatX second =
        kmeans(x, VecX::Ones(4), {.k = 2, .seeding = SeedPlusPlus{seed}, .max_iterations = 0}).centres.col(1);
    for (int i = 0; i < 4; ++i) far[i] += second(0, 0) == x(0, i);
  }
  for (const int n : random) EXPECT_NEAR(n, 2000, 4 * std::sqrt(4000 * 0.25));
  // By hand: the second is 10 with 100/105, 81/83 after 1 and so on; 0 with 0, 1/83, 4/69, 100/245.
  const double p = (100 / 105.0 + 81 / 83.0 + 64 / 69.0 + 0) / 4;
  EXPECT_NEAR(far[3], 4000 * p, 4 * std::sqrt(4000 * p * (1 - p)));
}

// 48 points on the rim of the unit disc and three rings inside.
ContactSet disc() {
  ContactSet set;
  for (const double radius : {1.0, 0.75, 0.5, 0.25})
    for (int i = 0; i < 48; ++i) {
      ContactPoint c;
      c.a.body = 0, c.b.body = 1;
      c.a.simplex = int(set.points.size());
      const double phi = 2 * kPi * (i + 0.3) / 48;
      c.x_a = c.x_b = Vec3(radius * std::cos(phi), radius * std::sin(phi), 0);
      set.points.push_back(c);
    }
  return set;
}

// Least support of the means about the origin over that of the disc, by scanning directions.
double margin(const MeanContacts& means) {
  double least = kInf;
  for (int i = 0; i < 3600; ++i) {
    const Vec3 d(std::cos(kPi * i / 1800), std::sin(kPi * i / 1800), 0);
    double support = -kInf;
    for (const MeanContact& c : means.contacts) support = std::max(support, d.dot(c.point.x_a));
    least = std::min(least, support);
  }
  return least;
}

TEST(MeanContacts, T_2_13_ShrinkTheSupportOfADisc) {
  const MeanContacts three = mean_contacts(disc(), {}, {}, {.k = 3});
  ASSERT_EQ(three.contacts.size(), 3u);
  RecordProperty("margin_of_3", std::to_string(margin(three)));
  EXPECT_NEAR(margin(three), 0.259, 0.01);
  const double four = margin(mean_contacts(disc(), {}, {}, {.k = 4}));
  RecordProperty("margin_of_4", std::to_string(four));
  EXPECT_NEAR(four, 0.398, 0.01);
}

TEST(MeanContacts, KeepTheirPlaceWhenStartedWarm) {
  ContactSet set = disc();
  const MeanContacts cold = mean_contacts(set, {}, {}, {.seeding = SeedRandom{3}});
  const MeanContacts warm = mean_contacts(set, {}, {}, {.seeding = SeedWarm{cold.centres}});
  EXPECT_EQ(warm.centres, cold.centres);
  EXPECT_EQ(warm.label, cold.label);
  for (ContactPoint& c : set.points) c.x_a.x() += 1e-3, c.x_b.x() += 1e-3;  // KMCW: they follow
  const MeanContacts moved = mean_contacts(set, {}, {}, {.seeding = SeedWarm{cold.centres}});
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT((moved.contacts[i].point.x_a - cold.contacts[i].point.x_a - Vec3(1e-3, 0, 0)).norm(), 1e-12);
}

// By hand: two contacts of one place with other normals are one for positions and two in seven dimensions.
TEST(MeanContacts, InSevenDimensionsTellNormalsAndFrictionApart) {
  ContactSet set = contacts_of({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitY()});
  for (std::size_t i = 0; i < 4; ++i) set.points[i].x_a.z() = set.points[i].x_b.z() = i < 2 ? 0 : 1e-3;
  const MeanContactOptions seven{.rule = MeanRule::position_normal_friction, .k = 2};
  EXPECT_EQ(mean_contacts(set, {}, {}, {.k = 2}).label[0], mean_contacts(set, {}, {}, {.k = 2}).label[1]);
  const MeanContacts by_normal = mean_contacts(set, {}, {}, seven);
  EXPECT_EQ(by_normal.label[0], by_normal.label[2]);
  EXPECT_NE(by_normal.label[0], by_normal.label[1]);
  for (ContactPoint& c : set.points) c.normal = Vec3::UnitZ();
  const MeanContacts by_mu = mean_contacts(set, {0.2, 0.8, 0.3, 0.8}, {1, 1, 3, 1}, seven);
  EXPECT_EQ(by_mu.label[0], by_mu.label[2]);
  EXPECT_NE(by_mu.label[0], by_mu.label[1]);
  const MeanContact& low = by_mu.contacts[by_mu.label[0]];
  EXPECT_NEAR(low.mu, (1 * 0.2 + 3 * 0.3) / 4, 1e-15);
  EXPECT_EQ(low.mu_min, 0.2);
  EXPECT_EQ(low.mu_max, 0.3);
  EXPECT_NEAR(by_mu.mu_spread, 1.5, 1e-15);
}

TEST(MeanContacts, WeighByDepth) {
  ContactSet set = contacts_of({Vec3::UnitZ(), Vec3(0, 0.6, 0.8)});
  set.points[0].gap = -3e-3, set.points[1].gap = -1e-3;
  set.points[1].x_a = set.points[1].x_b = Vec3(1, 0, 0);
  const MeanContacts mean =
      mean_contacts(set, {}, {}, {.rule = MeanRule::position_depth, .k = 1, .depth_floor = 1e-12});
  ASSERT_EQ(mean.contacts.size(), 1u);
  const ContactPoint& c = mean.contacts[0].point;
  EXPECT_LT((mid_point(c) - Vec3(0.25, 0, 0)).norm(), 1e-9);
  EXPECT_LT((c.normal - (3 * Vec3::UnitZ() + Vec3(0, 0.6, 0.8)).normalized()).norm(), 1e-9);
  EXPECT_EQ(c.gap, -3e-3);
  EXPECT_NEAR(c.normal.dot(c.x_a - c.x_b), c.gap, 1e-15);
}

TEST(MeanContacts, DoNotDependOnTheOrderOfTheSetAndCountNormalsThatCancel) {
  Random random(4);
  const ContactSet set = disc();
  for (const MeanRule rule :
       {MeanRule::position, MeanRule::position_depth, MeanRule::position_normal_friction}) {
    std::vector<int> from;
    const ContactSet other = shuffled(set, random, from);
    const MeanContacts a = mean_contacts(set, {}, {}, {.rule = rule, .seeding = SeedPlusPlus{5}}),
                       b = mean_contacts(other, {}, {}, {.rule = rule, .seeding = SeedPlusPlus{5}});
    EXPECT_EQ(a.centres, b.centres);
    for (std::size_t i = 0; i < from.size(); ++i) EXPECT_EQ(b.label[i], a.label[from[i]]);
  }
  const MeanContacts opposite = mean_contacts(contacts_of({Vec3::UnitX(), -Vec3::UnitX()}), {}, {}, {.k = 1});
  EXPECT_EQ(opposite.cancelled, 1);
  EXPECT_NEAR(opposite.contacts[0].point.normal.norm(), 1, 1e-15);
  EXPECT_TRUE(mean_contacts({}, {}, {}).contacts.empty());
  ContactSet bad = set;
  bad.points[3].gap = std::nan("");
  EXPECT_NE(message_of([&] { mean_contacts(bad, {}, {}); }).find("contact 3"), std::string::npos);
  EXPECT_NE(message_of([&] { mean_contacts(set, {0.1}, {}); }).find("1 entries of mu"), std::string::npos);
}

}  // namespace
}  // namespace aussois
