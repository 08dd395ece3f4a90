// SPDX-License-Identifier: Apache-2.0
// (CA-19): which pieces of a body are inside another, against half spaces of convex shapes and by hand.
#include "lmd/nesting.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "tests/support/compound.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

LmdShape shape_of(SimplicialComplex complex, double radius = 1e-3) {
  return prepare(dilate(std::move(complex), radius));
}

std::optional<Nesting> nesting(const LmdShape& a, const LmdShape& b, const SE3& g_a = {},
                               const SE3& g_b = {}) {
  return find_nesting({&a, g_a, 0}, connected_pieces(a.complex), {&b, g_b, 1}, connected_pieces(b.complex));
}

// Whichever is asked first; at most one of the two can be inside the other.
void expect_inside(const LmdShape& inner, const LmdShape& outer, const SE3& g_inner = {},
                   const SE3& g_outer = {}) {
  const auto one = nesting(inner, outer, g_inner, g_outer), other = nesting(outer, inner, g_outer, g_inner);
  ASSERT_TRUE(one && other);
  EXPECT_TRUE(one->a_in_b);
  EXPECT_FALSE(other->a_in_b);
  EXPECT_EQ(one->pieces, other->pieces);
}
void expect_outside(const LmdShape& a, const LmdShape& b, const SE3& g_a = {}, const SE3& g_b = {}) {
  EXPECT_FALSE(nesting(a, b, g_a, g_b));
  EXPECT_FALSE(nesting(b, a, g_b, g_a));
}

TEST(Nesting, IsSeenOfWhateverIsInsideASolid) {
  const LmdShape block = shape_of(make_box(2, 2, 2));
  Random random(17);
  for (const SimplicialComplex& small :
       {make_box(0.1, 0.1, 0.1), make_plate(0.1, 0.1), make_segment(0.1), make_point()})
    for (int i = 0; i < 20; ++i) {
      const SE3 g = random.pose(10), at{random.rotation(), random.vector(0.9)};
      expect_inside(shape_of(small), block, g * at, g);
      expect_outside(shape_of(small), block, g * translation(1.2, 0, 0) * at, g * translation(-1, 0, 0));
    }
}

// Sheets have no inside, closed ones neither: contacts see both of their sides.
TEST(Nesting, IsNothingOfASheet) {
  const SimplicialComplex box = make_box(2, 2, 2);
  expect_outside(shape_of(make_box(0.1, 0.1, 0.1)), shape_of(make_complex(box.vertices, box.triangles)));
}

TEST(Nesting, IsNothingInACavity) {
  const auto cube = [](double side) { return make_box(side, side, side); };
  const LmdShape room = shape_of(hollow(cube(2), cube(1.4))), ball = shape_of(make_sphere(0.1, 2));
  expect_outside(ball, room);
  expect_outside(room, shape_of(hollow(cube(4), cube(3))));
  // Touching the cavity from within, or what surrounds it: dilations of 1 mm each
  const SE3 leaning = translation(0.7 - 0.1 - 2e-3, 0, 0);
  const LmdShape block = shape_of(cube(0.2)), jacket = shape_of(hollow(cube(4), cube(2.004)));
  ASSERT_NEAR(base_distance({&block, {}, {.g = leaning}}, {&room, {}, {}}, 1), 2e-3, 1e-15);
  ASSERT_NEAR(base_distance({&jacket, {}, {}}, {&room, {}, {}}, 1), 2e-3, 1e-15);
  expect_outside(block, room, leaning);
  expect_outside(room, jacket);
  // In the wall; a hollow body with all of its wall, or with its outer shell only
  expect_inside(shape_of(make_sphere(0.05, 1)), room, translation(0.84, 0, 0));
  expect_inside(room, shape_of(cube(3)));
  EXPECT_EQ(nesting(room, shape_of(cube(3)))->pieces, 2);
  expect_inside(room, shape_of(hollow(cube(3), cube(1))));
  const LmdShape thick = shape_of(hollow(cube(1.7), cube(0.5)));
  for (const auto& found : {nesting(thick, room), nesting(room, thick)}) {  // walls in each other
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->a_in_b);
    EXPECT_EQ(found->pieces, 1);
  }
}

TEST(Nesting, CountsThePiecesThatAreInside) {
  const SimplicialComplex lump = make_box(0.2, 0.2, 0.2);
  const LmdShape block = shape_of(make_box(2, 2, 2)),
                 lumps = shape_of(merged({moved(lump, 3, 0, 0), moved(lump, 5, 0, 0), lump}, true));
  for (const auto& [shift, pieces] :
       {std::pair{0.0, 1}, std::pair{-3.0, 1}, std::pair{-4.0, 0}, std::pair{9.0, 0}}) {
    const auto found = nesting(lumps, block, translation(shift, 0, 0));
    ASSERT_EQ(bool(found), pieces > 0) << shift;
    if (!found) continue;
    EXPECT_TRUE(found->a_in_b);
    EXPECT_EQ(found->pieces, pieces);
    EXPECT_EQ(found->of, 3);
    EXPECT_LT(found->place.lpNorm<Eigen::Infinity>(), 0.1 + 1e-12);
  }
  EXPECT_EQ(to_string(*nesting(lumps, block), "lumps", "block")
                .find("1 of 3 pieces of lumps lie inside the solid of block, one at ("),
            0U);
  // The block may be the one with many pieces, and one of them may be inside a lump of the other
  const LmdShape blocks = shape_of(merged({moved(make_box(2, 2, 2), 9, 0, 0), make_box(2, 2, 2)}, true));
  expect_inside(shape_of(lump), blocks);
  expect_inside(shape_of(lump), blocks, translation(9, 0, 0));
  expect_outside(shape_of(lump), blocks, translation(4.5, 0, 0));
}

TEST(Nesting, IsNothingOfANutOnItsBolt) {
  const FastenerOptions options;
  const LmdShape bolt = shape_of(make_bolt(options), 1e-6), nut = shape_of(make_nut(options), 1e-6);
  for (int i = 0; i <= 36; ++i) {
    const double angle = i * kPi / 18;
    expect_outside(nut, bolt,
                   rotation(Vec3::UnitZ(), angle) * translation(0, 0, options.pitch * angle / (2 * kPi)));
  }
  // A pin in the bore of the nut is not in its steel, in the thread of the bolt it is
  const LmdShape pin = shape_of(make_cylinder(2e-3, 4e-3, 12), 1e-6);
  expect_outside(pin, nut, translation(0, 0, 3e-3));
  expect_inside(pin, bolt, translation(0, 0, 6e-3));
}

// Of convex shapes one is inside the other if all its vertices are behind all faces. Surfaces that cross are
// for the distance to tell.
TEST(Nesting, OfConvexShapesIsThatOfTheirHalfSpaces) {
  Random random(23);
  int inside = 0, outside = 0, crossing = 0;
  for (int i = 0; i < 800; ++i) {
    const double size = random.log_uniform(1e-6, 1e3);
    const LmdShape a = shape_of(transformed_complex(make_sphere(1, 1), {}, size), 0),
                   b = shape_of(
                       transformed_complex(make_box(1, 2, 3), {}, size * random.log_uniform(0.05, 5)), 0);
    const SE3 g_a = random.pose(size), g_b = random.pose(size);
    const auto behind = [](const LmdShape& inner, const SE3& g_in, const LmdShape& outer, const SE3& g_out) {
      const SE3 g = inverse(g_out) * g_in;
      for (const auto& [j, k, l] : outer.complex.triangles) {
        const auto x = [&](int v) { return outer.complex.vertices[v]; };
        const Vec3 n = (x(k) - x(j)).cross(x(l) - x(j));
        for (const Vec3& y : inner.complex.vertices)
          if (n.dot(g * y - x(j)) > 0) return false;
      }
      return true;
    };
    if (base_distance({&a, {}, {.g = g_a}}, {&b, {}, {.g = g_b}}, 10 * size) < 1e-9 * size) {
      ++crossing;
      continue;
    }
    const bool a_in_b = behind(a, g_a, b, g_b), b_in_a = behind(b, g_b, a, g_a);
    const auto found = nesting(a, b, g_a, g_b);
    ASSERT_EQ(bool(found), a_in_b || b_in_a) << i;
    ASSERT_TRUE(!found || found->a_in_b == a_in_b) << i;
    inside += bool(found), outside += !found;
  }
  EXPECT_GT(inside, 80);
  EXPECT_GT(outside, 80);
  EXPECT_GT(crossing, 80);
}

}  // namespace
}  // namespace aussois
