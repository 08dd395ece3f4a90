// SPDX-License-Identifier: Apache-2.0
// Contacts belong to the shape and not to its triangles: planar regions triangulated in other ways,
// subdivided, jiggled by a tenth of the tolerance of planarity, or torn (loose corners, duplicates,
// T-junctions and triangles of no area, with the same jiggle) and repaired, all give the same contacts to ten
// times that tolerance.
#include <gtest/gtest.h>

#include "geometry/mesh_repair.hpp"
#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/mesh_damage.hpp"

namespace aussois {
namespace {

constexpr double kThreshold = 0.05;
constexpr LmdShapeOptions kShape{};

// An L of height 1: two arms of 2 x 1.
SimplicialComplex make_l_block() {
  const std::vector<Vec2> outline = {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  std::vector<Vec3> x;
  for (const double z : {0.0, 1.0})
    for (const Vec2& p : outline) x.push_back({p.x() - 0.8, p.y() - 0.8, z - 0.5});
  std::vector<std::array<int, 3>> triangles;
  for (int k = 1; k < 5; ++k) {
    triangles.push_back({0, k + 1, k});
    triangles.push_back({6, 6 + k, 6 + k + 1});
  }
  for (int k = 0; k < 6; ++k) {
    const int next = (k + 1) % 6;
    triangles.push_back({k, next, 6 + next});
    triangles.push_back({k, 6 + next, 6 + k});
  }
  return make_complex(x, triangles, {}, true);
}

SimplicialComplex sample(int kind) {
  return kind == 0 ? make_box(1, 1.5, 2) : kind == 1 ? make_cylinder(0.7, 1.6, 12) : make_l_block();
}

enum class Change { retriangulated, subdivided, jiggled, torn };

SimplicialComplex changed(const SimplicialComplex& complex, Change change, double tau_f, Random& random) {
  LooseMesh mesh = loose(complex);
  const double jiggle = change == Change::jiggled || change == Change::torn ? 0.1 * tau_f : 0;
  // A region's plane is that of its largest triangle: if that is small, a jiggle tilts it out of tolerance.
  const double smallest = change >= Change::jiggled ? 0.5 : 0.1;
  for (int i = 0; i < 40 && change != Change::retriangulated; ++i)
    cut_a_side(mesh, Cut::conforming, smallest, jiggle, random);
  for (int i = 0; i < 100; ++i) flip_a_flat_edge(mesh, random);
  if (change == Change::torn) {
    for (int i = 0; i < 20; ++i)
      cut_a_side(mesh, i % 2 == 0 ? Cut::plugged : Cut::t_junction, 0.05, jiggle, random);
    for (int i = 0; i < 5; ++i)
      mesh.triangles.push_back(mesh.triangles[random.index(int(mesh.triangles.size()))]);
    mesh = soup_of(mesh, jiggle, random);
  }
  return repair_mesh(complex_of(mesh)).complex;
}

// B comes along a line until it is 0.01 away: rotated at random, or a face of it nearly parallel to one of A.
SE3 near_pose(const LmdShape& a, const LmdShape& b, bool parallel, Random& random) {
  SE3 g;
  Vec3 from = random.direction();
  if (parallel) {
    from = Vec3{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 1}.normalized();
    const double tilt = random.uniform(2e-3, 0.9 * 2 * kPi / 180);
    const Vec3 about = Vec3(1, random.uniform(-1, 1), 0).normalized();
    g.R = exp_so3(tilt * about) * exp_so3(random.uniform(0, kPi) * Vec3::UnitZ());
  } else {
    g.R = random.rotation();
  }
  double r = 6;
  for (int i = 0; i < 60; ++i) {
    g.p = r * from;
    const double d = base_distance({&a, {}, {}}, {&b, {}, {.g = g}}, 10);
    if (d < 0.011) break;
    r -= d - 0.01;
  }
  return g;
}

// The largest distance from a contact of one set to the nearest one of the other [m].
double one_sided(const ContactSet& from, const ContactSet& to) {
  double worst = 0;
  for (const ContactPoint& p : from.points) {
    double nearest = kInf;
    for (const ContactPoint& q : to.points)
      nearest = std::min(nearest,
                         std::max({(p.x_a - q.x_a).norm(), (p.x_b - q.x_b).norm(), std::abs(p.gap - q.gap)}));
    worst = std::max(worst, nearest);
  }
  return worst;
}

class TessellationInvariance : public ::testing::TestWithParam<Change> {};

TEST_P(TessellationInvariance, GivesTheSameContacts) {
  long contacts = 0, poses = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    // Re-entrant corners are silent only while the planes around them meet exactly: convex parts are jiggled.
    const int kinds = GetParam() >= Change::jiggled ? 2 : 3;
    const SimplicialComplex a = sample(int(seed) % kinds), b = sample(int(seed) / kinds % kinds);
    const double tau_a = kShape.planarity * bounding_box(a).diagonal(),
                 tau_b = kShape.planarity * bounding_box(b).diagonal();
    const LmdShape shape_a = prepare(dilate(a, 0)), shape_b = prepare(dilate(b, 0));
    const SimplicialComplex other_a = changed(a, GetParam(), tau_a, random),
                            other_b = changed(b, GetParam(), tau_b, random);
    ASSERT_TRUE(other_a.solid && other_b.solid);
    EXPECT_FALSE(other_a.triangles == a.triangles) << "nothing was changed";
    const LmdShape changed_a = prepare(dilate(other_a, 0)), changed_b = prepare(dilate(other_b, 0));
    for (int k = 0; k < 6; ++k) {
      const SE3 g = near_pose(shape_a, shape_b, k % 2 == 0, random);
      const ContactSet expected =
          find_contacts({&shape_a, {}, 0}, {&shape_b, g, 1}, {.threshold = kThreshold});
      const ContactSet found =
          find_contacts({&changed_a, {}, 0}, {&changed_b, g, 1}, {.threshold = kThreshold});
      const double tolerance = 10 * std::max(tau_a, tau_b);
      EXPECT_LE(one_sided(expected, found), tolerance) << "pose " << k << ": a contact is missing";
      EXPECT_LE(one_sided(found, expected), tolerance) << "pose " << k << ": a contact is new";
      EXPECT_EQ(found.points.size(), expected.points.size()) << "pose " << k;
      contacts += long(expected.points.size());
      ++poses;
    }
  }
  EXPECT_GT(contacts, 2 * poses) << "the sample is hollow";
}

std::string name_of(const ::testing::TestParamInfo<Change>& instance) {
  const char* const names[] = {"RetriangulatedRegions", "SubdividedMeshes", "JiggledMeshes", "TornMeshes"};
  return names[std::size_t(instance.param)];
}
INSTANTIATE_TEST_SUITE_P(Of, TessellationInvariance,
                         ::testing::Values(Change::retriangulated, Change::subdivided, Change::jiggled,
                                           Change::torn),
                         name_of);

}  // namespace
}  // namespace aussois
