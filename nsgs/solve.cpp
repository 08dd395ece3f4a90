// SPDX-License-Identifier: Apache-2.0
#include "nsgs/solve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/check.hpp"
#include "nsgs/block_solver.hpp"
#include "nsgs/islands.hpp"
#include "nsgs/method.hpp"

namespace aussois {

namespace {

constexpr double kNoise = 1e-6;  // an island with less of the whole |q| is solved to that much of it only

struct Solved {
  VecX r{}, u{};
  SolveReport report{};
  double size = 0;  // of the scaled q
};

// One island, or a problem without others: its operator, its start and, with bodies, their motion.
template <class Problem>
struct Part {
  Island island{};
  Problem problem{};
  VecX r0{};
  std::optional<MotionInverse> inverse{};  // of bodies; nothing if M is singular
  std::unique_ptr<Delassus> W{};           // nothing without contacts, or without `inverse`
  std::optional<Solved> solved{};          // of a single block that needed no more
};

// A block that feels no other, solved as a sweep would; nothing if that is not enough. Grains in the air and
// single supports are many: they take no part in anything dear.
std::optional<Solved> solve_alone(const LocalProblem& problem, const Island& island, const VecX& r0,
                                  const SolverOptions& options) {
  const bool sweeps = options.method == Method::automatic || options.method == Method::nsgs;
  if (island.blocks.size() != 1 || !sweeps || !r0.allFinite()) return std::nullopt;
  const std::vector<Law> laws{problem.laws[std::size_t(island.blocks.front())]};
  const int first = island.rows.front(), rows = laws.front().rows;
  AnyBlock W(rows, rows);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < rows; ++i) W(i, j) = problem.W.coeff(first + i, first + j);
  const Scaling scaled = scaling(W.diagonal(), problem.q.segment(first, rows), laws);
  if (!scaled.finite || !W.allFinite()) return std::nullopt;
  W = AnyBlock(scaled.s.asDiagonal() * W * scaled.s.asDiagonal());
  return with_rows(laws, [&]<int R>() -> std::optional<Solved> {
    const Law& law = scaled.laws.front();
    const Rows<R> q = scaled.q;
    const RowBlock<R> W_R = W;
    const auto residual = [&](const Rows<R>& r) {
      return (r - project<R>(law, r - modified_velocity<R>(law, Rows<R>(W_R * r + q)))).norm();
    };
    Solved out{.size = scaled.size * scaled.q.norm()};
    Rows<R> r = Rows<R>::Zero(rows);
    out.report.residual = residual(r);
    if (r0.size() > 0) {
      const Rows<R> start = scaled_start(scaled, r0.segment(first, rows));
      if (const double warm = residual(start); warm < out.report.residual)
        r = start, out.report.residual = warm;
    }
    if (out.report.residual > options.tolerance) {
      r = solve_block(prepare_block(W_R, law), q, law, r, options.local).r;
      out.report.residual = residual(r);
      out.report.iterations = 1;
    }
    if (!(out.report.residual <= options.tolerance)) return std::nullopt;
    out.report.coulomb_residual = out.report.residual;
    out.report.found_by = Method::nsgs;
    out.r = scaled.size * scaled.s.cwiseProduct(VecX(r));
    out.u = scaled.size * VecX(W_R * r + q).cwiseQuotient(scaled.s);
    return out;
  });
}
std::optional<Solved> solve_alone(const FrictionProblem&, const Island&, const VecX&, const SolverOptions&) {
  return std::nullopt;
}

void open(Part<LocalProblem>& part) {
  if (!part.problem.laws.empty()) part.W = make_delassus(part.problem);
}

void open(Part<FrictionProblem>& part) {
  const FrictionProblem& problem = part.problem;
  part.inverse = invert_motion(problem.M, problem.G);
  if (!part.inverse || problem.laws.empty()) return;
  const bool few_contacts = problem.f.size() > 2 * problem.w.size();
  const bool condensed =
      part.inverse->mass.factor || part.inverse->joints || problem.R.size() > 0 || few_contacts;
  part.W = condensed ? make_delassus(condense(problem, *part.inverse))
                     : make_delassus(problem, part.inverse->mass);
}

// The size of the scaled q; not a number if anything is not finite.
template <class Problem>
double size(const Part<Problem>& part) {
  if constexpr (std::is_same_v<Problem, FrictionProblem>)
    if (!part.inverse) return std::nan("");
  if (part.solved) return part.solved->size;
  if (!part.W) return 0;
  return part.W->scaled.finite && part.r0.allFinite() ? part.W->scaled.size * part.W->scaled.q.norm()
                                                      : std::nan("");
}

Solved solve_rows(Delassus& W, const VecX& r0, const SolverOptions& options) {
  Solved out;
  W.scaled.model = options.model;
  const Scaling& scaled = W.scaled;
  Iterate start = judged(W, scaled_start(scaled, {}), options.method);
  if (r0.size() > 0)
    if (Iterate warm = judged(W, scaled_start(scaled, r0), options.method); warm.residual < start.residual)
      start = std::move(warm);
  const Iterate best = start.residual <= options.tolerance ? start : run(W, start, options, out.report);
  out.report.residual = best.residual;
  out.report.coulomb_residual = natural_map(best.u, best.r, scaled.laws);
  out.report.found_by = best.by;
  out.r = scaled.size * scaled.s.cwiseProduct(best.r);
  out.u = scaled.size * best.u.cwiseQuotient(scaled.s);
  return out;
}

// Reports of islands make one: the worst status, the longest iteration, all work, and the residual of the
// whole.
void add(SolveReport& total, const SolveReport& part, double share) {
  total.status = std::max(total.status, part.status);
  total.iterations = std::max(total.iterations, part.iterations);
  total.newton_iterations += part.newton_iterations;
  total.local_failures += part.local_failures;
  total.local_fail_safes += part.local_fail_safes;
  total.residual = std::hypot(total.residual, share * part.residual);
  total.coulomb_residual = std::hypot(total.coulomb_residual, share * part.coulomb_residual);
}

void put(const VecX& part, const std::vector<int>& rows, VecX& whole) {
  for (std::size_t i = 0; i < rows.size(); ++i) whole[rows[i]] = part[Eigen::Index(i)];
}

void put_motion(const Part<LocalProblem>&, const VecX&, FrictionSolution&) {}
void put_motion(const Part<FrictionProblem>& part, const VecX& r, FrictionSolution& out) {
  if (!part.inverse) return;
  const JointedMotion moved = motion(part.problem, *part.inverse, r);
  put(moved.v, part.island.dofs, out.v);
  put(moved.lambda, part.island.joints, out.lambda);
}

template <class Problem>
FrictionSolution solve_islands(const Problem& problem, const VecX& r0, const SolverOptions& options,
                               FrictionSolution out) {
  std::vector<Island> all = islands(problem);
  std::vector<Part<Problem>> parts;
  parts.reserve(all.size());
  std::vector<int> scratch;
  for (Island& island : all) {
    Part<Problem>& now = parts.emplace_back();
    now.solved = solve_alone(problem, island, r0, options);
    if (!now.solved) {
      now.problem = part(problem, island, scratch);
      if (r0.size() > 0) now.r0 = r0(island.rows);
    }
    now.island = std::move(island);
    if (!now.solved) open(now);
  }
  double whole = 0;
  for (const Part<Problem>& now : parts)
    if (const double q = size(now); std::isfinite(q)) whole = std::hypot(whole, q);
  std::size_t largest = 0;
  for (Part<Problem>& now : parts) {
    const double q = size(now);
    if (!std::isfinite(q)) {
      add(out.report, {.status = SolveStatus::not_finite, .residual = kInf, .coulomb_residual = kInf}, 1);
      continue;
    }
    Solved solved{.r = VecX::Zero(Eigen::Index(now.island.rows.size()))};
    if (now.W || now.solved) {
      SolverOptions own = options;
      if (q > 0) own.tolerance = std::min(options.tolerance * std::max(1.0, kNoise * whole / q), 1.0);
      solved = now.solved ? *std::move(now.solved) : solve_rows(*now.W, now.r0, own);
      add(out.report, solved.report, whole > 0 ? q / whole : 1);
      if (now.island.blocks.size() > largest) {
        largest = now.island.blocks.size();
        out.report.found_by = solved.report.found_by;
      }
      put(solved.u, now.island.rows, out.u);
    }
    put(solved.r, now.island.rows, out.r);
    put_motion(now, solved.r, out);
  }
  return out;
}

void validate_start(const VecX& r0, Eigen::Index rows) {
  const std::string bound = "be 0 or " + std::to_string(rows) + ", the rows of laws";
  require_field(r0.size() == 0 || r0.size() == rows, "r0.size()", r0.size(), bound.c_str());
}

}  // namespace

FrictionSolution solve(const LocalProblem& problem, const VecX& r0, const SolverOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.q.size());
  return solve_islands(problem, r0, options, {.u = problem.q, .r = VecX::Zero(problem.q.size())});
}

FrictionSolution solve(const FrictionProblem& problem, const VecX& r0, const SolverOptions& options) {
  validate(problem);
  validate(options);
  validate_start(r0, problem.w.size());
  return solve_islands(problem, r0, options,
                       {.v = VecX::Zero(problem.f.size()),
                        .u = problem.w,
                        .r = VecX::Zero(problem.w.size()),
                        .lambda = VecX::Zero(problem.b.size())});
}

}  // namespace aussois
