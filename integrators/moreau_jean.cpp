// SPDX-License-Identifier: Apache-2.0
#include "integrators/moreau_jean.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <sstream>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "integrators/reduced_solve.hpp"
#include "nsgs/joint_elimination.hpp"

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

// Kinetic energy of the coordinates beyond what the mass of the step says of it (GEN-4).
double change_of_mass(const Model& model, const State& state, const State& next, const FreeMotion& free,
                      const DofMap& dofs, const VecX& v) {
  double work = 0;
  for (int i = 0; i < int(model.coordinates.size()); ++i) {
    const Coordinates& block = model.coordinates[std::size_t(i)];
    const VecX before = speeds(model, state, i), after = speeds(model, next, i);
    work += 0.5 * after.dot(block.mass(coordinates(model, next, i)) * after) -
            0.5 * before.dot(block.mass(coordinates(model, state, i)) * before);
  }
  if (model.coordinates.empty()) return 0;
  const Eigen::Index n = dofs.rows - dofs.coordinates;
  VecX change = VecX::Zero(dofs.rows);
  change.tail(n) = (v - free.v).tail(n);
  return work - 0.5 * (v + free.v).dot(free.mass * change);
}

// `v` is the velocity at the end, off by `projected` from what the impulses of the step gave (MJ-9).
EnergyLedger ledger(const FreeMotion& free, const VecX& contact_impulse, const VecX& joint_impulse,
                    const VecX& v, const VecX& projected) {
  const VecX change = v - free.v, middle = (v + free.v) / 2;
  EnergyLedger out{.kinetic_change = middle.dot(free.mass * change),
                   .gravity_work = middle.dot(free.gravity),
                   .law_work = middle.dot(free.laws - free.law_D * change),
                   .contact_work = middle.dot(contact_impulse),
                   .gyroscopic_work = middle.dot(free.gyroscopic - free.gyroscopic_D * change)};
  if (joint_impulse.size() > 0) out.joint_work = middle.dot(joint_impulse + free.M * projected);
  return out;
}

// The bodies at the end of their paths (MJ-8).
State moved(const StepMotion& step, const VecX& v_end) {
  State next = step.state;
  next.t += step.h;
  next.h = step.h;
  next.v = v_end;
  next.g = moved_poses(step.model, step.state, step.v, step.h);
  next.q += step.h * step.v.tail(next.q.size());
  if (!step.model.joints.empty()) next.turns = counted_turns(step.model, step.state, next.g);
  return next;
}

// The constant velocities that lead from the poses of `state` to those of `end`.
VecX velocity_to(const State& state, const State& end, VecX v, double h) {
  for (std::size_t b = 0; b < state.g.size(); ++b) {
    const auto at = 6 * Eigen::Index(b);
    v.segment<3>(at) = (end.g[b].p - state.g[b].p) / h;
    v.segment<3>(at + 3) = log_so3((state.g[b].R.conjugate() * end.g[b].R).normalized()) / h;
  }
  return v;
}

// Impulses that every row starts with: contacts from the memory, turned to now, the others from State::r.
std::vector<RowVector> starts(const std::vector<ContactRow>& rows, const WarmStart& warm, const VecX& r,
                              double scale) {
  std::vector<RowVector> out(rows.size(), RowVector::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].slot < 0) {
      out[i].head<3>() = rows[i].frame.transpose() * warm.impulse[i];
      out[i][3] = warm.drilling[i];
    } else if (r.size() > 0) {
      out[i].head(rows[i].law.rows) = scale * r.segment(rows[i].slot, rows[i].law.rows);
    }
  }
  return out;
}

// The impulses of a solution, sorted by what they belong to.
struct Impulses {
  std::vector<Vec3> contact{};  // world
  std::vector<double> drilling{};
  VecX r{};          // State::r
  VecX of_joints{};  // of the problem's rows, zero for contacts and gap functions
};
Impulses sorted(const Model& model, const std::vector<ContactRow>& rows, const ReducedSolution& solved) {
  Impulses out;
  const VecX& r = solved.solution.r;
  out.of_joints = VecX::Zero(r.size());
  if (row_count(model) > 0) out.r = VecX::Zero(row_count(model));
  for (std::size_t k = 0; k < solved.kept.size(); ++k) {
    const ContactRow& row = rows[std::size_t(solved.kept[k])];
    const int first = solved.first_row[k], count = row.law.rows;
    if (row.slot < 0) {
      out.contact.push_back(row.frame * r.segment<3>(first));
      out.drilling.push_back(count > 3 ? r[first + 3] : 0);
      continue;
    }
    out.r.segment(row.slot, count) = r.segment(first, count);
    if (row.slot < first_gap_row(model)) out.of_joints.segment(first, count) = r.segment(first, count);
  }
  return out;
}

std::vector<StepGap> step_gaps(const Model& model, const GapFunctionRows& gaps, const VecX& r) {
  std::vector<StepGap> out;
  for (int i = 0; i < int(gaps.rows.size()); ++i)
    if (const ContactRow& row = gaps.rows[std::size_t(i)]; row.active)
      out.push_back({i, gaps.gap[std::size_t(i)], r.segment<3>(first_gap_row(model) + 3 * i)});
  return out;
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
  validate(o.joints);
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
  const VecX v_prescribed = prescribed_velocity(model_, state, h);
  const GapFunctionRows gaps = gap_rows(model_, state, dofs_, v_prescribed, h, options_.normal);  // (GEN-3)
  report.min_gap = smallest_gap(found);
  for (const double gap : gaps.gap) report.min_gap = std::min(report.min_gap, gap);
  const double found_at = cpu_seconds();
  report.seconds_contact = found_at - begin;

  // 3 to 6: fewer contacts, matched with the last step's; the one-step problem and its solution
  const Selection selection = reduce(found, options_.reduction);  // (RED-1)
  const double scale = state.h > 0 ? h / state.h : 1;
  const WarmStart warm = warm_start(state.memory, found, scale);                 // (RED-5)
  const FreeMotion free = free_motion(model_, state, dofs_, h, options_.theta);  // (MJ-4), (MJ-5)
  std::vector<ContactRow> rows =
      contact_rows(model_, state, found, v_prescribed, h, options_.normal);  // (MJ-6)
  rows.insert(rows.end(), gaps.rows.begin(), gaps.rows.end());
  const JointSystem joints = joint_system(model_, state, dofs_, v_prescribed, h, options_.theta,
                                          options_.normal, options_.joints);  // (MJT-10)
  rows.insert(rows.end(), joints.rows.begin(), joints.rows.end());
  const ReducedSolution solved =
      solve_reduced(free, dofs_, rows, joints.equations, selection, starts(rows, warm, state.r, scale),
                    allowed_speeds(found, pairs, h), options_.solver);  // (NSGS-1)
  const FrictionSolution& solution = solved.solution;
  report.solve = solution.report;
  if (options_.keep_problem) report.problem = StepProblem{solved.problem, solved.start, solution};
  const Impulses impulses = sorted(model_, rows, solved);
  report.contacts_kept = int(impulses.contact.size());
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
  VecX v_end = all_velocities(dofs_, solution.v, v_prescribed);
  if (options_.joints.project && !model_.joints.empty()) {  // the path is the one to the projected poses
    const State end = consistent(model_, moved({model_, state, out.v_position, h}, v_end));  // (MJT-13)
    out.v_position = velocity_to(state, end, out.v_position, h);
    v_end = end.v;
  }
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
  out.next = moved(step, v_end);
  if (!all_finite(out.next.g)) {
    out.outcome = Attempt::Outcome::not_finite;
    report.reason = "a pose is not finite";
    return out;
  }
  const ContactSet kept = select(
      found, {solved.kept.begin(), solved.kept.begin() + report.contacts_kept});  // contacts come first
  for (std::size_t k = 0; k < kept.points.size(); ++k)
    report.contacts.push_back({kept.points[k], impulses.contact[k], impulses.drilling[k]});
  out.next.memory = remember(kept, impulses.contact, impulses.drilling);
  out.next.r = impulses.r;
  report.t = out.next.t;
  report.h = h;
  report.physical = physical_residual(solution.u, solution.r, solved.problem.laws);
  report.gaps = step_gaps(model_, gaps, impulses.r);
  VecX joint_impulse;
  if (!model_.joints.empty()) {
    report.joints = step_joints(model_, joints, solution.lambda, impulses.r, h);  // (MJT-12)
    report.joint_error = joint_error(model_, out.next);
    joint_impulse = solved.problem.H * impulses.of_joints + solved.problem.G * solution.lambda;
  }
  const VecX v_free_end = free_velocities(dofs_, v_end);
  report.energy =
      ledger(free, solved.problem.H * (solution.r - impulses.of_joints), joint_impulse, v_free_end,
             v_free_end - solution.v);  // (MJ-9)
  const double by_mass = change_of_mass(model_, state, out.next, free, dofs_, v_free_end);
  report.energy.kinetic_change += by_mass;
  report.energy.gyroscopic_work += by_mass;
  return out;
}

VecX MoreauJean::estimate(const State& state, double h) const {
  const VecX v_prescribed = prescribed_velocity(model_, state, h);
  const FreeMotion free = free_motion(model_, state, dofs_, h, options_.theta);
  VecX v = free.v_free;
  if (!model_.joints.empty()) {
    const JointEquations joints =
        joint_system(model_, state, dofs_, v_prescribed, h, options_.theta, options_.normal, options_.joints)
            .equations;
    FrictionProblem problem{
        .M = free.M, .H = SparseMatrix(dofs_.rows, 0), .f = free.f, .G = joints.G, .b = joints.b};
    if (const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G))
      v = free_velocity(problem, *inverse);
  }
  return all_velocities(dofs_, v, v_prescribed);
}

StepReport MoreauJean::step(State& state, double h_limit) const {
  const AdvancementOptions& o = options_.advancement;
  require_field(h_limit > 0, "h_limit", h_limit, "be positive [s]");
  const double begin = cpu_seconds();
  const double h_control = state.h_next > 0 ? std::min(options_.h, state.h_next) : options_.h;
  double h = std::min(h_control, h_limit);
  const double h_asked = h,
               min_h = std::min(o.min_h, h);  // what is left of a run may be shorter than any minimum
  VecX v_estimate = estimate(state, h);

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
