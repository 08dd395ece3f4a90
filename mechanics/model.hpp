// SPDX-License-Identifier: Apache-2.0
// Everything that stays constant during a run: shapes, bodies, joints, coordinates, laws.
#pragma once

#include <map>
#include <memory>
#include <set>

#include "lmd/lmd_shape.hpp"
#include "mechanics/contact_law.hpp"
#include "mechanics/coordinates.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/joint.hpp"
#include "mechanics/rigid_body.hpp"

namespace aussois {

inline constexpr double kGravity = 9.81;  // of the Earth [m/s^2]

struct Model {
  Vec3 gravity = {0, 0, -kGravity};            // [m/s^2]
  ContactLaw contact_law{};                    // of every pair that is not listed below
  std::map<BodyPair, ContactLaw> pair_laws{};  // the smaller first
  // Pairs that pass through each other, the smaller first: no contacts, no certificate
  std::set<BodyPair> passing{};
  Table<ShapeId, std::shared_ptr<const LmdShape>> shapes{};  // immutable, shared between bodies
  Table<BodyId, RigidBody> bodies{};
  Table<JointId, Joint> joints{};
  std::vector<Coupling> couplings{};          // of the joints' coordinates
  Table<BlockId, Coordinates> coordinates{};  // beside the bodies
  Table<GapId, GapFunction> gaps{};
  std::vector<ForceLaw> forces{};
  int inputs = 0;  // length of State::u
};

ShapeId add(Model& model, LmdShape shape);
BodyId add(Model& model, RigidBody body);  // throws like validate
/// Throws like validate. Without Joint::collide the two bodies pass through each other
/// from now on (Model::passing). All joints between two bodies must agree on this; throws if they do not.
JointId add(Model& model, Joint joint);
void add(Model& model, Coupling coupling);     // throws like validate
BlockId add(Model& model, Coordinates block);  // throws like validate
GapId add(Model& model, GapFunction gap);      // throws like validate
void add(Model& model, ForceLaw law);
/// Lengthens State::u by what laws read there and the caller sets between steps; returns the first new entry.
int add_inputs(Model& model, int count);
const ContactLaw& contact_law(const Model& model, BodyId body_a, BodyId body_b);
/// The distinct contact laws of a model: of pairs that are not listed, of those that are, of gap functions.
std::vector<ContactLaw> contact_laws(const Model& model);

/// Whether a body is carried by the coordinates of a tree.
bool carries_bodies(const Model& model);
/// Length of State::v: six per body, then the coordinates.
int velocity_count(const Model& model);
/// First entry of a block in State::q, and of its speeds in State::v. Of Table::next(): one past the last
/// entry.
int first_coordinate(const Model& model, BlockId block);
int first_speed(const Model& model, BlockId block);
/// Number of columns that J of a gap function must have.
int gap_columns(const Model& model, const GapFunction& gap);

/// Throws std::invalid_argument naming the body, joint or block, the field, its value and its bound.
void validate(const Model& model);

}  // namespace aussois
