// SPDX-License-Identifier: Apache-2.0
#include "nsgs/scaled_problem.hpp"

#include <cmath>

#include "nsgs/residual.hpp"

namespace aussois {

Law scaled(Law law, const double* s, double size) {
  switch (law.kind) {
    case LawKind::rolling:
      law.mu_r *= s[0] / s[3];
      break;
    case LawKind::contensou:
      law.radius = 1;
      break;
    case LawKind::dry_friction:
      law.limit /= s[0] * size;
      break;
    default:
      break;
  }
  return law;
}

VecX scales(const VecX& diagonal, const std::vector<Law>& laws) {
  VecX s = row_scales(diagonal, laws);
  for (double& w : s) w = 1 / std::sqrt(w);
  Eigen::Index k = 0;
  for (const Law& law : laws) {
    if (law.kind == LawKind::contensou) s[k + 3] *= law.radius;
    k += law.rows;
  }
  return s;
}

Scaling scaling(const VecX& diagonal, const VecX& q, const std::vector<Law>& laws) {
  Scaling out{.s = scales(diagonal, laws), .q = q};
  out.finite = are_scales(out.s);
  out.q.array() *= out.s.array();
  out.finite = out.finite && out.q.allFinite();
  if (const double size = out.q.norm(); size > 0) out.size = size;
  out.finite = out.finite && std::isfinite(out.size);
  out.q /= out.size;
  out.laws.reserve(laws.size());
  Eigen::Index k = 0;
  for (const Law& law : laws) {
    out.laws.push_back(scaled(law, out.s.data() + k, out.size));
    k += law.rows;
  }
  return out;
}

VecX modified_velocities(VecX u, const std::vector<Law>& laws) {
  with_rows(laws, [&]<int R>() {
    Eigen::Index k = 0;
    for (const Law& law : laws) {
      u.segment<R>(k, law.rows) = modified_velocity<R>(law, u.segment<R>(k, law.rows));
      k += law.rows;
    }
  });
  return u;
}

double natural_map(const VecX& u, const VecX& r, const std::vector<Law>& laws, FrictionModel model) {
  return with_rows(laws, [&]<int R>() {
    double wrong = 0;
    Eigen::Index k = 0;
    for (const Law& law : laws) {
      const Rows<R> r_c = r.segment<R>(k, law.rows);
      Rows<R> u_c = u.segment<R>(k, law.rows);
      if (model == FrictionModel::coulomb) u_c = modified_velocity<R>(law, u_c);
      wrong += (r_c - project<R>(law, r_c - u_c)).squaredNorm();
      k += law.rows;
    }
    return std::sqrt(wrong);
  });
}

VecX projected_impulses(VecX r, const std::vector<Law>& laws) {
  with_rows(laws, [&]<int R>() {
    Eigen::Index k = 0;
    for (const Law& law : laws) {
      r.segment<R>(k, law.rows) = project<R>(law, r.segment<R>(k, law.rows));
      k += law.rows;
    }
  });
  return r;
}

VecX scaled_start(const Scaling& scaling, const VecX& r0) {
  if (r0.size() == 0) return VecX::Zero(scaling.s.size());
  return projected_impulses(r0.cwiseQuotient(scaling.s) / scaling.size, scaling.laws);
}

}  // namespace aussois
