// SPDX-License-Identifier: Apache-2.0
// How normal impulses turn with the bodies: the gap Hessians that Newton's matrix of the fully implicit step
// takes in (MJ-14), as far as it stays a mass (MJ-15).
#pragma once

#include "integrators/pose/free_motion.hpp"
#include "lmd/contact_point.hpp"

namespace aussois {

/// -time * d(H_N r_N)/dq in the chart (p + v, R exp omega), rows of the problem [kg, kg m, kg m^2].
/// `r_N[i]` [N s] presses contact i, found at `state`; `time` [s] is what a velocity moves that pose by. A
/// contact whose derivative does not exist (KIN-7) is left out.
SparseMatrix gap_hessians(const Model& model, const State& state, const ContactSet& contacts,
                          const std::vector<double>& r_N, const Layout& dofs, double time);

/// The largest part 1, 1/2, 1/4, .. of `D` that leaves the symmetric part of M + D above half of that of M;
/// zero below 1/8, where the step is an impact onto a sharp edge and its curvature no small change.
SparseMatrix kept_positive(const SparseMatrix& M, const SparseMatrix& D);

}  // namespace aussois
