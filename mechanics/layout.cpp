// SPDX-License-Identifier: Apache-2.0
#include "mechanics/layout.hpp"

#include "mechanics/model.hpp"

namespace aussois {

Layout layout(const Model& model) {
  Layout out;
  for (const RigidBody& body : model.bodies) {
    out.first.push_back(is_dynamic(body) ? out.rows : -1);
    if (is_dynamic(body)) out.rows += 6;
  }
  out.coordinates = out.rows;
  out.rows += first_coordinate(model, int(model.coordinates.size()));
  return out;
}

int row_of(const Layout& dofs, Eigen::Index velocity) {
  const auto bodies = int(dofs.first.size());
  if (velocity >= first_velocity(bodies)) return dofs.coordinates + int(velocity - first_velocity(bodies));
  const int first = dofs.first[velocity / 6];
  return first < 0 ? -1 : first + int(velocity % 6);
}

VecX all_velocities(const Layout& dofs, const VecX& v, const VecX& v_prescribed) {
  VecX all = v_prescribed;
  for (int b = 0; b < int(dofs.first.size()); ++b)
    if (const int row = dofs.first[b]; row >= 0) of_body(all, b) = v.segment<6>(row);
  all.tail(dofs.rows - dofs.coordinates) = v.tail(dofs.rows - dofs.coordinates);
  return all;
}

VecX free_velocities(const Layout& dofs, const VecX& all) {
  VecX v(dofs.rows);
  for (int b = 0; b < int(dofs.first.size()); ++b)
    if (const int row = dofs.first[b]; row >= 0) v.segment<6>(row) = of_body(all, b);
  v.tail(dofs.rows - dofs.coordinates) = all.tail(dofs.rows - dofs.coordinates);
  return v;
}

}  // namespace aussois
