// SPDX-License-Identifier: Apache-2.0
// Joints between two bodies, or a body and the world: which of the six relative motions are locked, and what
// acts along the free ones (MJT-1) to (MJT-9). A joint carries a frame on each body; its axis is z. Motions
// are those of A seen from B. How the solver treats joints: doc/theory/joints.md.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "geometry/se3.hpp"
#include "lmd/body_id.hpp"

namespace aussois {

class SettingVisitor;

using JointId = Id<struct JointTag>;
using BlockId = Id<struct BlockTag>;  // of Model::coordinates

inline constexpr BodyId kWorld{};  // the other end of a joint that holds on to nothing else

enum class JointKind {  // locked motions -> free axes, in order
  fixed,                // all -> none
  revolute,             // translations, tilts -> angle about z
  prismatic,            // x, y, rotations -> z
  cylindrical,          // x, y, tilts -> z, angle about z
  spherical,            // translations -> rotations, without coordinates
  universal,            // translations, one rotation -> angle about z of B, angle about x of A
  planar,               // z, tilts -> x, y, angle about z
  screw,                // x, y, tilts, z = pitch * turns -> angle about z
  distance,             // |origin of A - origin of B| = length -> no coordinates
};
const char* to_string(JointKind kind);

enum class MotorKind {
  none,
  effort,    // target: force or torque on A
  speed,     // target: speed at the end of the step
  position,  // target: coordinate at the end of the step
};

/// What drives a free axis. With a limit, the bilateral row of a speed or position motor becomes a row of dry
/// friction about its target.
struct Motor {
  MotorKind kind = MotorKind::none;
  std::function<double(double t)> target{};  // [N, N m], [m/s, rad/s] or [m, rad]
  double limit = kInf;                       // of a speed or position motor [N, N m]
};
inline bool prescribes_motion(const Motor& motor) {
  return motor.kind == MotorKind::speed || motor.kind == MotorKind::position;
}

/// What acts along a free axis with coordinate q [m or rad]. `describe` gives the ranges.
struct JointAxis {
  double lower = -kInf, upper = kInf;  // stops [m, rad], lower < upper
  double restitution = 0;              // of the stops [-]
  double friction = 0;                 // largest force or torque of dry friction [N, N m]
  double stiffness = 0, damping = 0;   // of a spring to `rest` [N/m, N m], [N s/m, N m s]
  double rest = 0;                     // [m, rad]
  Motor motor{};
};
void describe(SettingVisitor& visit, JointAxis& axis);  // its numbers

struct Joint {
  std::string name{};
  JointKind kind = JointKind::fixed;
  BodyId body_a = kWorld, body_b = kWorld;
  // true: the two bodies touch each other like any others, and may not overlap at the start; false: they pass
  // through each other, without contacts or certificate (Model::passing)
  bool collide = false;
  SE3 frame_a{}, frame_b{};         // seen from the frames of the bodies
  double pitch = 0;                 // of a screw, with its sign, not 0; of others 0 [m/turn]
  double length = 0;                // of a distance, > 0; of others 0 [m]
  std::array<JointAxis, 3> axis{};  // only the first axis_count(kind) are used
  // If its axes are coordinates (`add_tree`): their block, and its place among the links. None: what it locks
  // is an equation
  BlockId tree{};
  int link = -1;
};

/// Couples the coordinates of two joints: q_1 = ratio q_2 + offset. For gears (ratio = -teeth_2 / teeth_1
/// between external wheels), racks [m/rad] and belts.
struct Coupling {
  std::string name{};
  JointId joint_1{}, joint_2{};
  int axis_1 = 0, axis_2 = 0;
  double ratio = 1;   // not 0
  double offset = 0;  // [m, rad]
};

/// A joint of two bodies whose two joint frames coincide at the poses `g`, at `frame` in the world.
Joint joint_at(JointKind kind, std::string name, BodyId body_a, BodyId body_b, const PerBody<SE3>& g,
               const SE3& frame);

int axis_count(JointKind kind);
bool is_angle(JointKind kind, int axis);
int locked_count(JointKind kind);
int locked_translations(JointKind kind);  // they come first; the others are rotations

/// The pose of the joint's frame on A, seen from that on B, at coordinates `q`, one for each axis (TREE-1).
/// The inverse of `axis_row`, of the kinds that have an axis.
SE3 joint_pose(const Joint& joint, const double* q);

/// A scalar function of two poses and its exact derivative: value' = J_a . twist_a + J_b . twist_b + others.
struct JointRow {
  double value = 0;  // [m, rad]
  Vec6 J_a = Vec6::Zero(), J_b = Vec6::Zero();
  std::vector<std::pair<int, double>>
      others{};  // (entry of State::v, factor): of coordinates that carry A or B
};
/// Where a row is evaluated: at the poses of the bodies or, with an `end`, at the mean of the matrices of
/// both ends. Then J times the mean velocity of a Cayley step is the exact change of the row (MJT-14), and
/// the value of the row is meaningless.
struct JointPoses {
  const PerBody<SE3>& start;
  const PerBody<SE3>* end = nullptr;
  JointPoses(const PerBody<SE3>& g) : start(g) {}  // NOLINT: poses are what most callers have
  JointPoses(const PerBody<SE3>& g, const PerBody<SE3>& g_end) : start(g), end(&g_end) {}
};
/// Zero where the joint holds: metres for translations, sines of angles for rotations (MJT-3), (MJT-4).
std::vector<JointRow> locked_rows(const Joint& joint, const JointPoses& at);
/// The coordinate of a free axis; angles in (-pi, pi] (MJT-5).
JointRow axis_row(const Joint& joint, const JointPoses& at, int axis);

/// The pose of the joint's frame on A, in the world.
SE3 frame_on_a(const Joint& joint, const PerBody<SE3>& g);

}  // namespace aussois
