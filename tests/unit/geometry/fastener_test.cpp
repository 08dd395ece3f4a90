// SPDX-License-Identifier: Apache-2.0
#include "geometry/fastener.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"

#ifdef AUSSOIS_WITH_GPL
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#endif

namespace aussois {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = std::array<Vec3, 3>;

// Coarse, steep, fine, tight: the corners of the range of the options, and the defaults.
std::vector<FastenerOptions> option_samples() {
  std::vector<FastenerOptions> samples = {FastenerOptions{}};
  for (const double pitch : {16e-3 / 4, 16e-3 / 8, 16e-3 / 50}) {
    for (const double relative_clearance : {1.0 / 4, 1.0 / 20, 1e-3}) {
      for (const int facets : {16, 24, 40, 96, 240}) {
        samples.push_back({.pitch = pitch,
                           .clearance = relative_clearance * pitch,
                           .facets = facets,
                           .bolt_turns = 2,
                           .nut_turns = 1});
      }
    }
  }
  return samples;
}

std::string describe(const FastenerOptions& o) {
  return "pitch " + std::to_string(o.pitch) + ", clearance " + std::to_string(o.clearance) + ", facets " +
         std::to_string(o.facets);
}

SE3 screw(const FastenerOptions& options, double angle) {
  return rotation({0, 0, 1}, angle) * translation(0, 0, options.pitch * angle / (2 * kPi));
}

Corners corners(const SimplicialComplex& complex, std::size_t t) {
  const auto& [a, b, c] = complex.triangles[t];
  return {complex.vertices[a], complex.vertices[b], complex.vertices[c]};
}

// All triangles, or only those whose corners lie between two radii and above the head.
std::vector<Corners> triangles_of(const SimplicialComplex& complex, double largest_radius = kInf,
                                  double lowest = -kInf) {
  std::vector<Corners> result;
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    const Corners x = corners(complex, t);
    if (std::all_of(x.begin(), x.end(),
                    [&](const Vec3& v) { return v.head<2>().norm() <= largest_radius && v.z() >= lowest; })) {
      result.push_back(x);
    }
  }
  return result;
}

Box box_of(const Corners& x) {
  return {x[0].cwiseMin(x[1]).cwiseMin(x[2]), x[0].cwiseMax(x[1]).cwiseMax(x[2])};
}

double box_distance(const Box& a, const Box& b) {
  return (a.lo - b.hi).cwiseMax(b.lo - a.hi).cwiseMax(Vec3::Zero()).norm();
}

bool intersect(const Corners& a, const Corners& b) {
  const auto point = [](const Vec3& x) { return Kernel::Point_3(x.x(), x.y(), x.z()); };
  return CGAL::do_intersect(Kernel::Triangle_3(point(a[0]), point(a[1]), point(a[2])),
                            Kernel::Triangle_3(point(b[0]), point(b[1]), point(b[2])));
}

double distance(const Vec3& x, const Corners& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  double nearest = kInf;
  bool inside = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = t[(k + 1) % 3] - t[k], from = x - t[k];
    inside = inside && normal.cross(side).dot(from) >= 0;
    nearest =
        std::min(nearest, (from - std::clamp(from.dot(side) / side.squaredNorm(), 0.0, 1.0) * side).norm());
  }
  return inside ? std::abs(normal.dot(x - t[0])) : nearest;
}

// Of two lines within their segments; kInf if the nearest points of the lines lie outside of them (then the
// end points decide, which distance(point, triangle) sees).
double distance_between_interiors(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v) {
  const Vec3 normal = u.cross(v), ab = b - a;
  const double area = normal.squaredNorm();
  if (area <= 1e-24 * u.squaredNorm() * v.squaredNorm()) return kInf;
  const double s = ab.cross(v).dot(normal) / area, t = ab.cross(u).dot(normal) / area;
  if (s < 0 || s > 1 || t < 0 || t > 1) return kInf;
  return (a + s * u - b - t * v).norm();
}

double distance(const Corners& a, const Corners& b) {
  double nearest = kInf;
  for (std::size_t i = 0; i < 3; ++i) {
    nearest = std::min({nearest, distance(a[i], b), distance(b[i], a)});
    for (std::size_t j = 0; j < 3; ++j) {
      nearest = std::min(
          nearest, distance_between_interiors(a[i], a[(i + 1) % 3] - a[i], b[j], b[(j + 1) % 3] - b[j]));
    }
  }
  return nearest;
}

struct Judgement {
  bool intersecting = false;
  double thread_distance = kInf;
};

// Every pair of triangles is looked at; boxes only spare pairs that cannot matter.
Judgement judge(const SimplicialComplex& bolt, const SimplicialComplex& nut, const FastenerOptions& options) {
  Judgement result;
  std::vector<Box> boxes;
  const std::vector<Corners> of_bolt = triangles_of(bolt);
  for (const Corners& a : of_bolt) boxes.push_back(box_of(a));
  for (const Corners& b : triangles_of(nut)) {
    const Box box = box_of(b);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (box_distance(box, boxes[i]) == 0)
        result.intersecting = result.intersecting || intersect(of_bolt[i], b);
    }
  }
  const std::vector<Corners> bolt_thread = triangles_of(bolt, options.diameter / 2, 0);
  boxes.clear();
  for (const Corners& a : bolt_thread) boxes.push_back(box_of(a));
  for (const Corners& b : triangles_of(nut, 0.6 * options.diameter)) {
    const Box box = box_of(b);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (box_distance(box, boxes[i]) < result.thread_distance)
        result.thread_distance = std::min(result.thread_distance, distance(bolt_thread[i], b));
    }
  }
  return result;
}

double largest_promised_distance(const FastenerOptions& o) {
  return (o.clearance + o.diameter / 2 * (1 / std::cos(kPi / o.facets) - 1)) / 2;
}

// ISO 68-1: pitch diameter d - 0.649519 P, where ridge and groove are equally wide; minor diameter d
// - 1.082532 P.
TEST(Fastener, HasTheDimensionsOfAnM16Thread) {
  const FastenerOptions m16;
  double lo = kInf, hi = 0, ridge = 0;
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) {
    const double d = 2 * (thread_radius(m16, m16.pitch * (i + 0.5) / kSamples) + m16.clearance);
    lo = std::min(lo, d);
    hi = std::max(hi, d);
    ridge += (d > 16e-3 - 0.649519 * 2e-3) / double(kSamples);
  }
  EXPECT_NEAR(hi, 16e-3, 1e-15);
  EXPECT_NEAR(lo, 13.834936e-3, 1e-9);
  EXPECT_NEAR(ridge, 0.5, 1e-4);
  const double flank = 0.3 * m16.pitch, step = 1e-6;
  EXPECT_NEAR((thread_radius(m16, flank + step) - thread_radius(m16, flank)) / step, -std::tan(kPi / 3),
              1e-9);
  EXPECT_NEAR(thread_radius(m16, flank), thread_radius(m16, flank - 5 * m16.pitch), 1e-15);

  const Box bolt = bounding_box(make_bolt(m16)), nut = bounding_box(make_nut(m16));
  EXPECT_DOUBLE_EQ(bolt.lo.z(), -10.4e-3);
  EXPECT_DOUBLE_EQ(bolt.hi.z(), 16e-3);
  EXPECT_EQ(nut.lo.z(), 0);
  EXPECT_DOUBLE_EQ(nut.hi.z(), 6e-3);
  EXPECT_NEAR(nut.hi.x() - nut.lo.x(), 24e-3, 1e-15);
  EXPECT_NEAR(bolt.hi.x() - bolt.lo.x(), 24e-3, 1e-15);
}

TEST(Fastener, IsAPairOfSolids) {
  for (const FastenerOptions& options : option_samples()) {
    SCOPED_TRACE(describe(options));
    const SimplicialComplex bolt = make_bolt(options), nut = make_nut(options);
    const auto euler = [](const SimplicialComplex& c) {
      return int(c.vertices.size()) - int(c.edges.size()) + int(c.triangles.size());
    };
    EXPECT_TRUE(bolt.solid && is_closed_oriented(bolt));
    EXPECT_TRUE(nut.solid && is_closed_oriented(nut));
    EXPECT_EQ(euler(bolt), 2);
    EXPECT_EQ(euler(nut), 0);  // one hole
  }
}

TEST(Fastener, OfDefaultOptionsIsDetailedButSmall) {
  const std::size_t count = make_bolt().triangles.size() + make_nut().triangles.size();
  EXPECT_GE(count, 3000u);
  EXPECT_LE(count, 20000u);
}

// Every cross-section of a helicoid has the same area, pi times the mean square of the profile. Material is
// missing where chords cut the circle (second order in 1 / facets) and, much less, along the diagonals of the
// twisted facets (first order): four times less at first, a little worse with many facets.
TEST(Fastener, ApproachesTheVolumeOfTheHelicoidFromInsideTheMaterial) {
  const double outer = 8e-3, inner = 8e-3 - 5.0 / 8 * std::sqrt(3.0) / 2 * 2e-3, clearance = 1e-4;
  const auto mean_square = [&](double offset) {
    const double a = outer + offset, b = inner + offset;
    return a * a / 8 + b * b / 4 + 5.0 / 8 * (a * a + a * b + b * b) / 3;
  };
  const double hexagon = 24e-3 * 24e-3 * std::sqrt(3.0) / 2;
  const double bolt = hexagon * 10.4e-3 + kPi * mean_square(-clearance) * 16e-3;
  const double nut = (hexagon - kPi * mean_square(0)) * 6e-3;
  double previous_bolt = 0, previous_nut = 0;
  for (const int facets : {24, 48, 96, 192}) {
    const FastenerOptions options{.clearance = clearance, .facets = facets};
    const double missing_bolt = bolt - signed_volume(make_bolt(options));
    const double missing_nut = nut - signed_volume(make_nut(options));
    EXPECT_GT(missing_bolt, 0);
    EXPECT_GT(missing_nut, 0);
    if (facets > 24) {
      EXPECT_GT(previous_bolt / missing_bolt, 3.3);
      EXPECT_GT(previous_nut / missing_nut, 3.3);
    }
    previous_bolt = missing_bolt;
    previous_nut = missing_nut;
  }
}

// The proof of the gap for all angles at once: F = r - radius(s), s = z - pitch angle / (2 pi), does not
// change in a screw motion, is at most 0 on the bolt's shank and at least the clearance on the nut, and both
// are attained.
TEST(Fastener, IsSeparatedByTheHelicoidBetweenTheThreads) {
  for (const FastenerOptions& options : option_samples()) {
    SCOPED_TRACE(describe(options));
    const auto outside = [&](const Vec3& x) {
      const double s = x.z() - options.pitch * std::atan2(x.y(), x.x()) / (2 * kPi);
      return x.head<2>().norm() - thread_radius(options, s);
    };
    const auto range = [&](const std::vector<Corners>& triangles) {
      constexpr int kSide = 10;
      double lo = kInf, hi = -kInf;
      for (const Corners& t : triangles) {
        for (int i = 0; i <= kSide; ++i) {
          for (int j = 0; i + j <= kSide; ++j) {
            const double f = outside((i * t[0] + j * t[1] + (kSide - i - j) * t[2]) / kSide);
            lo = std::min(lo, f);
            hi = std::max(hi, f);
          }
        }
      }
      return std::array{lo, hi};
    };
    const double rounding = 1e-16;  // of coordinates of 10 mm, some units in the last place
    EXPECT_NEAR(range(triangles_of(make_bolt(options), options.diameter / 2, 0))[1], 0, rounding);
    EXPECT_NEAR(range(triangles_of(make_nut(options)))[0], options.clearance, rounding);
  }
}

// Brute force over all pairs of triangles, with exact predicates, at 50 angles from the head to beyond the
// tip; the angles fall on whole facets, half facets and anything between.
TEST(Fastener, TurnsWithoutTouchingAndKeepsThePromisedGap) {
  for (const FastenerOptions& options :
       {FastenerOptions{.facets = 24, .bolt_turns = 5, .nut_turns = 2},
        FastenerOptions{.pitch = 4e-3, .clearance = 2e-4, .facets = 16, .bolt_turns = 5, .nut_turns = 2}}) {
    SCOPED_TRACE(describe(options));
    const SimplicialComplex bolt = make_bolt(options), nut = make_nut(options);
    double tightest = kInf, loosest = 0;
    for (int k = 1; k <= 50; ++k) {
      const double facet_steps =
          std::floor(k * options.facets / 9.0) + std::array{0.0, 0.25, 0.5, 0.83}[k % 4];
      const double turns = facet_steps / options.facets;
      const SimplicialComplex turned = transformed_complex(nut, screw(options, 2 * kPi * turns));
      const Judgement found = judge(bolt, turned, options);
      EXPECT_FALSE(found.intersecting) << turns;
      EXPECT_GE(found.thread_distance, thread_gap(options) - 1e-16) << turns;
      if (turns > options.bolt_turns - 1) continue;  // the nut is leaving
      tightest = std::min(tightest, found.thread_distance);
      loosest = std::max(loosest, found.thread_distance);
    }
    EXPECT_LE(loosest, largest_promised_distance(options));
    EXPECT_LT(tightest, 1.05 * thread_gap(options));  // the promise is not timid
  }
}

TEST(Fastener, OfDefaultOptionsTurnsWithoutTouching) {
  const FastenerOptions options;
  const SimplicialComplex bolt = make_bolt(options), nut = make_nut(options);
  for (const double turns : {0.25, 1 + 0.5 / 48, 3.3}) {
    const Judgement found = judge(bolt, transformed_complex(nut, screw(options, 2 * kPi * turns)), options);
    EXPECT_FALSE(found.intersecting) << turns;
    EXPECT_GE(found.thread_distance, thread_gap(options) - 1e-16) << turns;
    EXPECT_LE(found.thread_distance, largest_promised_distance(options)) << turns;
  }
}

// The judge itself: pushed along the axis by more than the play, the threads must be seen to intersect.
TEST(Fastener, IsSeenToIntersectOutOfPhase) {
  const FastenerOptions options{.facets = 24, .bolt_turns = 4, .nut_turns = 2};
  const double play = options.clearance / std::sqrt(3.0);  // (clearance / 2) / cos 30 degrees
  const SimplicialComplex bolt = make_bolt(options), nut = make_nut(options);
  const auto pushed = [&](double z) {
    return transformed_complex(nut, screw(options, 4) * translation(0, 0, z));
  };
  EXPECT_FALSE(judge(bolt, pushed(0.9 * play), options).intersecting);
  EXPECT_TRUE(judge(bolt, pushed(2.5 * play), options).intersecting);
  EXPECT_TRUE(judge(bolt, pushed(-2.5 * play), options).intersecting);
}

#ifdef AUSSOIS_WITH_GPL
TEST(Fastener, DoesNotIntersectItself) {
  for (const FastenerOptions& options : option_samples()) {
    SCOPED_TRACE(describe(options));
    for (const SimplicialComplex& solid : {make_bolt(options), make_nut(options)}) {
      using Index = CGAL::Surface_mesh<Kernel::Point_3>::Vertex_index;
      CGAL::Surface_mesh<Kernel::Point_3> mesh;
      for (const Vec3& x : solid.vertices) mesh.add_vertex({x.x(), x.y(), x.z()});
      for (const auto& [a, b, c] : solid.triangles) {
        ASSERT_TRUE(mesh.add_face(Index(unsigned(a)), Index(unsigned(b)), Index(unsigned(c)))
                        .is_valid());  // manifold
      }
      EXPECT_FALSE(CGAL::Polygon_mesh_processing::does_self_intersect(mesh));
      EXPECT_TRUE(CGAL::Polygon_mesh_processing::does_bound_a_volume(mesh));
    }
  }
}
#endif

TEST(Fastener, NamesTheOptionThatIsWrong) {
  const auto message = [](const FastenerOptions& options) { return message_of([&] { make_nut(options); }); };
  EXPECT_EQ(message({.diameter = -1}), "FastenerOptions::diameter = -1 must be finite and > 0 [m]");
  EXPECT_EQ(message({.diameter = 1, .pitch = 0.5}),
            "FastenerOptions::pitch = 0.5 must not exceed diameter / 4 [m]");
  EXPECT_EQ(message({.clearance = 0}), "FastenerOptions::clearance = 0 must be finite and > 0 [m]");
  EXPECT_EQ(message({.clearance = 0.5}), "FastenerOptions::clearance = 0.5 must not exceed pitch / 4 [m]");
  EXPECT_EQ(message({.facets = 20}), "FastenerOptions::facets = 20 must be a multiple of 8");
  EXPECT_EQ(message({.bolt_turns = 0}), "FastenerOptions::bolt_turns = 0 must lie in [1, 100]");
  EXPECT_EQ(message({.nut_turns = 101}), "FastenerOptions::nut_turns = 101 must lie in [1, 100]");
  EXPECT_THROW(make_bolt({.facets = 7}), std::invalid_argument);
  EXPECT_THROW(thread_gap({.facets = 7}), std::invalid_argument);
}

}  // namespace
}  // namespace aussois
