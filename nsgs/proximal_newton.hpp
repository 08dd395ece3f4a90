// SPDX-License-Identifier: Apache-2.0
// The second phase of the solver, doc/theory/proximal_newton.md: the friction problem with a compliance alpha
// w_c added to each contact, its impulses measured from a centre (PROX-1), by semismooth Newton in the few
// velocities (PROX-4) to (PROX-6). With the compliance isotropic every contact answers in closed form,
// however many there are. Sources: Alart and Curnier 1991 (augmented Lagrangian); Acary, Bremond and Huber
// 2018 (proximal point around Newton).
#pragma once

#include <memory>
#include <vector>

#include "nsgs/friction_problem.hpp"

namespace aussois {

struct ProximalStep {
  VecX r{};             // in the cones [N s]
  int iterations = 0;   // Newton iterations: linear solves
  bool solved = false;  // the equations (PROX-4) hold to their tolerance
};

class ProximalNewton {
 public:
  /// Newton's unknowns are the changes of the generalised velocities v (n). M must not have a zero on its
  /// diagonal.
  ProximalNewton(const FrictionProblem& problem, const std::vector<double>& w_c);
  /// Newton's unknowns are the changes of the relative velocities u (3c).
  ProximalNewton(const LocalProblem& problem, const std::vector<double>& w_c);
  ProximalNewton(ProximalNewton&& other) noexcept;
  ~ProximalNewton();

  /// Velocities few enough for dense algebra: an iteration then costs about as much as a sweep.
  static bool is_cheap(Eigen::Index velocity_count);

  /// Around the impulses r_center, whose relative velocities are u_center; alpha > 0 [-]. Everything is
  /// computed as a change from there, so that small alpha does not magnify the rounding of velocities
  /// (PROX-4).
  ProximalStep step(const VecX& r_center, const VecX& u_center, double alpha) const;

 private:
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace aussois
