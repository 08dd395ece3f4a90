// SPDX-License-Identifier: Apache-2.0
// M^-1 restricted by joints (JNT-1) to (JNT-4): gives velocities that obey G^T v + b = 0, and multipliers of
// smallest norm. Redundant joints are the normal case.
#pragma once

#include "nsgs/friction_problem.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {

struct JointFactor;  // of G^T M^-1 G, regularised

struct MotionInverse {
  MassInverse mass{};
  SparseMatrix Gt{};  // G^T, p x n; empty without joints
  SparseMatrix Y{};   // M^-1 G
  std::shared_ptr<JointFactor> joints{};

  VecX operator*(const VecX& x) const;                  // the velocity that the momentum x gives
  SparseMatrix operator*(const SparseMatrix& X) const;  // column by column
};

/// Empty if M or G is not finite, or if M is singular to working precision.
std::optional<MotionInverse> invert_motion(const SparseMatrix& M, const SparseMatrix& G);

/// v without contact impulses: M v = f + G lambda, G^T v + b = 0.
VecX free_velocity(const FrictionProblem& problem, const MotionInverse& inverse);

/// v and lambda for the contact impulses r.
struct JointedMotion {
  VecX v{}, lambda{};
};
JointedMotion motion(const FrictionProblem& problem, const MotionInverse& inverse, const VecX& r);

LocalProblem condense_with_inverse(const FrictionProblem& problem, const MotionInverse& inverse);

}  // namespace aussois
