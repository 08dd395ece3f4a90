// SPDX-License-Identifier: Apache-2.0
// Impacts as a map of velocities, apart from the forces of the step: Newton's and Poisson's law, all contacts
// at once or pair by pair (IMP-1) to (IMP-6).
#pragma once

#include <optional>

#include "integrators/reduced_solve.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

enum class ImpactLaw {
  newton,   // u+ >= -e u- (IMP-2)
  poisson,  // expansion gives back e times the normal impulse of compression (IMP-3)
};
enum class ImpactOrder {
  simultaneous,  // one problem of all contacts that close (IMP-4)
  sequential,    // one contact after the other, the fastest first (IMP-5)
};
const char* to_string(ImpactLaw law);
const char* to_string(ImpactOrder order);
/// By their names; throw std::invalid_argument naming what there is.
ImpactLaw impact_law(const std::string& name);
ImpactOrder impact_order(const std::string& name);

struct ImpactOptions {
  ImpactLaw law = ImpactLaw::newton;
  ImpactOrder order = ImpactOrder::simultaneous;
  int max_pairs = 10000;  // one-contact impacts of a step, >= 1; what is left then is plastic
};
void validate(const ImpactOptions& options);  // throws std::invalid_argument: field, value, bound

/// Newton's law for all at once needs no map of its own: it is the normal law of the step (MJ-6).
inline bool in_the_step(const ImpactOptions& o) {
  return o.law == ImpactLaw::newton && o.order == ImpactOrder::simultaneous;
}

/// What an impact did at the start of a step.
struct ImpactJump {
  VecX v{};                         // after it, rows of the problem
  std::vector<RowVector> r{};       // of every row of the step; zero for those that took no part [N s, N m s]
  VecX lambda{};                    // of the joints
  VecX of_contacts{}, of_joints{};  // impulses on the rows of the problem
  double kinetic_change = 0, contact_work = 0, joint_work = 0;  // [J]
  std::vector<double> work{};                                   // of every row on relative velocities [J]
  std::vector<StepJoint> joints{};                              // forces over the step that follows
  int solves = 0;
  SolveReport solve{};  // what all of them took, and the worst status
};

/// Of the contacts and gap functions among `rows`, as contact_rows and gap_rows made them at the state;
/// nothing if none that bounces (sequential: none at all) closes within the step. Joints keep the velocities
/// that they have; stops of joints take no part, the step that follows sees to them.
std::optional<ImpactJump> impact_jump(const Model& model, const State& state, const Layout& dofs,
                                      const std::vector<ContactRow>& rows, const SparseMatrix& G, double h,
                                      NormalLaw law, const ImpactOptions& options,
                                      const SolverOptions& solver);

}  // namespace aussois
