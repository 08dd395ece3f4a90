// SPDX-License-Identifier: Apache-2.0
#include "mechanics/model.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "geometry/settings.hpp"
#include "mechanics/layout.hpp"

namespace aussois {
namespace {

// Allowed asymmetry and violation of (MEC-3), relative to the largest moment
constexpr double kRounding = 1e-9;
constexpr double kLeastMoment = 1e-12;  // smallest principal moment, relative to the largest

void check_inertia(const Mat3& J, const std::string& who) {
  require(J.allFinite(), who + "inertia must be finite");
  const double size = J.cwiseAbs().maxCoeff();
  const double asymmetry = (J - J.transpose()).cwiseAbs().maxCoeff();
  require_field(asymmetry <= kRounding * size, (who + "largest |inertia - transpose|").c_str(), asymmetry,
                "be at most 1e-9 of the largest entry");
  const Vec3 moment =
      Eigen::SelfAdjointEigenSolver<Mat3>(0.5 * (J + J.transpose()), Eigen::EigenvaluesOnly).eigenvalues();
  require_field(moment[0] > kLeastMoment * moment[2], (who + "smallest principal moment of inertia").c_str(),
                moment[0], "be positive, above 1e-12 of the largest");
  require_field(moment[2] <= (moment[0] + moment[1]) + kRounding * moment[2],  // (MEC-3)
                (who + "largest principal moment of inertia").c_str(), moment[2],
                ("not exceed the sum of the others, " + number_text(moment[0] + moment[1])).c_str());
}

void check_body(const RigidBody& body, BodyId index, const Model& model) {
  const std::string who = "body " + to_string(index) + " (" + body.name + "): ";
  require_field(body.shape == ShapeId() || model.shapes.contains(body.shape), (who + "shape").c_str(),
                body.shape, ("lie in [-1, " + to_string(model.shapes.next()) + ")").c_str());
  checked_pose(body.g_bs, (who + "g_bs").c_str());
  if (has_inertia(body)) {
    require_field(body.mass > 0 && std::isfinite(body.mass), (who + "mass").c_str(), body.mass,
                  "be positive and finite [kg]");
    check_inertia(body.inertia, who);
  }
  if (const PrescribedMotion* prescribed = std::get_if<PrescribedMotion>(&body.motion)) {
    try {
      validate(prescribed->path);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(who + error.what());
    }
  }
}

void check_deformation(const RigidBody& body, BodyId index, const Model& model) {
  const std::string who = "body " + to_string(index) + " (" + body.name + "): deformation ";
  const VertexField& field = body.deformation.field;
  require(!field.values || (deforms(body) && !field.what.empty()),
          who + "field needs vertices and the name of what it is");
  if (!deforms(body)) return;
  require(bool(body.deformation.columns), who + "needs columns beside vertices");
  require(bool(body.shape), who + "needs a shape");
  require(model.shapes[body.shape]->deforming,
          who + "needs a shape prepared with LmdShapeOptions::deforming");
  require(!is_moved(body), who + "needs a dynamic or fixed body");
}

void check_axis(const JointAxis& axis, const std::string& who) {
  check_ranges(axis, who);
  require_field(axis.lower < axis.upper, (who + "lower").c_str(), axis.lower,
                ("be below upper = " + number_text(axis.upper)).c_str());
  require(axis.motor.kind == MotorKind::none || bool(axis.motor.target),
          who + "motor.target must be callable");
  require_field(prescribes_motion(axis.motor) || axis.motor.limit == kInf, (who + "motor.limit").c_str(),
                axis.motor.limit, "be infinite: only a motor of speed or position reads it");
  require(axis.motor.kind != MotorKind::none || !axis.motor.target,
          who + "motor.target is set, but the kind of the motor is none");
}

// For axes that the joint lacks: nothing acts along them.
bool is_plain(const JointAxis& axis) {
  return axis.lower == -kInf && axis.upper == kInf && axis.friction == 0 && axis.stiffness == 0 &&
         axis.damping == 0 && axis.motor.kind == MotorKind::none;
}

void check_joint(const Joint& joint, JointId index, const Table<BodyId, RigidBody>& bodies) {
  const std::string who = "joint " + to_string(index) + " (" + joint.name + "): ";
  const std::string range = "lie in [-1, " + to_string(bodies.next()) + "), -1 being the world";
  require_field(joint.body_a == kWorld || bodies.contains(joint.body_a), (who + "body_a").c_str(),
                joint.body_a, range.c_str());
  require_field(joint.body_b == kWorld || bodies.contains(joint.body_b), (who + "body_b").c_str(),
                joint.body_b, range.c_str());
  require_field(joint.body_a != joint.body_b, (who + "body_b").c_str(), joint.body_b, "differ from body_a");
  const auto moves = [&](BodyId body) { return body && has_inertia(bodies[body]); };
  require(moves(joint.body_a) || moves(joint.body_b), who + "one of its bodies must be dynamic");
  checked_pose(joint.frame_a, (who + "frame_a").c_str());
  checked_pose(joint.frame_b, (who + "frame_b").c_str());
  if (joint.kind == JointKind::screw)
    require_field(joint.pitch != 0 && std::isfinite(joint.pitch), (who + "pitch").c_str(), joint.pitch,
                  "be finite and not 0 [m/turn]");
  else
    require_field(joint.pitch == 0, (who + "pitch").c_str(), joint.pitch, "be 0: only a screw reads it");
  if (joint.kind == JointKind::distance)
    require_field(joint.length > 0 && std::isfinite(joint.length), (who + "length").c_str(), joint.length,
                  "be positive and finite [m]");
  else
    require_field(joint.length == 0, (who + "length").c_str(), joint.length,
                  "be 0: only a distance reads it");
  for (int i = 0; i < axis_count(joint.kind); ++i)
    check_axis(joint.axis[i], who + "axis[" + std::to_string(i) + "].");
  for (std::size_t i = std::size_t(axis_count(joint.kind)); i < joint.axis.size(); ++i)
    require(is_plain(joint.axis[i]),
            who + "axis[" + std::to_string(i) + "] has a stop, friction, spring or motor, but a " +
                to_string(joint.kind) + " joint has " + std::to_string(axis_count(joint.kind)) + " axes");
}

// Joint::collide and Model::passing must not contradict each other.
void check_collide(const Joint& joint, JointId index, const Model& model) {
  if (!joint.collide) return;
  const std::string who = "joint " + to_string(index) + " (" + joint.name + "): collide ";
  require(joint.body_a && joint.body_b, who + "needs two bodies: the world has no shape");
  require(!model.passing.contains(ordered_pair(joint.body_a, joint.body_b)),
          who + "contradicts Model::passing, where its bodies are; joints without collide put them there");
}

void check_coupling(const Coupling& coupling, int index, const Table<JointId, Joint>& joints) {
  const std::string who = "coupling " + std::to_string(index) + " (" + coupling.name + "): ";
  const auto check_end = [&](JointId joint, int axis, const char* field_joint, const char* field_axis) {
    require_field(joints.contains(joint), (who + field_joint).c_str(), joint,
                  ("lie in [0, " + to_string(joints.next()) + ")").c_str());
    const int axes = axis_count(joints[joint].kind);
    require_field(axis >= 0 && axis < axes, (who + field_axis).c_str(), axis,
                  ("lie in [0, " + std::to_string(axes) + "), the axes of the joint").c_str());
  };
  check_end(coupling.joint_1, coupling.axis_1, "joint_1", "axis_1");
  check_end(coupling.joint_2, coupling.axis_2, "joint_2", "axis_2");
  require(coupling.joint_1 != coupling.joint_2 || coupling.axis_1 != coupling.axis_2,
          who + "its two axes must differ");
  require_field(coupling.ratio != 0 && std::isfinite(coupling.ratio), (who + "ratio").c_str(), coupling.ratio,
                "be finite and not 0");
  require_field(std::isfinite(coupling.offset), (who + "offset").c_str(), coupling.offset, "be finite");
}

// What `add_tree` made must still fit.
void check_tree(const Model& model, const Coordinates& block, BlockId index, const std::string& who) {
  require(!block.mass && !block.force && !block.potential && block.points.empty(),
          who + "mass, points, force and potential must be empty: the bodies of its tree have masses");
  int size = 0;
  for (int i = 0; i < int(block.tree.links.size()); ++i) {
    const TreeLink& link = block.tree.links[std::size_t(i)];
    const std::string of = who + "link " + std::to_string(i) + ": ";
    require(model.joints.contains(link.joint) && model.joints[link.joint].tree == index &&
                model.joints[link.joint].link == i,
            of + "its joint must be one that add_tree gave it");
    const auto* carried = model.bodies.contains(link.body)
                              ? std::get_if<CarriedMotion>(&model.bodies[link.body].motion)
                              : nullptr;
    require(carried && carried->tree == index && carried->link == i, of + "its body must be carried by it");
    require(link.parent >= -1 && link.parent < i && link.first == size, of + "must come after its parent");
    size += axis_count(model.joints[link.joint].kind);
  }
  require_field(block.size == size, (who + "size").c_str(), block.size,
                ("be " + std::to_string(size) + ", the number of the joints' axes").c_str());
  const BodyId base = block.tree.base;
  require(!base || (model.bodies.contains(base) && !is_moved(model.bodies[base]) &&
                    !is_carried(model.bodies[base])),
          who + "the base must be the world, a fixed body or a dynamic one");
}

void check_block(const Model& model, const Coordinates& block, BlockId index) {
  const std::string who = "coordinates " + to_string(index) + " (" + block.name + "): ";
  require_field(block.size >= 1, (who + "size").c_str(), block.size, "be at least 1");
  if (is_tree(block)) return check_tree(model, block, index, who);
  if (block.points.empty()) {
    require(bool(block.mass), who + "mass must be callable");
    return;
  }
  require(
      !block.mass && !block.force && !block.potential,
      who + "mass, force and potential must be empty: its points have masses, and force laws act on them");
  require_field(block.size == 3 * std::ssize(block.points), (who + "size").c_str(), block.size,
                ("be " + std::to_string(3 * block.points.size()) + ", three for each of its points").c_str());
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const PointMass& point = block.points[i];
    const std::string of = who + "point " + std::to_string(i) + ": ";
    require_field(point.mass >= 0 && std::isfinite(point.mass), (of + "mass").c_str(), point.mass,
                  "be finite and not negative [kg]");
    require(point.place.allFinite(), of + "place must be finite [m]");
  }
}

void check_gap(const GapFunction& gap, GapId index, const Table<BlockId, Coordinates>& blocks) {
  const std::string who = "gap function " + to_string(index) + " (" + gap.name + "): ";
  require_field(gap.block == BlockId() || blocks.contains(gap.block), (who + "block").c_str(), gap.block,
                ("lie in [-1, " + to_string(blocks.next()) + ")").c_str());
  require(bool(gap.evaluate), who + "evaluate must be callable");
  check_ranges(gap.law, who + "law.");
  require_field(gap.law.contensou_radius == 0, (who + "law.contensou_radius").c_str(),
                gap.law.contensou_radius, "be 0: a gap function has no spin");
}

}  // namespace

ShapeId add(Model& model, LmdShape shape) {
  return model.shapes.append(std::make_shared<const LmdShape>(std::move(shape)));
}

BodyId add(Model& model, RigidBody body) {
  check_body(body, model.bodies.next(), model);
  check_deformation(body, model.bodies.next(), model);
  return model.bodies.append(std::move(body));
}

JointId add(Model& model, Joint joint) {
  const JointId index = model.joints.next();
  check_joint(joint, index, model.bodies);
  check_collide(joint, index, model);
  if (!joint.collide && joint.body_a && joint.body_b) {
    const BodyPair pair = ordered_pair(joint.body_a, joint.body_b);
    for (const Joint& other : model.joints)
      require(!other.collide || ordered_pair(other.body_a, other.body_b) != pair,
              "joint " + to_string(index) + " (" + joint.name + "): without collide contradicts joint " +
                  other.name + " of the same bodies, which has it");
    model.passing.insert(pair);
  }
  return model.joints.append(std::move(joint));
}

void add(Model& model, Coupling coupling) {
  check_coupling(coupling, int(model.couplings.size()), model.joints);
  model.couplings.push_back(std::move(coupling));
}

BlockId add(Model& model, Coordinates block) {
  check_block(model, block, model.coordinates.next());
  return model.coordinates.append(std::move(block));
}

GapId add(Model& model, GapFunction gap) {
  check_gap(gap, model.gaps.next(), model.coordinates);
  return model.gaps.append(std::move(gap));
}

int add_inputs(Model& model, int count) {
  require_field(count > 0, "add_inputs: count", count, "be positive");
  return std::exchange(model.inputs, model.inputs + count);
}

void add(Model& model, ForceLaw law) {
  require(bool(law.add_to), "force law (" + law.name + "): add_to must be callable");
  model.forces.push_back(std::move(law));
}

const ContactLaw& contact_law(const Model& model, BodyId body_a, BodyId body_b) {
  const auto named = model.pair_laws.find(ordered_pair(body_a, body_b));
  return named == model.pair_laws.end() ? model.contact_law : named->second;
}

std::vector<ContactLaw> contact_laws(const Model& model) {
  std::vector<ContactLaw> out{model.contact_law};
  const auto add = [&](const ContactLaw& law) {
    if (std::ranges::find(out, law) == out.end()) out.push_back(law);
  };
  for (const auto& named : model.pair_laws) add(named.second);
  for (const GapFunction& gap : model.gaps) add(gap.law);
  return out;
}

bool carries_bodies(const Model& model) {
  return std::ranges::any_of(model.coordinates, is_tree);
}

int first_coordinate(const Model& model, BlockId block) {
  int first = 0;
  for (const BlockId i : IdRange(block)) first += model.coordinates[i].size;
  return first;
}

int first_speed(const Model& model, BlockId block) {
  return first_velocity(model.bodies.next()) + first_coordinate(model, block);
}

int velocity_count(const Model& model) {
  return first_speed(model, model.coordinates.next());
}

int gap_columns(const Model& model, const GapFunction& gap) {
  return gap.block ? model.coordinates[gap.block].size : velocity_count(model);
}

void validate(const Model& model) {
  require(!model.bodies.empty() || !model.coordinates.empty(),
          "model: has neither bodies nor coordinates, nothing can move");
  require(model.gravity.allFinite(), "model: gravity must be finite [m/s^2]");
  check_ranges(model.contact_law, "model: contact_law.");
  const BodyId end = model.bodies.next();
  for (const auto& [pair, law] : model.pair_laws) {
    const std::string who = "model: pair_laws{" + to_string(pair.a) + ", " + to_string(pair.b) + "}";
    require(pair.a && pair.a < pair.b && pair.b < end,
            who + ": bodies must be different, in [0, " + to_string(end) + ") and the smaller first");
    check_ranges(law, who + ".");
  }
  for (const ShapeId i : model.shapes.ids())
    require(model.shapes[i] != nullptr, "model: shape " + to_string(i) + " must not be empty");
  for (const BodyId i : model.bodies.ids()) {
    check_body(model.bodies[i], i, model);
    check_deformation(model.bodies[i], i, model);
  }
  for (const auto& [a, b] : model.passing)
    require(a && a < b && b < end, "model: passing{" + to_string(a) + ", " + to_string(b) +
                                       "}: bodies must be different, in [0, " + to_string(end) +
                                       ") and the smaller first");
  for (const JointId i : model.joints.ids()) {
    check_joint(model.joints[i], i, model.bodies);
    check_collide(model.joints[i], i, model);
  }
  for (std::size_t i = 0; i < model.couplings.size(); ++i)
    check_coupling(model.couplings[i], int(i), model.joints);
  for (const BlockId i : model.coordinates.ids()) check_block(model, model.coordinates[i], i);
  for (const GapId i : model.gaps.ids()) check_gap(model.gaps[i], i, model.coordinates);
  for (const ForceLaw& law : model.forces)
    require(bool(law.add_to), "force law (" + law.name + "): add_to must be callable");
}

}  // namespace aussois
