// SPDX-License-Identifier: Apache-2.0
// The second phase of the solver, doc/theory/proximal_newton.md: the problem with a compliance alpha added to
// each row, its impulses measured from a centre (PROX-1), by semismooth Newton in the few velocities (PROX-4)
// to (PROX-6). With the compliance isotropic every block answers in closed form, however many there are.
// Sources: Alart and Curnier 1991 (augmented Lagrangian); Acary, Bremond and Huber 2018 (proximal point
// around Newton). Private to nsgs.
#pragma once

#include "nsgs/method.hpp"

namespace aussois {

struct ProximalOptions {
  double tolerance = 1e-8;
  int max_steps = 60;
  int max_iterations = 1000000;  // of Newton in all steps; the last step is finished
  double alpha = 0.1;            // compliance of the first step
  double accuracy = 1e-2;        // of the steps: what is left of (PROX-4) is less than what alpha leaves
};

struct ProximalStep {
  VecX r{};             // in the sets of the laws
  int iterations = 0;   // Newton iterations: linear solves
  int factorised = 0;   // of them with a matrix of their own
  bool solved = false;  // the equations (PROX-4) hold to their tolerance
};

/// Around the impulses and velocities of `center`; alpha > 0. Everything is computed as a change from there,
/// so that small alpha does not magnify the rounding of velocities (PROX-4). `accuracy` of (PROX-4) is
/// relative to the change of momentum. `inverse` of the last Newton matrix with this alpha, or empty; left as
/// the last one made.
ProximalStep proximal_step(Delassus& W, const Iterate& center, double alpha, double accuracy,
                           NewtonSolve& inverse);

/// Proximal steps (PROX-7) until the tolerance. The centre walks on while Newton solves the steps, even where
/// the residual rests on a plateau; what is returned is the best iterate met.
Iterate proximal_steps(Delassus& W, const Iterate& start, const ProximalOptions& options,
                       SolveReport& report);

}  // namespace aussois
