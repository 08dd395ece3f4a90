// SPDX-License-Identifier: Apache-2.0
#include "nsgs/proximal_newton.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/LU>
#include <Eigen/SparseLU>

#include "nsgs/cone.hpp"

namespace aussois {

namespace {

constexpr int kDenseSize = 150;   // velocities; above, sparse LU, which gains from open contacts
constexpr int kNewtonSteps = 30;  // a step that needs more has too small an alpha
// Of F relative to the change of momentum; Newton's last step goes far below
constexpr double kAccuracy = 1e-9;
constexpr double kRounding = 1e-15;
constexpr double kSmallestDamping = 1e-3;

// A change dr of the impulses changes the velocities by d, A d = B dr, and the relative ones by C d: the two
// forms of the problem in one (PROX-2).
template <class Matrix>
struct Linear {
  Matrix A{}, B{}, C{};
  VecX weight{};  // of each row of A, so that |A d|^2 is an energy or free of units
  double size(const VecX& row) const { return std::sqrt(row.cwiseAbs2().dot(weight)); }
};

SparseMatrix block_diagonal(const std::vector<Mat3>& blocks) {
  std::vector<Triplet> entries;
  for (std::size_t c = 0; c < blocks.size(); ++c)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (blocks[c](i, j) != 0) entries.emplace_back(3 * int(c) + i, 3 * int(c) + j, blocks[c](i, j));
  SparseMatrix D(3 * Eigen::Index(blocks.size()), 3 * Eigen::Index(blocks.size()));
  D.setFromTriplets(entries.begin(), entries.end());
  return D;
}

// (A + B D C) d = F with D block diagonal (PROX-5).
std::optional<VecX> newton_direction(const Linear<MatX>& l, const std::vector<Mat3>& D, const VecX& F) {
  MatX DC(l.C.rows(), l.C.cols());
  for (std::size_t c = 0; c < D.size(); ++c) {
    const Eigen::Index k = 3 * Eigen::Index(c);
    DC.middleRows<3>(k) = D[c] * l.C.middleRows<3>(k);
  }
  const VecX scale = l.weight.cwiseSqrt();  // equilibrated: translations beside rotations
  MatX J = l.A;
  J.noalias() += l.B * DC;
  J = scale.asDiagonal() * J * scale.asDiagonal();
  const VecX d = scale.asDiagonal() * J.partialPivLu().solve(scale.asDiagonal() * F);
  return d.allFinite() ? std::optional<VecX>(d) : std::nullopt;
}

std::optional<VecX> newton_direction(const Linear<SparseMatrix>& l, const std::vector<Mat3>& D,
                                     const VecX& F) {
  const SparseMatrix J = l.A + SparseMatrix(l.B * SparseMatrix(block_diagonal(D) * l.C));
  Eigen::SparseLU<SparseMatrix> lu(J);
  if (lu.info() != Eigen::Success) return std::nullopt;
  const VecX d = lu.solve(F);
  return d.allFinite() ? std::optional<VecX>(d) : std::nullopt;
}

}  // namespace

struct ProximalNewton::System {
  std::optional<Linear<MatX>> dense{};
  std::optional<Linear<SparseMatrix>> sparse{};
  std::vector<double> w_c{}, mu{};

  System(Linear<SparseMatrix> linear, std::vector<double> scales, std::vector<double> friction)
      : w_c(std::move(scales)), mu(std::move(friction)) {
    if (is_cheap(linear.A.rows()))
      dense = Linear<MatX>{linear.A, linear.B, linear.C, linear.weight};
    else
      sparse = std::move(linear);
  }

  VecX predictor(const VecX& r_center, const VecX& u, double alpha) const {  // (PROX-3), before the law
    VecX s(r_center.size());
    for (std::size_t c = 0; c < mu.size(); ++c) {
      const Eigen::Index k = 3 * Eigen::Index(c);
      s.segment<3>(k) = r_center.segment<3>(k) - u.segment<3>(k) / (alpha * w_c[c]);
    }
    return s;
  }
  VecX impulses(const VecX& s) const {  // (PROX-3)
    VecX r(s.size());
    for (std::size_t c = 0; c < mu.size(); ++c)
      r.segment<3>(3 * Eigen::Index(c)) = project_coulomb(s.segment<3>(3 * Eigen::Index(c)), mu[c]);
    return r;
  }
  std::vector<Mat3> derivatives(const VecX& s, double alpha) const {
    std::vector<Mat3> D(mu.size());
    for (std::size_t c = 0; c < mu.size(); ++c)
      D[c] = project_coulomb_derivative(s.segment<3>(3 * Eigen::Index(c)), mu[c]) / (alpha * w_c[c]);
    return D;
  }

  template <class Matrix>
  ProximalStep newton(const Linear<Matrix>& l, const VecX& r_center, const VecX& u_center,
                      double alpha) const {
    struct Trial {
      VecX d{}, s{}, r{}, F{};
      double wrong = 0;
    };
    const auto tried = [&](const VecX& d) {
      Trial trial{.d = d, .s = predictor(r_center, u_center + l.C * d, alpha)};
      trial.r = impulses(trial.s);
      trial.F = l.A * d - l.B * (trial.r - r_center);  // (PROX-4)
      trial.wrong = l.size(trial.F);
      return trial;
    };
    const double rounding = kRounding * l.size(l.B.cwiseAbs() * r_center.cwiseAbs());
    ProximalStep step;
    Trial now = tried(VecX::Zero(l.A.rows()));
    for (; step.iterations < kNewtonSteps; ++step.iterations) {
      step.solved = now.wrong <= kAccuracy * l.size(l.A * now.d) + rounding;
      if (step.solved || !std::isfinite(now.wrong)) break;
      const std::optional<VecX> direction = newton_direction(l, derivatives(now.s, alpha), now.F);
      if (!direction) break;
      bool moved = false;
      for (double damping = 1; damping >= kSmallestDamping && !moved; damping /= 2) {  // (PROX-6)
        Trial next = tried(now.d - damping * *direction);
        moved = next.wrong < now.wrong * (1 - 1e-4 * damping);
        if (moved) now = std::move(next);
      }
      if (!moved) break;
    }
    step.r = now.r;
    return step;
  }
};

ProximalNewton::ProximalNewton(const FrictionProblem& problem, const std::vector<double>& w_c) {
  const VecX weight = VecX(problem.M.diagonal()).cwiseAbs().cwiseInverse();
  system_ = std::make_unique<System>(
      Linear<SparseMatrix>{problem.M, problem.H, SparseMatrix(problem.H.transpose()), weight}, w_c,
      problem.mu);
}

ProximalNewton::ProximalNewton(const LocalProblem& problem, const std::vector<double>& w_c) {
  const Eigen::Index rows = problem.q.size();
  SparseMatrix identity(rows, rows);
  identity.setIdentity();
  VecX weight(rows);
  for (std::size_t c = 0; c < w_c.size(); ++c) weight.segment<3>(3 * Eigen::Index(c)).setConstant(1 / w_c[c]);
  system_ = std::make_unique<System>(
      Linear<SparseMatrix>{identity, sparse_matrix(problem.W), identity, weight}, w_c, problem.mu);
}

ProximalNewton::ProximalNewton(ProximalNewton&& other) noexcept = default;
ProximalNewton::~ProximalNewton() = default;

bool ProximalNewton::is_cheap(Eigen::Index velocity_count) {
  return velocity_count <= kDenseSize;
}

ProximalStep ProximalNewton::step(const VecX& r_center, const VecX& u_center, double alpha) const {
  return system_->dense ? system_->newton(*system_->dense, r_center, u_center, alpha)
                        : system_->newton(*system_->sparse, r_center, u_center, alpha);
}

}  // namespace aussois
