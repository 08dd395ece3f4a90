// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/bricard.hpp"

#include <array>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "examples/scenes/mechanisms.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/pose/joint_rows.hpp"
#include "mechanics/mechanism.hpp"

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
  for (int k = 0; k < 5; ++k) sum += kGravity * (r.rod[k] * Vec3((kCorner[k] + kCorner[k + 1]) / 2)).y();
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

VerificationCase equation_of_the_ring() {
  return {
      .name = "C8.equation_of_the_ring",
      .what = "the motion in one coordinate that Bricard's ring is compared with, 10 s at 2 ms",
      .rows = {{"energy", "worst energy", "J", 1e-9, "conserved; order four"},
               {"open", "worst opening of the last hinge", "m", 1e-10, "the ring stays closed; order four"}},
      .measure = [] {
        const ring::Motion reference = ring::motion(kReferenceStep, 10);
        return Figures{{"energy", reference.energy}, {"open", reference.open}};
      }};
}

VerificationCase one_coordinate(const std::string& scheme) {
  return {.name = "C8.ring",
          .setting = scheme,
          .what = "Bricard's ring of six hinges for 10 s at 2 ms",
          .rows = {{"start", "energy at the start, off -29.43 J", "J", 1e-12, "closed form"},
                   {"corner", "worst place of the corner", "m", 1e-5,
                    "motion in one coordinate; the benchmark allows 1e-3"},
                   {"energy", "worst energy, relative", "-", 1e-6, "conserved; guard: order two"},
                   {"drift", "worst error of a joint", "m", 1e-12, "joints hold to rounding"}},
          .measure = [scheme] {
            const ring::Motion reference = ring::motion(kReferenceStep, 10);
            const CaseScene s = bricard();
            const double before = energy(s.model, s.state).total();
            Worst corner, lost, drift;
            run_to(s, scheme, exact_options(kReferenceStep, NormalLaw::moreau, 1e-12), 10,
                   [&](const State& now, const StepReport& report) {
                     const auto k = std::size_t(std::lround(now.t / kReferenceStep)) - 1;
                     corner.add((bricard_corner(now) - reference.corner[k]).norm());
                     lost.add(std::abs(energy(s.model, now).total() / before - 1));
                     drift.add(report.joint_error.translation);
                   });
            return Figures{
                {"start", std::abs(before + 29.43)}, {"corner", corner}, {"energy", lost}, {"drift", drift}};
          }};
}

// Thirty equations, of which one says what the others say, all the time.
VerificationCase rank() {
  return {
      .name = "C8.rank",
      .what = "the 30 equations of Bricard's ring along 3 s at 10 ms",
      .rows = {{"equations", "equations", "-", 30, "six hinges", Sense::exactly},
               {"looks", "states examined", "-", 300, "3 s of steps", Sense::exactly},
               {"least", "largest of the least singular values", "-", 1e-10, "theory: rank 29"},
               {"next", "least of the ones above", "-", 0.2, "theory: no more than one is lost",
                Sense::at_least}},
      .measure = [] {
        const CaseScene s = bricard();
        const Layout dofs = layout(s.model);
        int looks = 0;
        Worst least, equations;
        Least next;
        run_to(s, "moreau_jean", exact_options(1e-2, NormalLaw::moreau, 1e-12), 3,
               [&](const State& now, const StepReport&) {
                 const MatX G = joint_constraints(s.model, now, dofs).G;
                 const VecX sigma = Eigen::JacobiSVD<MatX>(G).singularValues();
                 equations.add(double(G.cols()));
                 least.add(sigma[29]), next.add(sigma[28]);
                 ++looks;
               });
        return Figures{{"equations", equations}, {"looks", double(looks)}, {"least", least}, {"next", next}};
      }};
}

}  // namespace

std::vector<VerificationCase> bricard_verification() {
  return {equation_of_the_ring(), one_coordinate("moreau_jean"), one_coordinate("d1_minus_linear"), rank()};
}

}  // namespace aussois
