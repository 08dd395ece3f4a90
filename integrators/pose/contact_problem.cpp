// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/contact_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/frame.hpp"
#include "mechanics/surface.hpp"

namespace aussois {
namespace {

constexpr double kTouching = 0.02;  // gaps that this opens in a step count as closed [m/s^2, rad/s^2]

// What a row of a contact on bodies that deform moves with beside their twists.
struct Carried {
  int row = 0, velocity = 0;  // of the block; entry of State::v
  double value = 0;
};

// The point of the undilated simplex below a proximal point; of rigid bodies it is not needed.
Vec3 base_of(const Model& model, BodyId body, const Vec3& proximal, const Vec3& inwards) {
  const RigidBody& b = model.bodies[body];
  return deforms(b) ? Vec3(proximal + model.shapes[b.shape]->radius * inwards) : proximal;
}

// Of both bodies, whose points at p move against each other.
template <int N>
void set_point_rows(const Model& model, const State& state, const ContactPoint& c, const Vec3& p,
                    ContactRow& row, std::vector<Carried>& carried) {
  std::erase_if(carried, [](const Carried& entry) { return entry.row < N; });
  const auto set = [&](const Feature& on, const Vec3& proximal, double sign, RowJacobian& J) {
    const Vec3 base = base_of(model, on.body, proximal, sign * c.normal);
    const PointColumns<N> columns = point_columns<N>(model, state, on, p, base, row.frame);
    J.topRows<N>() = sign * columns.twist;
    for (const auto& [velocity, column] : columns.others)
      for (int d = 0; d < N; ++d) carried.push_back({d, velocity, sign * column[d]});
  };
  set(c.a, c.x_a, 1, row.J_a);
  set(c.b, c.x_b, -1, row.J_b);
}

// J v of the rows that the law has.
RowVector product(const RowJacobian& J, const Vec6& v, const Law& law) {
  RowVector u = RowVector::Zero();
  for (int d = 0; d < law.rows; ++d)
    for (int i = 0; i < 6; ++i) u[d] += J(d, i) * v[i];
  return u;
}

// The frictional law of a pair, and its drilling row (MEC-7). What does not rub needs one row, not three.
Law law_of(const ContactLaw& law, double patch_radius) {
  if (law.mu == 0) return unilateral();
  const double radius = std::max(law.contensou_radius, patch_radius);
  return radius > 0 ? contensou(law.mu, radius) : coulomb(law.mu);
}

Law law_of(const ContactLaw& law, Eigen::Index rows) {
  return rows == 1 ? unilateral() : rows == 2 ? coulomb_2d(law.mu) : coulomb(law.mu);
}

// Sets the bias of all rows of a block: the normal law, and the average that it refers to (MJ-6), (MJ-10).
void set_bias(ContactRow& row, const RowVector& u_before, double restitution, double h,
              const NormalRule& options) {
  const NormalBias normal = normal_bias(row.gap, u_before.x(), restitution, h, options);
  row.restitution = restitution;
  row.active = normal.active;
  if (options.gamma < 1)
    for (int d = 1; d < row.law.rows; ++d) row.w[d] += (1 - options.gamma) / options.gamma * u_before[d];
  row.w.x() += normal.w;
}

// What is free goes into `others`, what is moved into the bias; its gap is taken back to the start of the
// step.
void add_carried(const State& state, const Layout& dofs, const std::vector<Carried>& carried,
                 const VecX& v_prescribed, const ReachedPlace& reached, ContactRow& row,
                 RowVector& u_before) {
  for (const Carried& entry : carried) {
    if (entry.row >= row.law.rows) continue;
    const int at = row_of(dofs, entry.velocity);
    u_before[entry.row] += entry.value * (at >= 0 ? state.v : v_prescribed)[entry.velocity];
    if (entry.row == 0 && reached.time > 0) row.gap -= reached.time * entry.value * reached.v[entry.velocity];
    if (at >= 0)
      row.others.emplace_back(entry.row, at, entry.value);
    else
      row.w[entry.row] += entry.value * v_prescribed[entry.velocity];
  }
}

// Whether something free changes the gap. Columns of links of one tree may cancel each other.
bool can_open(const Model& model, const ContactRow& row) {
  constexpr double kNothing = 1e-10;  // [m/s] for a speed of one: what rounding leaves of sums that vanish
  for (const BodyId body : {row.body_a, row.body_b})
    if (body && is_dynamic(model.bodies[body])) return true;
  std::vector<std::pair<Eigen::Index, double>> columns;
  for (const Triplet& e : row.others)
    if (e.row() == 0) columns.emplace_back(e.col(), e.value());
  std::ranges::stable_sort(columns, {}, &std::pair<Eigen::Index, double>::first);
  for (std::size_t i = 0; i < columns.size();) {
    const Eigen::Index column = columns[i].first;
    double sum = 0;
    for (; i < columns.size() && columns[i].first == column; ++i) sum += columns[i].second;
    if (std::abs(sum) > kNothing) return true;
  }
  return false;
}

// Where a body's part of a row stands in the problem; -1: nowhere.
struct BodyColumns {
  const RowJacobian* J = nullptr;
  int first = -1;
};
}  // namespace

bool closes(double gap, double speed, double h, NormalLaw law) {
  return speed < 0 && gap + (law == NormalLaw::moreau ? h / 2 : h) * speed <= 0;
}

double closed_gap(const NormalRule& options, double h) {
  return std::min(options.touching, kTouching * h * h);
}

NormalBias normal_bias(double gap, double u_before, double restitution, double h, const NormalRule& options) {
  const double over_step = gap >= 0 ? gap / h : std::max(gap / h, -options.correction_speed);
  const double averaged = options.gamma < 1 ? (1 - options.gamma) / options.gamma : 0;  // (MJ-10)
  const double impact =
      std::max(restitution, averaged) * u_before;  // an opening contact may be hit back (IMP-2)
  switch (options.law) {
    case NormalLaw::moreau:
      return {impact, gap + h / 2 * u_before <= closed_gap(options, h)};
    case NormalLaw::gap_over_step:
      break;
    case NormalLaw::combined:
      if (restitution > 0 && closes(gap, u_before, h, options.law)) return {impact, true};
      break;
  }
  return {over_step / options.gamma + averaged * u_before, true};
}

std::vector<ContactRow> contact_rows(const Model& model, const State& state, const Layout& dofs,
                                     const ContactSet& contacts, const VecX& v_prescribed, double h,
                                     const NormalRule& options, const ReachedPlace& reached,
                                     const std::vector<FrictionPatch>& patches) {
  std::vector<ContactRow> rows;
  std::vector<Carried> carried;  // of one contact; none but on bodies that deform
  rows.reserve(contacts.points.size());
  for (std::size_t i = 0; i < contacts.points.size(); ++i) {
    const ContactPoint& c = contacts.points[i];
    ContactRow& row = rows.emplace_back();
    row.body_a = c.a.body;
    row.body_b = c.b.body;
    const ContactLaw& law = contact_law(model, row.body_a, row.body_b);
    const Vec3 p = mid_point(c);
    row.frame = frame_of(c.normal);
    row.law = law_of(law, patches.empty() ? 0 : patches[i].radius);
    carried.clear();
    if (row.law.rows >= 3)
      set_point_rows<3>(model, state, c, patches.empty() ? p : patches[i].centre, row, carried);
    if (row.law.rows < 3 || !patches.empty()) set_point_rows<1>(model, state, c, p, row, carried);
    if (row.law.kind == LawKind::contensou) {
      row.J_a.row(3) = spin_columns(model, state, row.body_a, c.normal);
      row.J_b.row(3) = -spin_columns(model, state, row.body_b, c.normal);
      for (const auto& [velocity, spin] : carried_spin(model, state, c.a, c.normal))
        carried.push_back({3, velocity, spin});
      for (const auto& [velocity, spin] : carried_spin(model, state, c.b, c.normal))
        carried.push_back({3, velocity, -spin});
    }
    const auto speed_before = [&](BodyId body, const RowJacobian& J) {
      if (is_dynamic(model.bodies[body])) return product(J, twist(state, body), row.law);
      RowVector u = product(J, body_part(v_prescribed, body), row.law);  // of its path on this step
      row.w += u;
      return u;
    };
    RowVector u_before = speed_before(row.body_a, row.J_a);
    u_before += speed_before(row.body_b, row.J_b);
    row.gap = c.gap;
    if (reached.time > 0) row.gap -= reached.time * normal_speed(row, reached.v);
    add_carried(state, dofs, carried, v_prescribed, reached, row, u_before);
    row.moved = row.w;
    row.can_open = can_open(model, row);
    set_bias(row, u_before, law.restitution, h, options);
  }
  return rows;
}

GapFunctionRows gap_rows(const Model& model, const State& state, const Layout& dofs, const VecX& v_prescribed,
                         double h, const NormalRule& options, const ReachedPlace& reached) {
  GapFunctionRows out;
  std::vector<Carried> carried;
  for (const GapId i : model.gaps.ids()) {
    const GapFunction& gap = model.gaps[i];
    const GapRows now = gap_function(model, state, i, state.t + reached.time);
    const Eigen::Index size = gap_columns(model, gap), first = gap.block ? first_speed(model, gap.block) : 0;
    ContactRow row{.law = law_of(gap.law, now.J.rows()), .slot = slot_of(model, i)};
    row.gap = now.gap;
    if (reached.time > 0 && now.rate.size() > 0) row.gap -= reached.time * now.rate[0];
    if (now.rate.size() > 0) row.w.head(now.J.rows()) = now.rate;
    RowVector u_before = row.w;
    carried.clear();
    for (Eigen::Index d = 0; d < now.J.rows(); ++d)
      for (Eigen::Index k = 0; k < size; ++k)
        if (now.J(d, k) != 0) carried.push_back({int(d), int(first + k), now.J(d, k)});
    add_carried(state, dofs, carried, v_prescribed, reached, row, u_before);
    row.moved = row.w;
    row.can_open = can_open(model, row);
    set_bias(row, u_before, gap.law.restitution, h, options);
    out.rows.push_back(std::move(row));
    out.gap.push_back(now.gap);
  }
  return out;
}

FrictionProblem contact_problem(const FreeMotion& free, const Layout& dofs,
                                const std::vector<ContactRow>& rows, const std::vector<int>& kept) {
  FrictionProblem problem;
  problem.M = free.M;
  problem.f = free.f;
  for (int i : kept) problem.laws.push_back(rows[i].law);
  const std::vector<int> first_of_block = first_rows(problem.laws);
  problem.w = VecX::Zero(first_of_block.back());
  Eigen::Index entries = 0;
  for (const int i : kept) entries += rows[i].law.rows * 12 + Eigen::Index(rows[i].others.size());
  problem.H = SparseMatrix(dofs.rows, first_of_block.back());
  problem.H.resizeNonZeros(entries);
  int at = 0, *begin = problem.H.outerIndexPtr(), *place = problem.H.innerIndexPtr();
  double* value = problem.H.valuePtr();
  std::vector<std::pair<int, double>> column;  // row, value
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const ContactRow& row = rows[kept[k]];
    problem.w.segment(first_of_block[k], row.law.rows) = row.w.head(row.law.rows);
    std::array ends{BodyColumns{&row.J_a, first_row(dofs, row.body_a)},
                    BodyColumns{&row.J_b, first_row(dofs, row.body_b)}};
    if (ends[1].first < ends[0].first) std::swap(ends[0], ends[1]);
    if (row.others.empty() && ends[0].first != ends[1].first) {
      for (int d = 0; d < row.law.rows; ++d) {
        *begin++ = at;
        for (const BodyColumns& end : ends)
          for (int i = 0; end.first >= 0 && i < 6; ++i, ++at)
            place[at] = end.first + i, value[at] = (*end.J)(d, i);
      }
      continue;
    }
    for (int d = 0; d < row.law.rows; ++d) {
      column.clear();
      for (const BodyColumns& end : ends)
        for (int i = 0; end.first >= 0 && i < 6; ++i) column.emplace_back(end.first + i, (*end.J)(d, i));
      for (const Triplet& e : row.others)
        if (e.row() == d) column.emplace_back(e.col(), e.value());
      const auto by_row = &std::pair<int, double>::first;
      if (!std::ranges::is_sorted(column, {}, by_row)) std::ranges::stable_sort(column, {}, by_row);
      *begin++ = at;
      for (auto entry = column.begin(); entry != column.end(); ++at) {  // entries of one row are summed
        place[at] = entry->first;
        for (value[at] = entry++->second; entry != column.end() && entry->first == place[at]; ++entry)
          value[at] += entry->second;
      }
    }
  }
  *begin = at;
  problem.H.resizeNonZeros(at);
  return problem;
}

double normal_speed(const ContactRow& row, const VecX& v) {
  double out = 0;
  for (const auto& [body, J] : {std::pair(row.body_a, &row.J_a), std::pair(row.body_b, &row.J_b)})
    if (body) out += J->row(0).dot(body_part(v, body));
  return out;
}

double largest_velocity(const ContactRow& row, const Layout& dofs, const VecX& v) {
  double out = 0;
  for (const BodyId body : {row.body_a, row.body_b})
    if (const int first = first_row(dofs, body); first >= 0)
      out = std::max(out, v.segment<6>(first).lpNorm<Eigen::Infinity>());
  for (const Triplet& e : row.others) out = std::max(out, std::abs(v[e.col()]));
  return out;
}

RowVector relative_velocity(const ContactRow& row, const Layout& dofs, const VecX& v) {
  RowVector u = row.w;
  const auto add = [&](BodyId body, const RowJacobian& J) {
    const int first = first_row(dofs, body);
    if (first >= 0) u += product(J, v.segment<6>(first), row.law);
  };
  add(row.body_a, row.J_a);
  add(row.body_b, row.J_b);
  for (const Triplet& e : row.others) u[e.row()] += e.value() * v[e.col()];
  return u;
}

RowVector slip_velocity(const ContactRow& row, const Layout& dofs, const VecX& v) {
  return relative_velocity(row, dofs, v) - row.w + row.moved;
}

VecX momentum_of(const std::vector<ContactRow>& rows, const Layout& dofs, const std::vector<RowVector>& r) {
  VecX out = VecX::Zero(dofs.rows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (r[i].isZero(0)) continue;
    const auto add = [&](BodyId body, const RowJacobian& J) {
      const int first = first_row(dofs, body);
      if (first >= 0) out.segment<6>(first) += J.transpose() * r[i];
    };
    add(rows[i].body_a, rows[i].J_a);
    add(rows[i].body_b, rows[i].J_b);
    for (const Triplet& e : rows[i].others) out[e.col()] += e.value() * r[i][e.row()];
  }
  return out;
}

}  // namespace aussois
