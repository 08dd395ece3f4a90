// SPDX-License-Identifier: Apache-2.0
// (LOD-1) to (LOD-5), (LOD-8): the bounds of levels against samples and against the independent base
// distance, and the smallest gap of all levels against that of the shapes themselves.
#include <gtest/gtest.h>

#include "geometry/coarse_surface.hpp"
#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/covering_distance.hpp"
#include "lmd/level_contacts.hpp"
#include "lmd/nesting.hpp"
#include "lmd/shape_levels.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"
#include "tests/support/sampled_distance.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 1e-3;

LmdShape levelled(SimplicialComplex complex, int levels = 4) {
  return prepare(dilate(std::move(complex), kDilation), {.levels = levels});
}
const LmdShape& ring() {
  static const LmdShape shape = levelled(make_torus(0.3, 0.05, 160, 40));
  return shape;
}
const LmdShape& bolt() {
  static const LmdShape shape = levelled(make_bolt());
  return shape;
}

SimplicialComplex raised(const SimplicialComplex& plate, const std::function<double(const Vec3&)>& height) {
  std::vector<Vec3> vertices = plate.vertices.to_vector();
  for (Vec3& x : vertices) x.z() += height(x);
  return make_complex(std::move(vertices), plate.triangles);
}

TEST(CoveringDistance, IsThatOfParallelPlates) {
  const SimplicialComplex plate = make_plate(1, 1, 7, 5), fine = make_plate(1, 1, 11, 13);
  for (const double z : {0.0, 1e-4, 0.1}) {
    const SimplicialComplex above = raised(fine, [&](const Vec3&) { return z; });
    for (const auto& [a, b] : {std::pair(&plate, &above), std::pair(&above, &plate)}) {
      EXPECT_GE(covering_distance(*a, *b), z);
      EXPECT_LE(covering_distance(*a, *b), 1.25 * z + 0.25 / 32);  // at the border pieces are as small
    }
  }
}

// What is seen at corners and in the middle of triangles says nothing of what lies between.
TEST(CoveringDistance, SeesAHoleThatNoCornerSees) {
  const SimplicialComplex whole = make_plate(1, 1, 1, 1), grid = make_plate(1, 1, 10, 10);
  std::vector<std::array<int, 3>> rest;
  for (const auto& t : grid.triangles) {  // without the cell around (0.25, -0.15)
    const Vec3 middle = (grid.vertices[t[0]] + grid.vertices[t[1]] + grid.vertices[t[2]]) / 3;
    if ((middle - Vec3(0.25, -0.15, 0)).head<2>().cwiseAbs().maxCoeff() > 0.05) rest.push_back(t);
  }
  ASSERT_EQ(rest.size() + 2, grid.triangles.size());
  const SimplicialComplex holed = make_complex(grid.vertices, rest);
  const double far = 0.05;  // from its middle to its border
  EXPECT_GE(covering_distance(whole, holed), far);
  EXPECT_LE(covering_distance(whole, holed), far + 0.1 / 32 * std::sqrt(2.0) + 1e-9);
  EXPECT_LE(covering_distance(holed, whole), 1e-9);
}

// A bump between the corners and middles of two large triangles, higher than what is seen there.
TEST(CoveringDistance, SeesABumpBesideWhatItSamples) {
  const Vec3 place(0.34, -0.34, 0);
  const SimplicialComplex plate = make_plate(1, 1),
                          bumpy = raised(make_plate(1, 1, 48, 48), [&](const Vec3&x) {
                            const double r = (x - place).head<2>().norm() / 0.15;
                            return r < 1 ? 3e-3 * std::pow(1 - r * r, 2) : 0.0;
                          });
  for (const auto& [a, b] : {std::pair(&plate, &bumpy), std::pair(&bumpy, &plate)}) {
    const double below = sampled_distance(*a, *b, 200000);
    EXPECT_GT(below, 2.9e-3);
    EXPECT_GE(covering_distance(*a, *b), below);
  }
}

// A sheet that turns back under itself covers its plane only as far as its fold.
TEST(CoveringDistance, IsNotDeceivedByAFold) {
  std::vector<Vec3> x;
  for (const double along : {0.0, 0.2, 0.4})
    for (const double across : {0.0, 1.0}) x.emplace_back(along, across, 0);
  for (const double across : {0.0, 1.0}) x.emplace_back(0.2, across, -1e-3);
  const SimplicialComplex folded = make_complex(
      x, std::vector<std::array<int, 3>>{{0, 2, 1}, {1, 2, 3}, {2, 4, 3}, {3, 4, 5}, {4, 6, 5}, {5, 6, 7}});
  const SimplicialComplex plate =
      make_complex(std::vector<Vec3>{Vec3(0, 0, 0), Vec3(0.6, 0, 0), Vec3(0.6, 1, 0), Vec3(0, 1, 0)},
                   std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}});
  EXPECT_GE(covering_distance(plate, folded), 0.2);
}

TEST(CoveringDistance, IsAboveEverySampleOfRandomSurfaces) {
  for (int seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const double rough = std::pow(10, random.uniform(-3, -1));
    const SimplicialComplex bumpy =
        raised(make_plate(1, 1, 20, 20), [&](const Vec3&) { return random.uniform(-rough, rough); });
    const SimplicialComplex coarse = coarse_surface(bumpy, rough);
    ASSERT_FALSE(coarse.triangles.empty());
    for (const auto& [a, b] : {std::pair(&bumpy, &coarse), std::pair(&coarse, &bumpy)}) {
      const double below = sampled_distance(*a, *b), bound = covering_distance(*a, *b);
      EXPECT_GE(bound, below) << seed;
      EXPECT_LE(bound, 1.25 * below + 0.5 * rough + 1.0 / 20 / 32) << seed;
      EXPECT_EQ(bound, covering_distance(*a, *b, 3)) << seed;
    }
  }
}

TEST(Levels, AreSmallerAndContainThePart) {
  for (const LmdShape* shape : {&ring(), &bolt()}) {
    ASSERT_TRUE(shape->levels);
    ASSERT_GE(level_count(*shape), 2);
    std::size_t triangles = shape->complex.triangles.size();
    for (const ShapeLevel& level : shape->levels->coarse) {
      EXPECT_LE(level.shape.complex.triangles.size(), triangles / 4);
      triangles = level.shape.complex.triangles.size();
      EXPECT_EQ(level.shape.radius, shape->radius + level.off);
      const double off = std::max(sampled_distance(shape->complex, level.shape.complex),
                                  sampled_distance(level.shape.complex, shape->complex));
      EXPECT_GE(level.off, off);
      EXPECT_LE(level.off, 2 * off);  // or gaps at which it answers would be needlessly large
    }
  }
}

TEST(Levels, AreTheSameForAnyNumberOfThreads) {
  const LmdShape one = prepare(dilate(make_torus(0.3, 0.05, 80, 20), kDilation), {.levels = 3}),
                 two = prepare(dilate(make_torus(0.3, 0.05, 80, 20), kDilation), {.levels = 3, .threads = 3});
  ASSERT_EQ(level_count(one), level_count(two));
  ASSERT_GE(level_count(one), 1);
  for (int k = 1; k <= level_count(one); ++k) {
    EXPECT_EQ(level_off(one, k), level_off(two, k));
    EXPECT_EQ(level_shape(one, k).complex.triangles, level_shape(two, k).complex.triangles);
  }
}

TEST(Levels, AreNoneOfWiresPointsAndFewTriangles) {
  for (const SimplicialComplex& complex :
       {make_point(), make_polyline({Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0)}), make_box(1, 1, 1)}) {
    const LmdShape shape = levelled(complex);
    ASSERT_TRUE(shape.levels);
    EXPECT_EQ(level_count(shape), 0);
    EXPECT_EQ(&level_shape(shape, 3), &shape);
    EXPECT_EQ(level_off(shape, 3), 0);
  }
  EXPECT_FALSE(prepare(dilate(make_torus(0.3, 0.05, 80, 20), kDilation)).levels);
}

TEST(Levels, RefuseShapesThatDeformAndBadCounts) {
  const auto message = [](const LmdShapeOptions& options) {
    return message_of([&] { prepare(dilate(make_box(1, 1, 1), kDilation), options); });
  };
  EXPECT_NE(message({.deforming = true, .levels = 1}).find("LmdShapeOptions::levels"), std::string::npos);
  EXPECT_NE(message({.levels = -1}).find("LmdShapeOptions::levels"), std::string::npos);
  EXPECT_NE(message({.levels = 9}).find("LmdShapeOptions::levels"), std::string::npos);
}

// A pose of the bolt outside the ring; their distance.
double random_apart(Random& random, SE3& g) {
  static const Pieces of_bolt = connected_pieces(bolt().complex), of_ring = connected_pieces(ring().complex);
  for (;;) {
    g = {random.rotation(), random.vector(0.6)};
    const double distance = base_distance({&bolt(), {}, {.g = g}}, {&ring(), {}, {}}, 10);
    if (distance > 2 * kDilation && !find_nesting({&bolt(), g, 0}, of_bolt, {&ring(), {}, 1}, of_ring))
      return distance;
  }
}

TEST(Levels, KeepDistancesWithinWhatTheyAreOff) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    SE3 g;
    const double fine = random_apart(random, g);
    for (int k = 1; k <= std::max(level_count(bolt()), level_count(ring())); ++k) {
      const double coarse =
          base_distance({&level_shape(bolt(), k), {}, {.g = g}}, {&level_shape(ring(), k), {}, {}}, 10);
      EXPECT_LE(std::abs(fine - coarse), level_off(bolt(), k) + level_off(ring(), k));  // (LOD-3)
    }
  }
}

TEST(LevelContacts, SayNoMoreThanTheShapesThemselvesAndNotMuchLess) {
  Random random(7);
  int by_levels = 0;
  for (int i = 0; i < 300; ++i) {
    SE3 g;
    const double gap = random_apart(random, g) - 2 * kDilation;
    const double threshold = gap * random.uniform(1, 3);
    const LevelUse use{.levels = int(random.uniform(1, 5)),
                       .fine_to = random.uniform(0, 1) < 0.5 ? 0 : random.uniform(0, 0.3)};
    const LevelContacts found =
        find_contacts_by_level({&bolt(), g, 0}, {&ring(), {}, 1}, {.threshold = threshold}, use);
    const double smallest = std::min(smallest_gap(found.fine), smallest_gap(found.coarse));
    const double rounding = 1e-9;
    EXPECT_LE(smallest, gap + rounding) << i;
    EXPECT_GE(smallest, 2.0 / 3 * gap - rounding) << i;
    by_levels += smallest_gap(found.coarse) < smallest_gap(found.fine);
    for (const ContactPoint& c : found.coarse.points) {
      EXPECT_LE(c.gap, threshold);
      EXPECT_GE(c.gap, answers_from(bolt(), ring(), 1) / 2);
    }
  }
  EXPECT_GT(by_levels, 100);
}

TEST(LevelContacts, AreThoseOfTheShapesWhereTheSearchEndsBeforeLevelsBegin) {
  Random random(9);
  const double begin = answers_from(bolt(), ring(), 1);
  for (int i = 0; i < 50; ++i) {
    SE3 g;
    random_apart(random, g);
    const LmdOptions options{.threshold = 0.49 * begin};  // (LOD-5): where the first begins to fade in
    const ContactSet all = find_contacts({&bolt(), g, 0}, {&ring(), {}, 1}, options);
    const LevelContacts found =
        find_contacts_by_level({&bolt(), g, 0}, {&ring(), {}, 1}, options, {.levels = 4});
    EXPECT_TRUE(found.coarse.points.empty());
    ASSERT_EQ(found.fine.points.size(), all.points.size());
    for (std::size_t k = 0; k < all.points.size(); ++k)
      EXPECT_EQ(found.fine.points[k].gap, all.points[k].gap);
  }
}

// Against the exhaustive search on each level, out to where nothing is cut off, and the formula of (LOD-5).
TEST(LevelContacts, AreThoseOfEachLevelFadedByTheirOwnGaps) {
  const int all = std::max(level_count(bolt()), level_count(ring()));
  const auto ramp = [](double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * (3 - 2 * x); };
  Random random(13);
  int faded = 0;
  for (int i = 0; i < 60; ++i) {
    SE3 g;
    const double threshold = (random_apart(random, g) - 2 * kDilation) * random.uniform(1, 2);
    std::vector<double> expected, gaps;
    for (int k = 1; k <= all; ++k) {
      const double from = answers_from(bolt(), ring(), k),
                   to = k < all ? answers_from(bolt(), ring(), k + 1) : kInf;
      if (from == to) continue;  // the finer one answers here too
      for (const ContactPoint& c :
           find_contacts_exhaustive({&level_shape(bolt(), k), g, 0}, {&level_shape(ring(), k), {}, 1},
                                    {.threshold = threshold})
               .points) {
        const double rise =
            ramp((0.75 * from - c.gap) / (0.25 * from)) + (k < all ? ramp((c.gap - to) / (0.25 * to)) : 0.0);
        if (c.gap > from / 2 && c.gap + threshold * rise <= threshold)
          expected.push_back(c.gap + threshold * rise), faded += rise > 0;
      }
    }
    for (const ContactPoint& c :
         find_contacts_by_level({&bolt(), g, 0}, {&ring(), {}, 1}, {.threshold = threshold}, {.levels = all})
             .coarse.points)
      gaps.push_back(c.gap);
    std::ranges::sort(expected);
    std::ranges::sort(gaps);
    ASSERT_EQ(gaps.size(), expected.size()) << i;
    for (std::size_t k = 0; k < gaps.size(); ++k) EXPECT_NEAR(gaps[k], expected[k], 1e-12) << i;
  }
  EXPECT_GT(faded, 20);
}

// A ball that falls along a line through all levels. Gaps of levels come and go at the search distance, and
// are continuous between; those of the shapes end a quarter beyond where levels begin.
TEST(LevelContacts, FadeFromLevelToLevel) {
  const LmdShape ball = prepare(dilate(make_point(), 0.01));
  const double begin = answers_from(ring(), ball, 1), threshold = 0.5, step = 1e-5;
  ASSERT_LT(1.25 * answers_from(ring(), ball, 2), threshold);
  // The slope of a fade is at most 3/2 of the threshold over the narrowest band, a quarter of `begin`.
  const double jump = step * (1 + 1.5 * threshold / (0.25 * begin));
  const auto at = [&](double z, int level) {
    const LevelContacts found = find_contacts_by_level(
        {&ball, translation(0.31, 0.02, z), 0}, {&ring(), {}, 1}, {.threshold = threshold}, {.levels = 2});
    return std::min(smallest_gap(level == 0 ? found.fine : found.coarse), threshold);
  };
  bool levels_came = false;
  double last = at(0.061, 1);
  for (double z = 0.061 + step; z < 0.5; z += step) {
    const double now = at(z, 1), fine = at(z, 0);
    EXPECT_LE(std::abs(now - last), jump) << z;  // what is not found counts as at the threshold
    levels_came = levels_came || (last == threshold && now < threshold);
    EXPECT_TRUE(fine == threshold || fine <= 1.25 * begin) << z;
    last = now;
  }
  EXPECT_TRUE(levels_came);
}

TEST(LevelContacts, BeginFarBeyondTheDilationsHoweverGoodALevelIs) {
  const LmdShape plate = levelled(make_box(1, 1, 0.1, 40));  // flat: hardly off at all
  ASSERT_GE(level_count(plate), 1);
  ASSERT_LT(level_off(plate, 1), 0.5 * kDilation);
  EXPECT_EQ(answers_from(plate, plate, 1), 8 * kDilation);
  EXPECT_EQ(answers_from(plate, plate, 0), 0);
}

}  // namespace
}  // namespace aussois
