// SPDX-License-Identifier: Apache-2.0
#include "integrators/attempt.hpp"

#include <algorithm>
#include <cmath>

#include "integrators/ledgers.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr double kReentry = 0.01;  // of the dilations per step; taste, below what the certificate allows

bool all_finite(const std::vector<SE3>& poses) {
  return std::ranges::all_of(poses, [](const SE3& g) { return g.p.allFinite() && g.R.coeffs().allFinite(); });
}

// How fast each contact may close although it was left out of the problem.
std::vector<double> allowed_speeds(const Found& found) {
  std::vector<double> allowed = contact_dilations(found.pairs, found.contacts);
  for (double& speed : allowed) speed *= kReentry / found.h;
  return allowed;
}

// Static friction undoes what it has lost: a bias of the tangential rows (PER-9).
void pull_back(const Found& found, const PersistenceOptions& options, std::vector<ContactRow>& rows) {
  for (std::size_t i = 0; i < found.warm.anchor.size(); ++i) {
    const Anchor& anchor = found.warm.anchor[i];
    if (!anchor.held || rows[i].law.rows < 3) continue;
    Vec3 speed = options.anchor_rate / found.h * anchor.drift;
    const double fast = speed.norm();
    if (fast > options.anchor_speed) speed *= options.anchor_speed / fast;
    rows[i].w.segment<2>(1) += rows[i].frame.rightCols<2>().transpose() * speed;
  }
}

// Anchors of the solved contacts: held by those that press and do not slip (PER-10).
std::vector<Anchor> anchors_after(const Found& found, const ImpulseStep& step, int contacts,
                                  const PersistenceOptions& options) {
  std::vector<Anchor> out;
  if (!options.anchors) return out;
  const FrictionSolution& solution = step.solved.solution;
  for (int k = 0; k < contacts; ++k) {
    const int row = step.solved.kept[std::size_t(k)], first = step.solved.first_row[std::size_t(k)];
    const Anchor& before = found.warm.anchor[std::size_t(row)];
    Anchor now;
    now.held = step.rows[std::size_t(row)].law.rows >= 3 && solution.r[first] > 0 &&
               solution.u.segment<2>(first + 1).norm() <= options.slip_speed;
    if (now.held && before.held) now.drift = before.drift;
    out.push_back(now);
  }
  return out;
}

// Contacts that were left out of the problem, and keep their anchors (PER-11): at most `layer` farther open
// than those of their cluster that hold, they slip against the first of them no faster than (PER-10) allows.
// Solved ones that bear no share of the load keep theirs likewise, in `anchors`.
std::vector<int> waiting_anchors(const StepSetting& setting, const Found& found, const ImpulseStep& step,
                                 std::vector<Anchor>& anchors, const VecX& v) {
  const auto slip = [&](int i) {
    const ContactRow& row = step.rows[std::size_t(i)];
    return Vec3(row.frame.rightCols<2>() * slip_velocity(row, setting.dofs, v).segment<2>(1));
  };
  const auto gap = [&](int i) { return found.contacts.points[std::size_t(i)].gap; };
  struct Held {
    int first = -1;
    double open = -kInf;
  };
  std::vector<Held> clusters(std::size_t(found.selection.cluster_count));
  std::vector<char> solved(found.contacts.points.size(), 0);
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const int i = step.solved.kept[k];
    solved[std::size_t(i)] = 1;
    if (!anchors[k].held) continue;
    Held& held = clusters[std::size_t(found.selection.cluster[std::size_t(i)])];
    if (held.first < 0) held.first = i;
    held.open = std::max(held.open, gap(i) + setting.options.reduction.layer);
  }
  const auto waits = [&](int i) {
    const Held& held = clusters[std::size_t(found.selection.cluster[std::size_t(i)])];
    return found.warm.anchor[std::size_t(i)].held && gap(i) <= held.open &&
           (slip(i) - slip(held.first)).norm() <= setting.options.persistence.slip_speed;
  };
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const int i = step.solved.kept[k];
    if (!anchors[k].held && !(step.solved.solution.r[step.solved.first_row[k]] > 0) && waits(i))
      anchors[k] = found.warm.anchor[std::size_t(i)];
  }
  std::vector<int> out;
  for (int i = 0; i < int(solved.size()); ++i)
    if (!solved[std::size_t(i)] && waits(i)) out.push_back(i);
  return out;
}

// Those of `apart` whose dilated shapes are not proven to keep apart on the path (CA-16).
std::vector<std::pair<int, int>> meeting_pairs(const StepSetting& setting, const StepPath& path,
                                               const std::vector<StepPair>& apart, StepReport& report) {
  std::vector<std::pair<int, int>> out;
  for (const StepPair& pair : apart) {
    const StepCertificate proof = certify_apart(path, pair, setting.bounds, setting.options.threads);
    report.certificate_rounds += int(proof.rounds);
    report.min_base_distance = std::min(report.min_base_distance, proof.min_distance);
    if (!proof.failure.empty()) out.emplace_back(pair.a, pair.b);
  }
  return out;
}

// Empty if every contact that ends overlapped and closing may go on so for a time (CA-17), otherwise what has
// no room; where the step cannot be halved there is no choice. With restitution, one that was pushed turns.
std::string without_room(const StepSetting& setting, const Found& found, const ImpulseStep& step,
                         const Move& move) {
  const AdvancementOptions& o = setting.options.advancement;
  if (move.goes_on == 0 || found.h / 2 < o.min_h) return "";
  const std::vector<RowVector> r = row_impulses(step);
  const std::vector<double> dilation = contact_dilations(found.pairs, found.contacts);
  for (std::size_t i = 0; i < found.contacts.points.size(); ++i) {
    const ContactPoint& c = found.contacts.points[i];
    const ContactRow& row = step.rows[i];
    if (row.restitution > 0 && r[i][0] > 0) continue;
    const double gap = row.gap + found.h * slip_velocity(row, setting.dofs, move.v_path).x();
    if (!(gap < 0)) continue;
    const double speed = slip_velocity(row, setting.dofs, move.v_end).x();
    if (speed < 0 && gap + move.goes_on * speed < -o.max_overlap * dilation[i])
      return "bodies " + std::to_string(c.a.body) + " and " + std::to_string(c.b.body) +
             ": the overlap that is allowed leaves no room to stop them";
  }
  return "";
}

// Impulses that every row starts with: those of the last solve; before that, contacts from the memory, turned
// to now, the others from State::r.
std::vector<RowVector> starts(const ImpulseStep& step, const Found& found, const VecX& r) {
  const std::vector<ContactRow>& rows = step.rows;
  if (!step.solved.first_row.empty()) return row_impulses(step);
  std::vector<RowVector> out(rows.size(), RowVector::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].slot < 0) {
      out[i].head<3>() = rows[i].frame.transpose() * found.start[i];
      out[i][3] = found.warm.drilling[i];
    } else if (r.size() > 0) {
      out[i].head(rows[i].law.rows) = found.scale * r.segment(rows[i].slot, rows[i].law.rows);
    }
  }
  return out;
}

// The impulses of a solution, sorted by what they belong to.
struct Impulses {
  std::vector<Vec3> contact{};     // world
  std::vector<double> drilling{};  // [N m s]
  VecX r{};                        // State::r
  VecX of_joints{};                // of the problem's rows, zero for contacts and gap functions
};
Impulses sorted(const Model& model, const std::vector<ContactRow>& rows, const ReducedSolution& solved,
                const VecX& r) {
  Impulses out;
  out.of_joints = VecX::Zero(r.size());
  if (row_count(model) > 0) out.r = VecX::Zero(row_count(model));
  for (std::size_t k = 0; k < solved.kept.size(); ++k) {
    const ContactRow& row = rows[std::size_t(solved.kept[k])];
    const int first = solved.first_row[k], count = row.law.rows;
    if (row.slot < 0) {
      const int of_frame = std::min(count, 3);
      out.contact.push_back(row.frame.leftCols(of_frame) * r.segment(first, of_frame));
      out.drilling.push_back(count > 3 ? r[first + 3] : 0);
      continue;
    }
    out.r.segment(row.slot, count) = r.segment(first, count);
    if (row.slot < first_gap_row(model)) out.of_joints.segment(first, count) = r.segment(first, count);
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

// What the next step knows of the contacts: the solved ones, the first `contacts` rows of the problem, and
// those that wait with an anchor.
ContactMemory memory_after(const StepSetting& setting, const Found& found, const ImpulseStep& step,
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
      trace.anchors.push_back(found.warm.anchor[std::size_t(i)]);
      trace.solved.push_back(0);
    }
  return remember(select(found.contacts, members), impulse, trace);
}

std::vector<StepGap> step_gaps(const Model& model, const ImpulseStep& step, std::size_t contacts,
                               const VecX& r) {
  std::vector<StepGap> out;
  for (int i = 0; i < int(step.gap.size()); ++i)
    if (const ContactRow& row = step.rows[contacts + std::size_t(i)]; row.active)
      out.push_back({i, step.gap[std::size_t(i)], r.segment<3>(first_gap_row(model) + 3 * i)});
  return out;
}

// The impulses of an impact, on top of those of the step.
void add_impact(const ImpactJump& impact, const ImpulseStep& step, std::size_t contacts, StepReport& report) {
  for (std::size_t k = 0; k < report.contacts.size(); ++k) {
    const auto i = std::size_t(step.solved.kept[k]);
    report.contacts[k].impulse += step.rows[i].frame * impact.r[i].head<3>();
    if (step.rows[i].law.rows > 3) report.contacts[k].drilling += impact.r[i][3];
  }
  for (StepGap& gap : report.gaps) gap.impulse += impact.r[contacts + std::size_t(gap.index)].head<3>();
}

// What the attempt can tell before it moves anything.
StepReport told(const StepSetting& setting, const Found& found, const ImpulseStep& step,
                const Impulses& impulses) {
  StepReport report;
  for (const std::vector<StepPair>* pairs : {&found.pairs, &found.apart})
    for (const StepPair& pair : *pairs) report.threshold = std::max(report.threshold, pair.threshold);
  report.contacts_found = found.count;
  report.contacts_kept = int(impulses.contact.size());
  report.loss = found.selection.loss;
  report.matches = found.warm.counts;
  report.passing_pairs = found.passing;
  report.min_gap = found.min_gap;
  for (const double gap : step.gap) report.min_gap = std::min(report.min_gap, gap);
  report.solve = step.solved.solution.report;
  add_part(step.beside, report.solve);
  if (step.impact) {
    report.impact_solves = step.impact->solves;
    add_part(step.impact->solve, report.solve);
  }
  if (setting.options.keep_problem)
    report.problem = StepProblem{*step.solved.problem, step.solved.start, step.solved.solution};
  report.seconds_contact = found.seconds;
  report.seconds_solve = step.seconds;
  return report;
}

}  // namespace

ContactBlocks contact_blocks(const StepSetting& setting, const State& state, const ContactSet& contacts,
                             double h, const NormalLawOptions& normal, const Reached& reached) {
  const VecX v_prescribed =  // of the step, wherever on it contacts are looked at
      reached.time > 0 ? all_velocities(setting.dofs, VecX::Zero(setting.dofs.rows), reached.v)
                       : prescribed_velocity(setting.model, state, h);
  const ReductionOptions& o = setting.options.reduction;
  std::vector<FrictionPatch> patches;
  if (o.friction == FrictionAt::patches) patches = friction_patches(contacts, o.clustering.angle, o.layer);
  ContactBlocks out{
      .rows = contact_rows(setting.model, state, contacts, v_prescribed, h, normal, reached, patches)};
  GapFunctionRows gaps =
      gap_rows(setting.model, state, setting.dofs, v_prescribed, h, normal, reached);  // (GEN-3)
  out.gap = std::move(gaps.gap);
  out.rows.insert(out.rows.end(), gaps.rows.begin(), gaps.rows.end());
  return out;
}

std::optional<AfterImpact> after_impact(const StepSetting& setting, const State& state, Found& found,
                                        const ImpactOptions& options, double theta) {
  if (in_the_step(options)) return std::nullopt;
  const Model& model = setting.model;
  const StepOptions& o = setting.options;
  const ContactBlocks blocks = contact_blocks(setting, state, found.contacts, found.h, o.normal);
  const VecX v_prescribed = prescribed_velocity(model, state, found.h);
  const JointSystem joints =
      joint_system(model, state, setting.dofs, v_prescribed, found.h, theta, o.normal, o.joints);
  std::optional<ImpactJump> met = impact_jump(model, state, setting.dofs, blocks.rows, joints.equations.G,
                                              found.h, o.normal.law, options, o.solver);
  if (!met) return std::nullopt;
  const VecX middle = (free_velocities(setting.dofs, state.v) + met->v) / 2;
  met->joints.resize(model.joints.size());
  add_forces(model, joints.columns, met->lambda, joints.middle, found.h, met->joints);
  add_work(model, joints.columns, met->lambda,
           {all_velocities(setting.dofs, middle, v_prescribed), v_prescribed}, met->joints);
  for (int i = 0; i < int(found.contacts.points.size()); ++i)  // they are reported, and held from now on
    if (!met->r[std::size_t(i)].isZero(0) &&
        std::ranges::find(found.selection.kept, i) == found.selection.kept.end())
      found.selection.kept.push_back(i);
  std::ranges::sort(found.selection.kept);
  AfterImpact out{.state = state, .blocks = {}, .impact = std::move(*met)};
  out.state.v = all_velocities(setting.dofs, out.impact.v, state.v);
  out.blocks = contact_blocks(setting, out.state, found.contacts, found.h, o.normal);
  for (std::size_t i = 0; i < out.blocks.rows.size(); ++i)
    if (!out.impact.r[i].isZero(0)) out.blocks.rows[i].active = true;
  return out;
}

void add_rows(const StepSetting& setting, const State& state, const Found& found,
              const NormalLawOptions& normal, ImpulseStep& step) {
  set_rows(contact_blocks(setting, state, found.contacts, found.h, normal), step);  // (MJ-6)
}

void set_rows(ContactBlocks blocks, ImpulseStep& step) {
  step.rows = std::move(blocks.rows);
  step.gap = std::move(blocks.gap);
  step.rows.insert(step.rows.end(), step.joints.rows.begin(), step.joints.rows.end());
}

ImpulseStep pose_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                      double theta) {
  return pose_step(setting, state, found, std::move(free), theta,
                   contact_blocks(setting, state, found.contacts, found.h, setting.options.normal));
}

ImpulseStep pose_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                      double theta, ContactBlocks blocks) {
  const double begin = step_clock();
  const StepOptions& o = setting.options;
  ImpulseStep out{.free = std::move(free),
                  .v_prescribed = prescribed_velocity(setting.model, state, found.h)};
  out.joints = joint_system(setting.model, state, setting.dofs, out.v_prescribed, found.h, theta, o.normal,
                            o.joints);                                      // (MJT-10)
  if (o.persistence.anchors) pull_back(found, o.persistence, blocks.rows);  // (PER-9)
  set_rows(std::move(blocks), out);
  out.seconds = step_clock() - begin;
  return out;
}

void solve_rows(const StepSetting& setting, const State& state, const Found& found, ImpulseStep& step) {
  const double begin = step_clock();
  SolverOptions solver = setting.options.solver;
  solver.tolerance *= step.tolerance_part;
  add_counts(step.solved.solution.report, step.beside);
  step.solved = solve_reduced(*step.free, setting.dofs, step.rows, step.joints.equations, found.selection,
                              starts(step, found, state.r), allowed_speeds(found), solver);  // (NSGS-1)
  step.seconds += step_clock() - begin;
}

ImpulseStep solve_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                       double theta) {
  ImpulseStep out = pose_step(setting, state, found, std::move(free), theta);
  solve_rows(setting, state, found, out);
  return out;
}

ImpulseStep solve_step(const StepSetting& setting, const State& state, const Found& found, SharedMotion free,
                       double theta, ContactBlocks blocks) {
  ImpulseStep out = pose_step(setting, state, found, std::move(free), theta, std::move(blocks));
  solve_rows(setting, state, found, out);
  return out;
}

std::vector<RowVector> row_impulses(const ImpulseStep& step) {
  std::vector<RowVector> out(step.rows.size(), RowVector::Zero());
  for (std::size_t k = 0; k < step.solved.kept.size(); ++k) {
    const auto row = std::size_t(step.solved.kept[k]);
    const int count = step.rows[row].law.rows;
    out[row].head(count) = step.solved.solution.r.segment(step.solved.first_row[k], count);
  }
  return out;
}

Attempt go(const StepSetting& setting, const State& state, const Found& found, const ImpulseStep& step,
           const Move& move) {
  const Model& model = setting.model;
  const StepOptions& o = setting.options;
  const FrictionSolution& solution = step.solved.solution;
  const VecX r = total_impulses(step);
  const Impulses impulses = sorted(model, step.rows, step.solved, r);
  Attempt out{.report = told(setting, found, step, impulses)};
  StepReport& report = out.report;
  const auto failed = [&](Outcome outcome, const std::string& reason) {
    out.outcome = outcome;
    report.reason = reason;
    return out;
  };
  if (report.solve.status == SolveStatus::not_finite || !move.v_path.allFinite() || !move.v_end.allFinite())
    return failed(Outcome::not_finite, "a force or velocity is not finite");

  // Did the step keep its word, and is it proven?
  out.v_path = path_velocity(o.update, model, state,
                             all_velocities(setting.dofs, move.v_path, step.v_prescribed), found.h);
  VecX v_end = all_velocities(setting.dofs, move.v_end, step.v_prescribed);
  ProjectedState held;
  if (move.end ||
      (o.joints.project && !model.joints.empty())) {  // the path is the one to the projected poses
    const State plain = state_after(model, state, out.v_path, v_end, found.h);
    held.state = move.end ? *move.end : plain;
    held.state.v = v_end;
    if (o.joints.project) held = projected(model, held.state);  // (MJT-13)
    out.v_path = velocity_between(state, plain, held.state, out.v_path, found.h);
    v_end = held.state.v;
  }
  const StepPath path = step_path({model, state, out.v_path, found.h}, setting.bounds);
  for (const std::string& broken :
       {broken_bound(path, found.pairs, o.lmd.alpha), broken_bound(path, found.apart, o.lmd.alpha),
        broken_reach(path, found.reach)})  // (CA-5)
    if (!broken.empty()) return failed(Outcome::bound_exceeded, broken);
  if (o.advancement.certify) {
    const double begin = step_clock();
    out.meeting = meeting_pairs(setting, path, found.apart, report);  // (CA-16)
    if (!out.meeting.empty()) return failed(Outcome::meets, "bodies meet whose contacts were not asked");
    const StepCertificate certificate =
        certify_step(path, found.pairs, setting.bounds, found.contacts, o.advancement, o.threads);  // (CA-6)
    report.certificate_rounds += int(certificate.rounds);
    report.min_base_distance = std::min(report.min_base_distance, certificate.min_distance);
    report.seconds_certificate = step_clock() - begin;
    if (!certificate.failure.empty()) return failed(Outcome::not_certified, certificate.failure);
    const std::string crowded = without_room(setting, found, step, move);  // (CA-17)
    if (!crowded.empty()) return failed(Outcome::not_certified, crowded);
    report.driven_overlaps =
        driven_overlaps(path, setting.bounds, setting.pieces, o.advancement, o.threads);  // (CA-20)
  }

  // The new state
  out.next = state_after(model, state, out.v_path, v_end, found.h);
  if (!all_finite(out.next.g)) return failed(Outcome::not_finite, "a pose is not finite");
  report.contacts.reserve(impulses.contact.size());
  for (std::size_t k = 0; k < impulses.contact.size(); ++k)
    report.contacts.push_back(
        {found.contacts.points[std::size_t(step.solved.kept[k])], impulses.contact[k], impulses.drilling[k]});
  out.next.memory = memory_after(setting, found, step, impulses, report.contacts_kept, move.v_end);
  out.next.r = impulses.r;
  report.t = out.next.t;
  report.h = found.h;
  report.v_path = out.v_path;
  report.physical = physical_residual(solution.u, solution.r, step.solved.problem->laws);
  report.gaps = step_gaps(model, step, found.contacts.points.size(), impulses.r);
  if (step.impact) add_impact(*step.impact, step, found.contacts.points.size(), report);
  VecX joint_impulse, contact_impulse;
  if (r.size() > 0) contact_impulse = step.solved.problem->H * (r - impulses.of_joints);
  if (!model.joints.empty()) {
    const VecX lambda =
        step.lambda_earlier.size() > 0 ? VecX(solution.lambda + step.lambda_earlier) : solution.lambda;
    report.joints = step_joints(setting, step, move, found.h, r, lambda, held, out.next);
    report.t_joints = state.t + move.about * found.h;
    report.joint_error = joint_error(model, out.next);
    joint_impulse = step.solved.problem->H * impulses.of_joints + step.solved.problem->G * lambda;
  }
  if (!within(report.joint_error, o.joints))
    return failed(Outcome::not_certified, text_of(report.joint_error, o.joints));
  tell_ledgers(setting, state, out.next, step,
               {.r = r,
                .by_contacts = contact_impulse,
                .by_joints = joint_impulse,
                .v_path = move.v_path,
                .v_end = free_velocities(setting.dofs, v_end)},
               report);  // (MJ-9), (MJ-13), (IMP-6)
  if (!is_solved(report.solve.status))
    return failed(Outcome::not_solved,
                  std::string("the solver ended with ") + to_string(report.solve.status));
  return out;
}

VecX estimate_without_contacts(const StepSetting& setting, const State& state, const FreeMotion& free,
                               double h, double theta) {
  const VecX v_prescribed = prescribed_velocity(setting.model, state, h);
  VecX v = free.v_free;
  if (!setting.model.joints.empty()) {
    const JointEquations joints = joint_system(setting.model, state, setting.dofs, v_prescribed, h, theta,
                                               setting.options.normal, setting.options.joints)
                                      .equations;
    const FrictionProblem problem{
        .M = free.M, .H = SparseMatrix(setting.dofs.rows, 0), .f = free.f, .G = joints.G, .b = joints.b};
    if (const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G))
      v = free_velocity(problem, *inverse);
  }
  return all_velocities(setting.dofs, v, v_prescribed);
}

}  // namespace aussois
