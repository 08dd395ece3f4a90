// SPDX-License-Identifier: Apache-2.0
// Question 14 of doc/theory/lmd.md: bad input ends as an exception that names field, value and bound, as a
// status with its reason, or as a result that is defined.
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/mass_properties.hpp"
#include "geometry/mesh_repair.hpp"
#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/contact_kinematics.hpp"
#include "lmd/erosion.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const double kNan = std::nan("");

LmdShape box_of(double side, double dilation) {
  return prepare(dilate(make_box(side, side, side), dilation));
}

void expect_defined(const ContactSet& contacts) {
  for (const ContactPoint& c : contacts.points) {
    EXPECT_TRUE(c.x_a.allFinite() && c.x_b.allFinite() && std::isfinite(c.gap) &&
                std::isfinite(c.angle_margin));
    EXPECT_NEAR(c.normal.norm(), 1, 1e-12);
  }
}

// Two cubes that pass through each other, as one surface: closed, oriented, and no boundary of a solid.
SimplicialComplex crossing_cubes() {
  const SimplicialComplex one = make_box(1, 1, 1),
                          other = transformed_complex(one, translation(0.5, 0.4, 0.3));
  std::vector<Vec3> vertices = one.vertices.to_vector();
  std::vector<std::array<int, 3>> triangles = one.triangles.to_vector();
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) triangles.push_back({a + 8, b + 8, c + 8});
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

TEST(BadInput, NotANumberIsNamedAtEveryDoor) {
  EXPECT_EQ(message_of([] {
              make_complex({{0, 0, 0}, {0, kNan, 1}}, {});
            }),
            "vertex 1 = (0 nan 1) must be finite");
  EXPECT_EQ(message_of([] { dilate(make_point(), kNan); }),
            "dilation radius [m] = nan must be finite and >= 0");
  EXPECT_EQ(message_of([] { prepare({.complex = make_point(), .radius = kNan}); }),
            "DilatedShape::radius = nan must be finite and not negative [m]");
  EXPECT_EQ(message_of([] { prepare(dilate(make_point(), 0), {.planarity = kNan}); }),
            "LmdShapeOptions::planarity = nan must lie in [0, 0.01]");
  const auto refusal = [](const LmdOptions& options) { return message_of([&] { validate(options); }); };
  EXPECT_NE(refusal({.threshold = kNan}).find("LmdOptions::threshold = nan must"), std::string::npos);
  EXPECT_NE(refusal({.threshold = -1}).find("LmdOptions::threshold = -1 must"), std::string::npos);
  EXPECT_NE(refusal({.alpha = kNan}).find("LmdOptions::alpha = nan must"), std::string::npos);
  EXPECT_NE(refusal({.alpha_ee = kNan}).find("LmdOptions::alpha_ee = nan must"), std::string::npos);
  const LmdShape box = box_of(1, 0.01);
  EXPECT_NE(message_of([&] {
              find_candidates({&box, translation(0, 0, 1.1), 0}, {&box, {}, 1}, {}, {.displacement = kNan});
            }).find("displacement = nan must"),
            std::string::npos);
  EXPECT_NE(
      message_of([] { erode(make_box(1, 1, 1), {.depth = kNan}); }).find("ErosionOptions::depth = nan must"),
      std::string::npos);
}

// A pose is no door: a step that makes it not a number says so (StepStatus::not_finite). Nothing is invented
// from it.
TEST(BadInput, PosesThatAreNotNumbersHaveNoContactsNoDistanceAndNoCertificate) {
  const LmdShape box = box_of(1, 0.01);
  for (const SE3& g : {translation(0, kNan, 1.01), SE3{Quat(kNan, 0, 0, 1), Vec3(0, 0, 1.01)}}) {
    EXPECT_TRUE(find_contacts({&box, g, 0}, {&box, {}, 1}, {.threshold = 0.1}).points.empty());
    EXPECT_TRUE(std::isnan(base_distance({&box, {}, {.g = g}}, {&box, {}, {}}, 1)));
    EXPECT_FALSE(
        certify({&box, {}, {.g = g}}, {&box, {}, {}}, 1e-3, {.required = 1e-3, .wanted = 1e-2}).certified);
  }
}

TEST(BadInput, AnEmptyComplexIsNoShape) {
  EXPECT_EQ(message_of([] { prepare({}); }), "DilatedShape::complex has no vertex");
  EXPECT_NE(message_of([] { dilate({}, 0); }), "");
}

// Without dilation two bases that touch have no direction where they do: no contact there, a distance of
// zero, no certificate, and nothing that is not a number.
TEST(BadInput, TouchingBasesWithoutDilationHaveADefinedResult) {
  const LmdShape box = box_of(1, 0), plate = prepare(dilate(make_plate(3, 3), 0));
  const SE3 standing = translation(0, 0, 0.5);
  const ContactSet found = find_contacts({&box, standing, 0}, {&plate, {}, 1}, {.threshold = 0.1});
  expect_defined(found);
  const MovingShape moving{&box, {}, {.g = standing}}, fixed{&plate, {}, {}};
  EXPECT_EQ(base_distance(moving, fixed, 1), 0);
  EXPECT_FALSE(certify(moving, fixed, 1e-3, {.required = 1e-9, .wanted = 1e-6}).certified);
  const LmdShape point = prepare(dilate(make_point(), 0));
  EXPECT_TRUE(find_contacts({&point, {}, 0}, {&point, {}, 1}, {.threshold = 1}).points.empty());
}

// With a dilation the same bases overlap by both dilations: they touch as deep as the search can see.
TEST(BadInput, CrossingBasesAreForTheCertificate) {
  const LmdShape box = box_of(1, 0.01);
  const SE3 inside = translation(0.3, 0.2, 0.9);
  expect_defined(find_contacts({&box, inside, 0}, {&box, {}, 1}, {.threshold = 0.1}));
  EXPECT_EQ(base_distance({&box, {}, {.g = inside}}, {&box, {}, {}}, 1), 0);
}

TEST(BadInput, AnOpenSolidIsRefusedWithItsEdges) {
  const SimplicialComplex box = make_box(1, 1, 1);
  std::vector<std::array<int, 3>> open = box.triangles.to_vector();
  open.pop_back();
  EXPECT_NE(message_of([&] { make_complex(box.vertices, open, {}, true); }).find("3 of 18 edges"),
            std::string::npos);
  const SimplicialComplex sheets = make_complex(box.vertices, open);
  EXPECT_NE(message_of([&] { mass_properties(sheets, 7850); }), "");
  const RepairedMesh repaired = repair_mesh(sheets);  // holes are not filled
  EXPECT_FALSE(repaired.complex.solid);
  EXPECT_NE(repaired.report.reason.find("3 border edges"), std::string::npos) << repaired.report.reason;
  EXPECT_EQ(erode(sheets, {.depth = 0.01}).status, ErosionStatus::not_solid);
  const LmdShape shape = prepare(dilate(sheets, 0.01));  // as sheets it has contacts like any other
  const LmdShape ball = prepare(dilate(make_point(), 0.1));
  const auto& [i, j, k] = box.triangles.front();
  const Vec3 middle = (box.vertices[i] + box.vertices[j] + box.vertices[k]) / 3;
  const Vec3 normal =
      (box.vertices[j] - box.vertices[i]).cross(box.vertices[k] - box.vertices[i]).normalized();
  const SE3 above{Quat::Identity(), middle + 0.15 * normal};
  const ContactSet found = find_contacts({&ball, above, 0}, {&shape, {}, 1}, {.threshold = 0.1});
  ASSERT_FALSE(found.points.empty());
  EXPECT_NEAR(smallest_gap(found), 0.15 - 0.1 - 0.01, 1e-12);
}

TEST(BadInput, ASelfIntersectingBaseIsNoSolidAndStillHasItsLocalMinima) {
  const SimplicialComplex cubes = crossing_cubes();
  const RepairedMesh repaired = repair_mesh(cubes);
  EXPECT_FALSE(repaired.complex.solid);
  EXPECT_NE(repaired.report.reason.find("intersect"), std::string::npos) << repaired.report.reason;
  EXPECT_EQ(erode(cubes, {.depth = 0.01}).status, ErosionStatus::not_solid);
  const LmdShape shape = prepare(dilate(cubes, 0.01)), ball = prepare(dilate(make_point(), 0.1));
  for (const Vec3& x : {Vec3(0, 0, 0.95), Vec3(0.6, 0.5, 0.95), Vec3(-0.1, -0.2, 0.7)}) {
    const PosedShape a{&ball, {Quat::Identity(), x}, 0}, b{&shape, {}, 1};
    const ContactSet found = find_contacts(a, b, {.threshold = 1}),
                     slow = find_contacts_exhaustive(a, b, {.threshold = 1});
    expect_defined(found);
    ASSERT_EQ(found.points.size(), slow.points.size());
    EXPECT_NEAR(smallest_gap(found) + 0.11, base_distance({&ball, {}, {.g = a.g_ws}}, {&shape, {}, {}}, 10),
                1e-12);
  }
}

}  // namespace
}  // namespace aussois
