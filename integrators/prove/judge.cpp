// SPDX-License-Identifier: Apache-2.0
#include "integrators/prove/judge.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/all_finite.hpp"
#include "integrators/prove/certify_step.hpp"
#include "mechanics/force_law.hpp"

namespace aussois {
namespace {

constexpr double kFineAtMost = 2;  // of the gap where levels begin: farther off the shapes are not asked

// Those of `apart` whose dilated shapes are not proven to keep apart on the path (CA-16).
std::vector<BodyPair> meeting_pairs(const StepSetting& setting, const StepPath& path,
                                    const std::vector<StepPair>& apart, Judgement& judgement) {
  std::vector<BodyPair> out;
  for (const StepPair& pair : apart) {
    const StepCertificate proof = certify_apart(path, pair, setting.bounds, setting.options.threads);
    judgement.certificate_rounds += int(proof.rounds);
    judgement.min_base_distance = std::min(judgement.min_base_distance, proof.min_distance);
    if (!proof.failure.empty()) out.push_back(bodies_of(pair));
  }
  return out;
}

// Empty if every contact that ends overlapped and closing may go on so for a time (CA-17), otherwise what has
// no room; where the step cannot be halved there is no choice. With restitution, one that was pushed turns.
std::string without_room(const StepSetting& setting, const FoundContacts& found, const ImpulseStep& step,
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
      return "bodies " + to_string(c.a.body) + " and " + to_string(c.b.body) +
             ": they cannot be stopped within the allowed overlap";
  }
  return "";
}

// The path to the poses that joints, or the scheme, hold at its end, and the state there.
void set_path(const StepSetting& setting, const State& state, const Trial& trial, Judgement& out) {
  const Model& model = setting.model;
  const double h = trial.found.h;
  const Move& move = trial.move;
  const VecX& v_prescribed = trial.impulses.v_prescribed;
  out.v_path = path_velocity(setting.options.update, model, state,
                             all_velocities(setting.dofs, move.v_path, v_prescribed), h);
  VecX v_end = all_velocities(setting.dofs, move.v_end, v_prescribed);
  const bool project = setting.options.joints.project;
  if (move.end || (project && !model.joints.empty())) {
    const State plain = state_after(model, state, out.v_path, v_end, h);
    out.held.state = move.end ? *move.end : plain;
    out.held.state.v = v_end;
    if (project) out.held = projected_state(model, out.held.state);  // (MJT-13)
    out.v_path = velocity_between(state, plain, out.held.state, out.v_path, h);
    v_end = out.held.state.v;
  }
  out.next = state_after(model, state, out.v_path, v_end, h);
}

Objection kept_bounds(const StepSetting& setting, const FoundContacts& found, const StepPath& path) {
  const double alpha = setting.options.lmd.alpha;
  for (const std::string& broken :
       {broken_bound(path, found.pairs, alpha), broken_bound(path, found.apart, alpha),
        broken_reach(path, found.reach)})  // (CA-5)
    if (!broken.empty()) return {Outcome::bound_exceeded, broken};
  return {};
}

// Contacts of levels that close on the path: there the shapes themselves must be asked, and where that is
// far the step is too long.
Objection open_guards(const StepSetting& setting, const State& state, const FoundContacts& found,
                      const VecX& v_path) {
  Objection out;
  bool is_far = false;
  for (const ContactPoint& c : found.guards.points) {
    if (!(gap_ahead(setting.model, state, c, v_path, found.h) < 0)) continue;
    const double near =
        kFineAtMost * answers_from(*shape_of(setting.model, c.a.body), *shape_of(setting.model, c.b.body), 1);
    is_far = is_far || c.gap > near;
    double& fine_to = out.fine_to[{c.a.body, c.b.body}];
    fine_to = std::max(fine_to, 2 * c.gap);
  }
  if (out.fine_to.empty()) return out;
  out.outcome = is_far ? Outcome::levels_meet_far : Outcome::levels_meet;
  out.reason = is_far ? "coarser levels of bodies meet far ahead" : "coarser levels of bodies meet";
  return out;
}

Objection proven(const StepSetting& setting, const Trial& trial, const StepPath& path, Judgement& out) {
  const StepOptions& o = setting.options;
  const FoundContacts& found = trial.found;
  std::vector<BodyPair> meeting = meeting_pairs(setting, path, found.apart, out);  // (CA-16)
  if (!meeting.empty())
    return {Outcome::meets, "bodies meet, but the step did not search for their contacts",
            std::move(meeting)};
  const StepCertificate certificate =
      certify_step(path, found.pairs, setting.bounds, found.contacts, o.advancement, o.threads);  // (CA-6)
  out.certificate_rounds += int(certificate.rounds);
  out.min_base_distance = std::min(out.min_base_distance, certificate.min_distance);
  if (!certificate.failure.empty()) return {Outcome::not_certified, certificate.failure};
  const std::string off_path = strayed(path, out.next);  // (DEF-2)
  if (!off_path.empty()) return {Outcome::not_certified, off_path};
  const std::string crowded = without_room(setting, found, trial.impulses, trial.move);  // (CA-17)
  if (!crowded.empty()) return {Outcome::not_certified, crowded};
  out.driven_overlaps =
      driven_overlaps(path, setting.bounds, setting.pieces, o.advancement, o.threads);  // (CA-20)
  return {};
}

// Where a law has no force on the path. It is looked at wherever a body has turned by another half radian, so
// two bodies by at most one, and no turn of theirs from 2.5 rad up to its image at 2 pi - 2.5 is skipped.
std::string refusal_on(const StepSetting& setting, const State& state, const Trial& trial,
                       const VecX& v_path) {
  const auto refuses = [](const ForceLaw& law) { return bool(law.refusal); };
  if (std::ranges::none_of(setting.model.forces, refuses)) return "";
  double turn = 0;
  for (const BodyId b : setting.model.bodies.ids())
    turn = std::max(turn, trial.found.h * angular_part(v_path, b).norm());
  const int count = int(std::clamp(std::ceil(2 * turn), 1.0, 1e6));
  for (int k = 1; k <= count; ++k) {
    std::string none =
        force_refusal(setting.model, retract(setting.model, state, v_path, trial.found.h * k / count));
    if (!none.empty()) return none;
  }
  return "";
}

Objection objection(const StepSetting& setting, const State& state, const Trial& trial, bool starts_apart,
                    Judgement& out) {
  const SolveStatus solved = solve_report(trial.impulses).status;
  if (solved == SolveStatus::not_finite || !all_finite(trial.move.v_path) || !all_finite(trial.move.v_end))
    return {Outcome::not_finite, "a force or velocity is not finite"};
  set_path(setting, state, trial, out);
  const auto speaks = [](const Objection& o) { return o.outcome != Outcome::accepted; };
  if (speaks(trial.beforehand)) return trial.beforehand;
  StepPath path = step_path({setting.model, state, out.v_path, trial.found.h}, setting.bounds);
  path.levels = setting.options.levels;
  path.starts_apart = starts_apart;
  path.deformed = setting.scratch->deformed;
  if (Objection broken = kept_bounds(setting, trial.found, path); speaks(broken)) return broken;
  if (Objection meet = open_guards(setting, state, trial.found, out.v_path); speaks(meet)) return meet;
  if (setting.options.advancement.certify) {
    StageClock clock(Stage::certificate, setting.options.profile);
    Objection unproven = proven(setting, trial, path, out);
    clock.add_to(out.times);
    if (speaks(unproven)) return unproven;
  }
  if (!all_finite(out.next.g)) return {Outcome::not_finite, "a pose is not finite"};
  if (std::string none = refusal_on(setting, state, trial, out.v_path); !none.empty())
    return {Outcome::not_certified, std::move(none)};
  if (!setting.model.joints.empty()) out.joint_error = joint_error(setting.model, out.next);
  if (!within(out.joint_error, setting.options.joints))
    return {Outcome::not_certified, text_of(out.joint_error, setting.options.joints)};
  if (!is_solved(solved))
    return {Outcome::not_solved, std::string("the solver ended with ") + to_string(solved)};
  return trial.afterwards;
}

}  // namespace

Judgement judge(const StepSetting& setting, const State& state, const Trial& trial, bool starts_apart) {
  Judgement out;
  out.objection = objection(setting, trial.from ? *trial.from : state, trial, starts_apart, out);
  return out;
}

}  // namespace aussois
