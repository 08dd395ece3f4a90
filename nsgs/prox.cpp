// SPDX-License-Identifier: Apache-2.0
// SOR-prox and JOR-prox (SORP-1) to (SORP-7): every block takes one prox step r = prox(r - R u), its own R
// from its block of W. Sources: Jourdan, Alart and Jean 1998; Studer 2009, ch. 5; Acary, Bremond and Huber
// 2018 on the choices of rho.
#include "nsgs/prox.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "nsgs/fixed_point.hpp"

namespace aussois {

// x_i = s_i y_i / (s_i + lambda). Newton on 1/|x(lambda)| - 1/radius, concave and increasing: from 0 it rises
// to the root and never beyond.
AnyRows nearest_in_ball(const AnyRows& y, const AnyRows& s, double radius) {
  if (y.norm() <= radius) return y;
  if (!(radius > 0)) return AnyRows::Zero(y.size());
  if (s.minCoeff() == s.maxCoeff()) return radius / y.norm() * y;
  AnyRows x = y;
  double lambda = 0;
  for (int step = 0; step < 50; ++step) {
    const double length = x.norm();
    if (length <= radius * (1 + 1e-15)) break;
    const double slope = x.cwiseAbs2().cwiseQuotient(AnyRows(s.array() + lambda)).sum();
    lambda += (length - radius) / radius * length * length / slope;
    x = s.cwiseProduct(y).cwiseQuotient(AnyRows(s.array() + lambda));
  }
  return std::min(1.0, radius / x.norm()) * x;
}

namespace {

constexpr double kRegularisation = 1e-6;  // of blocks of unit size (SORP-3)
constexpr int kWindow = 25;               // steps until a rho is judged (SORP-7)
constexpr double kClimb = 1.15;
constexpr double kSmallestRho = 1.0 / 8;  // of the largest

// Rows of a block that are projected together, with their R = V diag(1 / s) V^T.
struct Part {
  int first = 0, rows = 0;
  AnyBlock V{};
  AnyRows s{};
  double mu = 0, limit = kInf;  // the ball (LAW-2); infinite: no ball
  bool is_normal = false;
};

struct ProxBlock {
  AnyBlock W{};
  std::vector<Part> parts{};
};

Part block_part(const AnyBlock& W, int first, int rows, ProxMetric metric) {
  const AnyBlock S = (W + W.transpose()) / 2;
  const auto eigen_of = [](const AnyBlock& A) { return Eigen::SelfAdjointEigenSolver<AnyBlock>(A); };
  Part out{.first = first, .rows = rows, .V = AnyBlock::Identity(rows, rows)};
  if (metric == ProxMetric::spectral) {
    out.s = AnyRows::Constant(rows, eigen_of(S).eigenvalues().maxCoeff());
  } else {
    const auto eigen = eigen_of(S.block(first, first, rows, rows));
    const double largest = eigen.eigenvalues().maxCoeff();
    if (metric == ProxMetric::split) {
      out.s = AnyRows::Constant(rows, largest);
    } else {
      out.V = eigen.eigenvectors();
      out.s = (eigen.eigenvalues().array().max(0.0) + kRegularisation * largest).matrix();
    }
  }
  out.s = out.s.cwiseMax(1e-300);
  return out;
}

ProxBlock prepared(const AnyBlock& W, const Law& law, ProxMetric metric) {
  ProxBlock block{.W = W};
  if (has_normal(law)) {
    block.parts.push_back(block_part(W, 0, 1, metric));
    block.parts.back().is_normal = true;
  }
  for (const Ball& ball : balls(law)) {
    block.parts.push_back(block_part(W, ball.first, ball.rows, metric));
    block.parts.back().mu = ball.mu;
    block.parts.back().limit = ball.limit;
  }
  if (law.kind == LawKind::bilateral) block.parts.push_back(block_part(W, 0, law.rows, metric));
  return block;
}

// (SORP-2), (SORP-5): part after part, in Gauss-Seidel order the later ones already see the earlier.
AnyRows prox_step(const ProxBlock& block, AnyRows u, AnyRows r, double rho, bool gauss_seidel) {
  for (const Part& p : block.parts) {
    const AnyRows before = r.segment(p.first, p.rows);
    const AnyRows pushed = (p.V.transpose() * u.segment(p.first, p.rows)).cwiseQuotient(p.s);
    AnyRows after = before - rho * (p.V * pushed);
    if (p.is_normal) {
      after[0] = std::max(after[0], 0.0);
    } else if (std::isfinite(p.limit)) {
      after = p.V * nearest_in_ball(p.V.transpose() * after, p.s, p.mu * r[0] + p.limit);
    }
    if (gauss_seidel) u += block.W.middleCols(p.first, p.rows) * (after - before);
    r.segment(p.first, p.rows) = after;
  }
  return r;
}

// Climbs towards the rho whose window of steps contracts best (SORP-7).
class AdaptiveRho {
 public:
  AdaptiveRho(double first, double largest) : rho_(first), largest_(largest) {}
  double value() const { return rho_; }
  void observe(double change) {
    if (steps_++ == 0) first_change_ = change;
    if (steps_ <= kWindow) return;
    const double contraction = change / first_change_;
    if (contraction > last_contraction_) up_ = !up_;
    if (!(contraction < 1)) up_ = false;  // diverges, or cycles
    rho_ = std::clamp(up_ ? rho_ * kClimb : rho_ / kClimb, kSmallestRho * largest_, largest_);
    last_contraction_ = contraction;
    steps_ = 0;
  }

 private:
  double rho_, largest_, first_change_ = 0, last_contraction_ = 1;
  int steps_ = 0;
  bool up_ = true;
};

std::vector<ProxBlock> prepared(const Delassus& W, ProxMetric metric) {
  std::vector<ProxBlock> blocks;
  blocks.reserve(W.count());
  for (int c = 0; c < W.count(); ++c) blocks.push_back(prepared(W.block(c), W.scaled.laws[c], metric));
  return blocks;
}

double sor_step(Delassus& W, const std::vector<ProxBlock>& blocks, double rho, VecX& r) {
  return W.sweep(r, [&](int c, const AnyRows& u, const AnyRows& r_c) {
    return prox_step(blocks[c], u, r_c, rho, true);
  });
}

double jor_step(Delassus& W, const std::vector<ProxBlock>& blocks, double rho, VecX& r) {
  const VecX u = W.velocity(r), before = r;
  for (int c = 0; c < W.count(); ++c) {
    const int k = W.first[c], rows = W.scaled.laws[c].rows;
    r.segment(k, rows) = prox_step(blocks[c], u.segment(k, rows), r.segment(k, rows), rho, false);
  }
  return (r - before).norm();
}

// The largest |eigenvalue| of R W by power iteration: steps with rho < 2 / that are stable (SORP-6).
double spectral_radius(Delassus& W, const std::vector<ProxBlock>& blocks) {
  VecX x(W.scaled.q.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = 1 + 0.5 * std::sin(double(i));  // no axis of symmetry
  double size = 1;
  for (int step = 0; step < 30; ++step) {
    x /= x.norm();
    const VecX u = W.velocity(x) - W.scaled.q;
    for (int c = 0; c < W.count(); ++c)
      for (const Part& p : blocks[c].parts) {
        const int k = W.first[c] + p.first;
        x.segment(k, p.rows) = p.V * AnyRows((p.V.transpose() * u.segment(k, p.rows)).cwiseQuotient(p.s));
      }
    size = x.norm();
    if (!(size > 0)) return 1;
  }
  return size;
}

}  // namespace

Iterate sor_prox(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  const std::vector<ProxBlock> blocks = prepared(W, options.prox);
  AdaptiveRho rho(options.relaxation, 1.9);
  return fixed_point(W, start, Method::sor_prox, options, report, [&](VecX& r) {
    const double change = sor_step(W, blocks, rho.value(), r);
    rho.observe(change);
    return change;
  });
}

Iterate jor_prox(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  const std::vector<ProxBlock> blocks = prepared(W, options.prox);
  const double radius = spectral_radius(W, blocks);
  AdaptiveRho rho(options.relaxation / radius, 2 / radius);
  return fixed_point(W, start, Method::jor_prox, options, report, [&](VecX& r) {
    const double change = jor_step(W, blocks, rho.value(), r);
    rho.observe(change);
    return change;
  });
}

Iterate coulomb_pgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  const std::vector<ProxBlock> blocks = prepared(W, ProxMetric::split);
  return fixed_point(W, start, Method::coulomb_pgs, options, report,
                     [&](VecX& r) { return sor_step(W, blocks, 1, r); });
}

}  // namespace aussois
