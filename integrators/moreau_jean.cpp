// SPDX-License-Identifier: Apache-2.0
#include "integrators/moreau_jean.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <sstream>

#include "geometry/check.hpp"
#include "lmd/broad_phase.hpp"
#include "lmd/certificate.hpp"

namespace aussois {
namespace {

double cpu_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

RigidMotion motion_of(const State& state, const VecX& v, int body) {
  return {.g = pose(state, body), .v = v.segment<3>(6 * body), .omega = v.segment<3>(6 * body + 3)};
}

MovingShape moving_shape(const Model& model, const State& state, const VecX& v, int body) {
  const RigidBody& b = model.bodies[std::size_t(body)];
  return {
      .shape = model.shapes[std::size_t(b.shape)].get(), .g_bs = b.g_bs, .motion = motion_of(state, v, body)};
}

PosedShape posed_shape(const Model& model, const State& state, int body) {
  const RigidBody& b = model.bodies[std::size_t(body)];
  return {
      .shape = model.shapes[std::size_t(b.shape)].get(), .g_ws = pose(state, body) * b.g_bs, .body = body};
}

// Velocities of all bodies: the dynamic rows from `v`, the others as prescribed.
VecX all_velocities(const DofMap& dofs, const VecX& v, const VecX& v_prescribed) {
  VecX all = v_prescribed;
  for (std::size_t b = 0; b < dofs.first.size(); ++b)
    if (dofs.first[b] >= 0) all.segment<6>(6 * Eigen::Index(b)) = v.segment<6>(dofs.first[b]);
  return all;
}

// What has to be solved, and its solution so far.
struct Solved {
  std::vector<int> kept{};
  FrictionProblem problem{};
  FrictionSolution solution{};
};

// The reduced problem first; a contact that was left out and would close too far re-enters, the worst of each
// cluster at a time, until none does: what is returned satisfies every contact that was found (RED-4).
Solved solve_with_reduction(const FreeMotion& free, const DofMap& dofs, const std::vector<ContactRow>& rows, const Selection& selection,
                            const std::vector<Vec3>& warm, const std::vector<double>& allowed_speed,
                            const NsgsOptions& options) {
  Solved out;
  std::vector<char> in(rows.size(), 0);
  for (int i : selection.kept)
    if (rows[std::size_t(i)].active) in[std::size_t(i)] = 1;
  std::vector<Vec3> r(rows.size(), Vec3::Zero());
  for (std::size_t i = 0; i < rows.size(); ++i) r[i] = rows[i].frame.transpose() * warm[i];
  SolveReport total;
  for (;;) {
    out.kept.clear();
    for (int i = 0; i < int(rows.size()); ++i)
      if (in[std::size_t(i)]) out.kept.push_back(i);
    out.problem = contact_problem(free, dofs, rows, out.kept);
    VecX r0(3 * Eigen::Index(out.kept.size()));
    for (std::size_t k = 0; k < out.kept.size(); ++k)
      r0.segment<3>(3 * Eigen::Index(k)) = r[std::size_t(out.kept[k])];
    out.solution = solve_nsgs(out.problem, r0, options);
    total.iterations += out.solution.report.iterations;
    total.newton_iterations += out.solution.report.newton_iterations;
    total.local_failures += out.solution.report.local_failures;
    total.local_fail_safes += out.solution.report.local_fail_safes;
    for (std::size_t k = 0; k < out.kept.size(); ++k)
      r[std::size_t(out.kept[k])] = out.solution.r.segment<3>(3 * Eigen::Index(k));
    if (!out.solution.v.allFinite()) break;

    std::vector<int> worst(std::size_t(selection.cluster_count), -1);
    std::vector<double> excess(worst.size(), 0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (in[i] || !rows[i].active) continue;
      const auto cluster = std::size_t(selection.cluster[i]);
      const double closing = -relative_velocity(rows[i], dofs, out.solution.v).x() - allowed_speed[i];
      if (closing > excess[cluster]) excess[cluster] = closing, worst[cluster] = int(i);
    }
    bool again = false;
    for (int i : worst)
      if (i >= 0) in[std::size_t(i)] = 1, again = true;
    if (!again) break;
  }
  const SolveReport last = out.solution.report;
  out.solution.report = total;
  out.solution.report.status = last.status;
  out.solution.report.residual = last.residual;
  out.solution.report.finished_by_newton = last.finished_by_newton;
  return out;
}

EnergyLedger ledger(const FreeMotion& free, const VecX& contact_impulse, const VecX& v) {
  const VecX change = v - free.v, middle = (v + free.v) / 2;
  return {.kinetic_change = middle.dot(free.mass * change),
          .gravity_work = middle.dot(free.gravity),
          .law_work = middle.dot(free.laws - free.law_D * change),
          .contact_work = middle.dot(contact_impulse),
          .gyroscopic_work = middle.dot(free.gyroscopic - free.gyroscopic_D * change)};
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
  const AdvancementOptions& a = o.advancement;
  require_field(a.enlargement >= 1 && a.enlargement <= 4, "AdvancementOptions::enlargement", a.enlargement,
                "lie in [1, 4]");
  require_field(a.floor > 0 && a.floor <= 1, "AdvancementOptions::floor", a.floor, "lie in (0, 1]");
  require_field(a.max_overlap >= 0 && a.max_overlap <= 0.99, "AdvancementOptions::max_overlap", a.max_overlap,
                "lie in [0, 0.99]");
  require_field(a.min_h > 0 && a.min_h <= o.h, "AdvancementOptions::min_h", a.min_h, "lie in (0, h]");
  require_field(a.growth >= 1 && a.growth <= 4, "AdvancementOptions::growth", a.growth, "lie in [1, 4]");
  require_field(a.max_attempts >= 1, "AdvancementOptions::max_attempts", a.max_attempts, "be at least 1");
  validate(o.lmd);
  validate(o.reduction);
  validate(o.nsgs);
}

// Two shapes that can touch in this step.
struct MoreauJean::Pair {
  int a = 0, b = 0;      // bodies
  double dilation = 0;   // sum of the two [m]
  double threshold = 0;  // contacts are looked for up to this gap [m]
  double rotation = 0;   // bound of the relative rotation [rad]
};

struct MoreauJean::Attempt {
  enum class Outcome { accepted, bound_exceeded, not_certified, not_solved, not_finite };
  Outcome outcome = Outcome::accepted;
  VecX v{};           // dynamic rows at the end
  VecX v_position{};  // all rows: what moved the bodies
  State next{};
  StepReport report{};
};

MoreauJean::MoreauJean(const Model& model, const MoreauJeanOptions& options)
    : model_(model), options_(options), dofs_(dof_map(model)) {
  validate(options);
  validate(model);
  options_.lmd.threads = options.threads;
  int undilated = 0;
  bool dynamic_undilated = false;
  for (const RigidBody& body : model.bodies) {
    radius_.push_back(
        body.shape < 0 ? 0
                       : radius_about(transformed(model.shapes[std::size_t(body.shape)]->complex, body.g_bs),
                                      Vec3::Zero()));
    if (body.shape < 0 || model.shapes[std::size_t(body.shape)]->radius > 0) continue;
    ++undilated;
    dynamic_undilated = dynamic_undilated || is_dynamic(body);
  }
  require(!options_.advancement.certify || undilated < 2 || !dynamic_undilated,
          "two bodies that can touch have dilation 0: at least one of them needs a positive one [m]");
}

std::vector<MoreauJean::Pair> MoreauJean::near_pairs(const State& state, const VecX& v_estimate,
                                                     double h) const {
  const AdvancementOptions& o = options_.advancement;
  const VecX v = o.enlargement * v_estimate;
  std::vector<int> body_of;
  std::vector<Ball> balls;
  for (int b = 0; b < int(model_.bodies.size()); ++b) {
    const RigidBody& body = model_.bodies[std::size_t(b)];
    if (body.shape < 0) continue;
    const LmdShape& shape = *model_.shapes[std::size_t(body.shape)];
    const double reach = displacement_bound(motion_of(state, v, b), radius_[std::size_t(b)], h);
    balls.push_back({pose(state, b) * (body.g_bs * shape.centre),
                     shape.bounding_radius + (1 + o.floor) * shape.radius + reach});
    body_of.push_back(b);
  }
  std::vector<Pair> pairs;
  for (const auto& [i, j] : broad_phase(balls)) {
    Pair pair{.a = body_of[std::size_t(i)], .b = body_of[std::size_t(j)]};
    const RigidBody &a = model_.bodies[std::size_t(pair.a)], &b = model_.bodies[std::size_t(pair.b)];
    if (!is_dynamic(a) && !is_dynamic(b)) continue;
    const RigidMotion motion_a = motion_of(state, v, pair.a), motion_b = motion_of(state, v, pair.b);
    pair.dilation = model_.shapes[std::size_t(a.shape)]->radius + model_.shapes[std::size_t(b.shape)]->radius;
    pair.threshold = std::max(o.floor * pair.dilation,
                              relative_displacement_bound(motion_a, radius_[std::size_t(pair.a)], motion_b,
                                                          radius_[std::size_t(pair.b)], h));  // (CA-4)
    pair.rotation = std::min(relative_rotation_bound(motion_a, motion_b, h), 0.2);
    pairs.push_back(pair);
  }
  return pairs;
}

ContactSet MoreauJean::contacts_of(const State& state, const std::vector<Pair>& pairs) const {
  ContactSet all;
  for (const Pair& pair : pairs) {
    LmdOptions lmd = options_.lmd;
    lmd.threshold = pair.threshold;
    lmd.alpha =
        std::min(0.5, lmd.alpha + pair.rotation);  // contacts that the step's rotation can bring about
    lmd.alpha_ee = std::max(lmd.alpha_ee, lmd.alpha);
    const ContactSet found =
        find_contacts(posed_shape(model_, state, pair.a), posed_shape(model_, state, pair.b), lmd);
    all.points.insert(all.points.end(), found.points.begin(), found.points.end());
  }
  return all;  // pairs are sorted, so the whole set is
}

MoreauJean::Attempt MoreauJean::attempt(const State& state, const VecX& v_estimate, double h) const {
  Attempt out;
  StepReport& report = out.report;
  const double begin = cpu_seconds();

  const VecX v_prescribed = prescribed_velocity(model_, state, h);
  const FreeMotion free = free_motion(model_, state, dofs_, h, options_.theta);  // (MJ-4), (MJ-5)
  const std::vector<Pair> pairs = near_pairs(state, v_estimate, h);              // (CA-4)
  const ContactSet found = contacts_of(state, pairs);                            // (LMD-3)
  report.contacts_found = int(found.points.size());
  report.min_gap = smallest_gap(found);
  report.seconds_contact = cpu_seconds() - begin;

  const double solve_begin = cpu_seconds();
  const Selection selection = reduce(found, options_.reduction);                          // (RED-1)
  const WarmStart warm = warm_start(state.memory, found, state.h > 0 ? h / state.h : 1);  // (RED-5)
  const std::vector<ContactRow> rows =
      contact_rows(model_, state, found, v_prescribed, h, options_.normal);  // (MJ-6)
  std::vector<double> allowed;
  for (const ContactPoint& c : found.points) {
    const double dilation = model_.shapes[std::size_t(model_.bodies[std::size_t(c.a.body)].shape)]->radius +
                            model_.shapes[std::size_t(model_.bodies[std::size_t(c.b.body)].shape)]->radius;
    allowed.push_back(0.01 * dilation / h);
  }
  const Solved solved = solve_with_reduction(free, dofs_, rows, selection, warm.impulse, allowed,
                                             options_.nsgs);  // (NSGS-1)
  report.solve = solved.solution.report;
  report.contacts_kept = int(solved.kept.size());
  report.contacts_matched = warm.matched;
  report.seconds_solve = cpu_seconds() - solve_begin;

  out.v = solved.solution.v;
  if (!out.v.allFinite() || !free.f.allFinite()) {
    out.outcome = Attempt::Outcome::not_finite;
    report.reason = "a force or velocity is not finite";
    return out;
  }
  out.v_position =
      all_velocities(dofs_, options_.theta * out.v + (1 - options_.theta) * free.v, v_prescribed);  // (MJ-7)

  for (const Pair& pair : pairs) {  // (CA-5)
    const RigidMotion a = motion_of(state, out.v_position, pair.a),
                      b = motion_of(state, out.v_position, pair.b);
    const double moved =
        relative_displacement_bound(a, radius_[std::size_t(pair.a)], b, radius_[std::size_t(pair.b)], h);
    report.threshold = std::max(report.threshold, pair.threshold);
    if (moved > pair.threshold ||
        std::min(relative_rotation_bound(a, b, h), 0.2) > pair.rotation + options_.lmd.alpha) {
      std::ostringstream text;
      text << "bodies " << pair.a << " and " << pair.b << " may move by " << moved
           << " m, contacts were found within " << pair.threshold << " m";
      report.reason = text.str();
      out.outcome = Attempt::Outcome::bound_exceeded;
    }
  }
  const AdvancementOptions& o = options_.advancement;
  for (int b = 0; b < int(model_.bodies.size()); ++b) {  // pairs that were not even near
    const double moved = displacement_bound(motion_of(state, out.v_position, b), radius_[std::size_t(b)], h);
    const double reach =
        displacement_bound(motion_of(state, o.enlargement * v_estimate, b), radius_[std::size_t(b)], h);
    const int shape = model_.bodies[std::size_t(b)].shape;
    if (shape >= 0 && moved > reach + o.floor * model_.shapes[std::size_t(shape)]->radius) {
      report.reason = "body " + std::to_string(b) + " moved farther than its neighbours were looked for";
      out.outcome = Attempt::Outcome::bound_exceeded;
    }
  }
  if (out.outcome != Attempt::Outcome::accepted) return out;
  if (report.solve.status != SolveStatus::converged) {
    report.reason = std::string("the solver ended with ") + to_string(report.solve.status);
    out.outcome = Attempt::Outcome::not_solved;
  }

  const double certificate_begin = cpu_seconds();
  if (o.certify)
    for (const Pair& pair : pairs) {  // (CA-6)
      const double required = std::max(1e-3, 1 - o.max_overlap) * pair.dilation;
      const Certificate c = certify(
          moving_shape(model_, state, out.v_position, pair.a),
          moving_shape(model_, state, out.v_position, pair.b), h,
          {.required = required, .wanted = std::max(pair.dilation, required), .threads = options_.threads});
      report.certificate_rounds += int(c.rounds);
      report.min_base_distance = std::min(report.min_base_distance, c.min_distance);
      if (c.certified) continue;
      std::ostringstream text;
      text << "bodies " << pair.a << " and " << pair.b << ": base distance " << c.min_distance
           << " m is not proven to stay above " << required << " m";
      report.reason = text.str();
      out.outcome = Attempt::Outcome::not_certified;
      break;
    }
  report.seconds_certificate = cpu_seconds() - certificate_begin;
  if (out.outcome == Attempt::Outcome::not_certified) return out;

  out.next = state;  // (MJ-8)
  out.next.t = state.t + h;
  out.next.h = h;
  for (int b = 0; b < int(model_.bodies.size()); ++b) {
    pose(out.next, b) = pose_at(motion_of(state, out.v_position, b), h);
    if (const auto* prescribed = std::get_if<Prescribed>(&model_.bodies[std::size_t(b)].motion))
      pose(out.next, b) = evaluate(prescribed->path, out.next.t).pose;
  }
  out.next.v = all_velocities(dofs_, out.v, v_prescribed);
  ContactSet kept = select(found, solved.kept);
  std::vector<Vec3> impulses;
  for (std::size_t k = 0; k < solved.kept.size(); ++k) {
    impulses.push_back(rows[std::size_t(solved.kept[k])].frame *
                       solved.solution.r.segment<3>(3 * Eigen::Index(k)));
    report.contacts.push_back({kept.points[k], impulses.back()});
  }
  out.next.memory = remember(kept, impulses);
  report.t = out.next.t;
  report.h = h;
  report.physical = physical_residual(solved.solution.u, solved.solution.r, solved.problem.mu);
  report.energy = ledger(free, solved.problem.H * solved.solution.r, out.v);  // (MJ-9)
  report.seconds_total = cpu_seconds() - begin;
  return out;
}

StepReport MoreauJean::step(State& state, double h_limit) const {
  const AdvancementOptions& o = options_.advancement;
  double h = std::min(options_.h, h_limit);
  if (state.h > 0) h = std::min(h, o.growth * state.h);
  const FreeMotion free = free_motion(model_, state, dofs_, h, options_.theta);
  VecX v_estimate = all_velocities(dofs_, free.v_free, prescribed_velocity(model_, state, h));

  int unsolved = 0, enlarged = 0;
  double seconds = 0;
  StepReport last;
  for (int k = 1; k <= o.max_attempts && h >= o.min_h; ++k) {
    Attempt trial = attempt(state, v_estimate, h);
    seconds += trial.report.seconds_total > 0 ? trial.report.seconds_total
                                              : trial.report.seconds_contact + trial.report.seconds_solve;
    last = std::move(trial.report);
    last.attempts = k;
    last.seconds_total = seconds;
    switch (trial.outcome) {
      case Attempt::Outcome::not_finite:
        last.status = StepStatus::not_finite;
        last.t = state.t;
        return last;
      case Attempt::Outcome::not_solved:  // a shorter step is an easier problem; after that the report tells
        if (++unsolved <= 3 && h / 2 >= o.min_h) {
          h /= 2;
          break;
        }
        [[fallthrough]];
      case Attempt::Outcome::accepted:
        state = std::move(trial.next);
        return last;
      case Attempt::Outcome::bound_exceeded:
        v_estimate = trial.v_position;
        if (++enlarged % 4 == 0) h /= 2;
        break;
      case Attempt::Outcome::not_certified:
        h /= 2;
        break;
    }
  }
  last.status = StepStatus::refused;
  last.reason = "no step of at least " + std::to_string(o.min_h) + " s was accepted: " + last.reason;
  last.t = state.t;
  last.h = 0;
  return last;
}

ContactSet MoreauJean::contacts(const State& state, double threshold) const {
  std::vector<Pair> pairs = near_pairs(state, VecX::Constant(state.v.size(), 1.0), threshold);
  for (Pair& pair : pairs) pair.threshold = threshold, pair.rotation = 0;
  return contacts_of(state, pairs);
}

double MoreauJean::min_base_distance(const State& state, double cutoff) const {
  double distance = cutoff;
  const VecX rest = VecX::Zero(state.v.size());
  for (int a = 0; a < int(model_.bodies.size()); ++a)
    for (int b = a + 1; b < int(model_.bodies.size()); ++b) {
      const RigidBody &p = model_.bodies[std::size_t(a)], &q = model_.bodies[std::size_t(b)];
      if (p.shape < 0 || q.shape < 0 || (!is_dynamic(p) && !is_dynamic(q))) continue;
      distance = base_distance(moving_shape(model_, state, rest, a), moving_shape(model_, state, rest, b),
                               distance, options_.threads);
    }
  return distance;
}

}  // namespace aussois
