// SPDX-License-Identifier: Apache-2.0
// Where the surface of a body is at a state, and how its points move with the velocities (DEF-1) to (DEF-3).
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "lmd/contact_point.hpp"
#include "lmd/posed_shape.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// The shapes of bodies that deform as they were last asked for. It saves time and changes no result.
class DeformedShapes {
 public:
  /// `laid` with its vertices there (`refit`): made again only if the last one of this body is another.
  std::shared_ptr<const LmdShape> at(BodyId body, const LmdShape& laid, const std::vector<Vec3>& vertices);

 private:
  std::mutex mutex_{};  // of the table; two threads may both make a shape
  PerBody<std::shared_ptr<const LmdShape>> last_{};
};

/// The shape of a body at its pose; if the body deforms, as deformed at the state. The body must have a
/// shape.
PosedShape posed_shape(const Model& model, const State& state, BodyId body, DeformedShapes* known = nullptr);

/// The vertices of a body that deforms, in the frame of its shape [m]. Throws std::invalid_argument naming
/// the body if its deformation does not give one vertex for each vertex of the shape.
std::vector<Vec3> deformed_vertices(const Model& model, const State& state, BodyId body);

/// The numbers of its VertexField, if it has one; none otherwise. Throws std::invalid_argument naming the
/// body unless there is one for each vertex of the shape.
std::vector<double> vertex_field(const Model& model, const State& state, BodyId body);

/// The velocities of these vertices, in the frame of the shape, at the velocities `v`, laid out as State::v
/// [m/s].
std::vector<Vec3> vertex_velocities(const Model& model, const State& state, BodyId body, const VecX& v);

/// Velocity of a point of a body along N axes, per unit of each velocity that moves it.
template <int N>
struct PointColumns {
  Eigen::Matrix<double, N, 6> twist;                                  // of the body; zero if it is carried
  std::vector<std::pair<int, Eigen::Matrix<double, N, 1>>> others{};  // (entry of State::v, column)
};
/// The point at `x` is carried by the simplex `on`, above its place `base`, both in the world; `axes` are the
/// first N columns of `frame` [world]. Defined for N = 1 and 3.
template <int N>
PointColumns<N> point_columns(const Model& model, const State& state, const Feature& on, const Vec3& x,
                              const Vec3& base, const Mat3& frame);

/// Velocity of a point on the simplex itself at the velocities `v`, laid out as State::v [m/s].
Vec3 point_velocity(const Model& model, const State& state, const Feature& on, const Vec3& x, const VecX& v);

/// Angular velocity of the surface about `axis` [world], per unit of the body's twist (MEC-7): that of the
/// body, also where the body deforms; zero if it is carried.
Eigen::Matrix<double, 1, 6> spin_columns(const Model& model, const State& state, BodyId body,
                                         const Vec3& axis);

/// The same for what carries a body or a simplex that deforms: entries of State::v and how they turn the
/// surface at a point of `on` about `axis` (DEF-3), (TREE-2). None where vertices are points.
std::vector<std::pair<int, double>> carried_spin(const Model& model, const State& state, const Feature& on,
                                                 const Vec3& axis);

/// The place of the material at a contact's proximal point, in the frame of its body [m]: at the state for a
/// rigid body, in the undeformed shape for one that deforms.
Vec3 material_place(const Model& model, const State& state, const Feature& on, const Vec3& x);

}  // namespace aussois
