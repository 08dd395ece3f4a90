// SPDX-License-Identifier: Apache-2.0
// Rigid bodies (MEC-1): the body frame sits at the centre of mass; the twist of a body is (v_G in the world,
// omega in the body).
#pragma once

#include <string>
#include <variant>

#include "geometry/id.hpp"
#include "geometry/mass_properties.hpp"
#include "mechanics/deformation.hpp"
#include "mechanics/joint.hpp"
#include "mechanics/trajectory.hpp"

namespace aussois {

using ShapeId = Id<struct ShapeTag>;

struct DynamicMotion {};
struct FixedMotion {};
struct PrescribedMotion {  // pose and velocity known, reactions computed
  Trajectory path{};
};
struct DrivenMotion {};  // moves with its twist in State::v, which is set between steps (`lead_body`)
struct CarriedMotion {   // its pose follows from the coordinates of a tree (`add_tree`)
  BlockId tree{};
  int link = 0;
};
using Motion = std::variant<DynamicMotion, FixedMotion, PrescribedMotion, DrivenMotion, CarriedMotion>;

struct RigidBody {
  std::string name{};
  ShapeId shape{};              // of Model::shapes; none: no shape
  SE3 g_bs{};                   // shape frame seen from the body frame
  double mass = 0;              // [kg], > 0 if dynamic or carried
  Mat3 inertia = Mat3::Zero();  // about the centre of mass, body frame [kg m^2]; see (MEC-3)
  Motion motion = DynamicMotion{};
  Deformation deformation{};  // of the shape, seen from the body; by default none
};

inline bool is_dynamic(const RigidBody& body) {
  return std::holds_alternative<DynamicMotion>(body.motion);
}

/// Whether coordinates of a tree stand for its pose.
inline bool is_carried(const RigidBody& body) {
  return std::holds_alternative<CarriedMotion>(body.motion);
}
/// Whether forces move the body: in rows of its own, or in those of coordinates.
inline bool has_inertia(const RigidBody& body) {
  return is_dynamic(body) || is_carried(body);
}

/// Whether the body moves and nothing can stop it.
inline bool is_moved(const RigidBody& body) {
  return std::holds_alternative<PrescribedMotion>(body.motion) ||
         std::holds_alternative<DrivenMotion>(body.motion);
}
/// Whether the shape moves as seen from the body.
inline bool deforms(const RigidBody& body) {
  return bool(body.deformation.vertices);
}
/// Whether contacts can move the body's surface.
inline bool contacts_can_move(const RigidBody& body) {
  return has_inertia(body) || deforms(body);
}

/// A dynamic body whose frame has the axes of the shape and sits at the centre of mass.
RigidBody solid_body(std::string name, ShapeId shape, const MassProperties& mass);
/// A fixed body whose frame is the shape's.
RigidBody fixed_body(std::string name, ShapeId shape);
/// A body whose frame is the shape's, moved along `path`.
RigidBody prescribed_body(std::string name, ShapeId shape, Trajectory path);
/// A body whose frame is the shape's; its motion is set by the user between steps. Without a shape it is a
/// handle.
RigidBody driven_body(std::string name, ShapeId shape = {});

}  // namespace aussois
