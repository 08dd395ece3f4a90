// SPDX-License-Identifier: Apache-2.0
#include "nsgs/residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nsgs/cone.hpp"

namespace aussois {

namespace {

constexpr double kTiny =
    std::numeric_limits<double>::min();  // so that 0 / 0 is 0: nothing asked, nothing wrong

}  // namespace

std::vector<double> contact_scales(const BlockMatrix& W) {
  std::vector<double> w_c(std::size_t(W.rows()));
  for (int i = 0; i < W.rows(); ++i) w_c[std::size_t(i)] = W.diagonal(i).trace() / 3;
  return w_c;
}

double natural_map_residual(const LocalProblem& problem, const VecX& r) {
  const std::vector<double> one(problem.mu.size(), 1.0);
  return scaled_residual(problem.W * r + problem.q, r, problem.q, one, problem.mu);
}

double scaled_residual(const LocalProblem& problem, const VecX& r) {
  return scaled_residual(problem.W * r + problem.q, r, problem.q, contact_scales(problem.W), problem.mu);
}

double scaled_residual(const VecX& u, const VecX& r, const VecX& q, const std::vector<double>& w_c,
                       const std::vector<double>& mu) {
  double wrong = 0, size = 0;
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const Eigen::Index k = 3 * Eigen::Index(i);
    const double root = std::sqrt(w_c[i]);
    const Vec3 r_c = r.segment<3>(k) * root, u_c = u.segment<3>(k) / root;
    wrong += (r_c - project_cone(r_c - de_saxce(u_c, mu[i]), mu[i])).squaredNorm();
    size += q.segment<3>(k).squaredNorm() / w_c[i];
  }
  return std::sqrt(wrong) / std::max(std::sqrt(size), kTiny);
}

PhysicalResidual physical_residual(const VecX& u, const VecX& r, const std::vector<double>& mu) {
  PhysicalResidual worst;
  const double u_small = 1e-9 * u.lpNorm<Eigen::Infinity>(), r_small = 1e-9 * r.lpNorm<Eigen::Infinity>();
  for (std::size_t i = 0; i < mu.size(); ++i) {
    const Vec3 u_c = u.segment<3>(3 * Eigen::Index(i)), r_c = r.segment<3>(3 * Eigen::Index(i));
    const Vec2 u_t = u_c.tail<2>(), r_t = r_c.tail<2>();
    worst.worst_normal_approach = std::max(worst.worst_normal_approach, -u_c[0]);
    worst.worst_cone_violation = std::max({worst.worst_cone_violation, -r_c[0], r_t.norm() - mu[i] * r_c[0]});
    worst.worst_complementarity = std::max(worst.worst_complementarity, std::abs(u_c[0] * r_c[0]));
    if (mu[i] > 0 && u_t.norm() > u_small && r_c[0] > r_small) {
      const double cross = u_t[0] * r_t[1] - u_t[1] * r_t[0];
      worst.worst_misalignment =
          std::max(worst.worst_misalignment, std::atan2(std::abs(cross), -u_t.dot(r_t)));
    }
  }
  return worst;
}

}  // namespace aussois
