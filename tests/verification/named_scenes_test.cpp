// SPDX-License-Identifier: Apache-2.0
// Question 5 of doc/theory/lmd.md: scenes with a name, whose contacts are counted by hand.
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr double kAlpha = LmdOptions{}.alpha, kAlphaEe = LmdOptions{}.alpha_ee;
constexpr double kDilation = 1e-3;  // of every shape here, small against all gaps [m]
constexpr double kDegree = kPi / 180;

LmdShape prepared_scene(SimplicialComplex complex) {
  return prepare(dilate(std::move(complex), kDilation));
}

// Contacts of base complexes nearer than `distance`.
ContactSet contacts(const LmdShape& a, const SE3& g_a, const LmdShape& b, double distance,
                    double alpha = kAlpha) {
  return find_contacts(
      {&a, g_a, 0}, {&b, {}, 1},
      {.threshold = distance - 2 * kDilation, .alpha = alpha, .alpha_ee = std::max(alpha, kAlphaEe)});
}

int count(const LmdShape& a, const SE3& g_a, const LmdShape& b, double distance, double alpha = kAlpha) {
  return int(contacts(a, g_a, b, distance, alpha).points.size());
}

Quat yaw(double angle) {
  return exp_so3(angle * Vec3::UnitZ());
}

Quat tilt_below_alpha(Random& random) {
  return exp_so3(random.vector_of_length(0, 0.999 * kAlpha));
}

// Unit cubes at integer places, as one solid.
SimplicialComplex make_blocks(const std::vector<std::array<int, 3>>& cells) {
  std::map<std::array<int, 3>, int> index;
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [place, is_new] = index.try_emplace(at, int(vertices.size()));
    if (is_new) vertices.emplace_back(at[0], at[1], at[2]);
    return place->second;
  };
  for (const std::array<int, 3>& cell : cells)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        std::array<int, 3> neighbour = cell, corner = cell;
        neighbour[axis] += side ? 1 : -1;
        if (std::ranges::count(cells, neighbour)) continue;
        corner[axis] += side;
        const std::size_t u = (axis + (side ? 1 : 2)) % 3,
                          v = (axis + (side ? 2 : 1)) % 3;  // u x v: outwards
        std::array<int, 3> b = corner, c = corner, d = corner;
        ++b[u], ++c[u], ++c[v], ++d[v];
        triangles.push_back({vertex(corner), vertex(b), vertex(c)});
        triangles.push_back({vertex(corner), vertex(c), vertex(d)});
      }
  return make_complex(vertices, triangles, {}, true);
}

// A profile in (x, z), counter-clockwise seen against y, drawn out along y.
SimplicialComplex make_bar(const std::vector<Vec2>& profile, double length) {
  return transformed_complex(make_extrusion(profile, length), rotation(Vec3::UnitX(), kPi / 2));
}

TEST(ChecklistItem5, AStandingCylinderHasAContactPerFacet) {
  Random random(51);
  const LmdShape plate = prepared_scene(make_plate(1, 1, 3, 3));
  for (const int n : {3, 8, 16, 24, 48, 128}) {
    const LmdShape cylinder = prepared_scene(make_cylinder(0.05, 0.1, n));
    for (int sample = 0; sample < 20; ++sample) {
      const Quat lean = sample == 0 ? Quat::Identity() : tilt_below_alpha(random);
      const SE3 g{lean * yaw(random.uniform(-kPi, kPi)),
                  Vec3{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.06}};
      EXPECT_EQ(count(cylinder, g, plate, 0.02), n) << "sample " << sample;
    }
  }
}

// By hand: the end vertices of a crease hold the directions up to delta / 2 from it, delta the facet angle;
// so all creases within delta / 2 + alpha of the lowest line touch, at both ends. For alpha < delta / 2 these
// are one crease or, lying on a facet, two; beyond, two or three.
TEST(ChecklistItem5, ALyingCylinderTouchesAlongTheCreasesNearItsLowestLine) {
  Random random(52);
  const LmdShape plate = prepared_scene(make_plate(1, 1, 3, 3));
  const int n = 16;
  const double delta = 2 * kPi / n;
  const LmdShape cylinder = prepared_scene(make_cylinder(0.05, 0.1, n));
  std::map<int, int> seen;
  for (int sample = 0; sample < 600; ++sample) {
    const double alpha = std::array{2 * kDegree, 8 * kDegree, 12 * kDegree}[sample % 3];
    const double roll = sample < 3   ? 0          // on a crease
                        : sample < 6 ? delta / 2  // on a facet
                                     : random.uniform(-kPi, kPi);
    const SE3 g{yaw(random.uniform(-kPi, kPi)) * exp_so3(kPi / 2 * Vec3::UnitX()) * yaw(roll),
                Vec3{random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0.06}};
    const Vec3 down = g.R.conjugate() * Vec3(0, 0, -1);
    int expected = 0;
    for (int k = 0; k < n; ++k) {
      const double off = std::remainder(std::atan2(down.y(), down.x()) - k * delta, 2 * kPi);
      expected += std::abs(off) <= delta / 2 + alpha ? 2 : 0;
    }
    EXPECT_EQ(count(cylinder, g, plate, 0.03, alpha), expected) << "sample " << sample << " roll " << roll;
    ++seen[expected];
  }
  EXPECT_EQ(seen.size(), 3U);  // 2, 4 and 6
}

// A roof below, its normals up to 45 degrees from the vertical, and a blunter one upside down above it, of
// half its length and turned by psi. The creases cross below the middle, unless parallel. The ends of the
// upper crease, s = sin(psi) / 2 beside the lower one, see it in the direction (s, h), or its slope once s >
// h; the part of that direction along the upper crease is what takes it out of the end's normal cone.
TEST(ChecklistItem5, CreaseOnCreaseIsTwoEndsAndOneCrossing) {
  const LmdShape below = prepared_scene(make_bar({{-1, -1}, {1, -1}, {0, 0}}, 2)),
                 above =
                     prepared_scene(make_bar({{0, 0}, {1, std::tan(kPi / 3)}, {-1, std::tan(kPi / 3)}}, 1));
  const double h = 0.01, cutoff = 0.03;
  std::map<int, int> seen;
  for (const double psi : {0.0,  1e-9,  1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.015, 0.02, 0.025,
                           0.03, 0.035, 0.04, 0.05, 0.06, 0.08, 0.1,  0.2,  0.5,  1.0,   1.5,  kPi / 2}) {
    const double s = std::sin(psi) / 2;
    const double distance = s <= h ? std::hypot(s, h) : (s + h) / std::sqrt(2.0);
    const double sideways = s <= h ? s / distance : 1 / std::sqrt(2.0);
    const bool ends = distance <= cutoff && std::asin(std::sin(psi) * sideways) <= kAlpha;
    const int expected = (ends ? 2 : 0) + (psi > 1e-8 ? 1 : 0);
    EXPECT_EQ(count(above, {yaw(psi), Vec3(0, 0, h)}, below, cutoff), expected) << "psi " << psi;
    ++seen[expected];
  }
  EXPECT_EQ(seen.size(), 3U);  // 2, 3 and 1
}

TEST(ChecklistItem5, TwoBallsOnARodAreTwoContactsAtAnyTilt) {
  const LmdShape dimer = prepared_scene(make_complex({Vec3(-0.3, 0, 0), Vec3(0.3, 0, 0)}, {})),
                 rod = prepared_scene(make_segment(2));
  for (const double alpha : {0.0, kAlpha})
    for (const double tilt : {-0.5, -0.1, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 0.1, 0.5}) {
      const SE3 g{exp_so3(tilt * Vec3::UnitY()), Vec3(0.1, 0.02, 0.3)};
      EXPECT_EQ(count(dimer, g, rod, 1, alpha), 2) << "alpha " << alpha << " tilt " << tilt;
    }
}

// The singularity of a minimum is that it jumps from end to end at no tilt; the quasi-minima cover it openly.
TEST(ChecklistItem5, ADumbbellOnARodIsTwoContactsBelowAlphaAndOneBeyond) {
  const LmdShape dumbbell = prepared_scene(make_segment(0.6)), rod = prepared_scene(make_segment(2));
  for (const double tilt :
       {-0.3, -1.01 * kAlpha, -0.99 * kAlpha, -1e-6, 0.0, 1e-6, 0.99 * kAlpha, 1.01 * kAlpha, 0.3}) {
    const SE3 g{exp_so3(tilt * Vec3::UnitY()), Vec3(0.1, 0, 0.3)};
    const ContactSet strict = contacts(dumbbell, g, rod, 1, 0), quasi = contacts(dumbbell, g, rod, 1);
    EXPECT_EQ(strict.points.size(), tilt == 0 ? 2U : 1U) << tilt;
    EXPECT_EQ(quasi.points.size(), std::abs(tilt) < kAlpha ? 2U : 1U) << tilt;
    if (tilt != 0) {
      ASSERT_FALSE(strict.points.empty());
      EXPECT_GT(strict.points[0].x_a.x() * tilt, 0) << "the lower end";
    }
  }
}

// A block with a hole of n facets around z.
SimplicialComplex make_ring(double outer, double inner, double height, int n) {
  std::vector<Vec3> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < n; ++i)  // 4 i: outside below, then outside above, inside above, inside below
    for (const auto& [r, z] : {std::pair(outer, -height / 2), std::pair(outer, height / 2),
                               std::pair(inner, height / 2), std::pair(inner, -height / 2)})
      vertices.emplace_back(r * std::cos(2 * kPi * i / n), r * std::sin(2 * kPi * i / n), z);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) {
      const int a = 4 * i, b = 4 * ((i + 1) % n), next = (k + 1) % 4;
      triangles.push_back({a + k, b + k, b + next});
      triangles.push_back({a + k, b + next, a + next});
    }
  return make_complex(vertices, triangles, {}, true);
}

// By hand: every vertex at the end of the peg touches the facet of the hole that it faces, and every crease
// of the peg crosses that facet's upper rim: 32. The next facet counts too while its normal is at most alpha
// beyond the crease's arc, which is the yaw from where crease faces crease, and while the foot is on it: 64.
TEST(ChecklistItem5, APegOfSixteenFacetsInAHoleHasThirtyTwoToSixtyFourContacts) {
  Random random(55);
  const int n = 16;
  const double delta = 2 * kPi / n, hole = 0.05;
  const LmdShape block = prepared_scene(make_ring(0.1, hole, 0.2, n));
  std::map<int, int> seen;
  for (const double r : {0.9 * hole, 0.96 * hole}) {
    const LmdShape peg = prepared_scene(make_cylinder(r, 0.2, n));
    for (int sample = 0; sample < 100; ++sample) {
      const double turn = sample == 0   ? 0
                          : sample < 50 ? random.uniform(0, 2) * kAlpha
                                        : random.uniform(0, delta / 2);
      const bool next = turn <= kAlpha && r * std::sin(delta / 2 + turn) <= hole * std::sin(delta / 2);
      const int expected = next ? 64 : 32;
      EXPECT_EQ(count(peg, {yaw(turn), Vec3(0, 0, 0.13)}, block, 0.02), expected) << "turn " << turn;
      ++seen[expected];
      const Quat lean =
          exp_so3(0.05 * kAlpha * random.direction());  // a jam, the peg being 1 wide and 2 long
      const int jammed = count(peg, {lean * yaw(turn), Vec3(0, 0, 0.13)}, block, 0.02);
      EXPECT_GE(jammed, 32) << "turn " << turn;
      EXPECT_LE(jammed, 64) << "turn " << turn;
    }
  }
  EXPECT_EQ(seen.size(), 2U);
  EXPECT_GT(seen[64], 5);
}

TEST(ChecklistItem5, ACubeInACornerHasFourContactsPerWall) {
  std::vector<std::array<int, 3>> cells;
  for (int i = 0; i < 7; ++i) cells.push_back({i & 1, i >> 1 & 1, i >> 2 & 1});  // all but the eighth
  const LmdShape corner = prepared_scene(make_blocks(cells)), cube = prepared_scene(make_box(0.5, 0.5, 0.5));
  Random random(56);
  for (int sample = 0; sample < 200; ++sample) {
    const SE3 g{sample == 0 ? Quat::Identity() : tilt_below_alpha(random), Vec3(1.28, 1.29, 1.3)};
    const ContactSet found = contacts(cube, g, corner, 0.1);
    EXPECT_EQ(found.points.size(), 12U) << "sample " << sample;
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(std::ranges::count_if(found.points,
                                      [&](const ContactPoint& c) { return c.normal[axis] > 1 - 1e-12; }),
                4);
  }
}

// The L of the two scenes below: an arm over the edge of the step and an arm in front of its riser. The
// crease between the arms is concave; it ends in two saddle vertices.
SimplicialComplex make_l() {
  return make_blocks({{-1, 0, 1}, {0, 0, 1}, {-1, 0, 0}});
}

// By hand: tread and arm share a rectangle, riser and arm another one. Two corners of each are vertices of
// the L against a face; the other two are sides of the L that cross the edge of the step. The concave crease
// and its saddle vertices are silent.
TEST(ChecklistItem5, AnLBlockOnAStepHasFourContactsPerFace) {
  std::vector<std::array<int, 3>> cells;
  for (int y = -2; y < 3; ++y)
    for (int x = -2; x < 2; ++x)
      for (int z = -2; z < (x < 0 ? -1 : 1); ++z) cells.push_back({x, y, z});
  const LmdShape step = prepared_scene(make_blocks(cells)), block = prepared_scene(make_l());
  Random random(57);
  for (int sample = 0; sample < 200; ++sample) {
    const SE3 g{sample == 0 ? Quat::Identity() : tilt_below_alpha(random),
                Vec3(-0.1, random.uniform(-1, 1), 0.1)};
    const ContactSet found = contacts(block, g, step, 0.25);
    EXPECT_EQ(found.points.size(), 8U) << "sample " << sample;
    EXPECT_EQ(std::ranges::count_if(found.points,
                                    [](const ContactPoint& c) { return c.a.dim == 0 && c.b.dim == 2; }),
              4);
    EXPECT_EQ(std::ranges::count_if(found.points,
                                    [](const ContactPoint& c) { return c.a.dim == 1 && c.b.dim == 1; }),
              4);
  }
}

// (KIN-11), E4: a point passes the end of an edge at a saddle vertex. What vanishes there, at distance d, is
// dominated by what stays: the front of the other arm at d cos(delta), delta the angle by which the direction
// points into that arm.
TEST(ChecklistItem5, AtASaddleVertexAContactVanishesBehindANearerOne) {
  const LmdShape block = prepared_scene(make_l()), ball = prepared_scene(make_point());
  const double front = 0.05, under = 0.08, d = std::hypot(front, under), step = 1e-6;
  const auto at = [&](double x) {
    return contacts(ball, translation(x, 1 + front, 1 - under), block, 0.2).points;
  };
  const std::vector<ContactPoint> before = at(step), after = at(-step);
  ASSERT_EQ(before.size(), 2U);  // the lower side of the upper arm, the upright side of the lower arm
  ASSERT_EQ(after.size(), 1U);   // the front of the lower arm
  EXPECT_NEAR(std::max(before[0].gap, before[1].gap) + 2 * kDilation, d, 1e-12);
  EXPECT_NEAR(smallest_gap({before}) + 2 * kDilation, front, 1e-10);  // step^2 / (2 front)
  const double delta = std::asin(under / d);
  EXPECT_NEAR(after[0].gap + 2 * kDilation, d * std::cos(delta), 1e-12);
  EXPECT_EQ(after[0].b.dim, 2);
}

// A valley whose slopes rise by 30 degrees, and a V with slopes of `rise` above it. By hand: a sharper V
// touches both slopes with both ends of its crease (4); a blunter one with the upper corners alone, two per
// slope (4); one that fits with both (8).
TEST(ChecklistItem5, AVOverAConcaveValleyTouchesBothSlopes) {
  const double slope = std::tan(30 * kDegree);
  const LmdShape valley =
      prepared_scene(make_bar({{-2, -1}, {2, -1}, {2, 2 * slope}, {0, 0}, {-2, 2 * slope}}, 4));
  struct Case {
    double rise, height, distance;
    int expected;
    double crease_contacts;  // how many are at the crease
  };
  Random random(59);
  for (const Case& c : {Case{50, 0.1, 0.3, 4, 4}, Case{30, 0.1, 0.3, 8, 4}, Case{20, 0.3, 0.5, 4, 0}}) {
    const double top = std::tan(c.rise * kDegree);
    const LmdShape v = prepared_scene(make_bar({{0, 0}, {1, top}, {-1, top}}, 1));
    for (int sample = 0; sample < 50; ++sample) {
      const SE3 g{sample == 0 ? Quat::Identity() : tilt_below_alpha(random),
                  Vec3(0, random.uniform(-1, 1), c.height)};
      const ContactSet found = contacts(v, g, valley, c.distance);
      EXPECT_EQ(int(found.points.size()), c.expected) << "rise " << c.rise << " sample " << sample;
      EXPECT_EQ(std::ranges::count_if(found.points,
                                      [&](const ContactPoint& p) { return (inverse(g) * p.x_a).z() < 0.1; }),
                c.crease_contacts)
          << "rise " << c.rise << " sample " << sample;
    }
  }
}

}  // namespace
}  // namespace aussois
