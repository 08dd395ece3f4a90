// SPDX-License-Identifier: Apache-2.0
#include "mechanics/model.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
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

void check_body(const RigidBody& body, int index, std::size_t shape_count) {
  const std::string who = "body " + std::to_string(index) + " (" + body.name + "): ";
  require_field(body.shape >= -1 && body.shape < int(shape_count), (who + "shape").c_str(), body.shape,
                ("lie in [-1, " + std::to_string(shape_count) + ")").c_str());
  checked_pose(body.g_bs, (who + "g_bs").c_str());
  if (is_dynamic(body)) {
    require_field(body.mass > 0 && std::isfinite(body.mass), (who + "mass").c_str(), body.mass,
                  "be positive and finite [kg]");
    check_inertia(body.inertia, who);
  }
  if (const Prescribed* prescribed = std::get_if<Prescribed>(&body.motion)) {
    try {
      validate(prescribed->path);
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument(who + error.what());
    }
  }
}

void check_deformation(const RigidBody& body, int index, const Model& model) {
  if (!deforms(body)) return;
  const std::string who = "body " + std::to_string(index) + " (" + body.name + "): deformation ";
  require(bool(body.deformation.columns), who + "needs columns beside vertices");
  require(body.shape >= 0, who + "needs a shape");
  require(keeps_features(*model.shapes[body.shape]),
          who + "needs a shape prepared with LmdShapeOptions::deforming");
  require(!is_moved(body), who + "needs a dynamic or fixed body");
}

void check_law(const ContactLaw& law, const std::string& who) {
  require_field(law.mu >= 0 && std::isfinite(law.mu), (who + "mu").c_str(), law.mu,
                "be at least 0 and finite");
  require_field(law.restitution >= 0 && law.restitution <= 1, (who + "restitution").c_str(), law.restitution,
                "lie in [0, 1]");
  require_field(law.contensou_radius >= 0 && std::isfinite(law.contensou_radius),
                (who + "contensou_radius").c_str(), law.contensou_radius, "be at least 0 and finite [m]");
}

void check_axis(const JointAxis& axis, const std::string& who) {
  const auto at_least_0 = [&](double value, const char* field) {
    require_field(value >= 0 && std::isfinite(value), (who + field).c_str(), value,
                  "be at least 0 and finite");
  };
  require_field(axis.lower < axis.upper, (who + "lower").c_str(), axis.lower,
                ("be below upper = " + number_text(axis.upper)).c_str());
  require_field(axis.restitution >= 0 && axis.restitution <= 1, (who + "restitution").c_str(),
                axis.restitution, "lie in [0, 1]");
  at_least_0(axis.friction, "friction");
  at_least_0(axis.stiffness, "stiffness");
  at_least_0(axis.damping, "damping");
  require_field(std::isfinite(axis.rest), (who + "rest").c_str(), axis.rest, "be finite");
  require_field(axis.motor.limit > 0, (who + "motor.limit").c_str(), axis.motor.limit, "be positive");
  require(axis.motor.kind == MotorKind::none || bool(axis.motor.target),
          who + "motor.target must be callable");
}

// An axis that the joint has not: nothing acts along it.
bool is_plain(const JointAxis& axis) {
  return axis.lower == -kInf && axis.upper == kInf && axis.friction == 0 && axis.stiffness == 0 &&
         axis.damping == 0 && axis.motor.kind == MotorKind::none;
}

void check_joint(const Joint& joint, int index, const std::vector<RigidBody>& bodies) {
  const std::string who = "joint " + std::to_string(index) + " (" + joint.name + "): ";
  const int count = int(bodies.size());
  const std::string range = "lie in [-1, " + std::to_string(count) + "), -1 being the world";
  require_field(joint.body_a >= -1 && joint.body_a < count, (who + "body_a").c_str(), joint.body_a,
                range.c_str());
  require_field(joint.body_b >= -1 && joint.body_b < count, (who + "body_b").c_str(), joint.body_b,
                range.c_str());
  require_field(joint.body_a != joint.body_b, (who + "body_b").c_str(), joint.body_b, "differ from body_a");
  const auto moves = [&](int body) { return body >= 0 && is_dynamic(bodies[body]); };
  require(moves(joint.body_a) || moves(joint.body_b), who + "one of its bodies must be dynamic");
  checked_pose(joint.frame_a, (who + "frame_a").c_str());
  checked_pose(joint.frame_b, (who + "frame_b").c_str());
  if (joint.kind == JointKind::screw)
    require_field(joint.pitch != 0 && std::isfinite(joint.pitch), (who + "pitch").c_str(), joint.pitch,
                  "be finite and not 0 [m/turn]");
  if (joint.kind == JointKind::distance)
    require_field(joint.length > 0 && std::isfinite(joint.length), (who + "length").c_str(), joint.length,
                  "be positive and finite [m]");
  for (int i = 0; i < axis_count(joint.kind); ++i)
    check_axis(joint.axis[i], who + "axis[" + std::to_string(i) + "].");
  for (std::size_t i = std::size_t(axis_count(joint.kind)); i < joint.axis.size(); ++i)
    require(is_plain(joint.axis[i]),
            who + "axis[" + std::to_string(i) + "] has a stop, friction, spring or motor, but a " +
                to_string(joint.kind) + " joint has " + std::to_string(axis_count(joint.kind)) + " axes");
}

// Joint::collide and Model::passing must not contradict each other.
void check_collide(const Joint& joint, int index, const Model& model) {
  if (!joint.collide) return;
  const std::string who = "joint " + std::to_string(index) + " (" + joint.name + "): collide ";
  require(joint.body_a >= 0 && joint.body_b >= 0, who + "needs two bodies: the world has no shape");
  require(!model.passing.contains(std::minmax(joint.body_a, joint.body_b)),
          who + "contradicts Model::passing, where its bodies are; joints without collide put them there");
}

void check_coupling(const Coupling& coupling, int index, const std::vector<Joint>& joints) {
  const std::string who = "coupling " + std::to_string(index) + " (" + coupling.name + "): ";
  const auto check_end = [&](int joint, int axis, const char* field_joint, const char* field_axis) {
    require_field(joint >= 0 && joint < int(joints.size()), (who + field_joint).c_str(), joint,
                  ("lie in [0, " + std::to_string(joints.size()) + ")").c_str());
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

void check_block(const Coordinates& block, int index) {
  const std::string who = "coordinates " + std::to_string(index) + " (" + block.name + "): ";
  require_field(block.size >= 1, (who + "size").c_str(), block.size, "be at least 1");
  require(bool(block.mass), who + "mass must be callable");
}

void check_gap(const GapFunction& gap, int index, std::size_t block_count) {
  const std::string who = "gap function " + std::to_string(index) + " (" + gap.name + "): ";
  require_field(gap.block >= -1 && gap.block < int(block_count), (who + "block").c_str(), gap.block,
                ("lie in [-1, " + std::to_string(block_count) + ")").c_str());
  require(bool(gap.evaluate), who + "evaluate must be callable");
  check_law(gap.law, who + "law.");
  require_field(gap.law.contensou_radius == 0, (who + "law.contensou_radius").c_str(),
                gap.law.contensou_radius, "be 0: a gap function has no spin");
}

}  // namespace

int add(Model& model, LmdShape shape) {
  model.shapes.push_back(std::make_shared<const LmdShape>(std::move(shape)));
  return int(model.shapes.size()) - 1;
}

int add(Model& model, RigidBody body) {
  check_body(body, int(model.bodies.size()), model.shapes.size());
  check_deformation(body, int(model.bodies.size()), model);
  model.bodies.push_back(std::move(body));
  return int(model.bodies.size()) - 1;
}

int add(Model& model, Joint joint) {
  const int index = int(model.joints.size());
  check_joint(joint, index, model.bodies);
  check_collide(joint, index, model);
  if (!joint.collide && joint.body_a >= 0 && joint.body_b >= 0) {
    const auto pair = std::minmax(joint.body_a, joint.body_b);
    for (const Joint& other : model.joints)
      require(!other.collide || std::minmax(other.body_a, other.body_b) != pair,
              "joint " + std::to_string(index) + " (" + joint.name + "): without collide contradicts joint " +
                  other.name + " of the same bodies, which has it");
    model.passing.insert(pair);
  }
  model.joints.push_back(std::move(joint));
  return index;
}

void add(Model& model, Coupling coupling) {
  check_coupling(coupling, int(model.couplings.size()), model.joints);
  model.couplings.push_back(std::move(coupling));
}

int add(Model& model, Coordinates block) {
  check_block(block, int(model.coordinates.size()));
  model.coordinates.push_back(std::move(block));
  return int(model.coordinates.size()) - 1;
}

int add(Model& model, GapFunction gap) {
  check_gap(gap, int(model.gaps.size()), model.coordinates.size());
  model.gaps.push_back(std::move(gap));
  return int(model.gaps.size()) - 1;
}

void add(Model& model, ForceLaw law) {
  require(bool(law.add_to), "force law (" + law.name + "): add_to must be callable");
  model.forces.push_back(std::move(law));
}

const ContactLaw& contact_law(const Model& model, int body_a, int body_b) {
  const auto named = model.pair_laws.find(std::minmax(body_a, body_b));
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

int first_coordinate(const Model& model, int block) {
  int first = 0;
  for (int i = 0; i < block; ++i) first += model.coordinates[i].size;
  return first;
}

int first_speed(const Model& model, int block) {
  return first_velocity(int(model.bodies.size())) + first_coordinate(model, block);
}

int velocity_count(const Model& model) {
  return first_speed(model, int(model.coordinates.size()));
}

int gap_columns(const Model& model, const GapFunction& gap) {
  return gap.block < 0 ? velocity_count(model) : model.coordinates[gap.block].size;
}

void validate(const Model& model) {
  require(!model.bodies.empty() || !model.coordinates.empty(),
          "model: has neither bodies nor coordinates, nothing can move");
  require(model.gravity.allFinite(), "model: gravity must be finite [m/s^2]");
  check_law(model.contact_law, "model: contact_law.");
  const int count = int(model.bodies.size());
  for (const auto& [pair, law] : model.pair_laws) {
    const std::string who =
        "model: pair_laws{" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + "}";
    require(0 <= pair.first && pair.first < pair.second && pair.second < count,
            who + ": bodies must be different, in [0, " + std::to_string(count) + ") and the smaller first");
    check_law(law, who + ".");
  }
  for (std::size_t i = 0; i < model.shapes.size(); ++i)
    require(model.shapes[i] != nullptr, "model: shape " + std::to_string(i) + " must not be empty");
  for (int i = 0; i < count; ++i) {
    check_body(model.bodies[i], i, model.shapes.size());
    check_deformation(model.bodies[i], i, model);
  }
  for (const auto& [a, b] : model.passing)
    require(0 <= a && a < b && b < count, "model: passing{" + std::to_string(a) + ", " + std::to_string(b) +
                                              "}: bodies must be different, in [0, " + std::to_string(count) +
                                              ") and the smaller first");
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    check_joint(model.joints[i], int(i), model.bodies);
    check_collide(model.joints[i], int(i), model);
  }
  for (std::size_t i = 0; i < model.couplings.size(); ++i)
    check_coupling(model.couplings[i], int(i), model.joints);
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) check_block(model.coordinates[i], int(i));
  for (std::size_t i = 0; i < model.gaps.size(); ++i)
    check_gap(model.gaps[i], int(i), model.coordinates.size());
  for (const ForceLaw& law : model.forces)
    require(bool(law.add_to), "force law (" + law.name + "): add_to must be callable");
}

}  // namespace aussois
