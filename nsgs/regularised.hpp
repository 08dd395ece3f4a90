// SPDX-License-Identifier: Apache-2.0
// Contact with a compliance, v' = A lambda + b under R = diag(r_i) > 0: the solver of [Kim2019] in its dual
// form (REG-2), in three readings of what its friction means. See doc/theory/regularised.md.
#pragma once

#include "geometry/named.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

enum class FrictionReading {
  coulomb_pgs,  // the default: normal rows, then disks of radius mu lambda_N, in Gauss-Seidel order (REG-6)
  convex_cone,  // minimum over the cones, as in MuJoCo and Chrono (REG-5): a slipping contact lifts off
  hybrid,       // Coulomb's law with De Saxce's shift by the default solver (REG-7): the same fixed points as
                // coulomb_pgs, also where that converges slowly or not at all
};
inline constexpr Named<FrictionReading> kFrictionReadings[] = {{FrictionReading::coulomb_pgs, "coulomb_pgs"},
                                                               {FrictionReading::convex_cone, "convex_cone"},
                                                               {FrictionReading::hybrid, "hybrid"}};
const char* to_string(FrictionReading reading);

/// `describe` gives the ranges.
struct RegularisedOptions {
  FrictionReading reading = FrictionReading::coulomb_pgs;
  double tolerance = SolverOptions{}.tolerance;  // on the scaled residual [-]
  int max_iterations = 200;                      // sweeps or steps
};
void describe(SettingVisitor& visit, RegularisedOptions& options);

struct RegularisedSolution {
  VecX lambda{};         // impulses, m, normal first [N s]
  VecX v{};              // relative velocity v' = A lambda + b, m [m/s]
  double violation = 0;  // max r_i lambda_N: how fast closed contacts still approach (REG-8) [m/s]
  SolveReport report{};  // residual: the natural map of (A + R) lambda + b
};

/// Compliance of the rows, r_i = rho trace(A_ii) / rows (REG-4), m [1/kg]; rho >= 0 is about the relative
/// error of the force of one loaded contact. Throws std::invalid_argument for a negative rho.
VecX regularisation(const LocalProblem& problem, double rho = 1e-3);

/// b of (REG-3): `v_free` plus e v_N in normal rows where v_N < -threshold [m/s]; v is the relative velocity
/// before the step. Throws std::invalid_argument unless sizes agree and e lies in [0, 1].
VecX with_restitution(VecX v_free, const VecX& v, const std::vector<Law>& laws, double e,
                      double threshold = 0.01);

/// `problem` holds A (`W`, not necessarily symmetric: convex_cone takes its symmetric part, the others take
/// it as is) and b (`q`); R has m entries >= 0; `lambda_0` is the start (m) or empty for zero. Laws are
/// coulomb or unilateral. Throws std::invalid_argument naming a field that does not comply; numerical trouble
/// is reported as a status.
RegularisedSolution solve_regularised(const LocalProblem& problem, const VecX& R, const VecX& lambda_0 = {},
                                      const RegularisedOptions& options = {});

/// d lambda / d b at a solution, m x m [kg] (REG-9), valid as long as no contact changes between open, stick
/// and slip. Throws as solve_regularised does.
MatX impulse_sensitivity(const LocalProblem& problem, const VecX& R, const VecX& lambda,
                         FrictionReading reading);

}  // namespace aussois
