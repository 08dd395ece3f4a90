// SPDX-License-Identifier: Apache-2.0
// Everything that stays constant during a run: shapes, bodies, joints, coordinates, laws.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>

#include "lmd/lmd_shape.hpp"
#include "mechanics/contact_law.hpp"
#include "mechanics/coordinates.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/joint.hpp"
#include "mechanics/rigid_body.hpp"

namespace aussois {

struct Model {
  Vec3 gravity = {0, 0, -9.81};                           // [m/s^2]
  ContactLaw contact_law{};                               // of every pair that is not listed below
  std::map<std::pair<int, int>, ContactLaw> pair_laws{};  // by body indices, the smaller first
  // Pairs that pass through each other, the smaller first: no contacts, no certificate
  std::set<std::pair<int, int>> passing{};
  std::vector<std::shared_ptr<const LmdShape>> shapes{};  // immutable, shared between bodies
  std::vector<RigidBody> bodies{};
  std::vector<Joint> joints{};
  std::vector<Coupling> couplings{};       // of the joints' coordinates
  std::vector<Coordinates> coordinates{};  // beside the bodies
  std::vector<GapFunction> gaps{};
  std::vector<ForceLaw> forces{};
};

int add(Model& model, LmdShape shape);  // returns its index
int add(Model& model, RigidBody body);  // returns its index; throws like validate
/// Returns its index; throws like validate. Without Joint::collide the two bodies pass through each other
/// from now on (Model::passing). All joints between two bodies must agree on this; throws if they do not.
int add(Model& model, Joint joint);
void add(Model& model, Coupling coupling);  // throws like validate
int add(Model& model, Coordinates block);   // returns its index; throws like validate
int add(Model& model, GapFunction gap);     // returns its index; throws like validate
void add(Model& model, ForceLaw law);
const ContactLaw& contact_law(const Model& model, int body_a, int body_b);
/// The distinct contact laws of a model: of pairs that are not listed, of those that are, of gap functions.
std::vector<ContactLaw> contact_laws(const Model& model);

/// Length of State::v: six per body, then the coordinates.
int velocity_count(const Model& model);
/// First entry of a block in State::q, and of its speeds in State::v. If `block` is the number of blocks: one
/// past the last entry.
int first_coordinate(const Model& model, int block);
int first_speed(const Model& model, int block);
/// Number of columns that J of a gap function must have.
int gap_columns(const Model& model, const GapFunction& gap);

/// Throws std::invalid_argument naming the body, joint or block, the field, its value and its bound.
void validate(const Model& model);

}  // namespace aussois
