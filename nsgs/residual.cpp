// SPDX-License-Identifier: Apache-2.0
#include "nsgs/residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nsgs/scaled_problem.hpp"

namespace aussois {

double natural_map_residual(const LocalProblem& problem, const VecX& r) {
  // so that 0 / 0 is 0: a problem without q has no error
  constexpr double kTiny = std::numeric_limits<double>::min();
  return natural_map(problem.W * r + problem.q, r, problem.laws) / std::max(problem.q.norm(), kTiny);
}

VecX row_scales(const VecX& diagonal, const std::vector<Law>& laws) {
  VecX w = diagonal;
  Eigen::Index k = 0;
  for (const Law& law : laws) {
    switch (law.kind) {
      case LawKind::coulomb:
        w.segment(k, law.rows).setConstant(w.segment(k, law.rows).mean());
        break;
      case LawKind::rolling:
        w.segment(k, 3).setConstant(w.segment(k, 3).mean());
        w.segment(k + 3, 2).setConstant(w.segment(k + 3, 2).mean());
        break;
      case LawKind::contensou:
        w[k + 3] *= law.radius * law.radius;
        w.segment(k, 4).setConstant(w.segment(k, 4).mean());
        break;
      case LawKind::unilateral:
      case LawKind::bilateral:
      case LawKind::dry_friction:
        break;
    }
    k += law.rows;
  }
  return w;
}

double scaled_residual(const LocalProblem& problem, const VecX& r, FrictionModel model) {
  const Scaling scaled = scaling(problem.W.diagonal(), problem.q, problem.laws);
  const VecX u = problem.W * r + problem.q;
  return natural_map(u.cwiseProduct(scaled.s) / scaled.size, r.cwiseQuotient(scaled.s) / scaled.size,
                     scaled.laws, model);
}

PhysicalResidual physical_residual(const VecX& u, const VecX& r, const std::vector<Law>& laws) {
  PhysicalResidual worst;
  const double u_small = 1e-9 * u.lpNorm<Eigen::Infinity>(), r_small = 1e-9 * r.lpNorm<Eigen::Infinity>();
  Eigen::Index k = 0;
  for (const Law& law : laws) {
    const AnyRows u_c = u.segment(k, law.rows), r_c = r.segment(k, law.rows);
    k += law.rows;
    if (law.kind == LawKind::bilateral) {
      worst.worst_bilateral = std::max(worst.worst_bilateral, u_c.lpNorm<Eigen::Infinity>());
      continue;
    }
    if (has_normal(law)) {
      worst.worst_normal_approach = std::max(worst.worst_normal_approach, -u_c[0]);
      worst.worst_cone_violation = std::max(worst.worst_cone_violation, -r_c[0]);
      worst.worst_complementarity = std::max(worst.worst_complementarity, std::abs(u_c[0] * r_c[0]));
    }
    if (law.kind != LawKind::coulomb && law.kind != LawKind::rolling) continue;
    const int tangents = law.rows == 2 ? 1 : 2;
    const Vec2 u_t(u_c[1], tangents == 1 ? 0 : u_c[2]), r_t(r_c[1], tangents == 1 ? 0 : r_c[2]);
    worst.worst_cone_violation = std::max(worst.worst_cone_violation, r_t.norm() - law.mu * r_c[0]);
    if (law.mu > 0 && u_t.norm() > u_small && r_c[0] > r_small) {
      const double cross = u_t[0] * r_t[1] - u_t[1] * r_t[0];
      worst.worst_misalignment =
          std::max(worst.worst_misalignment, std::atan2(std::abs(cross), -u_t.dot(r_t)));
    }
  }
  return worst;
}

}  // namespace aussois
