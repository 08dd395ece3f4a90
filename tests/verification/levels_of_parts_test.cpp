// SPDX-License-Identifier: Apache-2.0
// Levels of recorded parts at random poses around their paths: what they are off, their distances (LOD-3) and
// smallest gaps (LOD-5), against the certificate's descent and against FCL, which knows nothing of either.
#include <gtest/gtest.h>

#ifdef AUSSOIS_TEST_FCL
#include "bench/peer_fcl.hpp"
#endif
#include "lmd/certificate.hpp"
#include "lmd/coverage.hpp"
#include "lmd/level_contacts.hpp"
#include "lmd/nesting.hpp"
#include "lmd/shape_levels.hpp"
#include "tests/support/sampled_distance.hpp"
#include "tests/support/shared_pair.hpp"

namespace aussois {
namespace {

constexpr int kLevels = 5;

class LevelsOfParts : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    std::optional<AssemblyInput> pair = shared_pair(GetParam());
    if (!pair) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
    input = std::move(*pair);
    const Box& box = input.moving.report.box;
    radius = radius_about(input.moving.complex, (box.lo + box.hi) / 2);
    const auto shape = [&](const SimplicialComplex& complex) {
      return prepare({.complex = complex, .radius = 1e-3 * radius}, {.levels = kLevels, .threads = 2});
    };
    a = shape(input.moving.complex);
    b = shape(input.fixed.complex);
    pieces_a = connected_pieces(a.complex);
    pieces_b = connected_pieces(b.complex);
    ASSERT_GT(std::max(level_count(a), level_count(b)), 0);
  }

  // Up to three radii off the path and turned at will, apart and not one in the other. Distances in between
  // are as likely at every scale.
  std::optional<SE3> random_pose(Random& random, double& distance) const {
    for (int tries = 0; tries < 100; ++tries) {
      const SE3& on_path = input.poses[random.index(int(input.poses.size()))];
      const double far = radius * random.log_uniform(1e-3, 3);
      const SE3 g = {Quat(Eigen::AngleAxisd(std::min(kPi, far / radius), random.direction())) * on_path.R,
                     on_path.p + far * random.direction()};
      distance = base_distance({&a, {}, {.g = g}}, {&b, {}, {}}, kInf);
      if (distance > a.radius + b.radius && !find_nesting({&a, g, 0}, pieces_a, {&b, {}, 1}, pieces_b))
        return g;
    }
    return {};
  }

  void hold_at_random_poses(int count, unsigned seed) const;

  AssemblyInput input;
  double radius = 0;  // of the moving part [m]
  LmdShape a, b;
  Pieces pieces_a, pieces_b;
};

void LevelsOfParts::hold_at_random_poses(int count, unsigned seed) const {
#ifdef AUSSOIS_TEST_FCL
  const FclPair fcl(input.moving.complex, input.fixed.complex);
#endif
  Random random(seed);
  int by_levels = 0;
  for (int i = 0; i < count; ++i) {
    double fine = 0;
    const std::optional<SE3> g = random_pose(random, fine);
    ASSERT_TRUE(g);
    const double tolerance = coverage_tolerance({&a, *g}, {&b});
#ifdef AUSSOIS_TEST_FCL
    ASSERT_NEAR(fcl.distance(*g, {}), fine, 1e-6 * radius) << i;
#endif
    for (int k = 1; k <= kLevels; ++k) {
      const double coarse =
          base_distance({&level_shape(a, k), {}, {.g = *g}}, {&level_shape(b, k), {}, {}}, kInf);
      ASSERT_LE(std::abs(fine - coarse), level_off(a, k) + level_off(b, k)) << i << ", level " << k;
    }
    const double gap = fine - a.radius - b.radius, threshold = gap * random.uniform(1, 1.25);
    const LevelContacts found =
        find_contacts_by_level({&a, *g, 0}, {&b, {}, 1}, {.threshold = threshold}, {.levels = kLevels});
    const double by_level = smallest_gap(found.coarse),
                 smallest = std::min(smallest_gap(found.fine), by_level);
    ASSERT_LE(smallest, gap + tolerance) << i;
    ASSERT_GE(smallest, 2.0 / 3 * gap - tolerance) << i;
    by_levels += by_level < smallest_gap(found.fine);
  }
  EXPECT_GT(by_levels, 0);
}

void expect_off_by_little_more_than_samples(const LmdShape& shape) {
  std::size_t triangles = 0;
  for (int k = 1; k <= level_count(shape); ++k) {
    const LmdShape& level = level_shape(shape, k);
    const double off = std::max(sampled_distance(shape.complex, level.complex),
                                sampled_distance(level.complex, shape.complex));
    EXPECT_GE(level_off(shape, k), off) << "level " << k;
    EXPECT_LE(level_off(shape, k), 2 * off + 2 * (shape.tolerance + level.tolerance)) << "level " << k;
    triangles += level.complex.triangles.size();
  }
  EXPECT_LT(double(triangles), double(shape.complex.triangles.size()) / 3);
}

TEST_P(LevelsOfParts, AreOffByWhatTheySayAndKeepDistancesAndSmallestGaps) {
  expect_off_by_little_more_than_samples(a);
  expect_off_by_little_more_than_samples(b);
  hold_at_random_poses(30, 1);
}
TEST_P(LevelsOfParts, KeepDistancesAndSmallestGapsTenThousandTimes) {
  hold_at_random_poses(10000, 2);
}

INSTANTIATE_TEST_SUITE_P(SharedAssemblies, LevelsOfParts,
                         ::testing::Values("alpha15", "alpha20", "own_bolt_nut", "own_bearing",
                                           "factory_m16_loose", "factory_gear_medium", "screw_387266",
                                           "piston_head", "featuretype_dock", "spot_link_dock"),
                         [](const auto& pair) { return std::string(pair.param); });

}  // namespace
}  // namespace aussois
