// SPDX-License-Identifier: Apache-2.0
#include "integrators/moreau_jean.hpp"

#include <cmath>

#include "geometry/check.hpp"
#include "integrators/advance_step.hpp"

namespace aussois {
namespace {

StepOptions step_options(const MoreauJeanOptions& o) {
  return {.h = o.h,
          .normal = o.normal,
          .joints = o.joints,
          .lmd = o.lmd,
          .reduction = o.reduction,
          .persistence = o.persistence,
          .solver = o.solver,
          .advancement = o.advancement,
          .update = o.update,
          .threads = o.threads,
          .keep_problem = o.keep_problem};
}

// The part `time` of the step that the mean velocities `v` lead through.
State on_the_way(const StepSetting& setting, const State& start, const VecX& v, double h, double time) {
  const VecX v_path = path_velocity(setting.options.update, setting.model, start, v, h);
  return moved(setting.model, start, v_path, v, time);
}

// What the momentum balance holds for one iterate: forces where it stands, the matrix of the start (MJ-12).
FreeMotion at_iterate(const StepSetting& setting, const State& start, const FreeMotion& first, const VecX& v,
                      const VecX& v_prescribed, double h, double theta) {
  const VecX v_theta = all_velocities(setting.dofs, theta * v + (1 - theta) * first.v, v_prescribed);
  const State there = on_the_way(setting, start, v_theta, h, theta * h);
  const FreeMotion forces = free_motion(setting.model, there, setting.dofs, h, 0);
  const VecX change = v - first.v;
  FreeMotion out = first;
  out.gravity = forces.gravity;
  out.gyroscopic = forces.gyroscopic + first.gyroscopic_D * change;
  out.laws = forces.laws + first.law_D * change;
  const VecX impulse = out.laws + out.gravity + out.gyroscopic;
  out.f = out.M * out.v + impulse;
  if (out.inverse) out.v_free = out.v + *out.inverse * impulse;
  return out;
}

double time_of(ContactsAt at, double h) {
  return at == ContactsAt::start ? 0 : at == ContactsAt::midpoint ? h / 2 : h;
}

}  // namespace

const char* to_string(ContactsAt at) {
  return at == ContactsAt::start ? "start" : at == ContactsAt::midpoint ? "midpoint" : "end";
}
ContactsAt contacts_at(const std::string& name) {
  for (const ContactsAt at : {ContactsAt::start, ContactsAt::midpoint, ContactsAt::end})
    if (name == to_string(at)) return at;
  throw std::invalid_argument("contacts at = " + name + " must be start, midpoint or end");
}

void validate(const MoreauJeanOptions& o) {
  require_field(o.theta >= 0.5 && o.theta <= 1, "MoreauJeanOptions::theta", o.theta, "lie in [0.5, 1]");
  require_field(o.newton.max_iterations >= 1, "NewtonOptions::max_iterations", o.newton.max_iterations,
                "be at least 1");
  require_field(o.newton.tolerance > 0, "NewtonOptions::tolerance", o.newton.tolerance, "be positive [m/s]");
  validate(o.impact);
  require(in_the_step(o.impact) || o.normal.law != NormalLaw::gap_over_step,
          std::string("MoreauJeanOptions::impact = ") + to_string(o.impact.law) + ", " +
              to_string(o.impact.order) + " needs an impact law: normal law moreau or combined");
  require(
      in_the_step(o.impact) || o.contacts == ContactsAt::start,
      "MoreauJeanOptions::contacts must be start with Poisson's or sequential impacts, which happen there");
  require(
      in_the_step(o.impact) || o.normal.gamma == 1,
      "NormalLawOptions::gamma must be 1 with Poisson's or sequential impacts, which have their own average");
  validate(step_options(o));
}

MoreauJean::MoreauJean(const Model& model, const MoreauJeanOptions& options)
    : setting_(step_setting(model, step_options(options))), options_(options) {
  validate(options);
}

FreeMotion MoreauJean::free(const State& state, double h) const {
  return free_motion(setting_.model, state, setting_.dofs, h, options_.theta);  // (MJ-4), (MJ-5)
}

Attempt MoreauJean::attempt(const State& state, const FreeMotion& without, const Estimate& ahead,
                            double h) const {
  const double theta = options_.theta, time = time_of(options_.contacts, h);
  const NormalLawOptions& normal = options_.normal;
  Found found = find_ahead(setting_, state, ahead, h);
  const std::optional<AfterImpact> after = after_impact(setting_, state, found, options_.impact, theta);
  const State& start = after ? after->state : state;
  const FreeMotion first = after ? free(start, h) : without;
  ImpulseStep step =
      solve_step(setting_, start, found, first, theta,
                 after ? after->blocks : contact_blocks(setting_, start, found.contacts, h, normal));

  // Again where that leads (MJ-11), (MJ-12)
  const int iterations = options_.newton.max_iterations, solves = iterations + (time > 0);
  int made = 1;
  double change = iterations == 1 ? 0 : kInf;
  while (made < solves && (made < 2 || change > options_.newton.tolerance)) {
    const VecX v = step.solved.solution.v;
    if (!v.allFinite()) break;
    const Reached reached{all_velocities(setting_.dofs, theta * v + (1 - theta) * first.v, step.v_prescribed),
                          time};
    State at = on_the_way(setting_, start, reached.v, h, time);
    at.v = start.v;
    at.t = start.t;
    Found there = time > 0 ? found_at(setting_, start, found, at) : found;
    ContactBlocks blocks =
        after ? after->blocks
              : contact_blocks(setting_, time > 0 ? at : start, there.contacts, h, normal, reached);
    step = solve_step(
        setting_, start, there,
        iterations > 1 ? at_iterate(setting_, start, first, v, step.v_prescribed, h, theta) : first, theta,
        std::move(blocks));
    found = std::move(there);
    change = (step.solved.solution.v - v).lpNorm<Eigen::Infinity>();
    ++made;
  }
  if (after) step.impact = after->impact;
  const VecX& v = step.solved.solution.v;
  Attempt out = go(setting_, start, found, step,
                   {.v_path = theta * v + (1 - theta) * first.v, .v_end = v, .end = {}});  // (MJ-7)
  out.report.newton_iterations = made;
  out.report.newton_change = change;
  if (iterations > 1 && change > options_.newton.tolerance && out.outcome == Outcome::accepted) {
    out.outcome = Outcome::not_solved;
    out.report.reason = "the Newton loop of the step did not reach its tolerance";
  }
  return out;
}

StepReport MoreauJean::step(State& state, double h_limit) const {
  FreeMotion without;  // contacts; of the length that is tried, from the start that all attempts share
  double length = 0;
  const auto free_for = [&](const State& start, double h) -> const FreeMotion& {
    if (h != length) without = free(start, h), length = h;
    return without;
  };
  return advance_step(setting_, state, h_limit,
                      {[&](const State& start, double h) {
                         return estimate_without_contacts(setting_, start, free_for(start, h), h,
                                                          options_.theta);
                       },
                       [&](const State& start, const Estimate& ahead, double h) {
                         return attempt(start, free_for(start, h), ahead, h);
                       }});
}

ContactSet MoreauJean::contacts(const State& state, double threshold) const {
  return contacts_within(setting_, state, threshold);
}

}  // namespace aussois
