// SPDX-License-Identifier: Apache-2.0
// Nothing passes through anything, however fast (question 11 of doc/theory/lmd.md): what is certified, and
// what the scheme accepts, keeps its distance when the motion is replayed without hierarchy, cones or bounds
// of the library.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "lmd/certificate.hpp"
#include "lmd/simplex_distance.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// The path of a step, written afresh: a straight line and a rotation about a fixed axis.
struct Path {
  Vec3 p = Vec3::Zero(), v = Vec3::Zero(), omega = Vec3::Zero();  // world
  Mat3 R = Mat3::Identity();
  Vec3 at(const Vec3& x, double s) const {
    const double rate = omega.norm();
    const Vec3 axis = rate > 0 ? Vec3(omega / rate) : Vec3(Vec3::UnitX());
    return p + s * v + Eigen::AngleAxisd(s * rate, axis) * (R * x);
  }
};

Path path_of(const SE3& g, const Vec3& v, const Vec3& omega_body) {
  const Mat3 R = g.R.toRotationMatrix();
  return {.p = g.p, .v = v, .omega = R * omega_body, .R = R};
}

Path standing(const SE3& g) {
  return {.p = g.p, .R = g.R.toRotationMatrix()};
}

double distance_at(const SimplicialComplex& a, const Path& path_a, const SimplicialComplex& b,
                   const Path& path_b, double s) {
  const auto placed = [&](const SimplicialComplex& k, const Path& path) {
    std::vector<Vec3> x;
    for (const Vec3& vertex : k.vertices) x.push_back(path.at(vertex, s));
    return x;
  };
  const std::vector<Vec3> x = placed(a, path_a), y = placed(b, path_b);
  double least = kInf;
  for (const auto& t : a.triangles)
    for (const auto& u : b.triangles) {
      const Vec3 p[] = {x[t[0]], x[t[1]], x[t[2]]};
      const Vec3 q[] = {y[u[0]], y[u[1]], y[u[2]]};
      least = std::min(least, closest_points(p, q).distance);
    }
  return least;
}

// Smallest distance along the path, replayed so densely that nothing below `resolution` hides between two
// looks: no point closes faster than `speed`, so half of the distance can be walked at once.
double least_distance(const SimplicialComplex& a, const Path& path_a, const SimplicialComplex& b,
                      const Path& path_b, double dt, double resolution) {
  const double speed = (path_a.v - path_b.v).norm() + path_a.omega.norm() * radius_about(a, Vec3::Zero()) +
                       path_b.omega.norm() * radius_about(b, Vec3::Zero());
  double least = kInf;
  for (double s = 0;;) {
    const double distance = distance_at(a, path_a, b, path_b, s);
    least = std::min(least, distance);
    if (s >= dt || distance == 0) return least;
    s = std::min(dt, s + std::max(distance, resolution) / 2 / speed);
  }
}

struct Verdicts {
  int certified = 0, refused = 0, hits = 0;  // hits: paths that do come below what is required
};

// One path, judged by the certificate and by the replay. False certificates fail.
void judge(const LmdShape& a, const RigidMotion& motion_a, const LmdShape& b, const RigidMotion& motion_b,
           double dt, double required, Verdicts& verdicts) {
  const Certificate c =
      certify({&a, {}, motion_a}, {&b, {}, motion_b}, dt, {.required = required, .wanted = 4 * required});
  const double truth = least_distance(a.complex, path_of(motion_a.g, motion_a.v, motion_a.omega), b.complex,
                                      path_of(motion_b.g, motion_b.v, motion_b.omega), dt, required / 4);
  if (truth < required) {
    ++verdicts.hits;
    EXPECT_FALSE(c.certified) << "comes to " << truth << " m, required are " << required << " m";
  }
  ++(c.certified ? verdicts.certified : verdicts.refused);
  if (!c.certified) return;
  EXPECT_GE(c.min_distance, required);
  EXPECT_GE(truth, c.min_distance - 1e-12);
}

TEST(NoTunnelling, ABulletThroughPaperIsNeverCertified) {
  Random random(31);
  const LmdShape paper = prepare(dilate(make_plate(0.2, 0.2), 5e-5)),
                 bullet = prepare(dilate(make_sphere(5e-3, 0), 5e-5));
  Verdicts verdicts;
  for (int sample = 0; sample < 120; ++sample) {  // 1000 m/s, from both sides, straight and oblique, tumbling
    const Vec3 aim{random.uniform(-0.12, 0.12), random.uniform(-0.12, 0.12), 0};
    const Vec3 direction = (Vec3(0, 0, sample % 2 ? 1 : -1) + random.vector(0.5)).normalized();
    const RigidMotion shot{{random.rotation(), aim - random.uniform(0.01, 2.2) * direction},
                           1000 * direction,
                           random.vector(200)};
    judge(bullet, shot, paper, RigidMotion{}, 2e-3, 9.6e-5, verdicts);
  }
  EXPECT_GT(verdicts.hits, 30);
  EXPECT_GT(verdicts.certified, 20);
  EXPECT_LT(verdicts.refused, 1.2 * verdicts.hits);  // hardly any refusal without a reason
}

// More than a whole turn per step: where the rod ends says nothing about what it swept.
TEST(NoTunnelling, ASpinningRodThroughAPostIsNeverCertified) {
  Random random(32);
  const LmdShape rod = prepare(dilate(make_box(0.2, 2e-3, 2e-3), 1e-4)),
                 post = prepare(dilate(make_box(2e-3, 2e-3, 0.1), 1e-4));
  Verdicts verdicts;
  for (int sample = 0; sample < 250; ++sample) {
    const double at = random.uniform(0.05, 0.2), spin = random.uniform(100, 2000);
    const RigidMotion turning{
        {exp_so3(Vec3(0, 0, random.uniform(0, kPi))), {0, 0, random.uniform(-0.06, 0.06)}},
        random.vector(1),
        Vec3(0, 0, spin) + random.vector(5)};
    const RigidMotion still{translation(at, 0, 0)};
    if (distance_at(rod.complex, standing(turning.g), post.complex, standing(still.g), 0) < 1e-3) continue;
    judge(rod, turning, post, still, random.uniform(1e-4, 7e-3), 1.92e-4, verdicts);
  }
  EXPECT_GT(verdicts.hits, 25);
  EXPECT_GT(verdicts.certified, 25);
}

constexpr double kEps = 1e-4;        // dilation of each part of the washboard scene [m]
constexpr double kWave = 60 * kEps;  // its wave length; a slide of 100 eps crosses several
constexpr double kHeight = 10 * kEps;

// A sheet folded along y into `waves` ridges, crests at z = 0.
SimplicialComplex washboard(int waves) {
  std::vector<Vec3> x;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= 2 * waves; ++i) {
    for (const double y : {-0.02, 0.02}) x.push_back({i * kWave / 2, y, i % 2 ? 0 : -kHeight});
    if (i == 0) continue;
    const int k = 2 * i;
    triangles.push_back({k - 2, k, k - 1});
    triangles.push_back({k - 1, k, k + 1});
  }
  return make_complex(std::move(x), std::move(triangles));
}

TEST(NoTunnelling, SlidingAHundredDilationsAlongAWashboardIsCertifiedOnlyAboveTheCrests) {
  Random random(33);
  const LmdShape board = prepare(dilate(washboard(12), kEps)),
                 slider = prepare(dilate(make_box(20 * kEps, 0.01, 0.004), kEps));
  Verdicts verdicts;
  for (int sample = 0; sample < 250;
       ++sample) {  // the slider's lowest edge a little above or below the crests
    const double clearance = random.uniform(-5, 4) * kEps, dt = 1e-3;
    const RigidMotion sliding{{exp_so3(Vec3(0, random.uniform(-0.02, 0.02), 0)),
                               {kWave * random.uniform(2, 6), 0, 0.002 + 2 * kEps + clearance}},
                              {100 * kEps / dt * (sample % 2 ? 1 : -1), 0, random.uniform(-1, 1) * kEps / dt},
                              {0, random.uniform(-10, 10), 0}};
    if (distance_at(slider.complex, standing(sliding.g), board.complex, standing({}), 0) < 2 * kEps) continue;
    judge(slider, sliding, board, RigidMotion{}, dt, 1.92 * kEps, verdicts);
  }
  EXPECT_GT(verdicts.hits, 20);
  EXPECT_GT(verdicts.certified, 40);
}

// The whole scheme, with steps as long as it likes: each accepted step is replayed.
void replay_steps(Model& model, State state, BodyId fixed, BodyId moving, double h, double t_end) {
  const MoreauJean scheme(model, {.h = h}, {.theta = 1});
  const SimplicialComplex &a = model.shapes[model.bodies[fixed].shape]->complex,
                          &b = model.shapes[model.bodies[moving].shape]->complex;
  const double dilations = 2 * kEps, required = 0.96 * dilations;
  double closest = kInf;
  while (state.t < t_end) {
    const State before = state;
    const StepReport report = scheme.step(state, t_end - state.t);
    ASSERT_EQ(report.status, StepStatus::ok) << report.reason;
    const SE3 &g = pose(before, moving), &next = pose(state, moving);
    const Path path =
        path_of(g, (next.p - g.p) / report.h, log_so3((g.R.conjugate() * next.R).normalized()) / report.h);
    const double truth = least_distance(a, standing({}), b, path, report.h, required / 4);
    ASSERT_GE(truth, required - 1e-9) << "at t = " << before.t;
    if (std::isfinite(report.min_base_distance)) {  // otherwise nothing was near
      ASSERT_LE(report.min_base_distance, truth + 1e-9);
    }
    closest = std::min(closest, truth);
  }
  EXPECT_LT(closest, dilations);  // they did touch
}

RigidBody centred(const std::string& name, ShapeId shape, const SimplicialComplex& complex) {
  return solid_body(name, shape, mass_properties(complex, 7800));
}

TEST(NoTunnelling, TheSchemeStopsABulletInFrontOfPaper) {
  Model model;
  const SimplicialComplex ball = make_sphere(5e-3, 1);
  const auto paper = add(model, fixed_body("paper", add(model, prepare(dilate(make_plate(0.2, 0.2), kEps)))));
  const auto bullet = add(model, centred("bullet", add(model, prepare(dilate(ball, kEps))), ball));
  State state = rest_state(model);
  pose(state, bullet).p = {0.013, 0.021, 0.5};
  twist(state, bullet)[2] = -1000;
  replay_steps(model, state, paper, bullet, 1e-3, 2e-3);
}

TEST(NoTunnelling, TheSchemeKeepsASliderOnAWashboardAtAHundredDilationsPerStep) {
  Model model;
  model.contact_law = {.mu = 0.1};
  model.gravity = {0, 0, -2000};  // pressed down, or the first ridge throws it off
  const SimplicialComplex box = make_box(40 * kEps, 0.01, 0.004);
  const auto board = add(model, fixed_body("board", add(model, prepare(dilate(washboard(80), kEps)))));
  const auto slider = add(model, centred("slider", add(model, prepare(dilate(box, kEps))), box));
  State state = rest_state(model);
  pose(state, slider).p = {4 * kWave, 0, 0.002 + 4 * kEps};
  twist(state, slider)[0] = 10;  // 100 eps per millisecond
  replay_steps(model, state, board, slider, 1e-3, 20e-3);
}

}  // namespace
}  // namespace aussois
