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
  for (const BlockId i : model.coordinates.ids()) {
    const std::vector<PointMass>& points = model.coordinates[i].points;
    for (std::size_t k = 0; k < points.size(); ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!points[k].held[axis]) continue;
        out.held.resize(std::size_t(out.rows - out.coordinates));
        out.held[std::size_t(first_coordinate(model, i)) + 3 * k + axis] = 1;
      }
  }
  return out;
}

int row_of(const Layout& dofs, Eigen::Index velocity) {
  const int row = any_row_of(dofs, velocity);
  return !dofs.held.empty() && row >= dofs.coordinates && dofs.held[row - dofs.coordinates] ? -1 : row;
}

void clear_held(const Layout& dofs, VecX& forces) {
  for (std::size_t i = 0; i < dofs.held.size(); ++i)
    if (dofs.held[i]) forces[dofs.coordinates + Eigen::Index(i)] = 0;
}

int any_row_of(const Layout& dofs, Eigen::Index velocity) {
  const int after_bodies = first_velocity(dofs.first.next());
  if (velocity >= after_bodies) return dofs.coordinates + int(velocity - after_bodies);
  const int first = dofs.first[BodyId::at(velocity / 6)];
  return first < 0 ? -1 : first + int(velocity % 6);
}

int velocity_of(const Layout& dofs, int row) {
  if (row >= dofs.coordinates) return first_velocity(dofs.first.next()) + row - dofs.coordinates;
  for (const BodyId b : dofs.first.ids())
    if (const int first = dofs.first[b]; first >= 0 && row < first + 6)
      return first_velocity(b) + row - first;
  return -1;
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
