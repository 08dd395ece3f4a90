// SPDX-License-Identifier: Apache-2.0
// Nonsmooth Gauss-Seidel (NSGS-4) to (NSGS-6): one block after the other, each solved exactly. Source: Jean
// and Moreau 1992; Acary and Brogliato 2008, ch. 13.
#include "nsgs/fixed_point.hpp"

namespace aussois {

Iterate nsgs(Delassus& W, const Iterate& start, const SolverOptions& options, SolveReport& report) {
  const SweepOptions sweep{.local = options.local, .relaxation = options.relaxation};
  SweepCounts counts;
  Iterate best = fixed_point(W, start, Method::nsgs, options, report,
                             [&](VecX& r) { return W.sweep(r, sweep, counts); });
  report.local_failures += counts.failures;
  report.local_fail_safes += counts.fail_safes;
  return best;
}

}  // namespace aussois
