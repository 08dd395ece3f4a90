// SPDX-License-Identifier: Apache-2.0
#include "geometry/mass_properties.hpp"

#include <gtest/gtest.h>

#include "geometry/convex_hull.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// Rounding of a sum of n terms of the size of the result; 100 is generous for meshes of some 10^3 triangles.
constexpr double kRounding = 100 * std::numeric_limits<double>::epsilon();

SimplicialComplex flipped(const SimplicialComplex& complex) {
  auto triangles = complex.triangles.to_vector();
  for (auto& triangle : triangles) std::swap(triangle[1], triangle[2]);
  return make_complex(complex.vertices, triangles);
}

SimplicialComplex union_of(const SimplicialComplex& a, const SimplicialComplex& b) {
  auto vertices = a.vertices.to_vector();
  auto triangles = a.triangles.to_vector();
  vertices.insert(vertices.end(), b.vertices.begin(), b.vertices.end());
  const int shift = int(a.vertices.size());
  for (const auto& [i, j, k] : b.triangles) triangles.push_back({i + shift, j + shift, k + shift});
  return make_complex(vertices, triangles);
}

TEST(MassProperties, OfABoxAreThoseOfTheTextbook) {
  const double a = 0.02, b = 0.03, c = 0.05, density = 7850;
  const MassProperties box = mass_properties(make_box(a, b, c, 2), density);
  const double m = density * a * b * c;
  EXPECT_NEAR(box.volume, a * b * c, kRounding * a * b * c);
  EXPECT_NEAR(box.mass, m, kRounding * m);
  EXPECT_LT(box.centre.norm(), kRounding * c);
  const Vec3 expected = m / 12 * Vec3(b * b + c * c, c * c + a * a, a * a + b * b);
  EXPECT_LT((box.inertia - Mat3(expected.asDiagonal())).norm(), kRounding * expected.norm());
}

TEST(MassProperties, OfTheCornerTetrahedronAreItsIntegralsByHand) {
  // Over {x, y, z >= 0, x + y + z <= 1}: V = 1/6, x = 1/4, integral of x^2 = 1/60, of x y = 1/120.
  const SimplicialComplex corner = make_complex({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}, {}, true);
  const MassProperties m = mass_properties(corner, 6);
  EXPECT_NEAR(m.mass, 1, kRounding);
  EXPECT_LT((m.centre - Vec3::Constant(0.25)).norm(), kRounding);
  const double diagonal = 6 * 2 * (1 / 60.0 - 1 / 96.0);  // central moments: minus V / 16
  const double product = -6 * (1 / 120.0 - 1 / 96.0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(m.inertia(i, j), i == j ? diagonal : product, kRounding);
}

TEST(MassProperties, OfAPrismOverARegularPolygonAreThoseOfThePolygon) {
  const double r = 0.01, h = 0.04, density = 1000;
  const int n = 12;
  const MassProperties prism = mass_properties(make_cylinder(r, h, n), density);
  const double angle = 2 * kPi / n;
  const double area = 0.5 * n * r * r * std::sin(angle);
  const double m = density * area * h;
  const double axial =
      m * r * r * (2 + std::cos(angle)) / 6;  // polar moment of a regular polygon of circumradius r
  const double transverse = axial / 2 + m * h * h / 12;
  EXPECT_NEAR(prism.mass, m, kRounding * m);
  EXPECT_LT((prism.inertia - Mat3(Vec3(transverse, transverse, axial).asDiagonal())).norm(),
            kRounding * transverse);
}

TEST(MassProperties, OfFineSpheresTendToThatOfTheBallAtOrderTwo) {
  double last_error = 0;
  for (int level = 2; level <= 4; ++level) {
    const MassProperties sphere = mass_properties(make_sphere(1, level), 1);
    const double error =
        8 * kPi / 15 - sphere.inertia(0, 0);  // 2/5 m r^2 of the ball, from below: vertices on it
    EXPECT_GT(error, 0);
    if (level > 2) {
      EXPECT_NEAR(last_error / error, 4, 0.3) << "halving the edges, level " << level;
    }
    last_error = error;
  }
}

TEST(MassProperties, MoveWithThePartAlsoFarFromTheOrigin) {
  const SE3 g{Quat(0.5, 0.5, -0.5, 0.5), Vec3(1000, -2000, 500)};  // 10^5 times the size of the part
  const SimplicialComplex part = make_torus(0.02, 0.005, 24, 12);
  const MassProperties here = mass_properties(part, 7850);
  const MassProperties there = mass_properties(transformed_complex(part, g), 7850);
  // The vertices themselves are rounded to 2000 eps, that is 2000 / 0.005 eps relative to the thin side.
  const double rounding = 2000 / 0.005 * kRounding;
  const Mat3 R = g.R.toRotationMatrix();
  EXPECT_NEAR(there.mass, here.mass, rounding * here.mass);
  EXPECT_LT((there.centre - g * here.centre).norm(), 2000 * kRounding);
  EXPECT_LT((there.inertia - R * here.inertia * R.transpose()).norm(), rounding * here.inertia.norm());
}

TEST(MassProperties, AreAdditive) {
  const SimplicialComplex a = transformed_complex(make_box(0.01, 0.02, 0.03), translation(0.1, 0, 0));
  const SimplicialComplex b = transformed_complex(make_sphere(0.02, 2), translation(-0.1, 0.05, 0));
  const MassProperties ma = mass_properties(a, 2700), mb = mass_properties(b, 2700);
  const MassProperties both = mass_properties(union_of(a, b), 2700);
  EXPECT_NEAR(both.mass, ma.mass + mb.mass, kRounding * both.mass);
  EXPECT_LT((both.mass * both.centre - ma.mass * ma.centre - mb.mass * mb.centre).norm(),
            kRounding * both.mass);
  const auto about_common_centre = [&](const MassProperties& m) {  // Huygens and Steiner
    const Vec3 d = m.centre - both.centre;
    return Mat3(m.inertia + m.mass * (d.squaredNorm() * Mat3::Identity() - d * d.transpose()));
  };
  EXPECT_LT((both.inertia - about_common_centre(ma) - about_common_centre(mb)).norm(),
            kRounding * both.inertia.norm());
}

TEST(MassProperties, OfAHollowBoxAreTheDifference) {
  const MassProperties hollow = mass_properties(union_of(make_box(2, 2, 2), flipped(make_box(1, 1, 1))), 3);
  EXPECT_NEAR(hollow.volume, 7, 7 * kRounding);
  EXPECT_NEAR(hollow.inertia(0, 0), 3 * (8 * 8 - 1 * 2) / 12.0, 20 * kRounding);
}

TEST(MassProperties, OfWhatBoundsNoVolumeAreRefused) {
  const SimplicialComplex box = make_box(1, 1, 1);
  EXPECT_THROW(mass_properties(flipped(box), 1000), std::invalid_argument);
  EXPECT_THROW(mass_properties(make_plate(1, 1), 1000), std::invalid_argument);
  EXPECT_THROW(mass_properties(make_segment(1), 1000), std::invalid_argument);
  for (const double density : {0.0, -1.0, std::nan(""), kInf}) {
    EXPECT_THROW(mass_properties(box, density), std::invalid_argument) << density;
    EXPECT_THROW(convex_hull_mass_properties(box, density), std::invalid_argument) << density;
  }
}

TEST(ConvexHullMassProperties, OfAConvexPartAreItsOwn) {
  for (const SimplicialComplex& part :
       {make_box(0.01, 0.02, 0.03, 3), make_sphere(0.01, 3), make_cylinder(0.01, 0.02, 7)}) {
    const MassProperties own = mass_properties(part, 7850), hull = convex_hull_mass_properties(part, 7850);
    EXPECT_NEAR(hull.mass, own.mass, kRounding * own.mass);
    EXPECT_LT((hull.centre - own.centre).norm(), kRounding * 0.01);
    EXPECT_LT((hull.inertia - own.inertia).norm(), kRounding * own.inertia.norm());
  }
}

TEST(ConvexHullMassProperties, NeedNoSurface) {
  const SimplicialComplex corners = make_complex(make_box(1, 2, 3).vertices, {});
  EXPECT_NEAR(convex_hull_mass_properties(corners, 1).volume, 6, 6 * kRounding);
  EXPECT_THROW(convex_hull_mass_properties(make_plate(1, 1, 4, 4), 1), std::invalid_argument);
  EXPECT_THROW(convex_hull_mass_properties(make_segment(1), 1), std::invalid_argument);
}

class ConvexHull : public ::testing::TestWithParam<unsigned> {};

// Brute force: a closed oriented surface that no point lies outside of is the hull.
TEST_P(ConvexHull, OfAnyPointsIsClosedAndNoPointIsOutside) {
  Random random(GetParam());
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const int kind = int(GetParam() % 4);
  std::vector<Vec3> points;
  for (int i = 0; i < 4 + int(GetParam()); ++i) {
    Vec3 x = random.vector();
    if (kind == 1) x.normalize();                // all on the hull
    if (kind == 2) x = (2 * x).array().round();  // few places: many equal, collinear, coplanar
    if (kind == 3) x.z() *= 1e-15;               // flat to rounding
    points.push_back(x);
  }
  if (kind == 2)
    for (const Vec3& corner : make_box(4, 4, 4, 2).vertices) points.push_back(corner);
  const SimplicialComplex hull = make_complex(points, convex_hull(points));
  EXPECT_TRUE(is_closed_oriented(hull));
  for (const auto& [i, j, k] : hull.triangles) {
    const Vec3 a = points[i];
    const Vec3 normal = (points[j] - a).cross(points[k] - a);
    ASSERT_TRUE(kind == 3 || normal.norm() > 0);
    for (const Vec3& x : points)  // 1e-15: rounding of this very formula, coordinates are of order one
      ASSERT_LE(normal.dot(x - a), kind == 2 ? 0 : 1e-15) << "integers are exact";
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, ConvexHull, ::testing::Range(1u, 101u));

TEST(ConvexHullOfPoints, RefusesWhatHasNoVolume) {
  EXPECT_THROW(convex_hull({}), std::invalid_argument);
  EXPECT_THROW(convex_hull(std::vector<Vec3>(9, Vec3::Ones())), std::invalid_argument);
  EXPECT_THROW(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}),
               std::invalid_argument);
  EXPECT_THROW(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, kInf}}),
               std::invalid_argument);
}

// Midpoints of a grid of cells, 60 along a radius: of order two in 1 / 60, so some 1e-3 off.
MassProperties summed_over_a_grid(const Vec3& a, const Vec3& b, double radius, double density) {
  MassProperties out;
  const double cell = radius / 60;
  const Vec3 lo = a.cwiseMin(b).array() - radius, hi = a.cwiseMax(b).array() + radius, d = b - a;
  Mat3 second = Mat3::Zero();
  Vec3 first = Vec3::Zero();
  for (double x = lo.x() + cell / 2; x < hi.x(); x += cell)
    for (double y = lo.y() + cell / 2; y < hi.y(); y += cell)
      for (double z = lo.z() + cell / 2; z < hi.z(); z += cell) {
        const Vec3 p(x, y, z);
        const double s = d.isZero(0) ? 0 : std::clamp(d.dot(p - a) / d.squaredNorm(), 0.0, 1.0);
        if ((p - a - s * d).norm() > radius) continue;
        const double m = density * cell * cell * cell;
        out.mass += m, first += m * p, second += m * p * p.transpose();
      }
  out.centre = first / out.mass;
  const Mat3 covariance = second - out.mass * out.centre * out.centre.transpose();
  out.inertia = covariance.trace() * Mat3::Identity() - covariance;
  return out;
}

TEST(WireMass, OfABallAndACapsuleAreTheirIntegrals) {
  const double radius = 0.003, density = 7850;
  for (const Vec3& b : {Vec3(0.001, 0.002, 0.003), Vec3(0.003, 0.006, 0.001)}) {
    const Vec3 a(0.001, 0.002, 0.003);
    const bool ball = a == b;
    const MassProperties found = wire_mass_properties(
        ball ? make_complex({a}, {}) : make_complex({a, b}, {}, {{0, 1}}), radius, density);
    const MassProperties expected = summed_over_a_grid(a, b, radius, density);
    EXPECT_NEAR(found.mass, expected.mass, 2e-3 * found.mass);
    EXPECT_LT((found.centre - expected.centre).norm(), 2e-3 * radius);
    EXPECT_LT((found.inertia - expected.inertia).norm(), 4e-3 * found.inertia.norm());
    if (ball) {
      EXPECT_NEAR(found.inertia(0, 0), 0.4 * found.mass * radius * radius, kRounding * found.inertia(0, 0));
    }
  }
}

TEST(WireMass, OfAPolylineIsThatOfItsCapsules) {
  const double radius = 1e-3, density = 1000;
  const SimplicialComplex both = make_polyline({{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}});
  const MassProperties one = wire_mass_properties(make_segment(0.1), radius, density),
                       two = wire_mass_properties(both, radius, density);
  EXPECT_NEAR(two.mass, 2 * one.mass, kRounding * one.mass);
  EXPECT_LT((two.centre - Vec3(0.075, 0.025, 0)).norm(), kRounding);
  // By hand about z: both across their axes, their centres 0.025 sqrt 2 off.
  EXPECT_NEAR(two.inertia(2, 2), 2 * (one.inertia(2, 2) + one.mass * 2 * 0.025 * 0.025),
              kRounding * two.inertia(2, 2));
}

TEST(WireMass, OfASurfaceIsRefused) {
  EXPECT_THROW(wire_mass_properties(make_plate(1, 1), 0.1, 1000), std::invalid_argument);
  EXPECT_THROW(wire_mass_properties(make_point(), 0, 1000), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
