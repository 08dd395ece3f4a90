// SPDX-License-Identifier: Apache-2.0
#include "geometry/primitives.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

int euler_characteristic(const SimplicialComplex& complex) {
  return int(complex.vertices.size()) - int(complex.edges.size()) + int(complex.triangles.size());
}

double polygon_area(int n, double radius) {
  return n / 2.0 * radius * radius * std::sin(2 * kPi / n);
}

// Closed, oriented outwards, of one piece with the given number of handles, of the given volume.
void expect_solid(const SimplicialComplex& complex, int handles, double volume) {
  EXPECT_TRUE(complex.solid);
  EXPECT_TRUE(is_closed_oriented(complex));
  EXPECT_EQ(euler_characteristic(complex), 2 - 2 * handles);
  EXPECT_NEAR(signed_volume(complex), volume, 1e-13 * volume);
}

TEST(Primitives, BoxIsASolidForAnySubdivision) {
  for (const int n : {1, 2, 3, 7}) {
    const SimplicialComplex box = make_box(1, 2, 3, n);
    expect_solid(box, 0, 6);
    EXPECT_EQ(box.triangles.size(), std::size_t(12 * n * n));
    EXPECT_EQ(box.vertices.size(), std::size_t(6 * n * n + 2));
    EXPECT_EQ(bounding_box(box).lo, Vec3(-0.5, -1, -1.5));
    EXPECT_EQ(bounding_box(box).hi, Vec3(0.5, 1, 1.5));
  }
}

TEST(Primitives, CylinderIsAPrismOverAnInscribedPolygon) {
  for (const int n : {3, 6, 101}) {
    const SimplicialComplex cylinder = make_cylinder(0.5, 3, n);
    expect_solid(cylinder, 0, 3 * polygon_area(n, 0.5));
    EXPECT_DOUBLE_EQ(bounding_box(cylinder).lo.z(), -1.5);
    EXPECT_DOUBLE_EQ(bounding_box(cylinder).hi.z(), 1.5);
  }
}

TEST(Primitives, CoarsestSphereIsTheIcosahedron) {
  const double edge = 2.0 / std::sqrt(2 * std::sqrt(5.0) * (std::sqrt(5.0) + 1) / 4);  // of circumradius 1
  expect_solid(make_sphere(2, 0), 0, 8 * 5 * (3 + std::sqrt(5.0)) / 12 * edge * edge * edge);
}

TEST(Primitives, SphereHasItsVerticesOnTheSphereAndConvergesToTheBallAtSecondOrder) {
  double previous_error = 0;
  for (int level = 0; level <= 5; ++level) {
    const SimplicialComplex sphere = make_sphere(0.01, level);
    EXPECT_EQ(sphere.triangles.size(), std::size_t(20) << (2 * level));
    for (const Vec3& x : sphere.vertices) EXPECT_NEAR(x.norm(), 0.01, 1e-17);
    expect_solid(sphere, 0, signed_volume(sphere));
    const double error = 4 * kPi / 3 * 1e-6 - signed_volume(sphere);
    EXPECT_GT(error, 0);
    if (level >= 3) {
      EXPECT_NEAR(previous_error / error, 4, 0.1) << level;
    }
    previous_error = error;
  }
}

// Its facets are planar trapezoids. In the half plane at the angle t from the middle of a facet the profile
// is that of the ring scaled in r by cos(d) / cos(t), d = pi / n: the volume is area * major * 2 sin(d)
// cos(d) per facet.
TEST(Primitives, ExtrusionHasTheAreaOfItsProfileTimesItsHeight) {
  const std::vector<Vec2> l = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  EXPECT_NEAR(signed_volume(make_extrusion(l, 2)), 5 * 2, 1e-13);
  EXPECT_THROW(make_extrusion({{0, 0}, {0, 1}, {1, 1}}, 1), std::invalid_argument) << "clockwise";
  EXPECT_THROW(make_extrusion({{0, 0}, {1, 0}}, 1), std::invalid_argument);
  EXPECT_THROW(make_extrusion(l, 0), std::invalid_argument);
}

TEST(Primitives, GearHasTheVolumeOfItsSectors) {
  const double root = 2, tip = 2.5, quarter = kPi / (2 * 12);  // four sectors of this angle per tooth
  const SimplicialComplex gear = make_extrusion(gear_profile(12, root, tip), 1);
  EXPECT_NEAR(signed_volume(gear), 12 * 0.5 * std::sin(quarter) * (root * root + 2 * root * tip + tip * tip),
              1e-12);
  EXPECT_THROW(gear_profile(12, 2, 2), std::invalid_argument);
  EXPECT_THROW(gear_profile(2, 1, 2), std::invalid_argument);
}

TEST(Primitives, TorusHasTheVolumeOfItsFrusta) {
  for (const int n : {3, 8, 50}) {
    for (const int m : {3, 5, 40}) {
      expect_solid(make_torus(2, 0.7, n, m), 1, n * std::sin(2 * kPi / n) * polygon_area(m, 0.7) * 2);
    }
  }
}

TEST(Primitives, PlateIsASheetFacingUpwards) {
  const SimplicialComplex plate = make_plate(2, 3, 4, 5);
  EXPECT_FALSE(plate.solid);
  EXPECT_EQ(plate.vertices.size(), 30u);
  EXPECT_EQ(plate.triangles.size(), 40u);
  EXPECT_EQ(euler_characteristic(plate), 1);
  double area = 0;
  for (const auto& [a, b, c] : plate.triangles) {
    const Vec3 corner = plate.vertices[a];
    const Vec3 twice = (plate.vertices[b] - corner).cross(plate.vertices[c] - corner);
    EXPECT_GT(twice.z(), 0);
    area += twice.norm() / 2;
  }
  EXPECT_NEAR(area, 6, 1e-14);
  EXPECT_EQ(bounding_box(plate).lo, Vec3(-1, -1.5, 0));
  EXPECT_EQ(bounding_box(plate).hi, Vec3(1, 1.5, 0));
}

TEST(Primitives, PointSegmentAndPolylineAreComplexesWithoutTriangles) {
  EXPECT_EQ(make_point().vertices, std::vector<Vec3>{Vec3::Zero()});
  EXPECT_TRUE(make_point().edges.empty());
  EXPECT_EQ(make_segment(3).vertices[1] - make_segment(3).vertices[0], Vec3(3, 0, 0));
  EXPECT_EQ(make_segment(3).edges.size(), 1u);
  const std::vector<Vec3> points = {
      {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}};  // may come back to an old place
  EXPECT_EQ(make_polyline(points).vertices, points);
  EXPECT_EQ(make_polyline(points).edges, (std::vector<std::array<int, 2>>{{0, 1}, {1, 2}, {2, 3}}));
}

TEST(Primitives, NameTheArgumentThatIsWrong) {
  EXPECT_EQ(message_of([] { make_segment(0); }), "length = 0 must be finite and > 0 [m]");
  EXPECT_EQ(message_of([] { make_plate(1, -2); }), "y = -2 must be finite and > 0 [m]");
  EXPECT_EQ(message_of([] { make_plate(1, 2, 0); }), "nx = 0 must be at least 1");
  EXPECT_EQ(message_of([] { make_box(1, 1, kInf); }), "z = inf must be finite and > 0 [m]");
  EXPECT_EQ(message_of([] { make_box(1, 1, 1, 257); }), "subdivisions = 257 must lie in [1, 256]");
  EXPECT_EQ(message_of([] { make_cylinder(1, 1, 2); }), "facets = 2 must be at least 3");
  EXPECT_EQ(message_of([] { make_sphere(1, 9); }), "subdivisions = 9 must lie in [0, 8]");
  EXPECT_EQ(message_of([] { make_sphere(std::nan(""), 1); }), "radius = nan must be finite and > 0 [m]");
  EXPECT_EQ(message_of([] { make_torus(1, 1, 8, 8); }), "minor = 1 must be smaller than major");
  EXPECT_EQ(message_of([] { make_torus(1, 0.5, 8, 2); }), "n_minor = 2 must be at least 3");
  EXPECT_EQ(message_of([] { make_polyline({Vec3::Zero()}); }),
            "number of points of a polyline = 1 must be at least 2");
  EXPECT_EQ(message_of([] {
              make_polyline({Vec3::Zero(), Vec3::Zero()});
            }),
            "point 1 of a polyline repeats the one before");
}

}  // namespace
}  // namespace aussois
