// SPDX-License-Identifier: Apache-2.0
// The parts that the attempts of all schemes are made of, once contacts are found: which impulses they take,
// and whether the path that follows may be gone. A scheme is what it does between them.
#pragma once

#include <algorithm>
#include <optional>

#include "integrators/find_ahead.hpp"
#include "integrators/impact.hpp"
#include "integrators/reduced_solve.hpp"
#include "integrators/step_report.hpp"

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

enum class Outcome { accepted, bound_exceeded, meets, not_certified, not_solved, not_finite };
struct Attempt {
  Outcome outcome = Outcome::accepted;
  VecX v_path{};                               // all velocities, constant on the path that was tried
  std::vector<std::pair<int, int>> meeting{};  // pairs of Found::apart that met on it, sorted
  State next{};                                // if accepted or not solved
  StepReport report{};
};

/// Where a scheme wants to go: velocities constant on the path, and those at its end; rows of the problem.
struct Move {
  VecX v_path{}, v_end{};
  std::optional<State> end{};  // other poses and coordinates that the path is to end at (PRJ-4)
  // How long a contact that ends overlapped and closing goes on like that before the scheme turns it [s]; the
  // step leaves room for it (CA-17)
  double goes_on = 0;
  // Impulses act for `lasts`; forces of joints are means about the time `about`; parts of h (MJT-17)
  double lasts = 1, about = 0.5;
};
/// Goes there if the step keeps the bounds that its contacts were found within (CA-5), nothing meets whose
/// contacts were not asked (CA-16), and it is proven to keep bodies apart (CA-6); with the report, joints
/// projected (MJT-13), and the energy as the velocities at both ends tell it (MJ-9).
Attempt go(const StepSetting& setting, const State& state, const Found& found, const ImpulseStep& impulses,
           const Move& move);

/// All velocities that the bodies would end with, were there no contacts; the first estimate of a step.
VecX estimate_without_contacts(const StepSetting& setting, const State& state, const FreeMotion& free,
                               double h, double theta);

}  // namespace aussois
