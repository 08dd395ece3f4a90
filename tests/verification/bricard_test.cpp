// SPDX-License-Identifier: Apache-2.0
// C8, Bricard's ring of six hinges (doc/theory/mechanism_benchmarks.md), against its motion in one
// coordinate.
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "examples/scenes/mechanisms.hpp"
#include "integrators/joint_rows.hpp"
#include "mechanics/mechanism.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {
namespace {

// The ring opened at its last hinge: angles of six hinges, a screw each in the position of the start (MCH-8).
// Nothing here is the kernel's.
namespace ring {

constexpr double kGravity = 9.81;
const Vec3 kCorner[6] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
const Vec3 kAxis[3] = {Vec3::UnitY(), Vec3::UnitZ(), Vec3::UnitX()};

/// Hinge k now, if those before it have turned by q.
struct Ring {
  std::array<Vec3, 6> axis{}, point{};
  std::array<Eigen::Isometry3d, 6> rod{};  // from where it was at the start; the sixth is the ground
};
Ring turned(const VecX& q) {
  Ring out;
  Eigen::Isometry3d g = Eigen::Isometry3d::Identity();
  for (int k = 0; k < 6; ++k) {
    const auto i = std::size_t(k);
    out.axis[i] = g.linear() * kAxis[k % 3], out.point[i] = g * kCorner[k];
    Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
    turn.linear() = Eigen::AngleAxisd(q[k], kAxis[k % 3]).toRotationMatrix();
    turn.translation() = kCorner[k] - turn.linear() * kCorner[k];
    out.rod[i] = g = g * turn;
  }
  return out;
}

/// The one motion of the closed ring, |q'| = 1, on the side of `like`.
VecX tangent(const VecX& q, const VecX& like) {
  const Ring r = turned(q);
  Mat6 J;  // twist of the last rod, which must stand still
  for (int k = 0; k < 6; ++k) {
    const auto i = std::size_t(k);
    J.col(k) << r.axis[i], r.point[i].cross(r.axis[i]);
  }
  const VecX t = Eigen::JacobiSVD<MatX>(J, Eigen::ComputeFullV).matrixV().col(5);
  return t.dot(like) < 0 ? VecX(-t) : t;
}

/// Of the five rods: twice the kinetic energy if the angles move with q', and the potential energy.
double mass(const VecX& q, const VecX& speed) {
  const Ring r = turned(q);
  const double across = 1.0 / 12, along = kBricardRadius * kBricardRadius / 2;
  double sum = 0;
  Vec3 omega = Vec3::Zero(),
       origin = Vec3::Zero();  // of the rod; velocity of its point at the world's origin
  for (int k = 0; k < 5; ++k) {
    const auto i = std::size_t(k);
    omega += speed[k] * r.axis[i], origin += speed[k] * r.point[i].cross(r.axis[i]);
    const Vec3 centre = r.rod[i] * Vec3((kCorner[k] + kCorner[k + 1]) / 2);
    const double turns = omega.dot(r.rod[i].linear() * (kCorner[k + 1] - kCorner[k]));
    sum += (origin + omega.cross(centre)).squaredNorm() + across * (omega.squaredNorm() - turns * turns) +
           along * turns * turns;
  }
  return sum;
}
double potential(const VecX& q) {
  const Ring r = turned(q);
  double sum = 0;
  for (int k = 0; k < 5; ++k)
    sum += kGravity * (r.rod[std::size_t(k)] * Vec3((kCorner[k] + kCorner[k + 1]) / 2)).y();
  return sum;
}

/// y = (q, s'): q' = s' t(q), m s'' = -dV/ds - m' s'^2 / 2, derivatives along the motion by differences.
VecX rates(const VecX& y, const VecX& like) {
  constexpr double kStep = 2e-3;  // of the angles; fourth order
  const VecX q = y.head(6), t = tangent(q, like);
  const auto along = [&](const auto& f) {
    return (8 * (f(q + kStep * t) - f(q - kStep * t)) - f(q + 2 * kStep * t) + f(q - 2 * kStep * t)) /
           (12 * kStep);
  };
  const auto m = [&](const VecX& at) { return mass(at, tangent(at, t)); };
  VecX out(7);
  out << y[6] * t, (-along(potential) - along(m) * y[6] * y[6] / 2) / m(q);
  return out;
}

struct Motion {
  std::vector<Vec3> corner{};  // that starts at (1, -1, 1), after each step
  double energy = 0;           // how far it was off, at most [J]
  double open = 0;             // how far the last hinge was, at most [m]
};

Motion motion(double h, double t_end) {  // the classical rule of order four
  Motion out;
  VecX y = VecX::Zero(7), side = tangent(y.head(6), VecX::Ones(6));
  const double before = potential(y.head(6));
  for (int k = 0; k * h < t_end * (1 - 1e-12); ++k) {
    side = tangent(y.head(6), side);
    const VecX a = rates(y, side), b = rates(y + h / 2 * a, side), c = rates(y + h / 2 * b, side),
               d = rates(y + h * c, side);
    y += h / 6 * (a + 2 * b + 2 * c + d);
    const Ring r = turned(y.head(6));
    out.corner.push_back(r.rod[2] * kCorner[3]);
    const double now = mass(y.head(6), y[6] * tangent(y.head(6), side)) / 2 + potential(y.head(6));
    out.energy = std::max(out.energy, std::abs(now - before));
    out.open = std::max(out.open, (r.rod[5].matrix() - MatX::Identity(4, 4)).norm());
  }
  return out;
}

}  // namespace ring

constexpr double kReferenceStep = 2e-3;

TEST(Bricard, MovesInOneCoordinateAsTheRingDoes) {
  const ring::Motion reference = ring::motion(kReferenceStep, 10);
  EXPECT_LT(reference.energy, 1e-9);  // the reference keeps its own balance and stays closed
  EXPECT_LT(reference.open, 1e-10);
  for (const char* scheme : {"moreau_jean", "d1_minus_linear"}) {
    const CaseScene s = bricard();
    const double before = energy(s.model, s.state).total();
    EXPECT_NEAR(before, -29.43, 1e-12);
    double corner = 0, lost = 0, drift = 0;
    run_scene(s, scheme, mechanism_options(kReferenceStep), 10,
              [&](const State& now, const StepReport& report) {
                const auto k = std::size_t(std::lround(now.t / kReferenceStep)) - 1;
                corner = std::max(corner, (bricard_corner(now) - reference.corner[k]).norm());
                lost = std::max(lost, std::abs(energy(s.model, now).total() / before - 1));
                drift = std::max(drift, report.joint_error.translation);
              });
    EXPECT_LT(corner, 1e-5) << scheme;  // the benchmark grants 1e-3
    EXPECT_LT(lost, 1e-6) << scheme;
    EXPECT_LT(drift, 1e-12) << scheme;
  }
}

// Thirty equations, of which one says what the others say, all the time.
TEST(Bricard, HasRank29Of30Throughout) {
  const CaseScene s = bricard();
  const DofMap dofs = dof_map(s.model);
  int looks = 0;
  double least = kInf;
  run_scene(s, "moreau_jean", mechanism_options(1e-2), 3, [&](const State& now, const StepReport&) {
    const MatX G = joint_constraints(s.model, now, dofs).G;
    ASSERT_EQ(G.cols(), 30);
    const VecX sigma = Eigen::JacobiSVD<MatX>(G).singularValues();
    EXPECT_LT(sigma[29], 1e-10);
    least = std::min(least, sigma[28]);
    ++looks;
  });
  EXPECT_GE(least, 0.2);
  EXPECT_EQ(looks, 300);
}

}  // namespace
}  // namespace aussois
