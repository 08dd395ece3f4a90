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
  out.rows += first_coordinate(model, model.coordinates.next());
  return out;
}

int row_of(const Layout& dofs, Eigen::Index velocity) {
  const int after_bodies = first_velocity(dofs.first.next());
  if (velocity >= after_bodies) return dofs.coordinates + int(velocity - after_bodies);
  const int first = dofs.first[BodyId::at(velocity / 6)];
  return first < 0 ? -1 : first + int(velocity % 6);
}

VecX all_velocities(const Layout& dofs, const VecX& v, const VecX& v_prescribed) {
  VecX all = v_prescribed;
  for (const BodyId b : dofs.first.ids())
    if (const int row = dofs.first[b]; row >= 0) body_part(all, b) = v.segment<6>(row);
  all.tail(dofs.rows - dofs.coordinates) = v.tail(dofs.rows - dofs.coordinates);
  return all;
}

VecX free_velocities(const Layout& dofs, const VecX& all) {
  VecX v(dofs.rows);
  for (const BodyId b : dofs.first.ids())
    if (const int row = dofs.first[b]; row >= 0) v.segment<6>(row) = body_part(all, b);
  v.tail(dofs.rows - dofs.coordinates) = all.tail(dofs.rows - dofs.coordinates);
  return v;
}

}  // namespace aussois
