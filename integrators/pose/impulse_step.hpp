// SPDX-License-Identifier: Apache-2.0
// The one-step problem of a scheme, posed and solved: rows of contacts, gap functions and joints, and the
// impulses that they take.
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
  std::vector<double> gap{};       // of the gap functions [m]
  JointSystem joints{};
  ReducedSolution solved{};
  SolveReport beside{};  // work of the step's other solves, and the worst status of those it stands on
  std::optional<ImpactJump> impact{};  // that came before, at the same poses
  // Of schemes that know the motion between contacts before they ask for impulses: what joints give in it in
  // the mean, where lambda_earlier is what they are told to give
  std::vector<JointImpulses> between{};
  // Of schemes that solve in stages; empty: none
  std::vector<RowVector> earlier{};  // impulses of the stages before, of all rows
  VecX lambda_earlier{};             // and of the joints
  double tolerance_part = 1;         // of the solver's tolerance, for a stage that another builds on
  double seconds = 0;                // that it took [s]
};
/// The rows of contacts and gap functions, biased for a normal law (MJ-6), in ImpulseStep's order.
struct ContactBlocks {
  std::vector<ContactRow> rows{};
  std::vector<double> gap{};  // of the gap functions [m]
};
ContactBlocks contact_blocks(const StepSetting& setting, const State& state, const ContactSet& contacts,
                             double h, const NormalLawOptions& normal, const Reached& reached = {});

/// With rows and joints as they are at the start of the step. `theta` as of FreeMotion, for the axes of
/// joints.
ImpulseStep solve_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                       double theta);
/// The same with rows of one's own.
ImpulseStep solve_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                       double theta, ContactBlocks blocks);

/// Its two halves: rows and joints, and their solution. Solved again, after a change, it starts from what was
/// found before.
ImpulseStep pose_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                      double theta);
ImpulseStep pose_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                      double theta, ContactBlocks blocks);
/// The step stands on its last solve, whatever is solved after it.
inline void keep_status(ImpulseStep& step) {
  step.beside.status = std::max(step.beside.status, step.solved.solution.report.status);
}
/// Contacts, gap functions and what acts on the axes of step.joints, biased for a normal law.
void add_rows(const StepSetting& setting, const State& state, const Found& found,
              const NormalLawOptions& normal, ImpulseStep& step);
/// Other blocks, before what acts on the axes of step.joints.
void set_rows(ContactBlocks blocks, ImpulseStep& step);
void solve_rows(const StepSetting& setting, const State& state, const Found& found, ImpulseStep& step);
/// The impulses of a solution, of all rows; zero where a row was left out.
std::vector<RowVector> row_impulses(const ImpulseStep& step);

/// The state after the impact that the step begins with, if there is one (IMP-1); its contacts are kept in
/// `found`.
struct AfterImpact {
  State state{};
  ContactBlocks blocks{};  // of the step that follows
  ImpactJump impact{};
};
std::optional<AfterImpact> after_impact(const StepSetting& setting, const State& state, Found& found,
                                        const ImpactOptions& options, double theta);
/// What its solves took together, those of an impact too, and the worst status that the step stands on.
SolveReport solve_report(const ImpulseStep& step);

/// All velocities that the bodies would end with, were there no contacts; the first estimate of a step.
VecX estimate_without_contacts(const StepSetting& setting, const State& state, const FreeMotion& free,
                               double h, double theta);

}  // namespace aussois
