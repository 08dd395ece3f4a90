// SPDX-License-Identifier: Apache-2.0
#include "integrators/moreau_jean.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <sstream>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "integrators/reduced_solve.hpp"
#include "lmd/motion_bound.hpp"

namespace aussois {
namespace {

constexpr double kReentry = 0.01;  // of the dilations per step; taste, below what the certificate allows

double cpu_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

bool all_finite(const std::vector<SE3>& poses) {
  return std::ranges::all_of(poses, [](const SE3& g) { return g.p.allFinite() && g.R.coeffs().allFinite(); });
}

const Model& checked(const Model& model) {
  validate(model);
  return model;
}

// Velocities of all bodies: the dynamic rows from `v`, the others as prescribed.
VecX all_velocities(const DofMap& dofs, const VecX& v, const VecX& v_prescribed) {
  VecX all = v_prescribed;
  for (std::size_t b = 0; b < dofs.first.size(); ++b)
    if (dofs.first[b] >= 0) all.segment<6>(6 * Eigen::Index(b)) = v.segment<6>(dofs.first[b]);
  return all;
}

// How fast each contact may close although it was left out of the problem.
std::vector<double> allowed_speeds(const ContactSet& found, const std::vector<StepPair>& pairs, double h) {
  std::vector<double> allowed;
  auto pair = pairs.begin();
  for (const ContactPoint& c : found.points) {  // both are sorted by bodies
    while (pair->a != c.a.body || pair->b != c.b.body) ++pair;
    allowed.push_back(kReentry * pair->dilation / h);
  }
  return allowed;
}

EnergyLedger ledger(const FreeMotion& free, const VecX& contact_impulse, const VecX& v) {
  const VecX change = v - free.v, middle = (v + free.v) / 2;
  return {.kinetic_change = middle.dot(free.mass * change),
          .gravity_work = middle.dot(free.gravity),
          .law_work = middle.dot(free.laws - free.law_D * change),
          .contact_work = middle.dot(contact_impulse),
          .gyroscopic_work = middle.dot(free.gyroscopic - free.gyroscopic_D * change)};
}

// The bodies at the end of their paths (MJ-8).
State moved(const StepMotion& step, const VecX& v_end) {
  State next = step.state;
  next.t += step.h;
  next.h = step.h;
  next.v = v_end;
  for (int b = 0; b < int(step.model.bodies.size()); ++b) {
    if (const auto* prescribed = std::get_if<Prescribed>(&step.model.bodies[std::size_t(b)].motion))
      pose(next, b) = evaluate(prescribed->path, next.t).pose;
    else
      pose(next, b) = pose_at(
          {.g = pose(step.state, b), .v = step.v.segment<3>(6 * b), .omega = step.v.segment<3>(6 * b + 3)},
          step.h);
  }
  return next;
}

}  // namespace

const char* to_string(StepStatus status) {
  switch (status) {
    case StepStatus::ok:
      return "ok";
    case StepStatus::refused:
      return "refused";
    case StepStatus::not_finite:
      return "not finite";
  }
  return "?";
}

void validate(const MoreauJeanOptions& o) {
  require_field(std::isfinite(o.h) && o.h > 0, "MoreauJeanOptions::h", o.h, "be positive [s]");
  require_field(o.theta >= 0.5 && o.theta <= 1, "MoreauJeanOptions::theta", o.theta, "lie in [0.5, 1]");
  require_field(o.threads >= 1, "MoreauJeanOptions::threads", o.threads, "be at least 1");
  require_field(o.normal.correction_speed >= 0, "NormalLawOptions::correction_speed",
                o.normal.correction_speed, "not be negative [m/s]");
  validate(o.advancement);
  require_field(o.advancement.min_h <= o.h, "AdvancementOptions::min_h", o.advancement.min_h,
                "not exceed h [s]");
  validate(o.lmd);
  validate(o.reduction);
  validate(o.solver);
}

struct MoreauJean::Attempt {
  enum class Outcome { accepted, bound_exceeded, not_certified, not_solved, not_finite };
  Outcome outcome = Outcome::accepted;
  VecX v_position{};  // of all bodies: what moves them (MJ-7)
  State next{};       // if accepted
  StepReport report{};
};

MoreauJean::MoreauJean(const Model& model, const MoreauJeanOptions& options)
    : model_(checked(model)), options_(options), dofs_(dof_map(model)), bounds_(body_bounds(model)) {
  validate(options);
  options_.lmd.threads = options.threads;
  options_.solver.for_all = [threads = options.threads](int n, const std::function<void(int)>& f) {
    parallel_for(n, threads, f);
  };
  int undilated = 0;
  bool dynamic_undilated = false;
  for (const RigidBody& body : model.bodies) {
    if (body.shape < 0 || model.shapes[std::size_t(body.shape)]->radius > 0) continue;
    ++undilated;
    dynamic_undilated = dynamic_undilated || is_dynamic(body);
  }
  require(!options_.advancement.certify || undilated < 2 || !dynamic_undilated,
          "two bodies that can touch have dilation 0: at least one of them needs a positive one [m]");
}

MoreauJean::Attempt MoreauJean::attempt(const State& state, const VecX& v_estimate, double h) const {
  Attempt out;
  StepReport& report = out.report;
  const double begin = cpu_seconds();

  // 1 and 2: contacts within the displacement bound
  const StepMotion estimate{model_, state, v_estimate, h};
  const std::vector<StepPair> pairs =
      step_pairs(estimate, bounds_, options_.advancement, options_.threads);  // (CA-4)
  const ContactSet found = contacts_of(model_, state, pairs, options_.lmd);   // (LMD-3)
  for (const StepPair& pair : pairs) report.threshold = std::max(report.threshold, pair.threshold);
  report.contacts_found = int(found.points.size());
  report.min_gap = smallest_gap(found);
  const double found_at = cpu_seconds();
  report.seconds_contact = found_at - begin;

  // 3 to 6: fewer contacts, matched with the last step's; the one-step problem and its solution
  const Selection selection = reduce(found, options_.reduction);                          // (RED-1)
  const WarmStart warm = warm_start(state.memory, found, state.h > 0 ? h / state.h : 1);  // (RED-5)
  const VecX v_prescribed = prescribed_velocity(model_, state, h);
  const FreeMotion free = free_motion(model_, state, dofs_, h, options_.theta);  // (MJ-4), (MJ-5)
  const std::vector<ContactRow> rows =
      contact_rows(model_, state, found, v_prescribed, h, options_.normal);  // (MJ-6)
  const ReducedSolution solved = solve_reduced(free, dofs_, rows, selection, warm.impulse,
                                               allowed_speeds(found, pairs, h), options_.solver);  // (NSGS-1)
  const FrictionSolution& solution = solved.solution;
  report.solve = solution.report;
  if (options_.keep_problem) report.problem = StepProblem{solved.problem, solved.start, solution};
  report.contacts_kept = int(solved.kept.size());
  report.contacts_matched = warm.matched;
  const double solved_at = cpu_seconds();
  report.seconds_solve = solved_at - found_at;
  if (report.solve.status == SolveStatus::not_finite || !solution.v.allFinite()) {
    out.outcome = Attempt::Outcome::not_finite;
    report.reason = "a force or velocity is not finite";
    return out;
  }

  // 7 and 8: did the step keep its word, and is it proven?
  out.v_position = all_velocities(dofs_, options_.theta * solution.v + (1 - options_.theta) * free.v,
                                  v_prescribed);  // (MJ-7)
  const StepMotion step{model_, state, out.v_position, h};
  report.reason =
      broken_bound(step, estimate, pairs, bounds_, options_.lmd.alpha, options_.advancement);  // (CA-5)
  if (!report.reason.empty()) {
    out.outcome = Attempt::Outcome::bound_exceeded;
    return out;
  }
  if (options_.advancement.certify) {
    const StepCertificate certificate =
        certify_step(step, pairs, bounds_, options_.advancement, options_.threads);  // (CA-6)
    report.certificate_rounds = int(certificate.rounds);
    report.min_base_distance = certificate.min_distance;
    report.reason = certificate.failure;
    report.seconds_certificate = cpu_seconds() - solved_at;
    if (!report.reason.empty()) {
      out.outcome = Attempt::Outcome::not_certified;
      return out;
    }
  }
  if (report.solve.status != SolveStatus::converged) {
    report.reason = std::string("the solver ended with ") + to_string(report.solve.status);
    out.outcome = Attempt::Outcome::not_solved;
  }

  // 9: the new state
  out.next = moved(step, all_velocities(dofs_, solution.v, v_prescribed));
  if (!all_finite(out.next.g)) {
    out.outcome = Attempt::Outcome::not_finite;
    report.reason = "a pose is not finite";
    return out;
  }
  const ContactSet kept = select(found, solved.kept);
  std::vector<Vec3> impulses;
  for (std::size_t k = 0; k < solved.kept.size(); ++k) {
    impulses.push_back(rows[std::size_t(solved.kept[k])].frame * solution.r.segment<3>(3 * Eigen::Index(k)));
    report.contacts.push_back({kept.points[k], impulses.back()});
  }
  out.next.memory = remember(kept, impulses);
  report.t = out.next.t;
  report.h = h;
  report.physical = physical_residual(solution.u, solution.r, solved.problem.laws);
  report.energy = ledger(free, solved.problem.H * solution.r, solution.v);  // (MJ-9)
  return out;
}

StepReport MoreauJean::step(State& state, double h_limit) const {
  const AdvancementOptions& o = options_.advancement;
  require_field(h_limit > 0, "h_limit", h_limit, "be positive [s]");
  const double begin = cpu_seconds();
  const double h_control = state.h_next > 0 ? std::min(options_.h, state.h_next) : options_.h;
  double h = std::min(h_control, h_limit);
  const double h_asked = h,
               min_h = std::min(o.min_h, h);  // what is left of a run may be shorter than any minimum
  const FreeMotion free = free_motion(model_, state, dofs_, h, options_.theta);
  VecX v_estimate = all_velocities(dofs_, free.v_free, prescribed_velocity(model_, state, h));

  StepReport report;
  const auto ended = [&](StepStatus status) {
    report.status = status;
    report.seconds_total = cpu_seconds() - begin;
    if (status != StepStatus::ok) report.t = state.t, report.h = 0;
    return report;
  };
  if (!v_estimate.allFinite() || !all_finite(state.g)) {
    report.reason = "a force, velocity or pose is not finite";
    return ended(StepStatus::not_finite);
  }
  int unsolved = 0, enlarged = 0;
  for (int k = 1; k <= o.max_attempts && h >= min_h; ++k) {
    Attempt trial = attempt(state, v_estimate, h);
    report = std::move(trial.report);
    report.attempts = k;
    switch (trial.outcome) {
      case Attempt::Outcome::not_finite:
        return ended(StepStatus::not_finite);
      case Attempt::Outcome::not_solved:  // a shorter step is an easier problem; after that the report tells
        if (++unsolved <= 3 && h / 2 >= min_h) {
          h /= 2;
          break;
        }
        [[fallthrough]];
      case Attempt::Outcome::accepted:
        state = std::move(trial.next);
        state.h_next = h < h_asked ? o.growth * h
                                   : std::max(h_control, o.growth * h);  // only a cut step makes it smaller
        return ended(StepStatus::ok);
      case Attempt::Outcome::bound_exceeded:
        v_estimate = trial.v_position;
        if (++enlarged % 4 == 0) h /= 2;
        break;
      case Attempt::Outcome::not_certified:
        h /= 2;
        break;
    }
  }
  std::ostringstream text;
  text << "no step of at least " << min_h << " s was accepted: " << report.reason;
  report.reason = text.str();
  return ended(StepStatus::refused);
}

ContactSet MoreauJean::contacts(const State& state, double threshold) const {
  std::vector<StepPair> pairs = pairs_within(
      model_, state, bounds_, std::vector<double>(model_.bodies.size(), threshold / 2), options_.threads);
  for (StepPair& pair : pairs) pair.threshold = threshold;
  return contacts_of(model_, state, pairs, options_.lmd);
}

}  // namespace aussois
