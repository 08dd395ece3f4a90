// SPDX-License-Identifier: Apache-2.0
#include "lmd/normal_cone.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

// Projection on the polar by Dykstra's cyclic projections on the half-spaces g . n <= 0: slow and
// independent.
Vec3 project_by_dykstra(const std::vector<Vec3>& g, const Vec3& u) {
  std::vector<Vec3> correction(g.size(), Vec3::Zero());
  Vec3 x = u;
  for (int round = 0; round < 20000; ++round) {
    const Vec3 before = x;
    for (std::size_t k = 0; k < g.size(); ++k) {
      const Vec3 y = x + correction[k];
      const Vec3 unit = g[k].normalized();
      x = y - std::max(0.0, unit.dot(y)) * unit;
      correction[k] = y - x;
    }
    if ((x - before).norm() < 1e-15) break;
  }
  return x;
}

TEST(NormalCone, OfAFaceIsItsNormal) {
  const NormalCone cone = make_normal_cone({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, -1}});
  EXPECT_EQ(cone.lineality, 2);
  EXPECT_EQ(angle_to(cone, Vec3(0, 0, 1)), 0);
  EXPECT_NEAR(angle_to(cone, Vec3(0, std::sin(0.1), std::cos(0.1))), 0.1, 1e-12);
}

TEST(NormalCone, OfACubeCornerIsTheOppositeOctant) {
  const NormalCone cone = make_normal_cone({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_EQ(cone.lineality, 0);
  EXPECT_EQ(cone.rays.size(), 3U);
  EXPECT_EQ(angle_to(cone, Vec3(-1, -1, -1).normalized()), 0);
  EXPECT_NEAR(angle_to(cone, Vec3(std::sin(0.2), -std::cos(0.2), 0)), 0.2, 1e-12);
  EXPECT_NEAR(cone.half_angle, std::acos(1 / std::sqrt(3.0)), 1e-6);
}

TEST(NormalCone, LeavesOutRaysThatAreNotExtreme) {
  const NormalCone cone =
      make_normal_cone({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 1, 1}, {1, 2, 3}});
  EXPECT_EQ(cone.rays.size(), 3U);
}

TEST(NormalCone, OfAFlatStarIsARayOrALine) {
  EXPECT_EQ(make_normal_cone({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, -1}}).lineality, 2);
  const NormalCone plane = make_normal_cone({{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}});
  EXPECT_EQ(plane.lineality, 2);
  EXPECT_TRUE(plane.rays.empty());
  EXPECT_EQ(make_normal_cone({{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}, {0, 0, 1}, {0, 0, -1}}).lineality, 3);
}

// A folded star of a real gear, three of whose directions leave a plane by 1e-6.
TEST(NormalCone, OfAFoldedStarHasACapThatHoldsIt) {
  const std::vector<Vec3> star = {{-0.778629584, -0.627483841, 0},
                                  {-0.000472987092, -0.000367878849, -0.99999982},
                                  {0, 0, -1},
                                  {0.00503724515, 0.00382135839, -0.999980011},
                                  {0.807137532, 0.590363452, 0},
                                  {0.430476356, -0.561364437, 0.706795639},
                                  {0.632503405, -0.376158413, 0.677085143}};
  const NormalCone cone = make_normal_cone(star);
  const Vec3 n = Vec3(-0.445065, 0.552676, 0.704604).normalized();
  for (const Vec3& g : star) ASSERT_LT(g.dot(n), -1e-4);
  EXPECT_EQ(angle_to(cone, n), 0);
  EXPECT_LE(std::acos(n.dot(cone.axis)), cone.half_angle);
}

TEST(NormalCone, OfWiresContainsLines) {
  const NormalCone end = make_normal_cone({{1, 0, 0}});
  EXPECT_EQ(end.lineality, 0);
  EXPECT_NEAR(end.half_angle, kPi / 2, 1e-9);
  const NormalCone straight = make_normal_cone({{1, 0, 0}, {-1, 0, 0}});
  EXPECT_EQ(straight.lineality, 1);
  EXPECT_EQ(angle_to(straight, Vec3(0, 0.6, 0.8)), 0);
  EXPECT_EQ(make_normal_cone({}).half_angle, kPi);
}

// Integer stars have many coplanar, opposite and duplicate directions: the hard ones.
class NormalConeOfIntegerStar : public ::testing::TestWithParam<unsigned> {};

TEST_P(NormalConeOfIntegerStar, ProjectsAsDykstraDoesAndItsCapHoldsIt) {
  Random random(GetParam());
  for (int sample = 0; sample < 200; ++sample) {
    const bool half_space = sample % 2 == 0;  // otherwise most stars span everything
    std::vector<Vec3> star;
    const int n = 1 + random.index(9);
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3i d{random.index(5) - 2, random.index(5) - 2,
                              half_space ? random.index(3) : random.index(5) - 2};
      star.push_back(d.cast<double>());
    }
    std::erase_if(star, [](const Vec3& d) { return d.norm() == 0; });
    const NormalCone cone = make_normal_cone(star);
    for (int probe = 0; probe < 5; ++probe) {
      const Vec3 u = random.direction();
      const Vec3 p = project_by_dykstra(star, u);
      const double off = (u - p).norm();
      const double expected = p.norm() < 1e-7 ? kPi / 2 : std::atan2(off, p.norm());
      const double angle = angle_to(cone, u);
      EXPECT_NEAR(std::min(angle, kPi / 2), expected, 1e-5) << "seed " << GetParam() << " sample " << sample;
      if (p.norm() > 1e-6 && angle < kPi / 2 - 0.01) {  // Dykstra converges slowly to zero
        EXPECT_TRUE(may_contain(cone, p.normalized(), 1e-9));
        EXPECT_LE(std::atan2(cone.axis.cross(p).norm(), cone.axis.dot(p)), cone.half_angle + 1e-7);
      }
      if (angle < 0.3) {
        EXPECT_TRUE(may_contain(cone, u, std::sin(0.3) + 1e-12));
      }
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, NormalConeOfIntegerStar, ::testing::Range(0U, 20U));

}  // namespace
}  // namespace aussois
