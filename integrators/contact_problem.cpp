// SPDX-License-Identifier: Apache-2.0
#include "integrators/contact_problem.hpp"

#include <algorithm>

#include "geometry/frame.hpp"

namespace aussois {
namespace {

using Mat36 = Eigen::Matrix<double, 3, 6>;

// Velocity of the body's point at p in the contact frame, per unit twist.
Mat36 point_jacobian(const State& state, int body, const Vec3& p, const Mat3& frame) {
  const SE3& g = pose(state, body);
  Mat36 J;
  J << frame.transpose(), -frame.transpose() * skew(p - g.p) * g.R.toRotationMatrix();
  return J;
}

// Bias of the normal row, and whether the contact takes part at all.
double normal_bias(double gap, double u_before, double restitution, double h, const NormalLawOptions& options,
                   bool& active) {
  const double over_step = gap >= 0 ? gap / h : std::max(gap / h, -options.correction_speed);
  const double impact = u_before < 0 ? restitution * u_before : 0;
  switch (options.law) {
    case NormalLaw::moreau:
      active = gap + h / 2 * u_before <= 0;
      return impact;
    case NormalLaw::gap_over_step:
      return over_step;
    case NormalLaw::combined:
      if (restitution > 0 && u_before < 0 && gap + h * u_before <= 0) return impact;
      return over_step;
  }
  return over_step;
}

}  // namespace

const char* to_string(NormalLaw law) {
  switch (law) {
    case NormalLaw::moreau:
      return "moreau";
    case NormalLaw::gap_over_step:
      return "gap_over_step";
    case NormalLaw::combined:
      return "combined";
  }
  return "?";
}

NormalLaw normal_law(const std::string& name) {
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::gap_over_step, NormalLaw::combined})
    if (name == to_string(law)) return law;
  throw std::invalid_argument("normal law = " + name + " must be moreau, gap_over_step or combined");
}

std::vector<ContactRow> contact_rows(const Model& model, const State& state, const ContactSet& contacts,
                                     const VecX& v_prescribed, double h, const NormalLawOptions& options) {
  std::vector<ContactRow> rows;
  rows.reserve(contacts.points.size());
  for (const ContactPoint& c : contacts.points) {
    ContactRow row{.body_a = c.a.body, .body_b = c.b.body};
    const ContactLaw& law = contact_law(model, row.body_a, row.body_b);
    const Vec3 p = (c.x_a + c.x_b) / 2;
    row.frame = frame_of(c.normal);
    row.J_a = point_jacobian(state, row.body_a, p, row.frame);
    row.J_b = -point_jacobian(state, row.body_b, p, row.frame);
    row.w =
        row.J_a * v_prescribed.segment<6>(6 * row.body_a) + row.J_b * v_prescribed.segment<6>(6 * row.body_b);
    const auto twist_before = [&](int body) {  // of a moved body: that of its path on this step
      return is_dynamic(model.bodies[std::size_t(body)]) ? twist(state, body)
                                                         : Vec6(v_prescribed.segment<6>(6 * body));
    };
    const double u_before = (row.J_a * twist_before(row.body_a) + row.J_b * twist_before(row.body_b)).x();
    row.w.x() += normal_bias(c.gap, u_before, law.restitution, h, options, row.active);
    row.mu = law.mu;
    rows.push_back(row);
  }
  return rows;
}

FrictionProblem contact_problem(const FreeMotion& free, const DofMap& dofs,
                                const std::vector<ContactRow>& rows, const std::vector<int>& kept) {
  FrictionProblem problem;
  problem.M = free.M;
  problem.f = free.f;
  problem.w = VecX::Zero(3 * Eigen::Index(kept.size()));
  std::vector<Triplet> entries;
  for (int k = 0; k < int(kept.size()); ++k) {
    const ContactRow& row = rows[std::size_t(kept[std::size_t(k)])];
    problem.w.segment<3>(3 * k) = row.w;
    problem.laws.push_back(coulomb(row.mu));
    for (const auto& [body, J] : {std::pair{row.body_a, &row.J_a}, std::pair{row.body_b, &row.J_b}}) {
      const int first = dofs.first[std::size_t(body)];
      if (first < 0) continue;
      for (int i = 0; i < 6; ++i)
        for (int d = 0; d < 3; ++d) entries.emplace_back(first + i, 3 * k + d, (*J)(d, i));
    }
  }
  problem.H = SparseMatrix(dofs.rows, 3 * Eigen::Index(kept.size()));
  problem.H.setFromTriplets(entries.begin(), entries.end());
  return problem;
}

Vec3 relative_velocity(const ContactRow& row, const DofMap& dofs, const VecX& v) {
  Vec3 u = row.w;
  if (const int a = dofs.first[std::size_t(row.body_a)]; a >= 0) u += row.J_a * v.segment<6>(a);
  if (const int b = dofs.first[std::size_t(row.body_b)]; b >= 0) u += row.J_b * v.segment<6>(b);
  return u;
}

}  // namespace aussois
