// SPDX-License-Identifier: Apache-2.0
// The problem without units (SOL-2): r = size s r~, u = size u~ / s row by row, so that every block of the
// diagonal of W~ has unit size, |q~| = 1, and the natural map of (u~, r~) is the scaled residual (NSGS-9).
#pragma once

#include "nsgs/friction_problem.hpp"

namespace aussois {

struct Scaling {
  VecX s{};                 // of the rows, 1 / sqrt of their inverse masses w
  double size = 1;          // |q / sqrt(w)|; 1 if that is 0
  std::vector<Law> laws{};  // with the radii that the scaled rows have
  VecX q{};                 // scaled
  FrictionModel model = FrictionModel::coulomb;
  bool finite = true;  // false: no other field may be used
};

/// Scaling::s. If are_scales() rejects it, the diagonal is not positive and finite.
VecX scales(const VecX& diagonal, const std::vector<Law>& laws);
template <class Vector>
bool are_scales(const Vector& s) {
  return s.allFinite() && (s.array() > 0).all();
}
/// The law of a block whose rows have the scales `s`.
Law scaled(Law law, const double* s, double size);

/// The scaling from the diagonal of W, q and the laws.
Scaling scaling(const VecX& diagonal, const VecX& q, const std::vector<Law>& laws);

/// u with De Saxce's term added for every block (LAW-4).
VecX modified_velocities(VecX u, const std::vector<Law>& laws);
/// |r - P(r - modified velocity)| of scaled quantities; for the convex cone model, |r - P(r - u)|.
double natural_map(const VecX& u, const VecX& r, const std::vector<Law>& laws,
                   FrictionModel model = FrictionModel::coulomb);
/// r with every block projected on the set of its law.
VecX projected_impulses(VecX r, const std::vector<Law>& laws);
/// The start, scaled and projected on the sets of the laws; zero if `r0` is empty.
VecX scaled_start(const Scaling& scaling, const VecX& r0);

/// Calls f.operator()<R>(), where R is the number of rows that all blocks have, or Eigen::Dynamic if they
/// differ.
template <class F>
decltype(auto) with_rows(const std::vector<Law>& laws, F&& f) {
  int rows = laws.empty() ? 3 : laws.front().rows;
  for (const Law& law : laws)
    if (law.rows != rows) rows = Eigen::Dynamic;
  switch (rows) {
    case 1:
      return f.template operator()<1>();
    case 2:
      return f.template operator()<2>();
    case 3:
      return f.template operator()<3>();
    case 5:
      return f.template operator()<5>();
    default:
      return f.template operator()<Eigen::Dynamic>();
  }
}

}  // namespace aussois
