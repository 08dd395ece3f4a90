// SPDX-License-Identifier: Apache-2.0
#include "mechanics/tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/check.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

std::string who(const std::string& tree, const Model& model, JointId joint) {
  return "tree (" + tree + "): joint " + to_string(joint) + " (" + model.joints[joint].name + ") ";
}

bool is_of(const Joint& joint, BodyId body) {
  return joint.body_a == body || joint.body_b == body;
}
BodyId other_of(const Joint& joint, BodyId body) {
  return joint.body_a == body ? joint.body_b : joint.body_a;
}
bool stands(const Model& model, BodyId body) {
  return !body || std::holds_alternative<FixedMotion>(model.bodies[body].motion);
}

BodyId base_of(const Model& model, const std::vector<JointId>& joints) {
  for (const JointId j : joints)
    for (const BodyId body : {model.joints[j].body_b, model.joints[j].body_a})
      if (stands(model, body)) return body;
  return model.joints[joints.front()].body_b;
}

void check_joints(const Model& model, const std::string& name, const std::vector<JointId>& joints) {
  require(!joints.empty(), "tree (" + name + "): joints must not be empty");
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointId j = joints[i];
    require_field(model.joints.contains(j), ("tree (" + name + "): joint").c_str(), j,
                  ("lie in [0, " + to_string(model.joints.next()) + ")").c_str());
    require(std::find(joints.begin(), joints.begin() + long(i), j) == joints.begin() + long(i),
            who(name, model, j) + "is listed twice");
    const Joint& joint = model.joints[j];
    require(axis_count(joint.kind) > 0,
            who(name, model, j) + "is " + to_string(joint.kind) + ": such joints have no coordinates");
    require(!joint.tree, who(name, model, j) + "is of another tree");
    for (const BodyId body : {joint.body_a, joint.body_b})
      if (body && !stands(model, body)) {
        const std::string of = who(name, model, j) + "holds body " + to_string(body) + " (" +
                               model.bodies[body].name + "), which ";
        require(is_dynamic(model.bodies[body]), of + "must be dynamic or fixed");
        require(!deforms(model.bodies[body]), of + "must not deform");
      }
  }
}

// The links in an order in which each comes after the one that it hangs on.
std::vector<TreeLink> links_of(const Model& model, const std::string& name, BodyId base,
                               std::vector<JointId> joints) {
  std::vector<TreeLink> out;
  int first = 0;
  const auto hang_on = [&](BodyId body, int parent) {
    for (JointId& j : joints) {
      if (!j || !is_of(model.joints[j], body)) continue;
      const BodyId next = other_of(model.joints[j], body);
      require(
          !stands(model, next) && next != base && std::ranges::find(out, next, &TreeLink::body) == out.end(),
          who(name, model, j) + "closes a cycle: leave it out, and it stays an equation");
      out.push_back({.joint = j, .body = next, .parent = parent, .first = first});
      first += axis_count(model.joints[j].kind);
      j = {};
    }
  };
  hang_on(base, -1);
  for (std::size_t i = 0; i < out.size(); ++i) hang_on(out[i].body, int(i));
  for (const JointId j : joints)
    if (j) require(false, who(name, model, j) + "does not hang on the others");
  return out;
}

const Tree& tree_of(const Model& model, BlockId block) {
  return model.coordinates[block].tree;
}
const TreeLink& link_of(const Model& model, JointId joint) {
  const Joint& j = model.joints.at(joint);
  require(bool(j.tree), "joint " + to_string(joint) + " (" + j.name + ") is of no tree");
  return tree_of(model, j.tree).links[std::size_t(j.link)];
}

// The screws of a joint's axes (TREE-2); in place, since every step makes them for every link.
class Screws {
 public:
  void add(const Vec3& along, const Vec3& about) { all_[count_++] << along, about; }
  int size() const { return count_; }
  const Vec6& operator[](int i) const { return all_[i]; }
  const Vec6* begin() const { return all_.data(); }
  const Vec6* end() const { return all_.data() + count_; }

 private:
  std::array<Vec6, 3> all_;
  int count_ = 0;
};

// Of the joint of a link, in the order of its coordinates.
Screws screws_of(const Model& model, const TreeLink& link, const PerBody<SE3>& g, const Vec3& origin) {
  const Joint& joint = model.joints[link.joint];
  const auto frame = [&](BodyId body, const SE3& f) { return body ? g[body] * f : f; };
  const SE3 a = frame(joint.body_a, joint.frame_a), b = frame(joint.body_b, joint.frame_b);
  const double sign = joint.body_a == link.body ? 1 : -1;  // motions are those of A seen from B
  Screws out;
  const auto slide = [&](const Vec3& axis) { out.add(sign * axis, Vec3::Zero()); };
  const auto turn = [&](const Vec3& axis, double lead) {
    out.add(sign * (lead * axis + (a.p - origin).cross(axis)), sign * axis);
  };
  const Vec3 z = b.R * Vec3::UnitZ();
  switch (joint.kind) {
    case JointKind::revolute:
      turn(z, 0);
      break;
    case JointKind::prismatic:
      slide(z);
      break;
    case JointKind::cylindrical:
      slide(z);
      turn(z, 0);
      break;
    case JointKind::universal:
      turn(z, 0);
      turn(a.R * Vec3::UnitX(), 0);
      break;
    case JointKind::planar:
      slide(b.R * Vec3::UnitX());
      slide(b.R * Vec3::UnitY());
      turn(z, 0);
      break;
    case JointKind::screw:
      turn(z, joint.pitch / (2 * kPi));
      break;
    default:
      break;
  }
  return out;
}

// A screw at the origin, as the twist of a body.
Vec6 moved_to(const SE3& g, const Vec3& origin, const Vec6& screw) {
  Vec6 out;
  out << screw.head<3>() + screw.tail<3>().cross(g.p - origin), g.R.conjugate() * Vec3(screw.tail<3>());
  return out;
}

}  // namespace

BlockId add_tree(Model& model, std::string name, const std::vector<JointId>& joints) {
  check_joints(model, name, joints);
  Coordinates block{.name = std::move(name)};
  block.tree.base = base_of(model, joints);
  block.tree.links = links_of(model, block.name, block.tree.base, joints);
  for (const TreeLink& link : block.tree.links) block.size += axis_count(model.joints[link.joint].kind);
  const BlockId id = model.coordinates.next();
  for (int i = 0; i < int(block.tree.links.size()); ++i) {
    const TreeLink& link = block.tree.links[std::size_t(i)];
    model.joints[link.joint].tree = id;
    model.joints[link.joint].link = i;
    model.bodies[link.body].motion = CarriedMotion{id, i};
  }
  return add(model, std::move(block));
}

int tree_coordinate(const Model& model, JointId joint, int axis) {
  const TreeLink& link = link_of(model, joint);
  AUSSOIS_ASSERT(axis >= 0 && axis < axis_count(model.joints[joint].kind));
  return first_coordinate(model, model.joints[joint].tree) + link.first + axis;
}
int tree_speed(const Model& model, JointId joint, int axis) {
  return first_velocity(model.bodies.next()) + tree_coordinate(model, joint, axis);
}

void carry_poses(const Model& model, const VecX& q, PerBody<SE3>& g) {
  int first = 0;
  for (const Coordinates& block : model.coordinates) {
    for (const TreeLink& link : block.tree.links) {
      const Joint& joint = model.joints[link.joint];
      const SE3 T = joint_pose(joint, q.data() + first + link.first);
      const BodyId from = other_of(joint, link.body);
      const SE3 on = from ? g[from] : SE3{};
      g[link.body] = joint.body_a == link.body ? on * joint.frame_b * T * inverse(joint.frame_a)
                                               : on * joint.frame_a * inverse(T) * inverse(joint.frame_b);
    }
    first += block.size;
  }
}

void carry_twists(const Model& model, const PerBody<SE3>& g, VecX& v) {
  int first = first_velocity(model.bodies.next());
  for (const Coordinates& block : model.coordinates) {
    const Tree& tree = block.tree;
    const Vec3 origin = tree_origin(tree, g);
    Vec6 of_base = Vec6::Zero();
    if (is_tree(block) && tree.base && is_dynamic(model.bodies[tree.base]))
      of_base << linear_part(v, tree.base), g[tree.base].R * Vec3(angular_part(v, tree.base));
    std::vector<Vec6> twist;  // at the origin
    for (const TreeLink& link : tree.links) {
      Vec6 sum = link.parent < 0 ? of_base : twist[std::size_t(link.parent)];
      int at = first + link.first;
      for (const Vec6& screw : screws_of(model, link, g, origin)) sum += v[at++] * screw;
      twist.push_back(sum);
      body_part(v, link.body) = moved_to(g[link.body], origin, sum);
    }
    first += block.size;
  }
}

void carry(const Model& model, State& state) {
  carry_poses(model, state.q, state.g);
  carry_twists(model, state.g, state.v);
  for (const JointId j : model.joints.ids())  // couplings count turns
    for (int i = 0; model.joints[j].tree && i < axis_count(model.joints[j].kind); ++i) {
      if (!is_angle(model.joints[j].kind, i)) continue;
      state.turns.resize(3 * model.joints.size(), 0);
      const double all = state.q[tree_coordinate(model, j, i)] - axis_row(model.joints[j], state.g, i).value;
      state.turns[std::size_t(3 * j.index() + i)] = int(std::lround(all / (2 * kPi)));
    }
}

State in_joint_coordinates(const Model& model, const State& state) {
  State out = rest_state(model);
  require_field(state.g.size() == out.g.size(), "in_joint_coordinates: bodies of the state", state.g.size(),
                ("be those of the model, " + std::to_string(out.g.size())).c_str());
  out.t = state.t;
  out.g = state.g;
  out.turns = state.turns;
  out.u = state.u;
  const int bodies = first_velocity(model.bodies.next());
  out.v.head(bodies) = state.v.head(bodies);
  int at = 0, from = 0;
  for (const Coordinates& block : model.coordinates) {
    for (const TreeLink& link : block.tree.links) {
      const Joint& joint = model.joints[link.joint];
      for (int i = 0; i < axis_count(joint.kind); ++i) {
        const JointRow row = axis_row(joint, state.g, i);
        const int turns = state.turns.empty() ? 0 : state.turns[std::size_t(3 * link.joint.index() + i)];
        out.q[at + link.first + i] = row.value + 2 * kPi * turns;
        out.v[bodies + at + link.first + i] = axis_speed(joint, row, state.v);
      }
    }
    if (!is_tree(block)) {
      require(from + block.size <= state.q.size(), "in_joint_coordinates: the state lacks coordinates");
      out.q.segment(at, block.size) = state.q.segment(from, block.size);
      out.v.segment(bodies + at, block.size) = state.v.segment(bodies + from, block.size);
      from += block.size;
    }
    at += block.size;
  }
  carry(model, out);
  return out;
}

std::vector<TwistColumn> carried_columns(const Model& model, const PerBody<SE3>& g, BodyId body) {
  std::vector<TwistColumn> out;
  const auto* carried = std::get_if<CarriedMotion>(&model.bodies[body].motion);
  if (!carried) return out;
  const Tree& tree = tree_of(model, carried->tree);
  const Vec3 origin = tree_origin(tree, g);
  const SE3& here = g[body];
  const int first = first_speed(model, carried->tree);
  for (int i = carried->link; i >= 0; i = tree.links[std::size_t(i)].parent) {
    const TreeLink& link = tree.links[std::size_t(i)];
    int at = first + link.first;
    for (const Vec6& screw : screws_of(model, link, g, origin))
      out.push_back({at++, moved_to(here, origin, screw)});
  }
  if (!tree.base || !is_dynamic(model.bodies[tree.base])) return out;
  const Mat3 R = g[tree.base].R.toRotationMatrix();
  for (int i = 0; i < 6; ++i) {
    Vec6 unit = Vec6::Zero();
    if (i < 3)
      unit[i] = 1;
    else
      unit.tail<3>() = R.col(i - 3);
    out.push_back({first_velocity(tree.base) + i, moved_to(here, origin, unit)});
  }
  return out;
}

std::vector<TreeAxis> tree_axes(const Model& model, const Tree& tree, const PerBody<SE3>& g) {
  const Vec3 origin = tree_origin(tree, g);
  std::vector<TreeAxis> out;
  std::vector<int> last;  // axis of each link
  for (int i = 0; i < int(tree.links.size()); ++i) {
    const TreeLink& link = tree.links[std::size_t(i)];
    const Screws screws = screws_of(model, link, g, origin);
    const bool a = model.joints[link.joint].body_a == link.body;  // else its axes follow each other backwards
    int parent = link.parent < 0 ? -1 : last[std::size_t(link.parent)];
    for (int k = 0; k < screws.size(); ++k) {
      const int at = a ? k : screws.size() - 1 - k;
      out.push_back({.screw = screws[at], .parent = parent, .coordinate = link.first + at});
      parent = int(out.size()) - 1;
    }
    out.back().link = i;
    last.push_back(parent);
  }
  return out;
}

Vec3 tree_origin(const Tree& tree, const PerBody<SE3>& g) {
  return tree.base ? g[tree.base].p : Vec3(Vec3::Zero());
}

}  // namespace aussois
