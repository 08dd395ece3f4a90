// SPDX-License-Identifier: Apache-2.0
// The Moreau-Jean theta scheme with conservative advancement: one step, in the order of
// doc/theory/moreau_jean.md. Sources: Moreau 1988, Jean 1999, Acary and Brogliato 2008, ch. 10; (MJ-1) to
// (MJ-9), (CA-1) to (CA-8).
#pragma once

#include "integrators/advancement.hpp"
#include "integrators/contact_problem.hpp"
#include "integrators/joint_rows.hpp"
#include "integrators/step_report.hpp"
#include "reduction/reduce.hpp"

namespace aussois {

struct MoreauJeanOptions {
  double h = 1e-3;     // largest step [s], > 0
  double theta = 1.0;  // of the smooth forces and of the position update [-], in [1/2, 1]
  NormalLawOptions normal{};
  JointOptions joints{};
  LmdOptions lmd{};  // its threshold is set in each step by the displacement bound
  ReductionOptions reduction{};
  SolverOptions solver{};
  AdvancementOptions advancement{};
  int threads = 1;            // the result does not depend on it
  bool keep_problem = false;  // StepReport::problem holds what was solved, to save and replay it
};
void validate(const MoreauJeanOptions& options);  // throws std::invalid_argument: field, value, bound

class MoreauJean {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  MoreauJean(const Model& model, const MoreauJeanOptions& options);
  MoreauJean(Model&&, const MoreauJeanOptions&) = delete;  // the model must outlive the scheme

  /// Advances by at most min(options.h, h_limit); shorter if the advancement needs it. The state is unchanged
  /// unless the report's status is ok. Never throws for numerical trouble, only for h_limit <= 0.
  StepReport step(State& state, double h_limit = kInf) const;

  /// Contacts of all pairs of bodies at the state with gap <= threshold [m], as a step would find them.
  ContactSet contacts(const State& state, double threshold) const;

 private:
  struct Attempt;
  VecX estimate(const State& state, double h) const;  // velocities without contacts
  Attempt attempt(const State& state, const VecX& v_estimate, double h) const;

  const Model& model_;
  MoreauJeanOptions options_;
  DofMap dofs_;
  std::vector<BodyBounds> bounds_;
};

}  // namespace aussois
