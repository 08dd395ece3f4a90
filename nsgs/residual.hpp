// SPDX-License-Identifier: Apache-2.0
// The judges: residuals that are independent of every solver (NSGS-8) to (NSGS-11).
#pragma once

#include "nsgs/friction_problem.hpp"

namespace aussois {

/// Sizes of the errors of (u, r), in familiar units (NSGS-11). Rows of moments and bilateral rows count only
/// in the last two.
struct PhysicalResidual {
  double worst_normal_approach = 0;  // max of -u_N [m/s]
  double worst_cone_violation = 0;   // max of |r_T| - mu r_N and of -r_N [N s]
  double worst_complementarity = 0;  // max of |u_N r_N| [J]
  double worst_misalignment = 0;     // largest angle between r_T and -u_T where the contact slips [rad]
  double worst_bilateral = 0;        // max of |u| of bilateral rows [m/s, rad/s]
};

/// |r - P_K(r - (u + mu |u_T| e_N))| / |q|, FCLIB's number (NSGS-8); depends on units. |q| = 0 counts as the
/// smallest positive number.
double natural_map_residual(const LocalProblem& problem, const VecX& r);

/// w_i of every row, the inverse mass that it sees (NSGS-10): the mean of the diagonal over the normal and
/// tangent rows of a block, the mean over its two rolling rows, and the diagonal itself for each bilateral
/// row. A drilling row counts with radius^2.
VecX row_scales(const VecX& diagonal, const std::vector<Law>& laws);

/// The natural map of r_i sqrt(w_i) and u_i / sqrt(w_i), relative to the scaled |q| (NSGS-9): free of units
/// and masses. It is the stopping test of every solver. 0 for a problem without contacts or with q = 0 and
/// r = 0; NaN if any number is NaN.
double scaled_residual(const LocalProblem& problem, const VecX& r,
                       FrictionModel model = FrictionModel::coulomb);

/// A contact counts as slipping where |u_T| exceeds 1e-9 of the largest |u| and r_N exceeds 1e-9 of the
/// largest |r|.
PhysicalResidual physical_residual(const VecX& u, const VecX& r, const std::vector<Law>& laws);

}  // namespace aussois
