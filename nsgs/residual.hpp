// SPDX-License-Identifier: Apache-2.0
// The judges: residuals that know nothing of any solver (NSGS-8) to (NSGS-11).
#pragma once

#include "nsgs/friction_problem.hpp"

namespace aussois {

/// Sizes of what is wrong with (u, r), in units that people know (NSGS-11).
struct PhysicalResidual {
  double worst_normal_approach = 0;  // max of -u_N [m/s]
  double worst_cone_violation = 0;   // max of |r_T| - mu r_N and of -r_N [N s]
  double worst_complementarity = 0;  // max of |u_N r_N| [J]
  double worst_misalignment = 0;     // largest angle between r_T and -u_T where the contact slips [rad]
};

/// |r - P_K(r - (u + mu |u_T| e_N))| / max(|q|, tiny), FCLIB's number (NSGS-8); depends on units.
double natural_map_residual(const LocalProblem& problem, const VecX& r);

/// w_c = trace(W_cc) / 3, the inverse mass that a contact sees [1/kg] (NSGS-10).
std::vector<double> contact_scales(const BlockMatrix& W);

/// The natural map after r_c sqrt(w_c), u_c / sqrt(w_c) relative to the scaled |q| (NSGS-9): free of units
/// and masses. The stopping test of every solver. 0 for a problem without contacts or with q = 0 and r = 0;
/// NaN if anything is.
double scaled_residual(const LocalProblem& problem, const VecX& r);

/// The same number from quantities at hand: u = W r + q, and contact_scales; used inside solvers.
double scaled_residual(const VecX& u, const VecX& r, const VecX& q, const std::vector<double>& w_c,
                       const std::vector<double>& mu);

/// A contact counts as slipping where |u_T| exceeds 1e-9 of the largest |u| and r_N 1e-9 of the largest |r|.
PhysicalResidual physical_residual(const VecX& u, const VecX& r, const std::vector<double>& mu);

}  // namespace aussois
