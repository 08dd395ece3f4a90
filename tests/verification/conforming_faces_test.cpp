// SPDX-License-Identifier: Apache-2.0
// Questions 3 and 4 of doc/theory/lmd.md: a box on a slab, and convex prisms on prisms. Faces that conform,
// exactly or within alpha, touch at the corners of the polygon they share; the tests know that polygon
// without contacts.
#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/mesh_damage.hpp"

namespace aussois {
namespace {

constexpr LmdOptions kDefault{};
constexpr double kRadius = 1e-3;  // of every shape here [m]

LmdShape prepared(SimplicialComplex complex) {
  return prepare(dilate(std::move(complex), kRadius));
}

Vec3 horizontal(double angle) {
  return {std::cos(angle), std::sin(angle), 0};
}

// The same solid with random vertices in its faces and on its edges, and other triangles.
SimplicialComplex cut_up(const SimplicialComplex& solid, int cuts, Random& random) {
  LooseMesh mesh = loose(solid);
  for (int i = 0; i < cuts; ++i) cut_a_side(mesh, Cut::conforming, 5e-3, 0, random);
  for (int i = 0; i < cuts; ++i) flip_a_flat_edge(mesh, random);
  return make_complex(mesh.vertices, mesh.triangles, {}, true);
}

// ---- Item 3

const Vec3 kBox(0.1, 0.07, 0.05);  // [m]

struct BoxOnSlab {
  SE3 g{}, world{};  // of the box over the slab, and of both
  ContactSet contacts(const LmdShape& box, const LmdShape& slab) const {
    return find_contacts({&box, world * g, 0}, {&slab, world, 1}, {.threshold = 0.04});
  }
};

BoxOnSlab box_on_slab(double tilt, bool aligned, Random& random) {
  const Quat yaw = aligned ? Quat::Identity() : exp_so3(random.uniform(-kPi, kPi) * Vec3::UnitZ());
  const Quat lean = exp_so3(tilt * horizontal(random.uniform(-kPi, kPi)));
  const Vec3 at{aligned ? 0 : random.uniform(-0.3, 0.3), aligned ? 0 : random.uniform(-0.3, 0.3),
                kBox.z() / 2 + 0.02};
  return {{(lean * yaw).normalized(), at}, random.pose(2)};
}

// Its top is z = 0 in its frame.
LmdShape random_slab(Random& random) {
  return prepared(
      transformed_complex(cut_up(make_box(1, 1, 0.1), random.index(40), random), translation(0, 0, -0.05)));
}

LmdShape random_plate(Random& random) {
  const int along = 1 + random.index(9);
  return prepared(make_plate(1, 1, along, 1 + random.index(9)));
}

TEST(ChecklistItem3, ABoxOnASlabHasFourContactsBelowItsCorners) {
  Random random(3);
  for (int mesh = 0; mesh < 40; ++mesh) {  // on solids and on sheets
    const LmdShape box = prepared(cut_up(make_box(kBox.x(), kBox.y(), kBox.z(), 1 + mesh % 3),
                                         random.index(60), random)),
                   slab = mesh % 2 == 0 ? random_slab(random) : random_plate(random);
    for (int sample = 0; sample < 40; ++sample) {
      const double tilt = sample < 2 ? 0 : random.uniform(0, 0.999) * kDefault.alpha;
      const BoxOnSlab s = box_on_slab(tilt, sample == 0, random);
      const ContactSet found = s.contacts(box, slab);
      ASSERT_EQ(found.points.size(), 4U) << "mesh " << mesh << " sample " << sample << " tilt " << tilt;
      for (const int side : {0, 1, 2, 3}) {
        const Vec3 corner =
            s.g * Vec3(kBox.cwiseProduct(Vec3(side & 1 ? 0.5 : -0.5, side & 2 ? 0.5 : -0.5, -0.5)));
        const auto below = std::ranges::count_if(found.points, [&](const ContactPoint& c) {
          const Vec3 foot = inverse(s.world) * c.x_b;
          return (foot - Vec3(corner.x(), corner.y(), kRadius)).norm() < 1e-9 &&
                 std::abs(c.gap - (corner.z() - 2 * kRadius)) < 1e-9;
        });
        EXPECT_EQ(below, 1) << "mesh " << mesh << " sample " << sample << " corner " << side;
      }
    }
  }
}

// By hand: the normal cone of the corner (sx, sy, -1) is an octant; a direction d whose components have the
// wrong sign is asin of the length of these components away from it.
TEST(ChecklistItem3, OnBothSidesOfAlphaTheCornersStayWhoseNormalConesAreNear) {
  Random random(33);
  const LmdShape box = prepared(cut_up(make_box(kBox.x(), kBox.y(), kBox.z()), 30, random)),
                 slab = random_slab(random);
  std::array<int, 5> with_count{};
  for (int sample = 0; sample < 2000; ++sample) {
    const double tilt =
        sample % 2 == 0 ? random.uniform(0.9, 1.1) * kDefault.alpha : random.uniform(0, 3) * kDefault.alpha;
    const BoxOnSlab s = box_on_slab(tilt, false, random);
    const Vec3 d = s.g.R.conjugate() * Vec3(0, 0, -1);
    int expected = 0;
    bool undecided = false;
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0}) {
        const double off = std::asin(std::hypot(std::min(0.0, sx * d.x()), std::min(0.0, sy * d.y())));
        expected += off <= kDefault.alpha;
        undecided |= std::abs(off - kDefault.alpha) < 1e-9;
      }
    if (undecided) continue;
    EXPECT_EQ(int(s.contacts(box, slab).points.size()), expected) << "sample " << sample << " tilt " << tilt;
    ++with_count[expected];
  }
  for (int n = 1; n <= 4; ++n) EXPECT_GT(with_count[n], 50) << n;
}

// ---- Item 4

using Polygon = std::vector<Vec2>;  // convex, counter-clockwise

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Corners on a circle, so that all of them are corners.
Polygon random_polygon(int n, double radius, Random& random) {
  Polygon out;
  for (int k = 0; k < n; ++k) {
    const double angle = (k + random.uniform(-0.3, 0.3)) * 2 * kPi / n;
    out.push_back(radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return out;
}

// Sutherland and Hodgman: what is left of `subject` on the left of each side of `clip`.
Polygon clipped(Polygon subject, const Polygon& clip) {
  for (std::size_t i = 0; i < clip.size(); ++i) {
    const Vec2 &a = clip[i], &b = clip[(i + 1) % clip.size()];
    Polygon left;
    for (std::size_t k = 0; k < subject.size(); ++k) {
      const Vec2 &p = subject[k], &q = subject[(k + 1) % subject.size()];
      const double in_p = cross(b - a, p - a), in_q = cross(b - a, q - a);
      if (in_p >= 0) left.push_back(p);
      if ((in_p < 0) != (in_q < 0)) left.push_back(p + in_p / (in_p - in_q) * (q - p));
    }
    subject = std::move(left);
  }
  return subject;
}

double distance_to_border(const Vec2& x, const Polygon& polygon) {
  double nearest = kInf;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], d = polygon[(i + 1) % polygon.size()] - a;
    const double s = std::clamp(d.dot(x - a) / d.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (x - a - s * d).norm());
  }
  return nearest;
}

// How far the corners of each polygon keep off the other's border.
double clearance(const Polygon& p, const Polygon& q) {
  double least = kInf;
  for (const Vec2& x : p) least = std::min(least, distance_to_border(x, q));
  for (const Vec2& x : q) least = std::min(least, distance_to_border(x, p));
  return least;
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
}

// How far along its sides the contact of two sides of tilted faces lies from their crossing seen from above,
// at most, for faces `d` apart. The sides cross at an angle psi, one of them rises by `tilt` at most: their
// common perpendicular leaves the vertical by tan(lean) = tan(tilt) / sin(psi), the feet are d tan(lean)
// apart across the level side and d tan(lean) / tan(psi) off along it. Infinite if a lean may exceed
// alpha_EE.
double reach_of_crossings(const Polygon& p, const Polygon& q, double tilt, double d) {
  const double most = std::tan(kDefault.alpha_ee);
  double reach = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < q.size(); ++j) {
      const Polygon side{p[i], p[(i + 1) % p.size()]}, other{q[j], q[(j + 1) % q.size()]};
      if (!cross_each_other(side[0], side[1], other[0], other[1]) && clearance(side, other) > d * most)
        continue;
      const Vec2 e = (side[1] - side[0]).normalized(), f = (other[1] - other[0]).normalized();
      const double sine = std::abs(cross(e, f)), lean = std::tan(tilt) / sine;
      if (lean >= most) return kInf;
      reach = std::max(reach, d * lean * std::abs(e.dot(f)) / sine);
    }
  return reach;
}

double smallest_side(const Polygon& p) {
  double least = kInf;
  for (std::size_t i = 0; i < p.size(); ++i) least = std::min(least, (p[(i + 1) % p.size()] - p[i]).norm());
  return least;
}

// Feet on B's base, seen from above.
Polygon feet_on_b(const ContactSet& found) {
  Polygon out;
  for (const ContactPoint& c : found.points) out.push_back((c.x_b - kRadius * c.normal).head<2>());
  return out;
}

double distance_to_nearest(const Vec2& x, const Polygon& points) {
  double nearest = kInf;
  for (const Vec2& p : points) nearest = std::min(nearest, (p - x).norm());
  return nearest;
}

constexpr double kHeight = 0.5;  // of a prism [m]

// A prism whose lower face is in z = 0 of its frame; the one below has its upper face there.
LmdShape upper_prism(const Polygon& p) {
  return prepared(transformed_complex(make_extrusion(p, kHeight), translation(0, 0, kHeight / 2)));
}
LmdShape lower_prism(const Polygon& q) {
  return prepared(transformed_complex(make_extrusion(q, kHeight), translation(0, 0, -kHeight / 2)));
}

// The upper prism's lower face from above, where the frame of the lower one is the world's.
Polygon projected(const Polygon& p, const SE3& g) {
  Polygon out;
  for (const Vec2& x : p) out.push_back((g * Vec3(x.x(), x.y(), 0)).head<2>());
  return out;
}

TEST(ChecklistItem4, ConformingPrismsTouchAtTheCornersOfTheClippedPolygon) {
  const double h = 2 * kRadius + 1e-3;
  // Corners that miss a border by less than the quasi-minimum forgives may count twice: such poses are left
  // out.
  const double band = 1.1 * h * std::tan(kDefault.alpha);
  int poses = 0, apart = 0, close = 0;
  std::array<int, 23> with_corners{};
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const auto polygon = [&] {
      const int corners = 3 + random.index(9);
      return random_polygon(corners, random.uniform(0.3, 1), random);
    };
    const Polygon p = polygon(), q = polygon();
    const SE3 g{exp_so3(random.uniform(-kPi, kPi) * Vec3::UnitZ()),
                Vec3{random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), h}};
    const Polygon seen = projected(p, g), expected = clipped(seen, q);
    if (expected.empty() || clearance(seen, q) < band) {
      ++(expected.empty() ? apart : close);  // apart: prisms side by side share no polygon
      continue;
    }
    const LmdShape upper = upper_prism(p), lower = lower_prism(q);
    const Polygon found = feet_on_b(find_contacts({&upper, g, 0}, {&lower, {}, 1}, {.threshold = 1.5e-3}));
    ASSERT_EQ(found.size(), expected.size()) << "seed " << seed;
    for (const Vec2& x : expected) EXPECT_LT(distance_to_nearest(x, found), 1e-6) << "seed " << seed;
    for (const Vec2& x : found) EXPECT_LT(distance_to_nearest(x, expected), 1e-6) << "seed " << seed;
    ++with_corners[expected.size()];
    ++poses;
  }
  EXPECT_GT(poses, 800) << apart << " apart, " << close << " too close to call";
  for (std::size_t n = 3; n <= 11; ++n) EXPECT_GT(with_corners[n], 5) << n << " corners";
}

// Borders on borders: a corner over a side, sides along sides, the same polygon twice.
TEST(ChecklistItem4, AlignedBordersCountOnce) {
  Random random(44);
  const double h = 2 * kRadius + 1e-3;
  const LmdOptions options{.threshold = 1.5e-3};
  for (int n = 3; n <= 11; ++n) {
    const Polygon p = random_polygon(n, 0.5, random);
    const LmdShape upper = upper_prism(p), lower = lower_prism(p);
    const Polygon found =
        feet_on_b(find_contacts({&upper, translation(0, 0, h), 0}, {&lower, {}, 1}, options));
    ASSERT_EQ(int(found.size()), n);
    for (const Vec2& x : p) EXPECT_LT(distance_to_nearest(x, found), 1e-6);
  }
  const Polygon square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const LmdShape upper = upper_prism(square), lower = lower_prism(square);
  for (const double x : {-0.75, -0.5, 0.0, 0.25, 0.5})
    for (const double y : {-0.75, -0.5, 0.0, 0.25, 0.5}) {
      const SE3 g = translation(x, y, h);
      const Polygon found = feet_on_b(find_contacts({&upper, g, 0}, {&lower, {}, 1}, options));
      const Polygon expected = {{std::max(0.0, x), std::max(0.0, y)},
                                {std::min(1.0, 1 + x), std::max(0.0, y)},
                                {std::min(1.0, 1 + x), std::min(1.0, 1 + y)},
                                {std::max(0.0, x), std::min(1.0, 1 + y)}};
      EXPECT_EQ(found.size(), 4U) << x << " " << y;
      for (const Vec2& corner : expected)
        EXPECT_LT(distance_to_nearest(corner, found), 1e-9) << x << " " << y;
    }
}

// Tilted by less than alpha, a corner over the other face stays where it was, to rounding; crossing sides
// touch within `reach` of their crossing seen from above. Exempt are poses in which two sides are so nearly
// parallel that their perpendicular may leave the vertical by alpha_EE: such crossings may be lost. Where a
// corner is nearer to the other's border, or to the next corner, than contacts reach, one contact is handing
// over to another: their number is not that of the corners, and a contact and its corner, each within reach
// of the end of a side where that happens, are within twice as much of each other.
TEST(ChecklistItem4, TiltedPrismsTouchThereToo) {
  int counted = 0, handing_over = 0, exempt = 0;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    const double size = random.uniform(0.3, 1);
    const int sides_p = 3 + random.index(9);
    const Polygon p = random_polygon(sides_p, size, random);
    const int sides_q = 3 + random.index(9);
    const double size_q = random.uniform(0.3, 1);
    const Polygon q = random_polygon(sides_q, size_q, random);
    const double tilt = random.uniform(0, 0.999) * kDefault.alpha;
    const double h = size * std::sin(tilt) + 2 * kRadius + 1e-3, d = h + size * std::sin(tilt);
    const Quat lean = exp_so3(tilt * horizontal(random.uniform(-kPi, kPi)));
    const Quat yaw = exp_so3(random.uniform(-kPi, kPi) * Vec3::UnitZ());
    const double x = random.uniform(-0.4, 0.4), y = random.uniform(-0.4, 0.4);
    const SE3 g{lean * yaw, Vec3(x, y, h)};
    const Polygon seen = projected(p, g), expected = clipped(seen, q);
    const double reach = reach_of_crossings(seen, q, tilt, d) + d * std::tan(kDefault.alpha);
    if (expected.empty() || reach == kInf) {
      exempt += !expected.empty();
      continue;
    }
    const LmdShape upper = upper_prism(p), lower = lower_prism(q);
    const ContactSet contacts = find_contacts({&upper, g, 0}, {&lower, {}, 1}, {.threshold = d});
    const Polygon found = feet_on_b(contacts);
    const bool hands_over = clearance(seen, q) < reach || smallest_side(expected) < 2 * reach;
    const double bound = hands_over ? 2 * reach : reach;
    for (const Vec2& corner : expected)
      EXPECT_LT(distance_to_nearest(corner, found), bound) << "seed " << seed << " tilt " << tilt;
    for (const Vec2& foot : found)
      EXPECT_LT(distance_to_nearest(foot, expected), bound) << "seed " << seed << " tilt " << tilt;
    handing_over += hands_over;
    if (hands_over) continue;
    EXPECT_EQ(found.size(), expected.size()) << "seed " << seed << " tilt " << tilt;
    for (std::size_t i = 0; i < found.size(); ++i)
      if (contacts.points[i].a.dim == 0) {  // its foot is vertically below it
        EXPECT_LT(distance_to_nearest(found[i], expected), 1e-6) << "seed " << seed << " tilt " << tilt;
      }
    ++counted;
  }
  EXPECT_GT(counted, 2000) << exempt << " exempt, " << handing_over << " handing over";
  EXPECT_GT(handing_over, 100);
}

}  // namespace
}  // namespace aussois
