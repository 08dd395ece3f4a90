// SPDX-License-Identifier: Apache-2.0
// Is there a place without a contact? The smallest gap is the distance of the base complexes less the
// dilations, to the tolerance of regions and chains, wherever a probe is aimed at (doc/theory/lmd.md,
// Coverage).
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "tests/support/aimed_poses.hpp"
#include "tests/support/random.hpp"
#include "tests/support/repaired_meshes.hpp"
#include "tests/support/shared_meshes.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 1e-3;

void expect_covered(const CoverageAudit& audit, long poses) {
  EXPECT_EQ(audit.poses + audit.hidden, poses);
  EXPECT_LT(audit.hidden, poses / 50) << "the sample is hollow";
  EXPECT_EQ(audit.holes, 0) << audit.first_hole;
  EXPECT_EQ(audit.early, 0);
}

// A chain's vertex 0.8 um inside of its chord: within the tolerance of chains, outside that of feet.
TEST(Coverage, ThereIsNoSlitBesideAVertexInsideAChain) {
  const LmdShape shape = prepare(dilate(box_with_border({{0.1, 0.8e-6}}), kDilation));
  ASSERT_EQ(shape.straightened.size(), 1U);
  expect_covered(audit_coverage(shape, 20000, 1), 20000);
}

// Two ridges of other flanks meet in line, to less than what makes a corner. A wire crosses them where they
// meet: its line passes those of both beyond their ends, by the bend over the square of the angle.
TEST(Coverage, ThereIsNoSlitWhereChainsGoOnAlmostStraight) {
  int beyond = 0;
  for (const double bend : {-1.9e-8, -4e-9, 4e-9, 1e-8, 1.9e-8, 3e-8}) {
    const std::vector<Vec3> v{{-1, 0, 0},      {0, 0, bend / 2}, {1, 0, 0},     {-0.5, -1, -0.8},
                              {0.5, -1, -0.5}, {-0.5, 1, -0.6},  {0.5, 1, -0.9}};
    const LmdShape roof = prepare(
        dilate(make_complex(v, {{0, 3, 1}, {1, 4, 2}, {1, 3, 4}, {0, 1, 5}, {1, 2, 6}, {1, 6, 5}}), 1e-6));
    const LmdShape wire = prepare(dilate(make_complex({{-0.3, 0, 0}, {0.4, 0, 0}}, {}, {{0, 1}}), 1e-6));
    for (const double angle : {0.005, 0.02, 0.05, 0.1, 0.3, 1.0})
      for (const double aside : {0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6})
        for (const double sign : {-1.0, 1.0})
          for (const double height : {1e-5, 1e-3}) {
            SCOPED_TRACE(testing::Message() << bend << " " << angle << " " << sign * aside << " " << height);
            const SE3 g{exp_so3(angle * Vec3::UnitZ()), Vec3(sign * aside, 0, height)};
            const PosedShape a{&wire, g, 0}, b{&roof, {}, 1};
            const double d = base_distance({&wire, {}, {.g = g}}, {&roof, {}, {}}, 1);
            EXPECT_TRUE(is_covered(a, b, d));
            beyond += bend > 0 && bend / 2 * height / (angle * angle) > 1e-9 * 2 * roof.bounding_radius;
          }
  }
  EXPECT_GT(beyond, 50) << "the slit is nowhere wider than what feet forgive";
}

// A face that a CAD program cut into triangles and wrote with rounded coordinates: creases of 1e-6, some of
// them concave, run out of its corner.
TEST(Coverage, ACornerOfAFaceThatIsNearlyFlatIsNoPit) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<Vec2> front;
    for (double x = -0.5 + random.uniform(0, 0.2); x < 0.5; x += random.uniform(0.01, 0.1)) {
      const double side = random.index(2) ? 1 : -1;
      front.emplace_back(x, side * random.log_uniform(1e-7, 1e-6));
    }
    const LmdShape shape = prepare(dilate(box_with_border(front), 1e-4));
    expect_covered(audit_coverage(shape, 500, seed), 500);
  }
}

// The long sides of a needle are near each other far beyond its tip: a foot there is none.
TEST(Coverage, NoFaceReachesBeyondTheTipOfANeedle) {
  const std::vector<Vec3> v{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5 - 2e-9, 0.5 + 2e-9, 0}};
  const LmdShape sheet =
      prepare(dilate(make_complex(v, {{0, 1, 2}, {0, 2, 4}, {0, 4, 3}, {4, 2, 3}}), kDilation));
  ASSERT_EQ(sheet.flat_triangles, 0);
  const LmdShape point = prepare(dilate(make_point(), kDilation));
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double beyond = random.uniform(0.01, 0.3);
    const SE3 g = translation(1 + beyond, 1 + beyond, random.uniform(0.02, 0.05));
    const double distance = base_distance({&point, {}, {.g = g}}, {&sheet, {}, {}}, 1);
    const ContactSet found = find_contacts_exhaustive({&point, g, 0}, {&sheet, {}, 1}, {.threshold = 1});
    ASSERT_NEAR(smallest_gap(found), distance - 2 * kDilation, 1e-9);
  }
}

TEST(Coverage, IsThatOfRepairedMeshesToo) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const LmdShape shape = prepare(dilate(damaged_and_repaired(seed), kDilation));
    expect_covered(audit_coverage(shape, 600, seed), 600);
  }
}

TEST(Coverage, StraightenedVerticesMoveByNoMoreThanTheTolerance) {
  const SimplicialComplex file = box_with_border({{-0.2, 0.8e-6}, {0.1, -0.5e-6}, {0.3, 1e-12}});
  const LmdShape shape = prepare(dilate(file, kDilation));
  ASSERT_EQ(shape.straightened.size(), 2U) << "the third is on the chord to rounding";
  for (const auto& [v, from] : shape.straightened) {
    EXPECT_EQ(from, file.vertices[v]);
    EXPECT_LE((shape.complex.vertices[v] - from).norm(), shape.tolerance);
    EXPECT_EQ(shape.complex.vertices[v].y(), -0.5);
  }
}

// A point has no planes and chains: of two balls only rounding is left, wherever they are.
TEST(Coverage, OfTwoBallsIsThatOfRounding) {
  const LmdShape ball = prepare(dilate(make_point(), 0.05));
  ASSERT_EQ(ball.tolerance, 0);
  Random random(1);
  for (const double far : {0.0, 1.0, 1000.0})
    for (int k = 0; k < 2000; ++k) {
      const SE3 g_a{.p = random.vector(far)}, g_b{.p = g_a.p + random.vector_of_length(0.09, 0.11)};
      const double d = base_distance({&ball, {}, {.g = g_a}}, {&ball, {}, {.g = g_b}}, 1);
      EXPECT_TRUE(is_covered({&ball, g_a, 0}, {&ball, g_b, 1}, d));
      EXPECT_FALSE(is_covered({&ball, g_a, 0}, {&ball, g_b, 1}, d + 1e-13 * (1 + far)));
    }
}

TEST(Coverage, IsAMatterOfTheSmallestGapAlone) {
  const LmdShape box = prepare(dilate(make_box(1, 1, 1), kDilation));
  const PosedShape a{&box}, b{&box, {.p = {0, 0, 1.1 + 2 * kDilation}}};
  const double off = coverage_tolerance(a, b), gap = 0.1;
  const double distance = gap + 2 * kDilation;
  EXPECT_TRUE(is_covered_by(gap, a, b, distance));
  EXPECT_TRUE(is_covered_by(gap + 0.99 * off, a, b, distance));
  EXPECT_FALSE(is_covered_by(gap + 1.01 * off, a, b, distance)) << "a contact is missing";
  EXPECT_FALSE(is_covered_by(gap - 1.01 * off, a, b, distance)) << "nearer than the bases";
  EXPECT_FALSE(is_covered_by(kInf, a, b, distance));
}

// Of each shared mesh. `poses_of` says how many poses a shape is given; those of the slice are judged.
template <class PosesOf>
void expect_meshes_covered(PosesOf poses_of, long at_least, PoseSlice slice = {}) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  long judged = 0;
  int wires = 0;
  double worst = 0;
  for (const std::filesystem::path& mesh : shared_meshes(data)) {
    SCOPED_TRACE(mesh.filename().string());
    const AssemblyPart part = read_part(mesh, 1e-3);
    if (part.complex.edges.empty()) continue;  // points alone have no border to aim at
    const LmdShape shape = prepare(dilate(part.complex, 1e-4 * part.report.box.diagonal()));
    const long poses = poses_of(shape);
    const CoverageAudit audit = audit_coverage(shape, poses, 1, slice);
    expect_covered(audit, poses / slice.of);
    EXPECT_TRUE(poses < poses_of_all_due(shape) || audit.missed == 0);
    judged += audit.poses;
    wires += part.complex.triangles.empty();
    worst = std::max(worst, audit.worst);
  }
  EXPECT_GT(judged, at_least);
  EXPECT_GE(wires, 3);
  std::printf("%ld aimed poses, worst difference %.3g of the tolerances\n", judged, worst);
}
TEST(SharedMeshes, HaveAContactWhereverAProbeIsAimed) {
  expect_meshes_covered([](const LmdShape&) { return 1000L; }, 20000);
}

// Above every vertex inside a chain and every border of a region. Each slice is a test of its own.
constexpr int kSlices = 16;
class SharedMeshesInSlices : public testing::TestWithParam<int> {};
TEST_P(SharedMeshesInSlices, HaveAContactWhereverAProbeIsAimedAMillionTimes) {
  expect_meshes_covered([](const LmdShape& shape) { return std::max(27000L, poses_of_all_due(shape)); },
                        1000000 / kSlices, {GetParam(), kSlices});
}
INSTANTIATE_TEST_SUITE_P(Slices, SharedMeshesInSlices, testing::Range(0, kSlices));

}  // namespace
}  // namespace aussois
