// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/impact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/check.hpp"
#include "mechanics/forces.hpp"

namespace aussois {
namespace {

constexpr double kTolerance = 1e-13;  // of the shocks; impacts of balls by hand hold to 1e-12
constexpr double kStill = 1e-12;      // of the velocities of both bodies: no longer approaching, but rounding

/// What the shocks of one impact share.
struct Setting {
  const Layout& dofs;
  const std::vector<ContactRow>& rows;
  const SparseMatrix &M, &G;
  ImpactLaw law;
  SolverOptions solver{};
};

/// Velocities and sums of impulses, while shocks go on.
struct Shocked {
  VecX v{};
  std::vector<RowVector> r{};
  VecX lambda{};
  int solves = 0;
  SolveReport solve{};
};

ContactRow unbiased(ContactRow row) {
  row.w = row.moved;
  return row;
}

// Only the friction of a contact whose normal impulse is given: its normal row acts on a mass of 1 kg of its
// own, which comes in at minus that impulse and so is stopped by exactly that (IMP-3).
ContactRow friction_of(ContactRow row, int own) {
  row.J_a.row(0).setZero();
  row.J_b.row(0).setZero();
  row.w.x() = 0;
  std::erase_if(row.others, [](const Triplet& e) { return e.row() == 0; });
  row.others.emplace_back(0, own, 1.0);
  return row;
}

// One problem: M v+ = M v + push + H r + G lambda, joints keep their velocities. `given[k]` >= 0: the
// friction of row k at that normal impulse comes on top.
void solve_shock(const Setting& s, const std::vector<int>& of, std::vector<ContactRow> rows, const VecX& push,
                 const std::vector<double>& given, Shocked& out) {
  Layout dofs = s.dofs;
  std::vector<Triplet> M;
  for (int k = 0; k < s.M.outerSize(); ++k)
    for (SparseMatrix::InnerIterator e(s.M, k); e; ++e) M.emplace_back(int(e.row()), int(e.col()), e.value());
  std::vector<double> own;
  std::vector<int> target = of;
  for (std::size_t k = 0; k < given.size(); ++k) {
    if (rows[k].law.rows == 1 || given[k] <= 0) continue;
    rows.push_back(friction_of(rows[k], dofs.rows));
    M.emplace_back(dofs.rows, dofs.rows, 1.0);
    own.push_back(-given[k]);
    target.push_back(of[k]);
    ++dofs.rows;
  }
  FreeMotion free;
  free.M = SparseMatrix(dofs.rows, dofs.rows);
  free.M.setFromTriplets(M.begin(), M.end());
  free.f = VecX::Zero(dofs.rows);
  free.f.head(s.dofs.rows) = s.M * out.v + push;
  for (std::size_t k = 0; k < own.size(); ++k) free.f[s.dofs.rows + Eigen::Index(k)] = own[k];
  std::vector<int> all(rows.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = int(k);
  FrictionProblem problem = contact_problem(free, dofs, rows, all);
  if (s.G.cols() > 0) {
    problem.G = s.G;
    problem.G.conservativeResize(dofs.rows, s.G.cols());
    problem.b = -(s.G.transpose() * out.v);
  }
  const FrictionSolution solved = solve(problem, VecX(), s.solver);
  ++out.solves;
  add_part(solved.report, out.solve);
  const std::vector<int> first = first_rows(problem.laws);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    RowVector& r = out.r[target[k]];
    const bool friction = k >= of.size();
    for (int d = friction ? 1 : 0; d < rows[k].law.rows; ++d) r[d] += solved.r[first[k] + d];
  }
  if (s.G.cols() > 0) out.lambda += solved.lambda;
  out.v = solved.v.head(s.dofs.rows);
}

// Directions of all rows of these blocks.
SparseMatrix directions(const Setting& s, const std::vector<ContactRow>& rows) {
  FreeMotion none;
  none.f = VecX::Zero(s.dofs.rows);
  std::vector<int> all(rows.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = int(k);
  return contact_problem(none, s.dofs, rows, all).H;
}

// The contacts `of` meet at once, by Newton's law (IMP-2) or by Poisson's (IMP-3).
void shock(const Setting& s, const std::vector<int>& of, Shocked& out) {
  std::vector<ContactRow> rows;
  std::vector<double> before;
  for (const int i : of) {
    rows.push_back(unbiased(s.rows[i]));
    before.push_back(relative_velocity(rows.back(), s.dofs, out.v).x());
  }
  const VecX none = VecX::Zero(s.dofs.rows);
  if (s.law == ImpactLaw::newton) {
    std::vector<ContactRow> biased = rows;
    for (std::size_t k = 0; k < rows.size(); ++k)
      biased[k].w.x() += rows[k].restitution * std::min(0.0, before[k]);
    return solve_shock(s, of, biased, none, {}, out);
  }
  std::vector<double> compression;
  for (const int i : of) compression.push_back(-out.r[i].x());
  solve_shock(s, of, rows, none, {}, out);
  VecX push = none;
  std::vector<double> given;
  bool expands = false;
  for (std::size_t k = 0; k < of.size(); ++k) {
    RowVector& r = out.r[of[k]];
    given.push_back(rows[k].restitution * (r.x() + compression[k]));
    expands = expands || given[k] > 0;
    r.x() += given[k];
  }
  if (!expands) return;
  const SparseMatrix H = directions(s, rows);
  Eigen::Index first = 0;
  for (std::size_t k = 0; k < of.size(); first += rows[k++].law.rows) push += given[k] * H.col(first);
  solve_shock(s, of, rows, push, given, out);
}

double speed_of(const Setting& s, int i, const VecX& v) {
  return slip_velocity(s.rows[i], s.dofs, v).x();
}

// All that close, and all that would close because of it (IMP-4).
Shocked simultaneous(const Setting& s, const std::vector<int>& near, const Shocked& start, double h,
                     NormalLaw law) {
  std::vector<int> of;
  Shocked out = start;
  for (std::size_t grown = 0; out.v.allFinite();) {
    for (const int i : near)
      if (closes(s.rows[i].gap, speed_of(s, i, out.v), h, law) &&
          std::find(of.begin(), of.end(), i) == of.end())
        of.push_back(i);
    if (of.size() == grown) break;
    grown = of.size();
    std::sort(of.begin(), of.end());
    const Shocked tried = std::exchange(out, start);
    out.solves = tried.solves;
    add_counts(tried.solve, out.solve);
    shock(s, of, out);
  }
  return out;
}

// Always the contact that approaches fastest (IMP-5).
Shocked sequential(const Setting& s, const std::vector<int>& near, Shocked out, double h, NormalLaw law,
                   int max_pairs) {
  const VecX v = out.v;
  const auto still = [&](int i) {  // of its bodies, whatever others do
    return kStill *
           std::max(largest_velocity(s.rows[i], s.dofs, v), largest_velocity(s.rows[i], s.dofs, out.v));
  };
  for (int n = 0; n < max_pairs && out.v.allFinite(); ++n) {
    int next = -1;
    double speed = 0;
    for (const int i : near) {
      const double u = speed_of(s, i, out.v);
      if (u < speed && u < -still(i) && closes(s.rows[i].gap, u, h, law)) next = i, speed = u;
    }
    if (next < 0) break;
    shock(s, {next}, out);
  }
  return out;
}

}  // namespace

std::optional<ImpactJump> impact_jump(const Model& model, const State& state, const Layout& dofs,
                                      const std::vector<ContactRow>& rows, const SparseMatrix& G, double h,
                                      NormalLaw law, const ImpactOptions& options,
                                      const SolverOptions& solver) {
  const VecX v = free_velocities(dofs, state.v);
  std::vector<int> near;
  bool meets = false;
  for (int i = 0; i < int(rows.size()); ++i) {
    const ContactRow& row = rows[i];
    if (is_of_axis(model, row.slot) || !row.can_open) continue;
    near.push_back(i);
    meets = meets || ((row.restitution > 0 || options.order == ImpactOrder::sequential) &&
                      closes(row.gap, slip_velocity(row, dofs, v).x(), h, law));
  }
  if (!meets) return std::nullopt;
  const SparseMatrix M = mass_matrix(model, state, dofs);
  Setting s{.dofs = dofs, .rows = rows, .M = M, .G = G, .law = options.law, .solver = solver};
  s.solver.tolerance = std::min(solver.tolerance, kTolerance);
  const Shocked start{
      .v = v, .r = std::vector<RowVector>(rows.size(), RowVector::Zero()), .lambda = VecX::Zero(G.cols())};
  const Shocked end = options.order == ImpactOrder::simultaneous
                          ? simultaneous(s, near, start, h, law)
                          : sequential(s, near, start, h, law, options.max_pairs);

  ImpactJump out{.v = end.v, .r = end.r, .lambda = end.lambda, .solves = end.solves, .solve = end.solve};
  out.of_joints = G.cols() > 0 ? VecX(G * end.lambda) : VecX(VecX::Zero(dofs.rows));
  out.of_contacts = VecX::Zero(dofs.rows);
  const SparseMatrix H = directions(s, rows);
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (int d = 0; d < rows[i].law.rows; ++d) out.of_contacts += end.r[i][d] * H.col(column++);
  const VecX middle = (v + end.v) / 2;
  out.kinetic_change = middle.dot(M * (end.v - v));
  out.contact_work = middle.dot(out.of_contacts);
  out.joint_work = middle.dot(out.of_joints);
  out.work.assign(rows.size(), 0);
  for (const int i : near) {
    const ContactRow& row = rows[i];
    out.work[i] = end.r[i].dot(slip_velocity(row, dofs, v) + slip_velocity(row, dofs, end.v)) / 2;
  }
  return out;
}

}  // namespace aussois
