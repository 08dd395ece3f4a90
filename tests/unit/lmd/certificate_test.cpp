// SPDX-License-Identifier: Apache-2.0
#include "lmd/certificate.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/simplex_distance.hpp"
#include "tests/support/change.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

TEST(ClosestPoints, AgreeWithDenseSampling) {
  Random random(3);
  for (int sample = 0; sample < 300; ++sample) {
    std::vector<Vec3> a, b;
    const int n = 1 + random.index(3), m = 1 + random.index(3);
    const Vec3 shift = random.vector(1.5);
    for (int i = 0; i < n; ++i) a.push_back(random.vector());
    for (int i = 0; i < m; ++i) b.push_back(random.vector() + shift);
    const ClosestPoints closest = closest_points(a, b);
    EXPECT_NEAR((closest.x_a - closest.x_b).norm(), closest.distance, 1e-12);
    const auto point_of = [&](const std::vector<Vec3>& k) {
      Vec3 x = Vec3::Zero();
      double sum = 0;
      for (const Vec3& p : k) {
        const double w = random.uniform();
        x += w * p;
        sum += w;
      }
      return Vec3(x / sum);
    };
    for (int probe = 0; probe < 200; ++probe) {
      const Vec3 of_a = point_of(a), of_b = point_of(b);
      EXPECT_GE((of_a - of_b).norm(), closest.distance - 1e-12);
    }
    // Optimality: no vertex lies beyond the planes through the closest points (convexity makes this
    // sufficient).
    if (closest.distance > 1e-9) {
      const Vec3 u = (closest.x_b - closest.x_a) / closest.distance;
      for (const Vec3& p : a) EXPECT_LE(u.dot(p - closest.x_a), 1e-9) << sample;
      for (const Vec3& p : b) EXPECT_GE(u.dot(p - closest.x_b), -1e-9) << sample;
    }
  }
}

TEST(ClosestPoints, OfCrossingTrianglesAreAtDistanceZero) {
  const std::vector<Vec3> a{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, b{{0, 0, -1}, {0, 0.1, 1}, {0.1, 0, 1}};
  EXPECT_EQ(closest_points(a, b).distance, 0);
}

TEST(MotionBound, HoldsAtAllTimes) {
  Random random(11);
  for (int sample = 0; sample < 2000; ++sample) {
    const RigidMotion a{random.pose(1), random.vector(2), random.vector(4)},
        b{random.pose(1), random.vector(2), random.vector(4)};
    const double dt = random.uniform(0, 1), radius_a = random.uniform(0, 1), radius_b = random.uniform(0, 1);
    const double bound = relative_displacement_bound(a, radius_a, b, radius_b, dt);
    const double bound_a = displacement_bound(a, radius_a, dt), turn = relative_rotation_bound(a, b, dt);
    for (int probe = 0; probe < 20; ++probe) {
      const double s = probe == 0 ? dt : random.uniform(0, dt);
      const SE3 ga = pose_at(a, s), gb = pose_at(b, s);
      const Vec3 x = radius_a * random.direction(), y = radius_b * random.direction();
      EXPECT_LE((ga * x - a.g * x).norm(), bound_a + 1e-12);
      // The distance of two body points changes by no more than the relative displacement.
      EXPECT_LE(std::abs((ga * x - gb * y).norm() - (a.g * x - b.g * y).norm()), bound + 1e-12) << sample;
      EXPECT_LE(
          angle_between((a.g.R.conjugate() * b.g.R).normalized(), (ga.R.conjugate() * gb.R).normalized()),
          turn + 1e-9);
    }
  }
}

// Balls of 0.1 m that fall on a slab at 10 m/s, for 10 ms: halving would find out in sixteen rounds where
// they come too near.
TEST(Certificate, FailsAtOnceForWhatEndsTooNear) {
  const LmdShape ball = prepare(dilate(make_point(), 0.1)), slab = prepare({.complex = make_box(10, 10, 1)});
  Random random(41);
  for (int sample = 0; sample < 100; ++sample) {
    const Vec3 at{random.uniform(-4, 4), random.uniform(-4, 4), 0.5 + 0.1 + random.uniform(0, 0.05)};
    const MovingShape a{&ball, {}, {.g = {Quat::Identity(), at}, .v = Vec3(0, 0, -10)}}, b{&slab, {}, {}};
    const Certificate found = certify(a, b, 1e-2, {.required = 0.1, .wanted = 0.1, .max_halvings = 16});
    EXPECT_FALSE(found.certified) << sample;
    EXPECT_LE(found.min_distance, 0.1) << sample;
    EXPECT_LE(found.rounds, 2 * found.simplex_pairs) << sample;
  }
}

// All pairs of simplices, each with closest_points.
double distance_of_all_pairs(const LmdShape& a, const SE3& g, const LmdShape& b) {
  double least = kInf;
  const auto place = [](const LmdShape& shape, const std::array<int, 3>& triangle, const SE3& at) {
    std::vector<Vec3> out;
    for (const int v : triangle) out.push_back(at * shape.complex.vertices[v]);
    return out;
  };
  for (const auto& p : a.complex.triangles)
    for (const auto& q : b.complex.triangles)
      least = std::min(least, closest_points(place(a, p, g), place(b, q, {})).distance);
  return least;
}

TEST(AreApart, IsNeverSaidOfWhatIsNear) {
  Random random(21);
  int said = 0, apart = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    std::vector<Vec3> a, b;
    const int n = 1 + random.index(3), m = 1 + random.index(3);
    const Vec3 shift = random.vector(3), far_off = random.vector(1e3);
    for (int i = 0; i < n; ++i) a.push_back(far_off + random.vector());
    for (int i = 0; i < m; ++i) b.push_back(far_off + random.vector() + shift);
    const double distance = closest_points(a, b).distance;
    EXPECT_FALSE(are_apart(a, b, distance + 1e-11)) << sample;
    said += are_apart(a, b, 0.9 * distance);
    apart += distance > 0;
  }
  EXPECT_GT(said, apart / 2);  // it would be of no use otherwise
}

// A ball in a hollow ball, turned a little: all of their triangles are nearly as far apart.
TEST(BaseDistance, OfConformingSurfacesLooksAtFewPairsAndIsThatOfAllPairs) {
  SimplicialComplex hollow = make_sphere(0.0102, 3);
  change_each(hollow.triangles, [](auto& triangle) { std::swap(triangle[1], triangle[2]); });
  const LmdShape ball = prepare({.complex = make_sphere(0.01, 3)}),
                 shell = prepare({.complex = make_complex(hollow.vertices, hollow.triangles)});
  Random random(22);
  for (int sample = 0; sample < 3; ++sample) {
    const SE3 g{exp_so3(random.vector(1)), random.vector(2e-5)};
    const double expected = distance_of_all_pairs(ball, g, shell);
    const MovingShape a{&ball, {}, {.g = g}}, b{&shell, {}, {}};
    const BaseDistance wide = find_base_distance(a, b, 1), tight = find_base_distance(a, b, 1.001 * expected);
    EXPECT_NEAR(wide.distance, expected, 1e-16);  // rounding of coordinates of a centimetre
    EXPECT_EQ(tight.distance, wide.distance);
    const long facing = long(ball.complex.triangles.size());  // each has one across the gap, or more
    EXPECT_LT(wide.simplex_pairs, facing);
    EXPECT_LT(tight.simplex_pairs, facing / 50);
  }
}

// A point across the axis whose chord lies along v; seen from a body at rest both bounds are reached.
TEST(MotionBound, IsAttained) {
  const double dt = 1e-3, radius = 0.3;
  const RigidMotion a{{}, Vec3(0, 2, 0), Vec3(0, 0, 5)}, still{};
  const Vec3 x(radius, 0, 0);
  const double moved = (pose_at(a, dt) * x - x).norm();
  EXPECT_GT(moved, 0.999 * displacement_bound(a, radius, dt));
  EXPECT_GT(moved, 0.999 * relative_displacement_bound(a, radius, still, 1, dt));
  // Both turn alike about one point: nothing moves relatively, but for what the second order allows.
  const RigidMotion b{translation(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)},
      c{{}, Vec3(0, 0, 0), Vec3(0, 0, 1)};
  EXPECT_LT(relative_displacement_bound(b, radius, c, radius, dt), 1e-6);
}

LmdShape prepared(SimplicialComplex complex) {
  return prepare({.complex = std::move(complex), .radius = 1e-3});
}

double sampled_distance(const MovingShape& a, const MovingShape& b, double dt, int samples) {
  double least = kInf;
  for (int i = 0; i <= samples; ++i) {
    const double s = dt * i / samples;
    MovingShape now_a = a, now_b = b;
    now_a.motion.g = pose_at(a.motion, s);
    now_b.motion.g = pose_at(b.motion, s);
    least = std::min(least, base_distance(now_a, now_b, 0.1));
  }
  return least;
}

// What is certified is true on a dense replay; what is refused comes near, or nearly so.
TEST(Certificate, IsNeverGivenWhenThePathUndercutsTheDistance) {
  Random random(5);
  const LmdShape shapes[] = {prepared(make_box(0.3, 0.2, 0.1)), prepared(make_torus(0.2, 0.05, 9, 5)),
                             prepared(make_plate(0.4, 0.4)),
                             prepared(make_polyline({{-0.2, 0, 0}, {0, 0.1, 0}, {0.2, 0, 0.1}}))};
  int certified = 0, refused = 0, at_once = 0;
  for (int sample = 0; sample < 600; ++sample) {
    const MovingShape a{
        &shapes[random.index(4)], random.pose(0.05), {random.pose(0.5), random.vector(1), random.vector(3)}};
    const MovingShape b{
        &shapes[random.index(4)], {}, {random.pose(0.2), random.vector(0.5), random.vector(2)}};
    const double dt = 0.3, required = 2e-3;
    if (base_distance(a, b, 1) < 0.01) continue;
    // Whatever direction one may hope for: none, from centre to centre, a wrong one (CA-15).
    const Vec3 axis[] = {Vec3::Zero(), b.motion.g.p - a.motion.g.p, random.direction()};
    const Certificate c = certify(a, b, dt, {.required = required, .wanted = 0.05, .axis = axis[sample % 3]});
    const double truth = sampled_distance(a, b, dt, 100);
    at_once += c.certified && c.simplex_pairs == 0 && sample % 3 == 1;
    if (c.certified) {
      ++certified;
      EXPECT_GE(truth, c.min_distance - 1e-12) << sample;
      EXPECT_GE(c.min_distance, required);
    } else {
      ++refused;
      EXPECT_LT(truth, required + 2e-2) << sample;  // refused only when it truly comes near
    }
  }
  EXPECT_GT(certified, 50);
  EXPECT_GT(refused, 30);
  EXPECT_GT(at_once, 5);
}

TEST(Certificate, SeesABulletThatPassesThroughPaperWithinOneStep) {
  const LmdShape paper = prepared(make_plate(0.1, 0.1)), bullet = prepared(make_sphere(5e-3, 1));
  const MovingShape target{&paper, {}, {}};
  for (int phase = 0; phase < 100; ++phase) {
    const MovingShape shot{
        &bullet, {}, {.g = translation(0.003, 0.002, 0.3 + 0.008 * phase), .v = {0, 0, -800}}};
    EXPECT_FALSE(certify(shot, target, 2e-3, {.required = 1e-6, .wanted = 1e-3}).certified) << phase;
    EXPECT_TRUE(certify(shot, target, 0.29 / 800, {.required = 1e-6, .wanted = 1e-3}).certified) << phase;
  }
}

TEST(Certificate, LetsAPartSlideFarInOneStep) {
  const LmdShape rail = prepared(make_box(1, 0.1, 0.1, 20)), slider = prepared(make_box(0.1, 0.1, 0.1, 4));
  const MovingShape still{&rail, {}, {}};
  const MovingShape moving{&slider, {}, {.g = translation(-0.3, 0, 0.1 + 1e-4), .v = {1, 0, 0}}};
  const Certificate c = certify(moving, still, 0.5, {.required = 9e-5, .wanted = 2e-4});  // 5000 gaps long
  EXPECT_TRUE(c.certified);
  EXPECT_NEAR(c.min_distance, 1e-4, 1e-6);  // a bound: one per cent below the truth
}

// By hand: a box that turns about z at 1 rad/s and rises at 0.1 m/s keeps its lower face where it is, so the
// plane sees the distance at the start; falling at 0.1 m/s it loses 1 cm in 0.1 s. Points bend by at most
// dt^2 / 2 times the distance to the axis of the box.
TEST(Certificate, OfOnePlaneIsTheDistanceAlongItsNormal) {
  const LmdShape box = prepared(make_box(0.2, 0.2, 0.2)), floor = prepared(make_box(1, 1, 0.2));
  const double dt = 0.1, bend = std::sqrt(0.03) * dt * dt / 2;
  for (const double v : {0.1, -0.1}) {
    const MovingShape a{&box, {}, {.g = translation(0, 0, 0.25), .v = {0, 0, v}, .omega = {0, 0, 1}}},
        b{&floor, {}, {}};
    const Certificate c = certify(a, b, dt, {.required = 0.03, .wanted = 0.5, .axis = Vec3(0, 0, -2)});
    EXPECT_TRUE(c.certified);
    EXPECT_EQ(c.simplex_pairs, 0);
    EXPECT_NEAR(c.min_distance, 0.05 + std::min(0.0, v * dt) - (v < 0 ? bend : 0), 1e-15) << v;
  }
}

}  // namespace
}  // namespace aussois
