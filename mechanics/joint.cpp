// SPDX-License-Identifier: Apache-2.0
#include "mechanics/joint.hpp"

#include <cmath>

#include "geometry/check.hpp"
#include "geometry/named.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

const SE3& pose_of(const PerBody<SE3>& g, BodyId body) {
  static const SE3 world;
  return body ? g[body] : world;
}

// The two frames of a joint in the world, and what moves them.
struct Frames {
  Mat3 to_a, to_b;  // take a moment from the world into the frames of the bodies
  Mat3 a, b;        // columns: axes of the frames
  Vec3 r_a, r_b;    // from the centres of the bodies to the origin of A's frame
  Vec3 d;           // from the origin of B's frame to that of A's [m]
};

Frames frames_of(const Joint& joint, const PerBody<SE3>& g) {
  const SE3 &body_a = pose_of(g, joint.body_a), &body_b = pose_of(g, joint.body_b);
  const SE3 frame_a = body_a * joint.frame_a, frame_b = body_b * joint.frame_b;
  return {.to_a = body_a.R.toRotationMatrix().transpose(),
          .to_b = body_b.R.toRotationMatrix().transpose(),
          .a = frame_a.R.toRotationMatrix(),
          .b = frame_b.R.toRotationMatrix(),
          .r_a = frame_a.p - body_a.p,
          .r_b = frame_a.p - body_b.p,
          .d = frame_a.p - frame_b.p};
}

// On the mean of two places of the bodies (MJT-14). The inverse of a mean of two rotations exists up to half
// a turn between them.
Frames frames_of(const Joint& joint, const JointPoses& at) {
  Frames f = frames_of(joint, at.start);
  if (!at.end) return f;
  const Frames g = frames_of(joint, *at.end);
  const auto mean = [](const auto& x, const auto& y) { return ((x + y) / 2).eval(); };
  return {.to_a = mean(f.to_a, g.to_a).transpose().inverse(),
          .to_b = mean(f.to_b, g.to_b).transpose().inverse(),
          .a = mean(f.a, g.a),
          .b = mean(f.b, g.b),
          .r_a = mean(f.r_a, g.r_a),
          .r_b = mean(f.r_b, g.r_b),
          .d = mean(f.d, g.d)};
}

// A unit force along `axis` on A at the origin of its frame, its opposite on B at the same point (MJT-2).
JointRow force_along(const Frames& f, const Vec3& axis, double value) {
  JointRow row{.value = value};
  row.J_a << axis, f.to_a * f.r_a.cross(axis);
  row.J_b << -axis, -(f.to_b * f.r_b.cross(axis));
  return row;
}

// b_i . d, the position of A along an axis of B (MJT-3).
JointRow along(const Frames& f, int i) {
  return force_along(f, f.b.col(i), f.b.col(i).dot(f.d));
}

// a_i . b_j: zero where the two axes are perpendicular (MJT-4).
JointRow dot(const Frames& f, int i, int j) {
  const Vec3 axis = f.a.col(i).cross(f.b.col(j));
  JointRow row{.value = f.a.col(i).dot(f.b.col(j))};
  row.J_a << Vec3::Zero(), f.to_a * axis;
  row.J_b << Vec3::Zero(), -(f.to_b * axis);
  return row;
}

// The angle of the vector whose coordinates are the values of two rows (MJT-5).
JointRow angle(const JointRow& x, const JointRow& y) {
  const double square = x.value * x.value + y.value * y.value;
  JointRow row{.value = std::atan2(y.value, x.value)};
  if (square == 0) return row;
  row.J_a = (x.value * y.J_a - y.value * x.J_a) / square;
  row.J_b = (x.value * y.J_b - y.value * x.J_b) / square;
  return row;
}
JointRow angle_about_z(const Frames& f) {
  return angle(dot(f, 0, 0), dot(f, 0, 1));
}
JointRow angle_about_x(const Frames& f) {
  return angle(dot(f, 2, 2), dot(f, 1, 2));
}

// z - pitch * turns; the turn is the one that fits z best, so no counter is needed (MJT-6).
JointRow thread(const Frames& f, double pitch) {
  const double lead = pitch / (2 * kPi);
  JointRow z = along(f, 2);
  const JointRow turn = angle_about_z(f);
  const double angle = turn.value + 2 * kPi * std::round((z.value / lead - turn.value) / (2 * kPi));
  z.value -= lead * angle;
  z.J_a -= lead * turn.J_a;
  z.J_b -= lead * turn.J_b;
  return z;
}

JointRow length(const Frames& f, double wanted) {
  const double size = f.d.norm();
  return force_along(f, size > 0 ? Vec3(f.d / size) : Vec3(Vec3::Zero()), size - wanted);
}

}  // namespace

void describe(SettingVisitor& visit, JointAxis& o) {
  visit.begin("JointAxis");
  visit.number({"lower", "lower stop", "m, rad"}, o.lower);
  visit.number({"upper", "upper stop", "m, rad"}, o.upper);
  visit.number({"restitution", "restitution of the stops", "-", {0, 1}}, o.restitution);
  visit.number({"friction", "largest force or torque of dry friction", "N, N m", not_negative_range()},
               o.friction);
  visit.number({"stiffness", "stiffness of the spring", "N/m, N m", not_negative_range()}, o.stiffness);
  visit.number({"damping", "damping of the spring", "N s/m, N m s", not_negative_range()}, o.damping);
  visit.number({"rest", "coordinate at which the spring is at rest", "m, rad", finite_range()}, o.rest);
  visit.number({"motor.limit", "largest effort of a speed or position motor", "N, N m", range_above(0)},
               o.motor.limit);
}

constexpr Named<JointKind> kJointKinds[] = {
    {JointKind::fixed, "fixed"},         {JointKind::revolute, "revolute"},
    {JointKind::prismatic, "prismatic"}, {JointKind::cylindrical, "cylindrical"},
    {JointKind::spherical, "spherical"}, {JointKind::universal, "universal"},
    {JointKind::planar, "planar"},       {JointKind::screw, "screw"},
    {JointKind::distance, "distance"}};

const char* to_string(JointKind kind) {
  return name_of(kind, kJointKinds);
}

Joint joint_at(JointKind kind, std::string name, BodyId body_a, BodyId body_b, const PerBody<SE3>& g,
               const SE3& frame) {
  return {.name = std::move(name),
          .kind = kind,
          .body_a = body_a,
          .body_b = body_b,
          .frame_a = inverse(pose_of(g, body_a)) * frame,
          .frame_b = inverse(pose_of(g, body_b)) * frame};
}

int axis_count(JointKind kind) {
  switch (kind) {
    case JointKind::revolute:
    case JointKind::prismatic:
    case JointKind::screw:
      return 1;
    case JointKind::cylindrical:
    case JointKind::universal:
      return 2;
    case JointKind::planar:
      return 3;
    case JointKind::fixed:
    case JointKind::spherical:
    case JointKind::distance:
      break;
  }
  return 0;
}

bool is_angle(JointKind kind, int axis) {
  switch (kind) {
    case JointKind::revolute:
    case JointKind::universal:
    case JointKind::screw:
      return true;
    case JointKind::cylindrical:
      return axis == 1;
    case JointKind::planar:
      return axis == 2;
    default:
      return false;
  }
}

int locked_translations(JointKind kind) {
  switch (kind) {
    case JointKind::prismatic:
    case JointKind::cylindrical:
      return 2;
    case JointKind::planar:
    case JointKind::distance:
      return 1;
    default:
      return 3;
  }
}

int locked_count(JointKind kind) {
  switch (kind) {
    case JointKind::fixed:
      return 6;
    case JointKind::revolute:
    case JointKind::prismatic:
    case JointKind::screw:
      return 5;
    case JointKind::cylindrical:
    case JointKind::universal:
      return 4;
    case JointKind::spherical:
    case JointKind::planar:
      return 3;
    case JointKind::distance:
      return 1;
  }
  return 0;
}

std::vector<JointRow> locked_rows(const Joint& joint, const JointPoses& at) {
  const Frames f = frames_of(joint, at);
  switch (joint.kind) {
    case JointKind::fixed:
      return {along(f, 0), along(f, 1), along(f, 2), dot(f, 2, 0), dot(f, 2, 1), dot(f, 0, 1)};
    case JointKind::revolute:
      return {along(f, 0), along(f, 1), along(f, 2), dot(f, 2, 0), dot(f, 2, 1)};
    case JointKind::prismatic:
      return {along(f, 0), along(f, 1), dot(f, 2, 0), dot(f, 2, 1), dot(f, 0, 1)};
    case JointKind::cylindrical:
      return {along(f, 0), along(f, 1), dot(f, 2, 0), dot(f, 2, 1)};
    case JointKind::spherical:
      return {along(f, 0), along(f, 1), along(f, 2)};
    case JointKind::universal:
      return {along(f, 0), along(f, 1), along(f, 2), dot(f, 0, 2)};
    case JointKind::planar:
      return {along(f, 2), dot(f, 2, 0), dot(f, 2, 1)};
    case JointKind::screw:
      return {along(f, 0), along(f, 1), thread(f, joint.pitch), dot(f, 2, 0), dot(f, 2, 1)};
    case JointKind::distance:
      return {length(f, joint.length)};
  }
  return {};
}

JointRow axis_row(const Joint& joint, const JointPoses& at, int axis) {
  AUSSOIS_ASSERT(axis >= 0 && axis < axis_count(joint.kind));
  const Frames f = frames_of(joint, at);
  switch (joint.kind) {
    case JointKind::prismatic:
      return along(f, 2);
    case JointKind::cylindrical:
      return axis == 0 ? along(f, 2) : angle_about_z(f);
    case JointKind::universal:
      return axis == 0 ? angle_about_z(f) : angle_about_x(f);
    case JointKind::planar:
      return axis < 2 ? along(f, axis) : angle_about_z(f);
    default:
      return angle_about_z(f);
  }
}

SE3 joint_pose(const Joint& joint, const double* q) {
  // Without a check: where a step fails, coordinates may be anything.
  const auto about_x = [](double a) {
    return SE3{Quat(std::cos(a / 2), std::sin(a / 2), 0, 0), Vec3::Zero()};
  };
  const auto about_z = [](double a) {
    return SE3{Quat(std::cos(a / 2), 0, 0, std::sin(a / 2)), Vec3::Zero()};
  };
  switch (joint.kind) {
    case JointKind::revolute:
      return about_z(q[0]);
    case JointKind::prismatic:
      return translation(0, 0, q[0]);
    case JointKind::cylindrical:
      return translation(0, 0, q[0]) * about_z(q[1]);
    case JointKind::universal:
      return about_z(q[0]) * about_x(q[1]);
    case JointKind::planar:
      return translation(q[0], q[1], 0) * about_z(q[2]);
    case JointKind::screw:
      return translation(0, 0, joint.pitch / (2 * kPi) * q[0]) * about_z(q[0]);
    default:
      return {};
  }
}

SE3 frame_on_a(const Joint& joint, const PerBody<SE3>& g) {
  return pose_of(g, joint.body_a) * joint.frame_a;
}

}  // namespace aussois
