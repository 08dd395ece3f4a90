// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/impulse_step.hpp"

#include "mechanics/tree.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr double kReentry = 0.01;  // of the dilations per step; taste, below what the certificate allows

// How fast each contact may close although it was left out of the problem.
std::vector<double> allowed_speeds(const FoundContacts& found) {
  std::vector<double> allowed = contact_dilations(found.pairs, found.contacts);
  for (double& speed : allowed) speed *= kReentry / found.h;
  return allowed;
}

// Static friction undoes what it has lost: a bias of the tangential rows (PER-9).
void pull_back(const FoundContacts& found, const PersistenceOptions& options, std::vector<ContactRow>& rows) {
  for (std::size_t i = 0; i < found.warm.anchor.size(); ++i) {
    const Anchor& anchor = found.warm.anchor[i];
    if (!anchor.held || rows[i].law.rows < 3) continue;
    Vec3 speed = options.anchor_rate / found.h * anchor.drift;
    const double fast = speed.norm();
    if (fast > options.anchor_speed) speed *= options.anchor_speed / fast;
    rows[i].w.segment<2>(1) += rows[i].frame.rightCols<2>().transpose() * speed;
  }
}

// Impulses that every row starts with: those of the last solve; before that, contacts from the memory, turned
// to now, the others from State::r.
std::vector<RowVector> starting_impulses(const ImpulseStep& step, const FoundContacts& found, const VecX& r) {
  const std::vector<ContactRow>& rows = step.rows;
  if (!step.solved.first_row.empty()) return row_impulses(step);
  std::vector<RowVector> out(rows.size(), RowVector::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].slot) {
      out[i].head<3>() = rows[i].frame.transpose() * found.start[i];
      out[i][3] = found.warm.drilling[i];
    } else if (r.size() > 0) {
      out[i].head(rows[i].law.rows) = found.scale * r.segment(*rows[i].slot, rows[i].law.rows);
    }
  }
  return out;
}

}  // namespace

ContactBlocks contact_blocks(const StepSetting& setting, const State& state, const ContactSet& contacts,
                             double h, const NormalRule& normal, const ReachedPlace& reached) {
  StageClock clock(Stage::kinematics, setting.options.profile);
  const VecX v_prescribed =  // of the step, wherever on it contacts are looked at
      reached.time > 0 ? all_velocities(setting.dofs, VecX::Zero(setting.dofs.rows), reached.v)
                       : prescribed_velocity(setting.model, state, h);
  const ReductionOptions& o = setting.options.reduction;
  std::vector<FrictionPatch> patches;
  if (o.friction == FrictionAt::patches) patches = friction_patches(contacts, o.clustering.angle, o.layer);
  ContactBlocks out{.rows = contact_rows(setting.model, state, setting.dofs, contacts, v_prescribed, h,
                                         normal, reached, patches)};
  GapFunctionRows gaps =
      gap_rows(setting.model, state, setting.dofs, v_prescribed, h, normal, reached);  // (GEN-3)
  out.gap = std::move(gaps.gap);
  out.rows.insert(out.rows.end(), gaps.rows.begin(), gaps.rows.end());
  clock.add_to(out.times);
  return out;
}

std::optional<AfterImpact> after_impact(const StepSetting& setting, const State& state, FoundContacts& found,
                                        const ImpactOptions& options, double theta) {
  if (in_the_step(options)) return std::nullopt;
  const Model& model = setting.model;
  const StepOptions& o = setting.options;
  const ContactBlocks blocks = contact_blocks(setting, state, found.contacts, found.h, setting.normal);
  const VecX v_prescribed = prescribed_velocity(model, state, found.h);
  const JointSystem joints =
      joint_system(model, state, setting.dofs, v_prescribed, found.h, theta, setting.normal, o.joints);
  std::optional<ImpactJump> met = impact_jump(model, state, setting.dofs, blocks.rows, joints.equations.G,
                                              found.h, setting.normal.law, options, o.solver);
  if (!met) return std::nullopt;
  met->columns = joints.columns;
  met->middle = joints.middle;
  met->v_mean = (free_velocities(setting.dofs, state.v) + met->v) / 2;
  for (int i = 0; i < int(found.contacts.points.size()); ++i)  // they are reported, and held from now on
    if (!met->r[i].isZero(0) && std::ranges::find(found.selection.kept, i) == found.selection.kept.end())
      found.selection.kept.push_back(i);
  std::ranges::sort(found.selection.kept);
  AfterImpact out{.state = state, .blocks = {}, .impact = std::move(*met)};
  out.state.v = all_velocities(setting.dofs, out.impact.v, state.v);
  carry_twists(model, out.state.g, out.state.v);
  out.blocks = contact_blocks(setting, out.state, found.contacts, found.h, setting.normal);
  out.blocks.times = {};  // more than one solve may use them
  for (std::size_t i = 0; i < out.blocks.rows.size(); ++i)
    if (!out.impact.r[i].isZero(0)) out.blocks.rows[i].active = true;
  return out;
}

void add_rows(const StepSetting& setting, const State& state, const FoundContacts& found,
              const NormalRule& normal, ImpulseStep& step) {
  set_rows(contact_blocks(setting, state, found.contacts, found.h, normal), step);  // (MJ-6)
}

void set_rows(ContactBlocks blocks, ImpulseStep& step) {
  add(blocks.times, step.times);
  step.rows = std::move(blocks.rows);
  step.gap = std::move(blocks.gap);
  step.rows.insert(step.rows.end(), step.joints.rows.begin(), step.joints.rows.end());
}

ImpulseStep pose_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                      SharedMotion free, double theta) {
  return pose_step(setting, state, found, std::move(free), theta,
                   contact_blocks(setting, state, found.contacts, found.h, setting.normal));
}

ImpulseStep pose_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                      SharedMotion free, double theta, ContactBlocks blocks) {
  const StepOptions& o = setting.options;
  StageClock clock(Stage::kinematics, o.profile);
  ImpulseStep out{.free = std::move(free),
                  .v_prescribed = prescribed_velocity(setting.model, state, found.h)};
  out.joints =
      joint_system(setting.model, state, setting.dofs, out.v_prescribed, found.h, theta, setting.normal,
                   o.joints);                                               // (MJT-10)
  if (o.persistence.anchors) pull_back(found, o.persistence, blocks.rows);  // (PER-9)
  set_rows(std::move(blocks), out);
  clock.add_to(out.times);
  return out;
}

void solve_rows(const StepSetting& setting, const State& state, const FoundContacts& found,
                ImpulseStep& step) {
  StageClock clock(Stage::solve, setting.options.profile);
  SolverOptions solver = setting.options.solver;
  solver.tolerance *= step.tolerance_part;
  add_counts(step.solved.solution.report, step.beside);
  step.solved = solve_reduced(*step.free, setting.dofs, step.rows, step.joints.equations, found.selection,
                              starting_impulses(step, found, state.r), allowed_speeds(found), solver,
                              clock);  // (NSGS-1)
  clock.add_to(step.times);
}

ImpulseStep solve_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                       SharedMotion free, double theta) {
  ImpulseStep out = pose_step(setting, state, found, std::move(free), theta);
  solve_rows(setting, state, found, out);
  return out;
}

ImpulseStep solve_step(const StepSetting& setting, const State& state, const FoundContacts& found,
                       SharedMotion free, double theta, ContactBlocks blocks) {
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

SolveReport solve_report(const ImpulseStep& step) {
  SolveReport out = step.solved.solution.report;
  add_part(step.beside, out);
  if (step.impact) add_part(step.impact->solve, out);
  return out;
}

VecX estimate_without_contacts(const StepSetting& setting, const State& state, const FreeMotion& free,
                               double h, double theta) {
  const VecX v_prescribed = prescribed_velocity(setting.model, state, h);
  VecX v = free.v_free;
  if (!setting.model.joints.empty()) {
    const JointEquations joints = joint_system(setting.model, state, setting.dofs, v_prescribed, h, theta,
                                               setting.normal, setting.options.joints)
                                      .equations;
    if (joints.b.size() == 0) return all_velocities(setting.dofs, v, v_prescribed);
    const FrictionProblem problem{
        .M = free.M, .H = SparseMatrix(setting.dofs.rows, 0), .f = free.f, .G = joints.G, .b = joints.b};
    if (const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G))
      v = free_velocity(problem, *inverse);
  }
  return all_velocities(setting.dofs, v, v_prescribed);
}

}  // namespace aussois
