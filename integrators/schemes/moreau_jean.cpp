// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/moreau_jean.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/settings.hpp"
#include "integrators/pose/gap_hessians.hpp"
#include "integrators/pose/landing.hpp"
#include "integrators/schemes/advance_step.hpp"
#include "integrators/schemes/shared_settings.hpp"

namespace aussois {
namespace {

// The part `time` of the step that the mean velocities `v` lead through.
State on_the_way(const StepSetting& setting, const State& start, const VecX& v, double h, double time) {
  const VecX v_path = path_velocity(setting.options.update, setting.model, start, v, h);
  return state_after(setting.model, start, v_path, v, time);
}

// What the momentum balance holds for one iterate: forces where it stands, the matrix of the start and how
// contact impulses `turn` (MJ-12).
FreeMotion at_iterate(const StepSetting& setting, const State& start, const FreeMotion& first, const VecX& v,
                      const VecX& v_prescribed, double h, double theta, const SparseMatrix& turn) {
  const VecX v_theta = all_velocities(setting.dofs, theta * v + (1 - theta) * first.v, v_prescribed);
  const State there = on_the_way(setting, start, v_theta, h, theta * h);
  const FreeMotion forces = free_motion(setting.model, there, setting.dofs, h, 0);
  const VecX change = v - first.v;
  FreeMotion out = first;
  out.gravity = forces.gravity;
  out.gyroscopic = forces.gyroscopic + first.gyroscopic_D * change;
  out.laws = forces.laws + first.law_D * change;
  const VecX all_change = all_velocities(setting.dofs, change, 0 * v_prescribed);
  for (AxisImpulse& a : out.axes) {
    a.motor = 0;
    a.spring = a.D * axis_speed(setting.model.joints[a.joint], a.row, all_change);
  }
  out.axes.insert(out.axes.end(), forces.axes.begin(), forces.axes.end());
  if (turn.nonZeros() > 0) {
    out.turning_D = kept_positive(first.M, turn);
    out.turning = out.turning_D * change;
    sum_up(out);
  } else {
    sum_up_impulses(out);
  }
  return out;
}

// Changes of the size of the solver's noise that no longer halve are no matter of Newton's. Small bodies turn
// by a tenth of it.
bool newton_done(double change, double last, const NewtonOptions& o, double solver_tolerance) {
  return change <= o.tolerance || (change <= kSolverNoise * solver_tolerance && change > last / 2);
}

// A loop whose changes grow so often in a row leads away from the solution next to its start, and may end at
// another one (MJ-16). One growth is a contact that comes or goes, or load that shifts among several.
constexpr int kDivergent = 2;
bool grows(double change, double last, double speed, double solver_tolerance) {
  return change > 1.1 * last && change > kSolverNoise * solver_tolerance * speed;
}

// Impulses of all contacts of a solution, to be matched with those of the next iterate.
ContactMemory remembered(const FoundContacts& found, const ImpulseStep& step) {
  const std::vector<RowVector> r = row_impulses(step);
  std::vector<Vec3> impulse;
  std::vector<double> drilling;
  for (std::size_t i = 0; i < found.contacts.points.size(); ++i) {
    const Law& law = step.rows[i].law;
    impulse.push_back(step.rows[i].frame * r[i].head<3>());
    drilling.push_back(law.rows > 3 ? r[i][3] : 0);
  }
  return remember(found.contacts, impulse,
                  {.drilling = drilling, .anchors = {}, .g = found.g, .places = found.places});
}

void start_with_the_last_solve(const FoundContacts& found, const ImpulseStep& step, FoundContacts& there) {
  WarmStart last = warm_start(remembered(found, step), there.contacts, {.g = there.g});
  there.start = std::move(last.impulse);
  there.warm.drilling = std::move(last.drilling);
}

std::vector<double> normal_impulses(const FoundContacts& found) {
  std::vector<double> r_N;
  for (std::size_t i = 0; i < found.contacts.points.size(); ++i)
    r_N.push_back(found.contacts.points[i].normal.dot(found.start[i]));
  return r_N;
}

double time_of(ContactsAt at, double h) {
  return at == ContactsAt::start ? 0 : at == ContactsAt::midpoint ? h / 2 : h;
}

}  // namespace

void describe(SettingVisitor& visit, NewtonOptions& o) {
  visit.begin("NewtonOptions");
  visit.count({.name = "max_iterations",
               .what = "maximum Newton iterations per step; 1: linearly implicit, more: fully implicit",
               .unit = "",
               .range = range_from(1),
               .flag = "--newton-iterations",
               .label = "implicit"},
              o.max_iterations);
  visit.number({"tolerance", "largest change of a velocity at convergence", "m/s, rad/s", positive_range()},
               o.tolerance);
  visit.toggle(
      {.name = "gap_hessians", .what = "include gap Hessians in the Newton matrix", .flag = "--gap-hessians"},
      o.gap_hessians);
}

void describe(SettingVisitor& visit, MoreauJeanOptions& o) {
  visit.begin("MoreauJeanOptions");
  visit.number(theta_setting(), o.theta);
  visit.choice(normal_law_setting(), o.law, kNormalLaws);
  visit.number(
      {.name = "gamma",
       .what = "weight of the end velocity in the contact laws; 1: end velocity alone; below, impacts "
               "bounce by at least (1 - gamma) / gamma",
       .unit = "-",
       .range = {0.5, 1},
       .flag = "--gamma",
       .label = "gamma %"},
      o.gamma);
  visit.choice({.name = "contacts",
                .what = "point of the step at which contacts are evaluated",
                .flag = "--contacts",
                .label = "contacts %"},
               o.contacts, kContactsAt);
  visit.group("newton", o.newton);
  visit.group("impact", o.impact);
}

void validate(const MoreauJeanOptions& o) {
  check_options(o);
  require(in_the_step(o.impact) || o.law != NormalLaw::gap_over_step,
          (o.impact.law != ImpactOptions{}.law
               ? std::string("ImpactOptions::law = ") + name_of(o.impact.law, kImpactLaws)
               : std::string("ImpactOptions::order = ") + name_of(o.impact.order, kImpactOrders)) +
              " needs MoreauJeanOptions::law = moreau or combined");
  require(in_the_step(o.impact) || o.contacts == ContactsAt::start,
          "MoreauJeanOptions::contacts must be start with Poisson's or sequential impacts, because these act "
          "at the start of a step");
  require(!o.newton.gap_hessians || (o.newton.max_iterations > 1 && o.contacts != ContactsAt::start),
          "NewtonOptions::gap_hessians needs NewtonOptions::max_iterations > 1 and "
          "MoreauJeanOptions::contacts = midpoint or end");
  require(o.newton.tolerance == NewtonOptions{}.tolerance || o.newton.max_iterations > 1,
          "NewtonOptions::tolerance = " + number_text(o.newton.tolerance) +
              " needs NewtonOptions::max_iterations > 1: one iteration has no loop that it could end");
  require(in_the_step(o.impact) || o.gamma == 1,
          "MoreauJeanOptions::gamma must be 1 with Poisson's or sequential impacts, which have their own "
          "average");
}

MoreauJean::MoreauJean(const Model& model, const StepOptions& step, const MoreauJeanOptions& own)
    : setting_(std::make_shared<const StepSetting>(step_setting(model, step, own.law, own.gamma))),
      own_(own) {
  validate(own);
  refuse_unread_by(own.law, step);
  if (own.law == NormalLaw::gap_over_step && own.gamma == 1) refuse_restitution(model);
  if (own.newton.gap_hessians) {
    refuse_deforming(model, "NewtonOptions::gap_hessians");
    refuse_carrying(model, "NewtonOptions::gap_hessians");
  }
}

namespace {

SharedMotion free(const StepSetting& setting, const State& state, double h, double theta) {
  return SharedMotion(new FreeMotion(free_motion(setting.model, state, setting.dofs, h, theta,
                                                 setting.mass_scratch.get())));  // (MJ-4), (MJ-5)
}

// Where a step begins, an impact behind it or not, and how it would go on without contacts.
struct StepStart {
  const State& state;
  const std::optional<AfterImpact>& after;
  SharedMotion free{};
};

// What Newton's loop carries from solve to solve.
struct Iterate {
  FoundContacts found{};
  ImpulseStep step{};
  int made = 1, growths = 0;
  double change = kInf, last = kInf;
};

// Solves again where the last solve leads (MJ-11), (MJ-12).
void solve_again(const StepSetting& setting, const MoreauJeanOptions& o, const StepStart& start, double h,
                 Iterate& now) {
  const double theta = o.theta, time = time_of(o.contacts, h);
  const VecX v = now.step.solved.solution.v;
  const ReachedPlace reached{
      all_velocities(setting.dofs, theta * v + (1 - theta) * start.free->v, now.step.v_prescribed), time};
  State at = on_the_way(setting, start.state, reached.v, h, time);
  at.v = start.state.v;
  at.t = start.state.t;
  FoundContacts there = time > 0 ? found_at(setting, start.state, now.found, at) : now.found;
  start_with_the_last_solve(now.found, now.step, there);
  ContactBlocks blocks = start.after ? start.after->blocks
                                     : contact_blocks(setting, time > 0 ? at : start.state, there.contacts, h,
                                                      setting.normal, reached);
  SharedMotion free = start.free;
  if (o.newton.max_iterations > 1) {
    SparseMatrix turn;  // with theta as of a velocity's part in the path
    if (o.newton.gap_hessians && time > 0)
      turn =
          gap_hessians(setting.model, at, there.contacts, normal_impulses(there), setting.dofs, theta * time);
    free = std::make_shared<const FreeMotion>(
        at_iterate(setting, start.state, *start.free, v, now.step.v_prescribed, h, theta, turn));
  }
  SolveReport beside = now.step.beside;
  add_counts(now.step.solved.solution.report, beside);
  const StageTimes times = now.step.times;
  now.step = solve_step(setting, start.state, there, std::move(free), theta, std::move(blocks));
  now.step.beside = beside;
  add(times, now.step.times);
  now.found = std::move(there);
  now.last = std::exchange(now.change, (now.step.solved.solution.v - v).lpNorm<Eigen::Infinity>());
  now.growths = grows(now.change, now.last, v.lpNorm<Eigen::Infinity>(), setting.options.solver.tolerance)
                    ? now.growths + 1
                    : 0;
  ++now.made;
}

// `without` is the free motion of the state.
Trial attempt(const StepSetting& setting, const MoreauJeanOptions& o, const State& state,
              const SharedMotion& without, const Estimate& ahead, double h) {
  const double theta = o.theta, time = time_of(o.contacts, h);
  Iterate now{.found = find_ahead(setting, state, ahead, h)};
  const std::optional<AfterImpact> after = after_impact(setting, state, now.found, o.impact, theta);
  const State& from = after ? after->state : state;
  const StepStart start{from, after, after ? free(setting, from, h, theta) : without};
  now.step = solve_step(
      setting, from, now.found, start.free, theta,
      after ? after->blocks : contact_blocks(setting, from, now.found.contacts, h, setting.normal));
  const int iterations = o.newton.max_iterations, solves = iterations + (time > 0);
  if (iterations == 1) now.change = 0;
  while (now.made < solves && now.growths < kDivergent &&
         (now.made < 2 || !newton_done(now.change, now.last, o.newton, setting.options.solver.tolerance)) &&
         now.step.solved.solution.v.allFinite())
    solve_again(setting, o, start, h, now);
  if (after) now.step.impact = after->impact;
  VecX v_path = theta * now.step.solved.solution.v + (1 - theta) * start.free->v;  // (MJ-7)
  if (theta < 1 && o.gamma == 1 && o.law != NormalLaw::moreau && v_path.allFinite())
    v_path = landing_path(setting, from, now.found, v_path, now.step);
  Trial trial{.move = {.v_path = v_path,
                       .v_end = now.step.solved.solution.v,
                       .goes_on = 2 * (1 - theta) * setting.options.advancement.min_h},
              .figures = {.newton_iterations = now.made, .newton_change = now.change}};
  if (now.growths == kDivergent)
    trial.beforehand = {Outcome::not_certified, "the Newton loop of the step diverges"};
  else if (iterations > 1 && !newton_done(now.change, now.last, o.newton, setting.options.solver.tolerance))
    trial.afterwards = {Outcome::not_solved, "the Newton loop of the step did not reach its tolerance"};
  trial.found = std::move(now.found);
  trial.impulses = std::move(now.step);
  if (after) trial.from = after->state;
  return trial;
}

}  // namespace

StepReport MoreauJean::step(State& state, double h_limit) const {
  const StepSetting& setting = *setting_;
  SharedMotion without;  // contacts; of the length that is tried, from the start that all attempts share
  double length = 0;
  const auto free_for = [&](const State& start, double h) -> const SharedMotion& {
    if (h != length) without = free(setting, start, h, own_.theta), length = h;
    return without;
  };
  return advance_step(setting, state, h_limit,
                      {[&](const State& start, double h) {
                         return estimate_without_contacts(setting, start, *free_for(start, h), h, own_.theta);
                       },
                       [&](const State& start, const Estimate& ahead, double h) {
                         return attempt(setting, own_, start, free_for(start, h), ahead, h);
                       }});
}

ContactSet MoreauJean::contacts(const State& state, double threshold) const {
  return contacts_within(*setting_, state, threshold);
}

}  // namespace aussois
