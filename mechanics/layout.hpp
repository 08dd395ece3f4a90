// SPDX-License-Identifier: Apache-2.0
// Where the velocities of bodies and coordinates are stored: in State::v, and in the rows of a problem, which
// has only the free ones.
#pragma once

#include <vector>

#include "geometry/types.hpp"
#include "lmd/body_id.hpp"

namespace aussois {

struct Model;

/// First entry of a body in State::v: v_G in the world, then omega in the body. The coordinates follow all
/// bodies.
constexpr int first_velocity(BodyId body) {
  return 6 * body.index();
}
/// The part of a body in a vector laid out as State::v (velocities, forces, momenta): all six entries, those
/// of the translation [world], those of the rotation [body].
template <class Vector>
auto body_part(Vector& all, BodyId body) {
  return all.template segment<6>(first_velocity(body));
}
template <class Vector>
auto linear_part(Vector& all, BodyId body) {
  return all.template segment<3>(first_velocity(body));
}
template <class Vector>
auto angular_part(Vector& all, BodyId body) {
  return all.template segment<3>(first_velocity(body) + 3);
}

/// Which rows of a problem belong to a body, six each; the coordinates follow all bodies.
struct Layout {
  PerBody<int> first{};  // its first row, -1 if it is not dynamic
  int coordinates = 0;   // first row of the coordinates
  int rows = 0;
  std::vector<char>
      held{};  // of each coordinate: whether it is the axis of a point that is held; empty: none
};
/// The first row of a body, or -1 of the world and of one that is not dynamic.
inline int first_row(const Layout& dofs, BodyId body) {
  return body ? dofs.first[body] : -1;
}
Layout layout(const Model& model);
/// The row of an entry of State::v, -1 if its body is not dynamic or the axis of its point is held.
int row_of(const Layout& dofs, Eigen::Index velocity);
/// The same where held axes have the row that keeps their speed.
int any_row_of(const Layout& dofs, Eigen::Index velocity);
/// The entry of State::v that has a row of the problem; inverts any_row_of.
int velocity_of(const Layout& dofs, int row);
/// Takes the forces on held axes out of a vector of the rows of the problem.
void clear_held(const Layout& dofs, VecX& forces);

/// Velocities laid out as State::v: the free ones from `v` (rows of the problem), the others from
/// `v_prescribed`.
VecX all_velocities(const Layout& dofs, const VecX& v, const VecX& v_prescribed);
/// The opposite: the rows of the problem from velocities laid out as State::v.
VecX free_velocities(const Layout& dofs, const VecX& all);

}  // namespace aussois
