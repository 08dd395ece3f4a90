// SPDX-License-Identifier: Apache-2.0
#include "lmd/step_minima.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "lmd/nesting.hpp"
#include "tests/support/change.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {
namespace {

// A pair at rest about as far apart as the certificate asks for, and a step of it.
struct Step {
  RandomPair pair{};
  RigidMotion of_a{}, of_b{};
  double dt = 0.05;
  MovingShape a() const { return {&pair.a, {}, of_a}; }
  MovingShape b() const { return {&pair.b, {}, of_b}; }
};

Step random_step(std::uint64_t seed) {
  Random random(seed + 1000);
  Step out{.pair = random_pair(seed, random.uniform(0.02, 0.1))};
  const double pace = std::pow(10, random.uniform(-3, 0));
  out.of_a = {out.pair.g_a, pace * random.vector(1), pace * random.vector(1.8)};
  out.of_b = {out.pair.g_b, pace * random.vector(1), pace * random.vector(1.8)};
  return out;
}

double sampled_distance(const MovingShape& a, const MovingShape& b, double dt, int samples) {
  double least = kInf;
  for (int i = 0; i <= samples; ++i) {
    const double s = dt * i / samples;
    least = std::min(least, base_distance({a.shape, {}, {.g = pose_at(a.motion, s)}},
                                          {b.shape, {}, {.g = pose_at(b.motion, s)}}, 0.2));
  }
  return least;
}

bool starts_apart(const Step& step) {
  return step.pair.distance > 0 && !find_nesting(step.pair.posed_a(), connected_pieces(step.pair.a.complex),
                                                 step.pair.posed_b(), connected_pieces(step.pair.b.complex));
}

constexpr DistanceGoal kGoal{.required = 0.02, .wanted = 0.03};

// With distances up to 0.2 m wanted, every pair of them has a say.
TEST(StepMinima, AreNeverFartherApartThanTheBasesComeOnThePath) {
  int looked = 0, proven = 0, provable = 0, near = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Step step = random_step(seed);
    if (!starts_apart(step) || !has_step_minima(step.a(), step.b(), step.dt, kGoal.required)) continue;
    ++looked;
    const PartialCheck found = check_step_minima(step.a(), step.b(), step.dt, kGoal, 1);
    const double truth = sampled_distance(step.a(), step.b(), step.dt, 100);
    if (!found.failed) {
      EXPECT_LE(found.min_distance, truth + 1e-12) << seed;
      EXPECT_GE(found.min_distance, kGoal.required) << seed;
    } else {
      EXPECT_LT(truth, kGoal.required + 2e-2) << seed;
    }
    const PartialCheck wide = check_step_minima(step.a(), step.b(), step.dt, {0.02, 0.2}, 1);
    EXPECT_TRUE(wide.failed || wide.min_distance <= truth + 1e-12) << seed;
    const bool certified =
        certify(step.a(), step.b(), step.dt, {.required = kGoal.required, .wanted = kGoal.wanted}).certified;
    proven += !found.failed, provable += certified, near += truth < kGoal.wanted;
  }
  EXPECT_GT(looked, 600);
  EXPECT_GT(near, looked / 10);
  EXPECT_GT(proven, 0.98 * provable);  // it would be of no use otherwise
  EXPECT_LT(proven, looked);
}

TEST(StepMinima, AreTheSameForAnyNumberOfThreads) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Step step = random_step(seed);
    const PartialCheck one = check_step_minima(step.a(), step.b(), step.dt, kGoal, 1);
    const PartialCheck two = check_step_minima(step.a(), step.b(), step.dt, kGoal, 2);
    EXPECT_EQ(one.failed, two.failed) << seed;
    EXPECT_EQ(one.seen, two.seen) << seed;
    EXPECT_EQ(one.min_distance, two.min_distance) << seed;
    EXPECT_EQ(one.simplex_pairs, two.simplex_pairs) << seed;
    EXPECT_EQ(one.rounds, two.rounds) << seed;
  }
}

// A turn by 0.25 rad is none of theirs: the certificate is that of a start of which nothing is known.
TEST(StepMinima, LeaveFastTurnsToTheDescent) {
  int turned = 0, refuted = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Step step = random_step(seed);
    if (!starts_apart(step)) continue;
    if (seed % 2 == 0) step.of_a.omega = 5 * Vec3::UnitX();
    CertificateOptions options{.required = kGoal.required, .wanted = kGoal.wanted};
    const Certificate judge = certify(step.a(), step.b(), step.dt, options);
    options.starts_apart = true;
    const Certificate quick = certify(step.a(), step.b(), step.dt, options);
    EXPECT_EQ(quick.certified, judge.certified) << seed;
    if (has_step_minima(step.a(), step.b(), step.dt, kGoal.required)) {
      refuted += !quick.certified;
      continue;
    }
    ++turned;
    EXPECT_EQ(quick.min_distance, judge.min_distance) << seed;
    EXPECT_EQ(quick.rounds, judge.rounds) << seed;
  }
  EXPECT_GT(turned, 50);
  EXPECT_GT(refuted, 5);
}

// A box 2 um farther above a plate than it must stay, where planes are only known to 14 um.
TEST(StepMinima, LeaveWhatTheyCannotTellToTheDescent) {
  const LmdShape box = prepare(dilate(make_box(1, 1, 1), 1e-2)),
                 plate = prepare(dilate(make_plate(2, 2), 1e-2));
  const double required = 1.9e-2;
  for (const double above : {2e-6, 1e-3, -2e-6}) {
    const MovingShape a{&box, {}, {.g = translation(0, 0, 0.5 + required + above), .v = {0.1, 0, 0}}},
        b{&plate, {}, {}};
    const PartialCheck found = check_step_minima(a, b, 1e-3, {.required = required, .wanted = 2e-2}, 1);
    EXPECT_EQ(found.failed, above < 1e-3) << above;
    EXPECT_EQ(is_seen_nearer(found, required), above < 0) << above;
    const Certificate quick =
        certify(a, b, 1e-3, {.required = required, .wanted = 2e-2, .starts_apart = true});
    EXPECT_EQ(quick.certified, above > 0) << above;
    if (quick.certified) {
      EXPECT_NEAR(quick.min_distance, required + above, 2e-5);
    }
  }
}

// A box near a plate, with a ball far off: without a leaf anywhere, the simplices of the box are the proof.
TEST(StepMinima, AreAskedBesideAllPairsOfSimplicesThatAreNotProven) {
  const SimplicialComplex box = make_box(1, 1, 1), ball = make_sphere(1, 2);
  std::vector<Vec3> vertices = box.vertices.to_vector();
  std::vector<std::array<int, 3>> triangles = box.triangles.to_vector();
  for (const Vec3& x : ball.vertices) vertices.push_back(x + Vec3(0, 0, 4));
  for (const auto& t : ball.triangles) triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  LmdShape part = prepare(dilate(make_complex(vertices, triangles, {}), 1e-2));
  const LmdShape plate = prepare(dilate(make_plate(4, 4), 1e-2));
  ASSERT_TRUE(part.unproven.empty());
  part.vertex_tree = part.wide_vertex_tree = part.edge_tree = part.wide_edge_tree = {};
  std::vector<ConeTreeItem> items;
  std::vector<int> listed, ordered;
  for (int i = 0; i < base_count(part); ++i) {
    const BaseSimplex s = base_simplex(part, i);
    if (s.vertex[0] >= 8) continue;
    listed.push_back(i);
    items.push_back({.vertex = s.vertex, .vertex_count = 3});
  }
  std::vector<int> order;
  part.unproven_tree = build_cone_tree(items, vertices, part.centre, order);
  for (int i : order) ordered.push_back(listed[i]);
  part.unproven = std::move(ordered);

  Random random(3);
  int certified = 0;
  for (int sample = 0; sample < 200; ++sample) {
    const double above = random.uniform(0.019, 0.03);
    const SE3 g{exp_so3(random.vector(0.01)), Vec3(0, 0, 0.5 + above + 0.01)};
    const Vec3 v = random.vector(1), omega = random.vector(1);
    const double required = 0.0192;
    MovingShape moving{&part, {}, {.g = g, .v = v, .omega = omega}}, still{&plate, {}, {}};
    if (sample % 2 == 1) std::swap(moving, still);
    if (base_distance(moving, still, 1) < required) continue;
    ASSERT_TRUE(has_step_minima(moving, still, 0.01, required));
    ASSERT_EQ(check_step_minima(moving, still, 0.01, {required, 0.05}, 1).simplex_pairs, 0);
    CertificateOptions options{.required = required, .wanted = 0.05};
    const Certificate judge = certify(moving, still, 0.01, options);
    options.starts_apart = true;
    const Certificate quick = certify(moving, still, 0.01, options);
    EXPECT_EQ(quick.certified, judge.certified) << sample;
    if (judge.certified) {
      EXPECT_NEAR(quick.min_distance, judge.min_distance, 1e-4) << sample;
    }
    options.threads = 2;
    EXPECT_EQ(certify(moving, still, 0.01, options).min_distance, quick.min_distance) << sample;
    certified += judge.certified;
  }
  EXPECT_GT(certified, 50);
  EXPECT_LT(certified, 190);
}

// One face of a box bends by a little more than its plane tolerates, in a corner of it.
TEST(StepMinima, OfAMeshThatMissesConditionsProveWhatTheDescentProves) {
  Random random(5);
  SimplicialComplex box = make_box(1, 1, 1, 12);
  const double tolerance = 1e-6 * std::sqrt(3.0);
  change_each(box.vertices, [&](Vec3& x) {
    if (x.z() > 0.49 && x.x() > 0.1 && x.y() > 0.1) x.z() += random.uniform(-3, 3) * tolerance;
  });
  const LmdShape bent = prepare(dilate(std::move(box), 0.02)),
                 probe = prepare(dilate(make_box(0.3, 0.3, 0.3), 0.02));
  ASSERT_GT(bent.unproven.size(), 5U);
  ASSERT_LT(4 * bent.unproven.size(), std::size_t(base_count(bent)));
  int certified = 0, near = 0;
  for (int sample = 0; sample < 300; ++sample) {
    const Quat lean = exp_so3(random.vector(1e-3));
    const Vec3 place(random.uniform(-0.3, 0.6), random.uniform(-0.3, 0.6),
                     0.65 + random.uniform(0.0385, 0.045));
    const MovingShape a{&probe, {}, {.g = {lean, place}, .v = random.vector(0.2), .omega = random.vector(1)}},
        b{&bent, {}, {}};
    CertificateOptions options{.required = 0.0384, .wanted = 0.04};
    if (base_distance(a, b, 1) < options.required) continue;
    const Certificate judge = certify(a, b, 0.01, options);
    options.starts_apart = true;
    const Certificate quick = certify(a, b, 0.01, options);
    EXPECT_EQ(quick.certified, judge.certified) << sample;
    if (!judge.certified) continue;
    EXPECT_LE(quick.min_distance, sampled_distance(a, b, 0.01, 30) + 1e-12) << sample;
    ++certified, near += judge.min_distance < options.wanted;
  }
  EXPECT_GT(certified, 50);
  EXPECT_GT(near, 50);
}

// Threads that fit with play: surfaces conform, so that boxes and balls tell little.
TEST(StepMinima, OfABoltInItsNutProveWhatTheDescentProvesWithFewerPairs) {
  const double dilation = 2e-5;
  const LmdShape bolt = prepare(dilate(make_bolt({}), dilation)),
                 nut = prepare(dilate(make_nut({}), dilation));
  Random random(7);
  int proven = 0, certified = 0;
  long pairs = 0, of_the_descent = 0;
  for (int sample = 0; sample < 40; ++sample) {
    const SE3 lean{exp_so3(random.vector(2e-4)), random.vector(5e-6)};
    const RigidMotion of_bolt{translation(0, 0, -3 * FastenerOptions{}.pitch) * lean, random.vector(5e-3),
                              random.vector(0.2)};
    const MovingShape a{&bolt, {}, of_bolt}, b{&nut, {}, {}};
    if (base_distance(a, b, 1e-3) < 1.96 * dilation) continue;
    const DistanceGoal goal{.required = 1.92 * dilation, .wanted = 2 * dilation};
    const PartialCheck found = check_step_minima(a, b, 1e-3, goal, 1);
    const Certificate judge = certify(a, b, 1e-3, {.required = goal.required, .wanted = goal.wanted});
    EXPECT_LE(!found.failed, judge.certified) << sample;
    proven += !found.failed, certified += judge.certified;
    if (found.failed) continue;
    EXPECT_LE(found.min_distance, base_distance(a, b, 1e-3) + 1e-12) << sample;
    pairs += found.simplex_pairs, of_the_descent += judge.simplex_pairs;
  }
  EXPECT_GT(certified, 5);
  EXPECT_GE(proven, 0.9 * certified);
  EXPECT_LT(pairs, of_the_descent / 2);
}

}  // namespace
}  // namespace aussois
