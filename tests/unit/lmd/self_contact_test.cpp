// SPDX-License-Identifier: Apache-2.0
// A shape that meets itself (DEF-4): which pairs count, the contacts of all of them, and what is certified.
#include <algorithm>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"
#include "lmd/material_neighbours.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

LmdShape soft(const SimplicialComplex& complex, double radius, double reach) {
  return touching_itself(prepare(dilate(complex, radius), {.deforming = true}), reach);
}

SimplicialComplex straight_line(int segments, double length) {
  std::vector<Vec3> points;
  for (int i = 0; i <= segments; ++i) points.emplace_back(length * i / segments, 0, 0);
  return make_polyline(points);
}

// A random curve that comes back to itself: sums of a few waves.
std::vector<Vec3> tangled(int count, Random& random) {
  Vec3 a[3], b[3];
  for (int k = 0; k < 3; ++k) a[k] = random.vector(0.5 / (k + 1)), b[k] = random.vector(0.5 / (k + 1));
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    Vec3 x = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const double phase = 2 * kPi * (k + 1) * i / count;
      x += std::cos(phase) * a[k] + std::sin(phase) * b[k];
    }
    out.push_back(x);
  }
  return out;
}

TEST(SelfContact, LeavesOutWhatIsNearInTheMaterial) {
  const SimplicialComplex line = straight_line(10, 1);
  const auto near = material_neighbours(line, 0.25);
  const auto between = [&](std::vector<int> a, std::vector<int> b) { return meet(*near, a, b); };
  EXPECT_FALSE(between({3}, {3}));
  EXPECT_FALSE(between({3}, {5}));        // 0.2
  EXPECT_TRUE(between({3}, {6}));         // 0.3
  EXPECT_FALSE(between({6}, {3}));        // the one with the lower vertex comes first
  EXPECT_FALSE(between({2, 3}, {5, 6}));  // 0.2 from 3 to 5
  EXPECT_TRUE(between({2, 3}, {6, 7}));
  EXPECT_EQ(message_of([&] { material_neighbours(line, 0); }),
            "material_neighbours: reach = 0 must be positive and finite [m]");
  expect_names(message_of([&] { touching_itself(prepare(dilate(line, 0.1)), 0.2); }),
               "must be prepared with");
}

TEST(SelfContact, IsNoneOfAStraightLineNorOfAFlatSheet) {
  const LmdShape line = soft(straight_line(40, 1), 0.02, kPi * 0.02);
  const PosedShape posed{&line, {}, 0};
  EXPECT_TRUE(find_contacts(posed, posed, {.threshold = 0.5}).points.empty());
  const LmdShape sheet = soft(make_plate(1, 1, 6, 6), 0.02, 0.5);
  const PosedShape flat{&sheet, {}, 0};
  EXPECT_TRUE(find_contacts(flat, flat, {.threshold = 0.1}).points.empty());
}

// Two bodies of one shape are no shape that meets itself.
TEST(SelfContact, IsOfOneBodyOnly) {
  const LmdShape line = soft(straight_line(4, 1), 0.02, 0.1);
  const PosedShape a{&line, {}, 0}, b{&line, {Quat::Identity(), {0, 0.05, 0}}, 1};
  EXPECT_FALSE(find_contacts(a, b, {.threshold = 0.1}).points.empty());
}

TEST(SelfContact, HasTheContactsOfAnExhaustiveSearch) {
  Random random(3);
  int found = 0;
  for (int k = 0; k < 100; ++k) {
    LmdShape shape =
        k % 4 == 3 ? soft(make_plate(1, 0.5, 8, 4), 0.02, 0.3) : soft(straight_line(60, 3), 0.05, 0.2);
    std::vector<Vec3> places;
    if (k % 4 == 3)  // folded over
      for (const Vec3& x : shape.complex.vertices) {
        const double angle = (x.x() + 0.5) * random.uniform(4.5, 5.5), r = 0.2 + 0.03 * x.y();
        places.emplace_back(r * std::cos(angle), x.y(), r * std::sin(angle) + 0.05 * x.x());
      }
    else
      places = tangled(61, random);
    shape = refit(shape, places);
    const PosedShape posed{&shape, random.pose(1), 7};
    const LmdOptions options{.threshold = 0.2};
    const ContactSet quick = find_contacts(posed, posed, options),
                     all = find_contacts_exhaustive(posed, posed, options);
    ASSERT_EQ(quick.points.size(), all.points.size());
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      EXPECT_EQ(key_of(quick.points[i]), key_of(all.points[i]));
      EXPECT_EQ(quick.points[i].gap, all.points[i].gap);
      EXPECT_EQ(quick.points[i].a.body, quick.points[i].b.body);
    }
    const Candidates window = find_candidates(posed, posed, options, {0.01, 0.01});
    EXPECT_EQ(find_contacts(window, posed, posed).points.size(), all.points.size());
    found += int(all.points.size());
  }
  EXPECT_GT(found, 200);
}

// Against every pair of simplices that counts.
double nearest(const LmdShape& shape) {
  double out = kInf;
  const SimplicialComplex& k = shape.complex;
  for (const auto& e : k.edges)
    for (const auto& f : k.edges) {
      if (!meet(*shape.self, e, f)) continue;
      const Vec3 a[] = {k.vertices[e[0]], k.vertices[e[1]]}, b[] = {k.vertices[f[0]], k.vertices[f[1]]};
      for (int i = 0; i <= 40; ++i) {  // from points along one to the other
        const Vec3 x = a[0] + i / 40.0 * (a[1] - a[0]), d = b[1] - b[0];
        const double s = std::clamp((x - b[0]).dot(d) / d.squaredNorm(), 0.0, 1.0);
        out = std::min(out, (x - b[0] - s * d).norm());
      }
    }
  return out;
}

TEST(SelfContact, DistanceIsThatOfAllPairsThatCount) {
  Random random(4);
  for (int k = 0; k < 40; ++k) {
    const LmdShape shape = refit(soft(straight_line(60, 3), 0.05, 0.2), tangled(61, random));
    const MovingShape m{.shape = &shape, .body = 3};
    const double sampled = nearest(shape), found = base_distance(m, m, 10);
    EXPECT_LE(found, sampled + 1e-12);
    EXPECT_GE(found, sampled - 0.02);  // segments are up to a tenth long
  }
}

TEST(SelfContact, IsCertifiedOnlyWhereDenseSamplesKeepApart) {
  Random random(5);
  int certified = 0, broken = 0;
  for (int k = 0; k < 300; ++k) {
    const LmdShape shape = refit(soft(straight_line(40, 3), 0.02, 0.2), tangled(41, random));
    const std::vector<Vec3> to = tangled(41, random);
    const double part = random.uniform(0, 0.2);
    std::vector<Vec3> v;
    for (std::size_t i = 0; i < to.size(); ++i) v.emplace_back(part * (to[i] - shape.complex.vertices[i]));
    const MovingShape m{.shape = &shape,
                        .motion = {random.pose(1), random.vector(1), random.vector(1)},
                        .velocity = v,
                        .body = 0};
    const CertificateOptions options{
        .required = 0.03, .wanted = 0.05, .axis = Vec3::UnitX(), .starts_apart = true};
    const Certificate proof = certify(m, m, 1, options);
    double least = kInf;
    for (int i = 0; i <= 40; ++i) {
      std::vector<Vec3> places = shape.complex.vertices.to_vector();
      for (std::size_t j = 0; j < v.size(); ++j) places[j] += i / 40.0 * v[j];
      const LmdShape there = refit(shape, places);
      const MovingShape still{.shape = &there, .body = 0};
      least = std::min(least, base_distance(still, still, 0.1));
    }
    if (proof.certified) {
      ++certified;
      EXPECT_GE(least, proof.min_distance - 1e-12) << k;
    } else {
      broken += least < options.required;
    }
  }
  EXPECT_GT(certified, 60);
  EXPECT_GT(broken, 60);
}

}  // namespace
}  // namespace aussois
