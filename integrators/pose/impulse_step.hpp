// SPDX-License-Identifier: Apache-2.0
// Poses and solves the one-step problem of a scheme: rows of contacts, gap functions and joints, and their
// impulses.
#pragma once

#include <algorithm>
#include <optional>

#include "integrators/pose/find_ahead.hpp"
#include "integrators/pose/impact.hpp"
#include "integrators/pose/joint_rows.hpp"
#include "integrators/pose/reduced_solve.hpp"

namespace aussois {

/// Impulses along columns of G.
struct JointImpulses {
  std::vector<JointColumn> columns{};
  VecX lambda{};  // [N s, N m s]
};

/// The one-step problem of contacts, gap functions and joints, and its solution.
struct ImpulseStep {
  SharedMotion free{};
  VecX v_prescribed{};
  std::vector<ContactRow> rows{};  // contacts first, then gap functions, then joint axes
  Table<GapId, double> gap{};      // of the gap functions [m]
  JointSystem joints{};
  ReducedSolution solved{};
  SolveReport beside{};  // effort of the step's other solves, and the worst status of those it depends on
  std::optional<ImpactJump> impact{};  // impact before the step, at the same poses
  // For schemes that compute the motion between contacts before they solve for impulses: the mean impulses of
  // joints in that motion; lambda_earlier then holds the impulses that they are reported to give
  std::vector<JointImpulses> between{};
  // For schemes that solve in stages; otherwise empty
  std::vector<RowVector> earlier{};  // impulses of the stages before, for all rows
  VecX lambda_earlier{};             // the same for the joints
  double tolerance_part = 1;         // fraction of the solver's tolerance, for a stage that another builds on
  StageTimes times{};
};
/// The rows of contacts and gap functions, biased for a normal law (MJ-6), in ImpulseStep's order.
struct ContactBlocks {
  std::vector<ContactRow> rows{};
  Table<GapId, double> gap{};  // of the gap functions [m]
  StageTimes times{};
};
ContactBlocks contact_blocks(const StepSetting& setting, const State& state, const ContactSet& contacts,
                             double h, const NormalRule& normal, const ReachedPlace& reached = {});

/// Poses and solves the step, with rows and joints as they are at the start of the step. `theta` is that of
/// FreeMotion, for the axes of joints.
ImpulseStep solve_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                       SharedMotion free, double theta);
/// The same with the caller's own rows.
ImpulseStep solve_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                       SharedMotion free, double theta, ContactBlocks blocks);

/// The two halves of solve_step: pose_step makes rows and joints, solve_rows solves them. A step that is
/// solved again after a change starts from the solution found before.
ImpulseStep pose_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                      SharedMotion free, double theta);
ImpulseStep pose_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                      SharedMotion free, double theta, ContactBlocks blocks);
/// Makes the step depend on the status of its last solve, whatever is solved after it.
inline void keep_status(ImpulseStep& step) {
  step.beside.status = std::max(step.beside.status, step.solved.solution.report.status);
}
/// Adds rows for contacts, gap functions and what acts on the axes of step.joints, biased for a normal law.
void add_rows(const StepSetting& setting, const State& state, const FoundContacts& found,
              const NormalRule& normal, ImpulseStep& step);
/// Puts other blocks in front of what acts on the axes of step.joints.
void set_rows(ContactBlocks blocks, ImpulseStep& step);
void solve_rows(const StepSetting& setting, const State& state, const FoundContacts& found,
                ImpulseStep& step);
/// The impulses of a solution, for all rows; zero where a row was left out.
std::vector<RowVector> row_impulses(const ImpulseStep& step);

/// The state after the impact that the step begins with, if there is one (IMP-1); its contacts are kept in
/// `found`.
struct AfterImpact {
  State state{};
  ContactBlocks blocks{};  // of the step that follows
  ImpactJump impact{};
};
std::optional<AfterImpact> after_impact(const StepSetting& setting, const State& state, FoundContacts& found,
                                        const ImpactOptions& options, double theta);
/// The total effort of the step's solves, including those of an impact, and the worst status that the step
/// depends on.
SolveReport solve_report(const ImpulseStep& step);

/// All velocities that the bodies would end with if there were no contacts; the first estimate of a step.
VecX estimate_without_contacts(const StepSetting& setting, const State& state, const FreeMotion& free,
                               double h, double theta);

}  // namespace aussois
