// SPDX-License-Identifier: Apache-2.0
#include "nsgs/solve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/check.hpp"
#include "nsgs/block_solver.hpp"
#include "nsgs/islands.hpp"
#include "nsgs/joint_elimination.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr double kFewDigits = 1e-6;  // of q are rounding: more digits are not asked for, else they are,
constexpr int kFurther = 5;          // by so many iterations
constexpr double kFiner = 1e-3;      // of the residual has the answer that errors are seen against,
constexpr double kExact = 1e-13;     // or this
constexpr double kGoodStart = 1e-3;  // residual of a start that need not be compared with none
constexpr double kOpening = 2;       // times as fast as what may push it: a block opens whatever that does

struct Solved {
  VecX r{}, u{};
  SolveReport report{};
};

// One island, or a problem without others: its operator, its start and, with bodies, their motion.
template <class Problem>
struct Part {
  Island island{};
  std::unique_ptr<const Problem> own{};  // of an island among others
  const Problem* problem = nullptr;      // that, or the whole
  VecX r0{};
  std::optional<MotionInverse> inverse{};  // of bodies; nothing if M is singular
  VecX v_free{};                           // M^-1 f, if it is known
  std::unique_ptr<Delassus> W{};           // nothing without contacts, or without `inverse`
  double cancelled = 0;  // the size, scaled as q is, that the rounding of q is relative to; 0: not known
  Solved solved{};
};

void open(Part<LocalProblem>& part) {
  if (!part.problem->laws.empty()) part.W = make_delassus(*part.problem);
}

// Bodies that fall together, or hang on one hinge, leave nothing but rounding in q.
double cancelled(const Part<FrictionProblem>& part) {
  const FrictionProblem& p = *part.problem;
  const VecX v_free = part.v_free.size() > 0 ? part.v_free : free_velocity(p, *part.inverse);
  VecX terms = p.w.cwiseAbs();
  for (int j = 0; j < p.H.outerSize(); ++j) {
    double sum = terms[j];
    for (SparseMatrix::InnerIterator it(p.H, j); it; ++it) sum += std::abs(it.value() * v_free[it.row()]);
    terms[j] = sum;
  }
  return part.W->scaled.s.cwiseProduct(terms).norm();
}

void open(Part<FrictionProblem>& part) {
  const FrictionProblem& problem = *part.problem;
  if (!part.inverse) part.inverse = invert_motion(problem.M, problem.G);
  if (!part.inverse || problem.laws.empty()) return;
  // One block is its own W: speeds of the bodies would only bring in their rounding.
  const bool few_contacts = problem.f.size() > 2 * problem.w.size() || problem.laws.size() == 1;
  const bool condensed =
      !part.inverse->mass.large.empty() || part.inverse->joints || problem.R.size() > 0 || few_contacts;
  part.W = condensed ? make_delassus(condense_with_inverse(problem, *part.inverse))
                     : make_delassus(problem, part.inverse->mass);
  part.cancelled = cancelled(part);
}

// The size of the scaled q; not a number if anything is not finite.
template <class Problem>
double size(const Part<Problem>& part) {
  if constexpr (std::is_same_v<Problem, FrictionProblem>)
    if (!part.inverse) return std::nan("");
  if (!part.W) return 0;
  return part.W->scaled.finite && part.r0.allFinite() ? part.W->scaled.size * part.W->scaled.q.norm()
                                                      : std::nan("");
}

// How far the velocities of `found` are from those of a better answer, relative to |q| (SOL-4).
double estimated_error(Delassus& W, const Iterate& found) {
  if (found.residual <= kExact) return found.residual;
  SolveReport unused;
  const Iterate better =
      automatic(W, found, {.tolerance = std::max(kFiner * found.residual, kExact)}, unused);
  return better.residual <= 0.1 * found.residual ? (better.u - found.u).norm() : kInf;
}

// Where q has digits enough an answer that is within its rounding is often a few iterations from the
// tolerance.
Iterate further(Delassus& W, const Iterate& start, SolverOptions options, SolveReport& report) {
  SolveReport more;
  options.max_iterations = kFurther;
  Iterate best = run_method(W, start, options, more);
  report.iterations += more.iterations;
  report.newton_iterations += more.newton_iterations;
  report.local_failures += more.local_failures;
  report.local_fail_safes += more.local_fail_safes;
  return best.residual < start.residual ? best : start;
}

// `floor`: the residual that the rounding of q leaves.
Solved solve_rows(Delassus& W, const VecX& r0, SolverOptions options, double floor) {
  Solved out;
  const double asked = options.tolerance;
  options.tolerance = std::min(std::max(asked, floor), 1.0);
  W.scaled.model = options.model;
  const Scaling& scaled = W.scaled;
  Iterate start;
  if (r0.size() > 0 && !scaled.q.isZero(0)) start = judged(W, scaled_start(scaled, r0), options.method);
  if (start.residual > kGoodStart)
    if (Iterate none = judged(W, scaled_start(scaled, {}), options.method); !(start.residual < none.residual))
      start = std::move(none);
  Iterate best = start.residual <= options.tolerance ? start : run_method(W, start, options, out.report);
  if (best.residual > asked && best.residual <= floor && floor <= kFewDigits) {
    options.tolerance = asked;
    best = further(W, best, options, out.report);
  }
  if (best.residual > asked && (best.residual <= std::min(floor, 1.0) || is_at_rounding(W, best)))
    out.report.status = SolveStatus::at_rounding;
  if (options.estimate_error && options.model == FrictionModel::coulomb)
    out.report.error = estimated_error(W, best);
  out.report.residual = out.report.worst_island = best.residual;
  out.report.coulomb_residual = natural_map(best.u, best.r, scaled.laws);
  out.report.found_by = best.by;
  out.r = scaled.size * scaled.s.cwiseProduct(best.r);
  out.u = scaled.size * best.u.cwiseQuotient(scaled.s);
  return out;
}

// Reports of islands make one: the worst status, the longest iteration, all work, the worst residual, and
// what makes the residual of the whole, with the size of the island's q still in it.
void add(SolveReport& total, const SolveReport& part, double q) {
  total.status = std::max(total.status, part.status);
  total.iterations = std::max(total.iterations, part.iterations);
  total.newton_iterations += part.newton_iterations;
  total.local_failures += part.local_failures;
  total.local_fail_safes += part.local_fail_safes;
  total.worst_island = std::max(total.worst_island, part.worst_island);
  total.error = std::max(total.error, part.error);
  total.residual = std::hypot(total.residual, q * part.residual);
  total.coulomb_residual = std::hypot(total.coulomb_residual, q * part.coulomb_residual);
}

void put(const VecX& part, const std::vector<int>& rows, VecX& whole) {
  for (std::size_t i = 0; i < rows.size(); ++i) whole[rows[i]] = part[Eigen::Index(i)];
}

void put_motion(const Part<LocalProblem>&, const VecX&, FrictionSolution&) {}
void put_motion(const Part<FrictionProblem>& part, const VecX& r, FrictionSolution& out) {
  if (!part.inverse) return;
  if (part.v_free.size() > 0) {
    put(part.v_free + part.inverse->mass * (part.problem->H * r), part.island.dofs, out.v);
    return;
  }
  const JointedMotion moved = motion(*part.problem, *part.inverse, r);
  put(moved.v, part.island.dofs, out.v);
  put(moved.lambda, part.island.joints, out.lambda);
}

void set_known(const KnownMotion& known, const std::vector<int>& dofs, Part<FrictionProblem>& now) {
  now.inverse = MotionInverse{.mass = inverse_part(known.inverse, dofs)};
  now.v_free = known.v_free(dofs);
}

// Islands into `out`, in the order given. `size_done` is the size of the scaled q of what is solved already.
template <class Problem>
void solve_islands(const Problem& problem, std::vector<Island> all, const KnownMotion* known, const VecX& r0,
                   double size_done, const SolverOptions& options, FrictionSolution& out) {
  std::vector<Part<Problem>> parts;
  parts.reserve(all.size());
  std::vector<int> scratch;
  for (Island& island : all) {
    Part<Problem>& now = parts.emplace_back();
    if (!is_whole(problem, island))  // in place: sparse matrices are copied where others are moved
      now.own.reset(new Problem(island_problem(problem, island, scratch)));
    now.problem = now.own ? now.own.get() : &problem;
    if (r0.size() > 0) now.r0 = r0(island.rows);
    if constexpr (std::is_same_v<Problem, FrictionProblem>)
      if (known) set_known(*known, island.dofs, now);
    now.island = std::move(island);
  }
  const auto each = [&](auto&& f) { for_all(options, int(parts.size()), [&](int i) { f(parts[i]); }); };
  each([](Part<Problem>& now) { open(now); });
  double whole = size_done;
  for (const Part<Problem>& now : parts)
    if (const double q = size(now); std::isfinite(q)) whole = std::hypot(whole, q);
  each([&](Part<Problem>& now) {
    const double q = size(now);
    now.solved.r.setZero(Eigen::Index(now.island.rows.size()));
    if (now.W && std::isfinite(q))
      now.solved = solve_rows(*now.W, now.r0, options, q > 0 ? kCancellation * now.cancelled / q : 0);
  });
  std::size_t largest = 0;
  for (Part<Problem>& now : parts) {
    const double q = size(now);
    if (!std::isfinite(q)) {
      add(out.report,
          {.status = SolveStatus::not_finite,
           .residual = kInf,
           .worst_island = kInf,
           .coulomb_residual = kInf},
          1);
      continue;
    }
    if (now.W) {
      add(out.report, now.solved.report, q);
      if (now.island.blocks.size() > largest) {
        largest = now.island.blocks.size();
        out.report.found_by = now.solved.report.found_by;
      }
      put(now.solved.u, now.island.rows, out.u);
    }
    put(now.solved.r, now.island.rows, out.r);
    put_motion(now, now.solved.r, out);
  }
  if (whole > 0) out.report.residual /= whole, out.report.coulomb_residual /= whole;
}

std::vector<char> lone_blocks(const std::vector<int>& leader) {
  std::vector<char> lone(leader.size(), 1);
  for (std::size_t c = 0; c < leader.size(); ++c)
    if (std::size_t(leader[c]) != c) lone[c] = lone[leader[c]] = 0;
  return lone;
}

// Blocks that feel no other, solved as a sweep would: grains in the air and single supports are many, and
// take no part in anything dear. What is not solved at once is taken out of `lone`. Returns the size of the
// scaled q of the others.
template <int R>
double solve_lone_blocks(const LocalProblem& problem, const VecX& r0, const SolverOptions& options,
                         std::vector<char>& lone, FrictionSolution& out) {
  if (std::ranges::find(lone, 1) == lone.end()) return 0;
  const VecX all_scales = scales(problem.W.diagonal(), problem.laws);
  double size = 0;
  Eigen::Index next = 0;
  for (std::size_t c = 0; c < lone.size(); ++c) {
    const int rows = problem.laws[c].rows;
    const Eigen::Index k = std::exchange(next, next + rows);
    if (!lone[c]) continue;
    const Rows<R> s = all_scales.segment<R>(k, rows);
    Rows<R> q = s.cwiseProduct(problem.q.segment<R>(k, rows));
    const double own = q.norm(), unit = own > 0 ? own : 1;
    lone[c] = are_scales(s) && std::isfinite(own);
    if (!lone[c]) continue;
    q /= unit;
    const Law law = scaled(problem.laws[c], s.data(), unit);
    RowBlock<R> W(rows, rows);
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < rows; ++i) W(i, j) = problem.W.coeff(k + i, k + j) * s[i] * s[j];
    const auto residual = [&](const Rows<R>& r) {
      return (r - project<R>(law, r - modified_velocity<R>(law, Rows<R>(W * r + q)))).norm();
    };
    Rows<R> r = Rows<R>::Zero(rows);
    SolveReport report{.found_by = Method::nsgs, .residual = residual(r)};
    if (r0.size() > 0)
      if (const Rows<R> warm = project<R>(law, r0.segment<R>(k, rows).cwiseQuotient(s) / unit);
          residual(warm) < report.residual)
        r = warm, report.residual = residual(r);
    const auto exact = [&] { return solve_block(prepare_block(W, law), q, law, r, options.local).r; };
    if (report.residual > options.tolerance) {
      r = exact();
      report.residual = residual(r);
      report.iterations = 1;
    }
    lone[c] = report.residual <= options.tolerance;
    if (!lone[c]) continue;
    if (options.estimate_error) report.error = Rows<R>(W * (exact() - r)).norm();
    report.coulomb_residual = report.worst_island = report.residual;
    out.r.segment<R>(k, rows) = unit * s.cwiseProduct(r);
    out.u.segment<R>(k, rows) = unit * Rows<R>(W * r + q).cwiseQuotient(s);
    add(out.report, report, own);
    out.report.found_by = report.found_by;
    size = std::hypot(size, own);
  }
  return size;
}

void validate_start(const VecX& r0, Eigen::Index rows) {
  const std::string bound = "be 0 or " + std::to_string(rows) + ", the rows of laws";
  require_field(r0.size() == 0 || r0.size() == rows, "r0.size()", r0.size(), bound.c_str());
}

// Blocks without an impulse at the start that open whatever the others do (ISL-2): faster than twice what may
// push their bodies, and than their bodies move, each on its own.
std::vector<char> opening_blocks(const FrictionProblem& problem, const VecX& v_free, const VecX& r0) {
  const std::vector<int> first = first_rows(problem.laws);
  std::vector<char> opens(problem.laws.size());
  VecX u = problem.w, fastest = VecX::Zero(v_free.size());  // of the blocks that may push a velocity
  for (std::size_t c = 0; c < opens.size(); ++c) {
    const int k = first[c], rows = problem.laws[c].rows;
    double moves = 0;
    for (SparseMatrix::InnerIterator it(problem.H, k); it; ++it) {
      const double part = it.value() * v_free[it.row()];
      u[k] += part;
      moves += std::abs(part);
    }
    opens[c] = has_normal(problem.laws[c]) && u[k] > kOpening * moves &&
               (r0.size() == 0 || r0.segment(k, rows).isZero(0));
    if (opens[c]) continue;
    for (int j = k + 1; j < k + rows; ++j) u[j] += problem.H.col(j).dot(v_free);
    const double speed = u.segment(k, rows).norm();
    for (SparseMatrix::InnerIterator it(problem.H, k); it; ++it)
      fastest[it.row()] = std::max(fastest[it.row()], speed);
  }
  for (std::size_t c = 0; c < opens.size(); ++c)
    for (SparseMatrix::InnerIterator it(problem.H, first[c]); it && opens[c]; ++it)
      opens[c] = u[first[c]] > kOpening * fastest[it.row()];
  return opens;
}

// Velocities of the blocks left out. Those that close, or are not finite, are taken in (ISL-3), `with_all` of
// their island of the whole problem; whether there are any.
bool take_in(const FrictionProblem& problem, bool with_all, FrictionSolution& out,
             std::vector<char>& left_out) {
  std::vector<char> closes(left_out.size());
  int next = 0;
  for (std::size_t c = 0; c < left_out.size(); ++c) {
    const int k = std::exchange(next, next + problem.laws[c].rows);
    if (!left_out[c]) continue;
    for (int j = k; j < next; ++j) out.u[j] += problem.H.col(j).dot(out.v);
    closes[c] = !(out.u[k] >= 0 && out.u.segment(k, next - k).allFinite());
  }
  if (std::ranges::find(closes, 1) == closes.end()) return false;
  if (with_all)
    for (const Island& island : islands(problem))
      if (std::ranges::any_of(island.blocks, [&](int c) { return closes[c]; }))
        for (const int c : island.blocks) closes[c] = 1;
  for (std::size_t c = 0; c < closes.size(); ++c)
    if (closes[c]) left_out[c] = 0;
  return true;
}

FrictionSolution solve_bodies(const FrictionProblem& problem, const KnownMotion* known, const VecX& r0,
                              const SolverOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.w.size());
  FrictionSolution without{.v = known ? known->v_free : VecX::Zero(problem.f.size()),
                           .u = problem.w,
                           .r = VecX::Zero(problem.w.size()),
                           .lambda = VecX::Zero(problem.b.size())};
  if (known && problem.laws.empty()) return without;
  const bool screened = known && options.model == FrictionModel::coulomb;
  std::vector<char> left_out =
      screened ? opening_blocks(problem, known->v_free, r0) : std::vector<char>(problem.laws.size(), 0);
  SolveReport before;
  for (int pass = 1;; ++pass) {  // each from the same start: islands do not feel that others are solved again
    FrictionSolution out = without;
    std::vector<Island> all = islands(problem, left_out);
    if (known && !all.empty() && all.back().blocks.empty()) all.pop_back();  // what feels no contact
    solve_islands(problem, std::move(all), known, r0, 0, options, out);
    out.report.iterations += before.iterations;
    out.report.newton_iterations += before.newton_iterations;
    out.report.local_failures += before.local_failures;
    out.report.local_fail_safes += before.local_fail_safes;
    if (!take_in(problem, pass > 1, out, left_out)) return out;
    before = out.report;
  }
}

}  // namespace

FrictionSolution solve(const LocalProblem& problem, const VecX& r0, const SolverOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.q.size());
  FrictionSolution out{.u = problem.q, .r = VecX::Zero(problem.q.size())};
  const std::vector<int> leader = leaders(problem);
  std::vector<char> lone;
  double size_done = 0;
  const bool sweeps = options.method == Method::automatic || options.method == Method::nsgs;
  if (sweeps && problem.q.allFinite() && r0.allFinite()) {
    lone = lone_blocks(leader);
    with_rows(problem.laws,
              [&]<int R>() { size_done = solve_lone_blocks<R>(problem, r0, options, lone, out); });
  }
  solve_islands(problem, islands(problem, leader, lone), nullptr, r0, size_done, options, out);
  return out;
}

FrictionSolution solve(const FrictionProblem& problem, const VecX& r0, const SolverOptions& options) {
  return solve_bodies(problem, nullptr, r0, options);
}

FrictionSolution solve(const FrictionProblem& problem, const KnownMotion& known, const VecX& r0,
                       const SolverOptions& options) {
  return solve_bodies(problem, problem.G.cols() > 0 ? nullptr : &known, r0, options);
}

}  // namespace aussois
