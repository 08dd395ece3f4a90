// SPDX-License-Identifier: Apache-2.0
// Beams: elements between nodes that are bodies, as one force law (doc/theory/beams.md).
#pragma once

#include <string>
#include <vector>

#include "geometry/settings.hpp"
#include "lmd/body_id.hpp"
#include "mechanics/beam_element.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/rigid_body.hpp"

namespace aussois {

/// Stiffness and damping of a cross-section in the order of the strains: along x, shear y, shear z, twist,
/// bending about y, bending about z.
struct BeamSection {
  Vec6 stiffness = Vec6::Zero();           // EA, GA2, GA3 [N]; GJ, EI2, EI3 [N m^2]; > 0
  Vec6 damping = Vec6::Zero();             // the same times a time [N s], [N m^2 s]; >= 0
  double mass_per_length = 0;              // [kg/m], > 0
  Vec3 inertia_per_length = Vec3::Zero();  // about x, y and z [kg m], > 0
};

/// A full circle of one material, with the shear coefficient of Cowper (1966). `describe` gives the ranges.
struct RoundSection {
  double radius = 0;             // [m]
  double young = 0;              // [Pa]
  double poisson = 0.3;          // in (-1, 1/2) [-]
  double density = 0;            // [kg/m^3]
  double bending_stiffness = 0;  // EI of a rope, which bends more easily [N m^2]; 0: that of the circle
  double damping_time = 0;       // damping over stiffness [s]
};
void describe(SettingVisitor& visit, RoundSection& round);
/// Throws std::invalid_argument: field, value, bound.
BeamSection beam_section(const RoundSection& round);

/// Between two nodes; its x axis leads from a to b. One of them may be fixed or moved.
struct BeamElement {
  BodyId body_a{}, body_b{};
  int section = 0;           // of Beam::sections
  SE3 frame_a{}, frame_b{};  // of its ends, seen from the bodies
  double length = 0;         // [m], > 0
  Vec6 rest = Vec6::Zero();  // log(g_a^-1 g_b) without stress (BEA-1) [m, rad]
};

struct Beam {
  std::string name{};
  std::vector<BeamSection> sections{};
  std::vector<BeamElement> elements{};
};

/// Straight and free of stress: rest = (length, 0, 0, 0, 0, 0).
Vec6 straight_rest(double length);

/// Throws std::invalid_argument naming the beam, the element or section, the field, its value and its bound.
void validate(const Beam& beam, const Table<BodyId, RigidBody>& bodies);
/// Validates, then adds the force of the beam to the model, which must have its nodes.
void add(Model& model, Beam beam);

/// What an element bears.
struct BeamLoad {
  Vec6 strain = Vec6::Zero();  // (Gamma [-], K [1/m])
  Vec6 stress = Vec6::Zero();  // (N [N], M [N m]), damping included, in the axes of the element
};
std::vector<BeamLoad> beam_loads(const Beam& beam, const State& state);
/// Elastic energy of all elements [J].
double beam_energy(const Beam& beam, const State& state);
/// Names the first element that turns by more than kLargestBeamTurn; empty: there is none.
std::string beam_refusal(const Beam& beam, const State& state);

/// Mass and inertia (about the end of an element, in the body's axes) that the elements give to each node
/// (half of each element to either), to be set in its RigidBody. Nodes of no element get nothing.
struct NodeMass {
  double mass = 0;              // [kg]
  Mat3 inertia = Mat3::Zero();  // [kg m^2]
};
PerBody<NodeMass> node_masses(const Beam& beam, std::size_t body_count);

}  // namespace aussois
