// SPDX-License-Identifier: Apache-2.0
// The second phase of the solver, doc/theory/proximal_newton.md: adds a compliance alpha to each row, with
// impulses measured from a centre (PROX-1), and solves by semismooth Newton in the few velocities (PROX-4) to
// (PROX-6). The compliance is isotropic, so every block answers in closed form, however many there are.
// Sources: Alart and Curnier 1991 (augmented Lagrangian); Acary, Bremond and Huber 2018 (proximal point
// around Newton). Private to nsgs.
#pragma once

#include "nsgs/method.hpp"

namespace aussois {

struct ProximalOptions {
  double tolerance = 1e-8;
  int max_steps = 60;
  int max_iterations = 1000000;  // of Newton in all steps; the step that reaches it is finished
  double alpha = 0.1;            // compliance of the first step
  double accuracy = 1e-2;        // of each step: what it leaves of (PROX-4) is less than what alpha leaves
};

struct ProximalStep {
  VecX r{};             // in the sets of the laws
  int iterations = 0;   // Newton iterations: linear solves
  int factorised = 0;   // those of them with a newly factorised matrix
  bool solved = false;  // the equations (PROX-4) hold to their tolerance
};

/// A step around the impulses and velocities of `center`; alpha > 0. Everything is computed as a change from
/// there, so that a small alpha does not magnify the rounding of velocities (PROX-4). `accuracy` of (PROX-4)
/// is relative to the change of momentum. `inverse` is that of the last Newton matrix with this alpha, or
/// empty; on return, the last one made.
ProximalStep proximal_step(Delassus& W, const Iterate& center, double alpha, double accuracy,
                           NewtonSolve& inverse);

/// Takes proximal steps (PROX-7) until the tolerance is met. The centre keeps moving while Newton solves the
/// steps, even where the residual is on a plateau. Returns the best iterate met.
Iterate proximal_steps(Delassus& W, const Iterate& start, const ProximalOptions& options,
                       SolveReport& report);

}  // namespace aussois
