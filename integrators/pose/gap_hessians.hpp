// SPDX-License-Identifier: Apache-2.0
// Gap Hessians: how normal impulses turn with the bodies. Newton's matrix of the fully implicit step contains
// them (MJ-14), as far as it remains a mass matrix (MJ-15).
#pragma once

#include "integrators/pose/free_motion.hpp"
#include "lmd/contact_point.hpp"

namespace aussois {

/// -time * d(H_N r_N)/dq in the chart (p + v, R exp omega), rows of the problem [kg, kg m, kg m^2]. `r_N[i]`
/// [N s] presses contact i, found at `state`; that pose moves by `time` [s] times the velocity. A contact
/// whose derivative does not exist (KIN-7) is left out.
SparseMatrix gap_hessians(const Model& model, const State& state, const ContactSet& contacts,
                          const std::vector<double>& r_N, const Layout& dofs, double time);

/// `D` times the largest factor 1, 1/2, 1/4, .. that keeps the symmetric part of M + D above half of that of
/// M. Zero if the factor would be below 1/8: the step is then an impact onto a sharp edge, and its curvature
/// is no small change.
SparseMatrix kept_positive(const SparseMatrix& M, const SparseMatrix& D);

}  // namespace aussois
