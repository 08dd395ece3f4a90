// SPDX-License-Identifier: Apache-2.0
// Question 2 of doc/theory/lmd.md: normal cones of 1e5 stars with integer directions, where all that is asked
// has an exact answer in 64-bit integers. Coplanar, opposite and repeated directions are the rule here.
#include <algorithm>
#include <sstream>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "lmd/normal_cone.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using IntVec = Eigen::Matrix<std::int64_t, 3, 1>;  // entries below 100: determinants below 1e7
using Star = std::vector<IntVec>;

std::int64_t det(const IntVec& a, const IntVec& b, const IntVec& c) {
  return a.cross(b).dot(c);
}

int sign(std::int64_t x) {
  return (x > 0) - (x < 0);
}

// Is v in cone(G)? Caratheodory: then it is in the cone of at most three independent directions of G, with
// weights by Cramer's rule.
bool in_cone(const Star& star, const IntVec& v) {
  if (v.isZero()) return true;
  const std::size_t n = star.size();
  for (std::size_t i = 0; i < n; ++i) {
    const IntVec& a = star[i];
    if (a.cross(v).isZero() && a.dot(v) > 0) return true;
    for (std::size_t j = i + 1; j < n; ++j) {
      const IntVec& b = star[j];
      const IntVec normal = a.cross(b);
      if (normal.isZero()) continue;
      if (normal.dot(v) == 0 && v.cross(b).dot(normal) >= 0 && a.cross(v).dot(normal) >= 0) return true;
      for (std::size_t k = j + 1; k < n; ++k) {
        const IntVec& c = star[k];
        const int d = sign(det(a, b, c));
        if (d != 0 && d * det(v, b, c) >= 0 && d * det(a, v, c) >= 0 && d * det(a, b, v) >= 0) return true;
      }
    }
  }
  return false;
}

int rank(const Star& star) {
  int found = 0;
  for (const IntVec& a : star) {
    if (!a.isZero()) found = std::max(found, 1);
    for (const IntVec& b : star) {
      const IntVec normal = a.cross(b);
      if (normal.isZero()) continue;
      found = std::max(found, 2);
      for (const IntVec& c : star)
        if (normal.dot(c) != 0) return 3;
    }
  }
  return found;
}

// The directions of Lin: g is one iff -g is in the cone.
Star lineality(const Star& star) {
  Star lin;
  for (const IntVec& g : star)
    if (in_cone(star, -g)) lin.push_back(g);
  return lin;
}

// Number of extreme rays of a pointed cone: directions, each once, that the others do not span.
int extreme_rays(const Star& star) {
  Star once;
  for (const IntVec& g : star)
    if (std::ranges::none_of(once, [&](const IntVec& o) { return g.cross(o).isZero() && g.dot(o) > 0; }))
      once.push_back(g);
  int count = 0;
  for (std::size_t i = 0; i < once.size(); ++i) {
    Star others = once;
    others.erase(others.begin() + long(i));
    count += !in_cone(others, once[i]);
  }
  return count;
}

IntVec random_integers(Random& random, int half) {
  const int x = random.index(2 * half + 1), y = random.index(2 * half + 1), z = random.index(2 * half + 1);
  return {x - half, y - half, z - half};
}

enum class Kind { any, half_space, planar, few_planes, count };

Star random_star(Random& random) {
  const auto kind = Kind(random.index(int(Kind::count)));
  const int half = std::array{1, 3, 12}[random.index(3)];
  const IntVec up = random_integers(random, half), side = random_integers(random, half);
  Star star;
  for (int n = 1 + random.index(8); n > 0; --n) {
    IntVec g = random_integers(random, half);
    if (kind == Kind::half_space && g.dot(up) < 0) g = -g;
    if (kind == Kind::planar || (kind == Kind::few_planes && random.index(2) == 0))
      g = (random.index(5) - 2) * up, g += (random.index(5) - 2) * side;
    star.push_back(g);
    if (random.index(8) == 0) star.push_back((1 + random.index(3)) * g);  // the same direction again
    if (random.index(8) == 0) star.push_back(-g);
  }
  std::erase_if(star, [](const IntVec& g) { return g.isZero(); });
  return star;
}

std::vector<Vec3> doubles(const Star& star) {
  std::vector<Vec3> out;
  for (const IntVec& g : star) out.push_back(g.cast<double>());
  return out;
}

std::string text(const Star& star) {
  std::ostringstream out;
  for (const IntVec& g : star) out << '(' << g.transpose() << ") ";
  return out.str();
}

// Probes of N, many of them on its border: across pairs of directions, against them, and any.
IntVec probe_of(const Star& star, Random& random) {
  const auto any = [&]() -> const IntVec& { return star[random.index(int(star.size()))]; };
  switch (random.index(4)) {
    case 0:
      return random_integers(random, 3);
    case 1:
      return -any();
    case 2:
      return any().cross(any());
    default:
      return any().cross(any()) + any().cross(any());
  }
}

constexpr int kStars = 100000, kParts = 10;

class ChecklistItem2 : public ::testing::TestWithParam<unsigned> {};

TEST_P(ChecklistItem2, LinealityAndRaysAreThoseOfExactArithmetic) {
  Random random(GetParam());
  std::array<int, 4> with_lineality{};
  for (int sample = 0; sample < kStars / kParts; ++sample) {
    const Star star = random_star(random);
    const NormalCone cone = make_normal_cone(doubles(star));
    const Star lin = lineality(star);
    ASSERT_EQ(cone.lineality, rank(lin)) << "seed " << GetParam() << " star " << text(star);
    ++with_lineality[cone.lineality];
    for (const IntVec& g : lin) {  // it is the same space, not only one of that dimension
      Vec3 off = g.cast<double>().normalized();
      for (int k = 0; k < cone.lineality; ++k) off -= cone.lin[k].dot(off) * cone.lin[k];
      ASSERT_LT(off.norm(), 1e-12) << "seed " << GetParam() << " star " << text(star);
    }
    if (cone.lineality == 0) {
      ASSERT_EQ(int(cone.rays.size()), extreme_rays(star)) << "seed " << GetParam() << " star " << text(star);
    }
    ASSERT_TRUE(cone.cyclic) << "wrapping gave up; seed " << GetParam() << " star " << text(star);
  }
  for (const int n : with_lineality) EXPECT_GT(n, kStars / kParts / 50) << "the sample is hollow";
}

TEST_P(ChecklistItem2, NormalConesHoldExactlyTheirIntegerProbes) {
  Random random(GetParam() + 1000);
  int inside = 0, outside = 0;
  for (int sample = 0; sample < kStars / kParts; ++sample) {
    const Star star = random_star(random);
    if (star.empty()) continue;
    const NormalCone cone = make_normal_cone(doubles(star));
    for (int k = 0; k < 6; ++k) {
      const IntVec probe = probe_of(star, random);
      if (probe.isZero()) continue;
      const bool member = std::ranges::all_of(star, [&](const IntVec& g) { return g.dot(probe) <= 0; });
      const Vec3 u = probe.cast<double>().normalized();
      const double angle = angle_to(cone, u);
      (member ? inside : outside) += 1;
      if (member) {  // rounding of u and of the rays: a few 1e-16
        ASSERT_LT(angle, 1e-14) << "seed " << GetParam() << " star " << text(star) << " probe "
                                << text({probe});
        ASSERT_TRUE(may_contain(cone, u, 1e-12));
        ASSERT_LE(std::atan2(cone.axis.cross(u).norm(), cone.axis.dot(u)), cone.half_angle + 1e-12)
            << "the cap misses a direction; seed " << GetParam() << " star " << text(star);
      } else {  // sin(angle) >= g . u >= 1 / (|g| |probe|), the numerator being an integer
        double least = 0;
        for (const IntVec& g : star) least = std::max(least, g.cast<double>().normalized().dot(u));
        ASSERT_GE(std::sin(std::min(angle, kPi / 2)), least * (1 - 1e-9))
            << "seed " << GetParam() << " star " << text(star) << " probe " << text({probe});
      }
    }
  }
  EXPECT_GT(inside, kStars / kParts / 4) << "the sample is hollow";
  EXPECT_GT(outside, kStars / kParts / 4) << "the sample is hollow";
}

// Projection on { n : g . n <= 0 } by Dykstra's cyclic projections. By construction u - x stays in cone(G):
// an x of the polar at right angles to u - x is the projection.
bool dykstra(const std::vector<Vec3>& unit, const Vec3& u, Vec3& x) {
  std::vector<double> weight(unit.size(), 0);  // of unit[k] in u - x
  x = u;
  for (int round = 0; round < 20000; ++round) {
    const Vec3 before = x;
    for (std::size_t k = 0; k < unit.size(); ++k) {
      const double next = std::max(0.0, weight[k] + unit[k].dot(x));
      x -= (next - weight[k]) * unit[k];
      weight[k] = next;
    }
    if ((x - before).norm() > 1e-16) continue;
    const bool polar = std::ranges::all_of(unit, [&](const Vec3& g) { return g.dot(x) <= 1e-13; });
    if (polar && std::abs(x.dot(u - x)) <= 1e-13) return true;
  }
  return false;
}

TEST_P(ChecklistItem2, ProjectionsAreThoseOfDykstra) {
  Random random(GetParam() + 2000);
  int converged = 0, between = 0, total = 0;
  for (int sample = 0; sample < 1000; ++sample) {
    const Star star = random_star(random);
    std::vector<Vec3> unit = doubles(star);
    const NormalCone cone = make_normal_cone(unit);
    for (Vec3& g : unit) g.normalize();
    const Vec3 u = random.direction();
    Vec3 p;
    ++total;
    if (!dykstra(unit, u, p)) continue;
    ++converged;
    const double angle = std::min(angle_to(cone, u), kPi / 2);
    between += angle > 0 && angle < kPi / 2 - 1e-6;
    EXPECT_NEAR(std::cos(angle), p.norm(), 1e-12) << "seed " << GetParam() << " star " << text(star);
    EXPECT_NEAR(std::sin(angle), (u - p).norm(), 1e-12) << "seed " << GetParam() << " star " << text(star);
  }
  EXPECT_GT(converged, total * 9 / 10) << "where it crawls nothing is compared";
  EXPECT_GT(between, total / 5) << "the sample is hollow";
}

INSTANTIATE_TEST_SUITE_P(Seeds, ChecklistItem2, ::testing::Range(0U, unsigned(kParts)));

}  // namespace
}  // namespace aussois
