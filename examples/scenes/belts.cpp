// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/belts.hpp"

#include <cmath>

#include "examples/scenes/beams.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

// Nodes along the belt, counter-clockwise; its chords touch the pulleys.
std::vector<Vec3> belt_nodes() {
  constexpr double kWay = BeltDrive::kPulley + BeltDrive::kRadius;
  constexpr int kFine = 2000;
  const double out = kWay / std::cos(BeltDrive::chord_angle() / 2);
  std::vector<Vec3> line;
  for (const double side : {1.0, -1.0})
    for (int i = 0; i <= kFine; ++i) {
      const double a = kPi * (double(i) / kFine - 0.5);
      line.push_back(side * Vec3(BeltDrive::kApart / 2 + out * std::cos(a), out * std::sin(a), 0));
    }
  line.push_back(line.front());
  std::vector<Vec3> nodes = points_along(line, BeltDrive::kElements + 1);
  nodes.pop_back();
  return nodes;
}

}  // namespace

double BeltDrive::chord_angle() {
  const double way = kPulley + kRadius;
  return (2 * kApart + 2 * kPi * way) / kElements / way;
}

BeltDrive::BeltDrive(double slower, double damping_time) {
  model.gravity = Vec3::Zero();
  model.contact_law.mu = kMu;
  const SimplicialComplex axle = make_polyline({Vec3(0, 0, -0.03), Vec3(0, 0, 0.03)});
  const ShapeId round = add(model, prepare(dilate(axle, kPulley)));
  for (BodyId& pulley : pulleys)
    pulley = add(model, RigidBody{.name = "pulley", .shape = round, .motion = DrivenMotion{}});
  const std::vector<Vec3> nodes = belt_nodes();
  std::vector<Vec3> loose;
  for (const Vec3& x : nodes) loose.push_back((1 - kTension / kStiffness) * x);
  BeamSection tape = section_of(
      {.EA = kStiffness, .GA = kStiffness, .GJ = 1, .EI = 1, .mass = 1e-2, .about_x = 2e-8, .across = 1e-8});
  tape.damping = damping_time * tape.stiffness;
  tape.stiffness[4] = 1e-4;  // about z, which y of the nodes is along
  belt = add_cable(
      model,
      {.name = "belt", .nodes = frames_along(loose), .section = tape, .radius = kRadius, .closed = true});
  state = rest_state(model);
  lay(belt, state);
  for (std::size_t i = 0; i < nodes.size(); ++i) pose(state, belt.nodes[i]).p = nodes[i];
  for (const std::size_t k : {0u, 1u}) {
    pose(state, pulleys[k]).p.x() = (k == 0 ? -1 : 1) * kApart / 2;
    angular_part(state.v, pulleys[k]).z() = kSpeed / (kPulley + kRadius) * (k == 0 ? 1 : 1 - slower);
  }
}

CaseScene belt_drive() {
  BeltDrive drive(0.01, 5e-3);
  return {.model = std::move(drive.model), .state = std::move(drive.state), .body = drive.pulleys[1]};
}

}  // namespace aussois
