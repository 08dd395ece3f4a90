// SPDX-License-Identifier: Apache-2.0
#include "nsgs/nsgs.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/check.hpp"
#include "nsgs/cone.hpp"
#include "nsgs/mass_inverse.hpp"
#include "nsgs/proximal_newton.hpp"
#include "nsgs/residual.hpp"

namespace aussois {

namespace {

// Measured on random pegs in holes, doc/theory/proximal_newton.md; factors of 10 either way cost little.
constexpr int kPatience = 1000;          // sweeps without halving the best residual
constexpr double kFirstAlpha = 1e-3;     // compliance of the first proximal step
constexpr double kSmallestAlpha = 1e-8;  // 1e-6 left 1 of 2000 problems above 1e-12
constexpr double kLargestAlpha = 1e3;
constexpr int kProximalSteps = 60;
constexpr int kEasyStep = 5;     // Newton iterations
constexpr int kDearNewton = 10;  // windows are this much longer where Newton needs sparse factorisations

// What both phases need to know of the contacts. The two forms below hold it and have the same members
// besides:
//   restart(r)      makes the velocities those of r, afresh: rounding does not pile up from sweep to sweep
//   velocity(c, r)  u_c for the impulses of the last restart and the changes added since
//   add(c, dr)      r_c has changed by dr
//   newton()        the second phase for it, in velocity_count() unknowns
struct Contacts {
  std::vector<Mat3> W_cc{};
  std::vector<double> w_c{}, mu{};
  VecX q{};
  int count() const { return int(mu.size()); }
};

// On the Delassus operator (NSGS-4): velocities are computed from all impulses when asked for.
class DelassusForm {
 public:
  explicit DelassusForm(const LocalProblem& problem)
      : contacts{.w_c = contact_scales(problem.W), .mu = problem.mu, .q = problem.q}, problem_(problem) {
    for (int c = 0; c < problem.contact_count(); ++c) contacts.W_cc.push_back(problem.W.diagonal(c));
  }
  Contacts contacts{};
  void restart(const VecX&) {}
  Vec3 velocity(int c, const VecX& r) const {
    return problem_.W.row_times(c, r) + problem_.q.segment<3>(3 * Eigen::Index(c));
  }
  void add(int, const Vec3&) {}
  Eigen::Index velocity_count() const { return problem_.q.size(); }
  ProximalNewton newton() const { return {problem_, contacts.w_c}; }

 private:
  const LocalProblem& problem_;
};

// Matrix-free (NSGS-5): v follows the impulses; a contact reads and writes only the rows that its columns
// touch.
class VelocityForm {
 public:
  VelocityForm(const FrictionProblem& problem, const MassInverse& inverse)
      : contacts{.mu = problem.mu}, problem_(problem), v_free_(inverse * problem.f), v_(v_free_) {
    const SparseMatrix Y = inverse * problem.H;
    begin_.push_back(0);
    for (int c = 0; c < problem.contact_count(); ++c) {
      append(c, Y);
      Mat3 W_cc = Mat3::Zero();
      for (std::size_t k = begin_[std::size_t(c)]; k < begin_.back(); ++k)
        W_cc += arms_[k].H * arms_[k].Y.transpose();
      contacts.W_cc.push_back(W_cc);
      contacts.w_c.push_back(W_cc.trace() / 3);
    }
    contacts.q.resize(problem.w.size());
    for (int c = 0; c < problem.contact_count(); ++c)
      contacts.q.segment<3>(3 * Eigen::Index(c)) = velocity(c, contacts.q);
  }
  Contacts contacts{};
  void restart(const VecX& r) {
    v_ = v_free_;
    for (int c = 0; c < contacts.count(); ++c) add(c, r.segment<3>(3 * Eigen::Index(c)));
  }
  Vec3 velocity(int c, const VecX&) const {
    Vec3 u = problem_.w.segment<3>(3 * Eigen::Index(c));
    for (std::size_t k = begin_[std::size_t(c)]; k < begin_[std::size_t(c) + 1]; ++k)
      u += arms_[k].H * v_[arms_[k].row];
    return u;
  }
  void add(int c, const Vec3& dr) {
    for (std::size_t k = begin_[std::size_t(c)]; k < begin_[std::size_t(c) + 1]; ++k)
      v_[arms_[k].row] += arms_[k].Y.dot(dr);
  }
  const VecX& v() const { return v_; }
  Eigen::Index velocity_count() const { return v_.size(); }
  ProximalNewton newton() const { return {problem_, contacts.w_c}; }

 private:
  struct Arm {  // one row of the three columns of a contact, in H and in M^-1 H
    Vec3 H = Vec3::Zero(), Y = Vec3::Zero();
    Eigen::Index row = 0;
  };

  void append(int c, const SparseMatrix& Y) {
    std::vector<Eigen::Index> rows;
    for (int j = 3 * c; j < 3 * c + 3; ++j) {
      for (SparseMatrix::InnerIterator it(problem_.H, j); it; ++it) rows.push_back(it.row());
      for (SparseMatrix::InnerIterator it(Y, j); it; ++it) rows.push_back(it.row());
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (const Eigen::Index row : rows) {
      Arm arm{.row = row};
      for (int j = 0; j < 3; ++j) {
        arm.H[j] = problem_.H.coeff(row, 3 * c + j);
        arm.Y[j] = Y.coeff(row, 3 * c + j);
      }
      arms_.push_back(arm);
    }
    begin_.push_back(arms_.size());
  }

  const FrictionProblem& problem_;
  std::vector<Arm> arms_{};
  std::vector<std::size_t> begin_{};
  VecX v_free_{}, v_{};
};

struct Iterate {
  VecX r{}, u{};
  double residual = kInf;
  bool by_newton = false;
};

// The velocities of r afresh, and what the judge says of them. A residual that is not a number becomes
// infinite.
template <class Form>
Iterate judged(Form& form, const VecX& r) {
  const Contacts& contacts = form.contacts;
  Iterate iterate{.r = r, .u = VecX(r.size())};
  form.restart(r);
  for (int c = 0; c < contacts.count(); ++c) iterate.u.segment<3>(3 * Eigen::Index(c)) = form.velocity(c, r);
  const double residual = scaled_residual(iterate.u, r, contacts.q, contacts.w_c, contacts.mu);
  iterate.residual = std::isfinite(residual) ? residual : kInf;
  return iterate;
}

// One pass over the contacts in their order (NSGS-4).
template <class Form>
VecX sweep(Form& form, VecX r, const NsgsOptions& options, SolveReport& report) {
  const Contacts& contacts = form.contacts;
  for (int c = 0; c < contacts.count(); ++c) {
    const Eigen::Index k = 3 * Eigen::Index(c);
    const Vec3 r_old = r.segment<3>(k);
    const Vec3 u = form.velocity(c, r);
    if (u[0] >= 0 && r_old[0] == 0) continue;  // stays open (NSGS-6)
    const Mat3& W = contacts.W_cc[std::size_t(c)];
    const LocalSolution local =
        solve_one_contact(W, u - W * r_old, contacts.mu[std::size_t(c)], r_old, options.local);
    report.local_failures += !local.solved && options.local != LocalSolver::projection;
    report.local_fail_safes += local.fail_safe;
    const Vec3 dr = options.relaxation * (local.r - r_old);
    r.segment<3>(k) += dr;
    form.add(c, dr);
  }
  return r;
}

// Proximal steps (PROX-7). The centre walks on while Newton solves the steps, even where the residual rests
// on a plateau for a while; what is returned is the best iterate met.
template <class Form>
Iterate newton_phase(Form& form, const ProximalNewton& newton, Iterate best, double alpha,
                     const NsgsOptions& options, SolveReport& report) {
  Iterate center = best;
  for (int step = 0; step < kProximalSteps && best.residual > options.tolerance && alpha <= kLargestAlpha;
       ++step) {
    const ProximalStep proximal = newton.step(center.r, center.u, alpha);
    report.newton_iterations += proximal.iterations;
    Iterate iterate = judged(form, proximal.r);
    iterate.by_newton = true;
    if (proximal.solved || iterate.residual < best.residual) center = iterate;
    if (iterate.residual < best.residual) best = iterate;
    if (!proximal.solved)
      alpha *= 4;
    else
      alpha = std::max(alpha / (proximal.iterations <= kEasyStep ? 10 : 3), kSmallestAlpha);
  }
  return best;
}

VecX start_in_the_cones(const VecX& r0, const std::vector<double>& mu) {
  VecX r = r0.size() == 0 ? VecX(VecX::Zero(3 * Eigen::Index(mu.size()))) : r0;
  for (std::size_t c = 0; c < mu.size(); ++c) {
    const Eigen::Index k = 3 * Eigen::Index(c);
    r.segment<3>(k) = project_cone(r.segment<3>(k), mu[c]);
  }
  return r;
}

bool is_finite(const Contacts& contacts) {
  return contacts.q.allFinite() && std::all_of(contacts.w_c.begin(), contacts.w_c.end(),
                                               [](double w) { return std::isfinite(w) && w > 0; });
}

// Both phases (NSGS-7): sweeps while they contract well, Newton when they do not, sweeps again where Newton
// fails.
template <class Form>
FrictionSolution solve(Form& form, const VecX& r0, const NsgsOptions& options) {
  const Contacts& contacts = form.contacts;
  SolveReport report;
  Iterate best{.r = VecX::Zero(contacts.q.size()), .u = contacts.q};
  if (!is_finite(contacts) || !r0.allFinite()) {
    report.status = SolveStatus::not_finite;
    report.residual = kInf;
    return {.u = best.u, .r = best.r, .report = report};
  }
  best = judged(form, start_in_the_cones(r0, contacts.mu));
  if (const Iterate zero = judged(form, VecX::Zero(contacts.q.size())); zero.residual < best.residual)
    best = zero;

  std::optional<ProximalNewton> newton;
  double alpha = kFirstAlpha;
  int window = options.handover_after * (ProximalNewton::is_cheap(form.velocity_count()) ? 1 : kDearNewton);
  int window_start = 0, halved_at = 0;
  double window_residual = best.residual, halved = best.residual;
  Iterate swept = best;
  form.restart(swept.r);
  report.status = SolveStatus::max_iterations;
  while (best.residual > options.tolerance && report.iterations < options.max_iterations) {
    swept.r = sweep(form, std::move(swept.r), options, report);
    ++report.iterations;
    if (report.iterations % options.check_every != 0 && report.iterations != options.max_iterations) continue;
    swept = judged(form, swept.r);
    if (swept.residual == kInf) {
      report.status = SolveStatus::not_finite;
      break;
    }
    if (swept.residual < best.residual) best = swept;
    if (best.residual <= halved / 2) halved = best.residual, halved_at = report.iterations;
    if (report.iterations - halved_at >= kPatience) {
      report.status = SolveStatus::stagnated;
      break;
    }
    if (window == 0 || report.iterations - window_start < window) continue;
    const double expected =
        swept.residual * std::min(swept.residual / window_residual, 1.0);  // one more window on
    if (best.residual > options.tolerance && expected > options.tolerance) {
      if (!newton) newton.emplace(form.newton());
      const Iterate found = newton_phase(form, *newton, swept, alpha, options, report);
      if (found.residual < best.residual) best = found;
      // Where Newton fails, the sweeps go on from where they were and get more room before it is asked again:
      // it then starts elsewhere, and more cautiously.
      form.restart(swept.r);
      window *= 2;
      alpha = std::min(10 * alpha, 1.0);
    }
    window_start = report.iterations;
    window_residual = swept.residual;
  }
  if (best.residual <= options.tolerance) report.status = SolveStatus::converged;
  report.residual = best.residual;
  report.finished_by_newton = best.by_newton;
  form.restart(best.r);
  return {.u = best.u, .r = best.r, .report = report};
}

void validate_start(const VecX& r0, int contacts) {
  require_field(r0.size() == 0 || r0.size() == 3 * contacts, "r0.size()", r0.size(), "be 0 or 3 mu.size()");
}

FrictionSolution nothing_finite(const FrictionProblem& problem) {
  FrictionSolution solution{
      .v = VecX::Zero(problem.f.size()), .u = problem.w, .r = VecX::Zero(problem.w.size())};
  solution.report.status = SolveStatus::not_finite;
  solution.report.residual = kInf;
  return solution;
}

}  // namespace

const char* to_string(SolveStatus status) {
  switch (status) {
    case SolveStatus::converged:
      return "converged";
    case SolveStatus::stagnated:
      return "stagnated";
    case SolveStatus::max_iterations:
      return "max_iterations";
    case SolveStatus::not_finite:
      return "not_finite";
  }
  return "unknown";
}

void validate(const NsgsOptions& options) {
  require_field(options.tolerance > 0 && options.tolerance < 1, "NsgsOptions::tolerance", options.tolerance,
                "lie in (0, 1)");
  require_field(options.max_iterations >= 1, "NsgsOptions::max_iterations", options.max_iterations,
                "be >= 1");
  require_field(options.relaxation > 0 && options.relaxation <= 1, "NsgsOptions::relaxation",
                options.relaxation, "lie in (0, 1]");
  require_field(options.check_every >= 1, "NsgsOptions::check_every", options.check_every, "be >= 1");
  require_field(options.handover_after >= 0, "NsgsOptions::handover_after", options.handover_after,
                "be >= 0");
}

FrictionSolution solve_nsgs(const LocalProblem& problem, const VecX& r0, const NsgsOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.contact_count());
  DelassusForm form(problem);
  return solve(form, r0, options);
}

FrictionSolution solve_nsgs(const FrictionProblem& problem, const VecX& r0, const NsgsOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.contact_count());
  const std::optional<MassInverse> inverse = invert_mass(problem.M);
  if (!inverse) return nothing_finite(problem);
  if (inverse->factor) {
    const LocalProblem local = condense(problem);
    FrictionSolution solution = solve_nsgs(local, r0, options);
    solution.v = *inverse * VecX(problem.f + problem.H * solution.r);
    return solution;
  }
  VelocityForm form(problem, *inverse);
  FrictionSolution solution = solve(form, r0, options);
  solution.v = form.v();
  return solution;
}

}  // namespace aussois
