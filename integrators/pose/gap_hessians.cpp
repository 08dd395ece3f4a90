// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/gap_hessians.hpp"

#include <utility>

#include <Eigen/SparseCholesky>

#include "lmd/contact_kinematics.hpp"
#include "mechanics/surface.hpp"

namespace aussois {
namespace {

constexpr double kSmallestPart = 0.125;  // taste; from there on the loop without Hessians is as fast

bool is_positive(const SparseMatrix& symmetric) {
  return Eigen::SimplicialLLT<SparseMatrix>(symmetric).info() == Eigen::Success;
}

}  // namespace

SparseMatrix gap_hessians(const Model& model, const State& state, const ContactSet& contacts,
                          const std::vector<double>& r_N, const Layout& dofs, double time) {
  std::vector<Triplet> entries;
  for (std::size_t k = 0; k < contacts.points.size(); ++k) {
    if (r_N[k] == 0) continue;
    const ContactPoint& c = contacts.points[k];
    const ContactKinematics now =
        contact_kinematics(c, posed_shape(model, state, c.a.body), pose(state, c.a.body),
                           posed_shape(model, state, c.b.body), pose(state, c.b.body));
    if (now.status != KinematicsStatus::ok) continue;
    const Mat12 turning = -time * r_N[k] * jacobian_derivative(now).transpose();
    const std::pair<int, int> sides[] = {{dofs.first[c.a.body], 0}, {dofs.first[c.b.body], 6}};
    for (const auto& [row, i_0] : sides)
      for (const auto& [column, j_0] : sides)
        for (int i = 0; i < 6 && row >= 0; ++i)
          for (int j = 0; j < 6 && column >= 0; ++j)
            entries.emplace_back(row + i, column + j, turning(i_0 + i, j_0 + j));
  }
  SparseMatrix out(dofs.rows, dofs.rows);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

SparseMatrix kept_positive(const SparseMatrix& M, const SparseMatrix& D) {
  const auto symmetric = [](const SparseMatrix& A) { return SparseMatrix(A + SparseMatrix(A.transpose())); };
  const SparseMatrix half = 0.5 * symmetric(M), turning = symmetric(D);
  for (double part = 1; part >= kSmallestPart; part /= 2)
    if (is_positive(half + part * turning)) return part * D;
  return SparseMatrix(D.rows(), D.cols());
}

}  // namespace aussois
