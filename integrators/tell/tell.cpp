// SPDX-License-Identifier: Apache-2.0
#include "integrators/tell/tell.hpp"

#include <algorithm>
#include <utility>

#include "integrators/tell/ledgers.hpp"

namespace aussois {
namespace {

// Anchors of the solved contacts: held by those that press and do not slip (PER-10).
std::vector<Anchor> anchors_after(const FoundContacts& found, const ImpulseStep& step, int contacts,
                                  const PersistenceOptions& options) {
  std::vector<Anchor> out;
  if (!options.anchors) return out;
  const FrictionSolution& solution = step.solved.solution;
  for (int k = 0; k < contacts; ++k) {
    const int row = step.solved.kept[k], first = step.solved.first_row[k];
    const Anchor& before = found.warm.anchor[row];
    Anchor now;
    now.held = step.rows[row].law.rows >= 3 && solution.r[first] > 0 &&
               solution.u.segment<2>(first + 1).norm() <= options.slip_speed;
    if (now.held && before.held) now.drift = before.drift;
    out.push_back(now);
  }
  return out;
}

// Contacts that were left out of the problem, and keep their anchors (PER-11): at most `layer` farther open
// than those of their cluster that hold, they slip against the first of them no faster than (PER-10) allows.
// Solved ones that bear no share of the load keep theirs likewise, in `anchors`.
std::vector<int> waiting_anchors(const StepSetting& setting, const FoundContacts& found,
                                 const ImpulseStep& step, std::vector<Anchor>& anchors, const VecX& v) {
  const auto slip = [&](int i) {
    const ContactRow& row = step.rows[i];
    return Vec3(row.frame.rightCols<2>() * slip_velocity(row, setting.dofs, v).segment<2>(1));
  };
  const auto gap = [&](int i) { return found.contacts.points[i].gap; };
  struct Held {
    int first = -1;
    double open = -kInf;
  };
  std::vector<Held> clusters(found.selection.cluster_count);
  std::vector<char> solved(found.contacts.points.size(), 0);
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const int i = step.solved.kept[k];
    solved[i] = 1;
    if (!anchors[k].held) continue;
    Held& held = clusters[found.selection.cluster[i]];
    if (held.first < 0) held.first = i;
    held.open = std::max(held.open, gap(i) + setting.options.reduction.layer);
  }
  const auto waits = [&](int i) {
    const Held& held = clusters[found.selection.cluster[i]];
    return found.warm.anchor[i].held && gap(i) <= held.open &&
           (slip(i) - slip(held.first)).norm() <= setting.options.persistence.slip_speed;
  };
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const int i = step.solved.kept[k];
    if (!anchors[k].held && !(step.solved.solution.r[step.solved.first_row[k]] > 0) && waits(i))
      anchors[k] = found.warm.anchor[i];
  }
  std::vector<int> out;
  for (int i = 0; i < int(solved.size()); ++i)
    if (!solved[i] && waits(i)) out.push_back(i);
  return out;
}

// The impulses of a solution, sorted by what they belong to.
struct Impulses {
  std::vector<Vec3> contact{};     // world
  std::vector<double> drilling{};  // [N m s]
  VecX r{};                        // State::r
  VecX of_joints{};                // of the problem's rows, zero for contacts and gap functions
};
Impulses sorted_impulses(const Model& model, const std::vector<ContactRow>& rows,
                         const ReducedSolution& solved, const VecX& r) {
  Impulses out;
  out.of_joints = VecX::Zero(r.size());
  if (row_count(model) > 0) out.r = VecX::Zero(row_count(model));
  out.contact.reserve(solved.kept.size());
  out.drilling.reserve(solved.kept.size());
  for (std::size_t k = 0; k < solved.kept.size(); ++k) {
    const ContactRow& row = rows[solved.kept[k]];
    const int first = solved.first_row[k], count = row.law.rows;
    if (!row.slot) {
      const int of_frame = std::min(count, 3);
      out.contact.push_back(row.frame.leftCols(of_frame) * r.segment(first, of_frame));
      out.drilling.push_back(count > 3 ? r[first + 3] : 0);
      continue;
    }
    out.r.segment(*row.slot, count) = r.segment(first, count);
    if (is_of_axis(model, row.slot)) out.of_joints.segment(first, count) = r.segment(first, count);
  }
  return out;
}

// Of all stages, rows of the problem.
VecX total_impulses(const ImpulseStep& step) {
  VecX r = step.solved.solution.r;
  if (step.earlier.empty()) return r;
  for (std::size_t k = 0; k < step.solved.kept.size(); ++k) {
    const auto row = std::size_t(step.solved.kept[k]);
    const int count = step.rows[row].law.rows;
    r.segment(step.solved.first_row[k], count) += step.earlier[row].head(count);
  }
  return r;
}

// What the next step needs of the contacts: the solved ones, the first `contacts` rows of the problem, and
// those that wait with an anchor.
ContactMemory memory_after(const StepSetting& setting, const FoundContacts& found, const ImpulseStep& step,
                           const Impulses& impulses, int contacts, const VecX& v) {
  std::vector<int> members(step.solved.kept.begin(), step.solved.kept.begin() + contacts);
  std::vector<Vec3> impulse = impulses.contact;
  StepTrace trace{.drilling = impulses.drilling,
                  .anchors = anchors_after(found, step, contacts, setting.options.persistence),
                  .solved = std::vector<char>(members.size(), 1),
                  .g = found.g};
  if (!trace.anchors.empty())
    for (const int i : waiting_anchors(setting, found, step, trace.anchors, v)) {
      members.push_back(i);
      impulse.push_back(Vec3::Zero());
      trace.drilling.push_back(0);
      trace.anchors.push_back(found.warm.anchor[i]);
      trace.solved.push_back(0);
    }
  std::vector<std::array<Vec3, 2>> places;
  if (!found.places.empty())
    for (const int i : members) places.push_back(found.places[i]);
  trace.places = places;
  return remember(select(found.contacts, members), impulse, trace);
}

std::vector<StepGap> step_gaps(const Model& model, const ImpulseStep& step, std::size_t contacts,
                               const VecX& r) {
  std::vector<StepGap> out;
  for (const GapId i : model.gaps.ids())
    if (const ContactRow& row = step.rows[contacts + i.index()]; row.active)
      out.push_back({i, step.gap[i], r.segment<3>(slot_of(model, i))});
  return out;
}

// The impulses of an impact, on top of those of the step.
void add_impact(const ImpactJump& impact, const ImpulseStep& step, std::size_t contacts, StepReport& report) {
  for (std::size_t k = 0; k < report.contacts.size(); ++k) {
    const auto i = std::size_t(step.solved.kept[k]);
    report.contacts[k].impulse += step.rows[i].frame * impact.r[i].head<3>();
    if (step.rows[i].law.rows > 3) report.contacts[k].drilling += impact.r[i][3];
  }
  for (StepGap& gap : report.gaps) gap.impulse += impact.r[contacts + gap.id.index()].head<3>();
}

// What was found and solved, whatever became of it.
StepReport asked(const StepSetting& setting, const Trial& trial) {
  const FoundContacts& found = trial.found;
  const ImpulseStep& step = trial.impulses;
  StepReport report;
  for (const std::vector<StepPair>* pairs : {&found.pairs, &found.apart})
    for (const StepPair& pair : *pairs) report.threshold = std::max(report.threshold, pair.threshold);
  report.contacts_found = found.count;
  report.contacts_coarse = found.coarse_count;
  report.contacts_kept =
      int(std::ranges::count_if(step.solved.kept, [&](int row) { return !step.rows[row].slot; }));
  report.loss = found.selection.loss;
  report.matches = found.warm.counts;
  report.passing_pairs = found.passing;
  report.min_gap = found.min_gap;
  for (const double gap : step.gap) report.min_gap = std::min(report.min_gap, gap);
  report.solve = solve_report(step);
  if (step.impact) report.impact_solves = step.impact->solves;
  if (setting.options.keep_problem && step.solved.problem)
    report.problem = StepProblem{*step.solved.problem, step.solved.start, step.solved.solution};
  report.newton_iterations = trial.figures.newton_iterations;
  report.newton_change = trial.figures.newton_change;
  report.contacts_made_passive = trial.figures.contacts_made_passive;
  report.projection = trial.figures.projection;
  report.overlap_left = trial.figures.overlap_left;
  return report;
}

void tell_proof(const Judgement& judgement, StepReport& report) {
  report.reason = judgement.objection.reason;
  report.certificate_rounds = judgement.certificate_rounds;
  report.min_base_distance = judgement.min_base_distance;
  report.driven_overlaps = judgement.driven_overlaps;
}

State next_state(const StepSetting& setting, const Trial& trial, State next, const Impulses& impulses) {
  next.memory = memory_after(setting, trial.found, trial.impulses, impulses, int(impulses.contact.size()),
                             trial.move.v_end);
  next.r = impulses.r;
  next.a = trial.a;
  return next;
}

}  // namespace

bool may_be_taken(const Judgement& judgement) {
  return judgement.objection.outcome == Outcome::accepted ||
         judgement.objection.outcome == Outcome::not_solved;
}

StepResult tell(const StepSetting& setting, const State& start, const Trial& trial, Judgement judgement) {
  const State& state = trial.from ? *trial.from : start;
  StepReport report = asked(setting, trial);
  report.t = state.t;
  tell_proof(judgement, report);
  if (!may_be_taken(judgement)) return {std::move(report)};
  const Model& model = setting.model;
  const FoundContacts& found = trial.found;
  const ImpulseStep& step = trial.impulses;
  const FrictionSolution& solution = step.solved.solution;
  const VecX r = total_impulses(step);
  const Impulses impulses = sorted_impulses(model, step.rows, step.solved, r);
  report.contacts.reserve(impulses.contact.size());
  for (std::size_t k = 0; k < impulses.contact.size(); ++k)
    report.contacts.push_back(
        {found.contacts.points[step.solved.kept[k]], impulses.contact[k], impulses.drilling[k]});
  report.t = judgement.next.t;
  report.h = found.h;
  report.v_path = std::move(judgement.v_path);
  report.physical = physical_residual(solution.u, solution.r, step.solved.problem->laws);
  report.gaps = step_gaps(model, step, found.contacts.points.size(), impulses.r);
  if (step.impact) add_impact(*step.impact, step, found.contacts.points.size(), report);
  VecX joint_impulse, contact_impulse;
  if (r.size() > 0) contact_impulse = step.solved.problem->H * (r - impulses.of_joints);
  if (!model.joints.empty()) {
    const VecX lambda =
        step.lambda_earlier.size() > 0 ? VecX(solution.lambda + step.lambda_earlier) : solution.lambda;
    report.joints =
        step_joints(setting, step, trial.move, found.h, r, lambda, judgement.held, judgement.next);
    report.t_joints = state.t + trial.move.about * found.h;
    report.joint_error = judgement.joint_error;
    joint_impulse = step.solved.problem->H * impulses.of_joints + step.solved.problem->G * lambda;
  }
  tell_ledgers(setting, state, judgement.next, step,
               {.r = r,
                .by_contacts = contact_impulse,
                .by_joints = joint_impulse,
                .v_path = trial.move.v_path,
                .v_end = model.joints.empty() ? trial.move.v_end  // only joints are projected
                                              : free_velocities(setting.dofs, judgement.next.v)},
               report);  // (MJ-9), (MJ-13), (IMP-6)
  return {std::move(report), next_state(setting, trial, std::move(judgement.next), impulses)};
}

}  // namespace aussois
