// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/trees.hpp"

#include <cmath>
#include <string>

#include "geometry/primitives.hpp"
#include "mechanics/tree.hpp"

namespace aussois {
namespace {

const SE3 kAboutY = rotation(Vec3::UnitX(), -kPi / 2);  // z of the frame along y

// A rod along z.
RigidBody rod(const std::string& name, double mass, double length, double radius) {
  const double across = mass * (length * length / 12 + radius * radius / 4);
  return {
      .name = name, .mass = mass, .inertia = Vec3(across, across, mass * radius * radius / 2).asDiagonal()};
}

// Twists of a motion that the coordinates of trees describe.
void start_with(TreeScene& scene, const std::vector<double>& q, const std::vector<double>& v) {
  Model model = scene.bodies.model;
  for (const std::vector<JointId>& joints : scene.trees) add_tree(model, "tree", joints);
  State state = rest_state(model);
  state.g = scene.bodies.state.g;
  state.q = Eigen::Map<const VecX>(q.data(), state.q.size());
  state.v.tail(state.q.size()) = Eigen::Map<const VecX>(v.data(), state.q.size());
  carry(model, state);
  scene.bodies.state.g = state.g;
  scene.bodies.state.v = state.v.head(scene.bodies.state.v.size());
}

}  // namespace

CaseScene in_joint_coordinates(const TreeScene& scene) {
  CaseScene out = scene.bodies;
  for (const std::vector<JointId>& joints : scene.trees) add_tree(out.model, "tree", joints);
  out.state = in_joint_coordinates(out.model, scene.bodies.state);
  return out;
}

TreeScene rods_in_a_row(int rods, double bend) {
  TreeScene out;
  Model& model = out.bodies.model;
  const double length = 1.0 / rods;
  for (int i = 0; i < rods; ++i) add(model, rod("rod", 1.0 / rods, length, 0.02 * length));
  State& state = out.bodies.state = rest_state(model);
  out.trees.emplace_back();
  for (int i = 0; i < rods; ++i) {
    state.g[BodyId::at(i)].p.z() = -(i + 0.5) * length;
    out.trees[0].push_back(
        add(model, joint_at(JointKind::revolute, "hinge " + std::to_string(i), BodyId::at(i),
                            BodyId::at(i - 1), state.g, translation(0, 0, -i * length) * kAboutY)));
  }
  std::vector<double> q(std::size_t(rods), 0), v(std::size_t(rods), 0);
  q[0] = 0.4, v[0] = 1;
  if (rods > 1) q[1] = bend;
  start_with(out, q, v);
  out.bodies.body = BodyId::at(rods - 1);
  return out;
}

TreeScene four_bar() {
  constexpr double kCrank = 0.3, kCoupler = 0.8, kRocker = 0.6, kGround = 0.9;
  TreeScene out;
  Model& model = out.bodies.model;
  const double lengths[] = {kCrank, kCoupler, kRocker};
  const char* names[] = {"crank", "coupler", "rocker"};
  for (int i = 0; i < 3; ++i) add(model, rod(names[i], 1, lengths[i], 0.01));
  State& state = out.bodies.state = rest_state(model);
  // The crank upright; the triangle of coupler and rocker over its end and the rocker's hinge.
  const Vec3 end(0, 0, kCrank), hinge(kGround, 0, 0), across = hinge - end;
  const double d = across.norm(), along = (kCoupler * kCoupler - kRocker * kRocker + d * d) / (2 * d),
               up = std::sqrt(kCoupler * kCoupler - along * along);
  const Vec3 unit = across / d, top = end + along * unit + up * Vec3(-unit.z(), 0, unit.x());
  const auto lay = [&](int i, const Vec3& from, const Vec3& to) {
    state.g[BodyId::at(i)] = {Quat::FromTwoVectors(Vec3::UnitZ(), to - from), (from + to) / 2};
  };
  lay(0, Vec3::Zero(), end), lay(1, end, top), lay(2, top, hinge);
  const auto hinge_at = [&](const char* name, BodyId a, BodyId b, const Vec3& at) {
    return add(model,
               joint_at(JointKind::revolute, name, a, b, state.g, SE3{Quat::Identity(), at} * kAboutY));
  };
  out.trees.push_back(
      {hinge_at("ground", 0, kWorld, Vec3::Zero()), hinge_at("end", 1, 0, end), hinge_at("top", 2, 1, top)});
  hinge_at("closing", 2, kWorld, hinge);
  out.bodies.body = 2;
  return out;
}

TreeScene arm_with_peg() {
  constexpr double kDilation = 1e-3, kPegRadius = 0.02, kPegLength = 0.1;
  constexpr double kLength[] = {0.17, 0.17, 0.2, 0.2, 0.2, 0.2, 0.126 + kPegLength};
  constexpr double kMass[] = {4, 4, 3, 2.7, 1.7, 1.8, 0.5};
  TreeScene out;
  Model& model = out.bodies.model;
  model.contact_law = {.mu = 0.3};
  const SimplicialComplex core = make_cylinder(kPegRadius - kDilation, kPegLength - 2 * kDilation, 24);
  const ShapeId peg = add(model, prepare(dilate(core, kDilation)));
  const ShapeId plate = add(model, prepare(dilate(make_plate(1, 1), kDilation)));
  for (int i = 0; i < 7; ++i) {
    RigidBody link = rod("link " + std::to_string(i + 1), kMass[i], kLength[i], 0.05);
    if (i == 6) link.shape = peg, link.g_bs = translation(0, 0, (kLength[6] - kPegLength) / 2);
    add(model, std::move(link));
  }
  const BodyId ground = add(model, fixed_body("plate", plate));
  State& state = out.bodies.state = rest_state(model);
  double z = 0;
  out.trees.emplace_back();
  const double stiffness[] = {800, 800, 400, 400, 80, 80, 8};
  const double rest[] = {0, 0.6, 0, 1.4, 0, kPi - 2, 0},
               start[] = {0.1, 0.55, 0.05, 1.4, 0.1, kPi - 1.9, 0.2};
  for (int i = 0; i < 7; ++i) {
    state.g[BodyId::at(i)].p.z() = z + kLength[i] / 2;
    Joint joint = joint_at(JointKind::revolute, "axis " + std::to_string(i + 1), BodyId::at(i),
                           BodyId::at(i - 1), state.g, translation(0, 0, z) * (i % 2 == 0 ? SE3{} : kAboutY));
    joint.axis[0] = {.stiffness = stiffness[i], .damping = stiffness[i] / 40, .rest = rest[i]};
    out.trees[0].push_back(add(model, std::move(joint)));
    z += kLength[i];
  }
  start_with(out, {std::begin(start), std::end(start)}, std::vector<double>(7, 0));
  out.bodies.body = 6;
  const SE3& last = state.g[out.bodies.body];
  state.g[ground].p = last * Vec3(0, 0, kLength[6] / 2) - Vec3(0, 0, 0.03);
  return out;
}

}  // namespace aussois
