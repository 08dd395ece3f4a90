// SPDX-License-Identifier: Apache-2.0
// The Moreau-Jean theta scheme with conservative advancement: one step, in the order of
// doc/theory/moreau_jean.md. Sources: Moreau 1988, Jean 1999, Acary and Brogliato 2008, ch. 10; (MJ-1) to
// (MJ-12), (IMP-1) to (IMP-6), (CA-1) to (CA-8).
#pragma once

#include <memory>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

/// Where a step evaluates normals, arms and gaps of its contacts: at the start, or at the middle or the end
/// of the path given by the velocities found so far (MJ-11).
enum class ContactsAt { start, midpoint, end };
const char* to_string(ContactsAt at);
/// Finds the value by its name; throws std::invalid_argument listing the three.
ContactsAt contacts_at(const std::string& name);

/// The Newton loop of the fully implicit step (MJ-12). The default of one iteration makes the step linearly
/// implicit.
struct NewtonOptions {
  int max_iterations = 1;    // >= 1; contacts at the midpoint or the end need one more solve, their predictor
  double tolerance = 1e-10;  // largest change of a velocity [m/s, rad/s], > 0; if the loop misses it, or
                             // diverges (MJ-16), the step is halved
  // Adds gap Hessians to its matrix (MJ-14): curved contacts under a load take fewer iterations, but the
  // matrix then couples bodies that touch, which costs time in large stacks. No effect at max_iterations = 1
  // or with contacts at the start.
  bool gap_hessians = false;
};

struct MoreauJeanOptions {
  double h = 1e-3;     // largest step [s], > 0
  double theta = 1.0;  // of the smooth forces and of the position update [-], in [1/2, 1]
  ContactsAt contacts = ContactsAt::start;
  NewtonOptions newton{};
  ImpactOptions impact{};  // values other than the defaults exclude NormalLaw::gap_over_step
  NormalLawOptions normal{};
  JointOptions joints{};
  LmdOptions lmd{};  // the displacement bound sets its threshold in each step
  ReductionOptions reduction{};
  PersistenceOptions persistence{};
  SolverOptions solver{};
  AdvancementOptions advancement{};
  GroupUpdate update = GroupUpdate::exponential;
  int threads = 1;            // the result does not depend on it
  bool keep_problem = false;  // keeps the solved problem in StepReport::problem, to save and replay it
};
void validate(const MoreauJeanOptions& options);  // throws std::invalid_argument: field, value, bound

class MoreauJean {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  MoreauJean(const Model& model, const MoreauJeanOptions& options);
  MoreauJean(Model&&, const MoreauJeanOptions&) = delete;  // the model must outlive the scheme

  /// Advances by at most min(options.h, h_limit); less if the advancement needs it. The state is unchanged
  /// unless the report says moved(). Throws for arguments that do not fit (check_fits), not for numerical
  /// trouble.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Contacts of all pairs of bodies at the state with gap <= threshold [m], as a step would find them.
  ContactSet contacts(const State& state, double threshold) const;

 private:
  std::shared_ptr<const StepSetting> setting_;
  MoreauJeanOptions options_;
};

}  // namespace aussois
