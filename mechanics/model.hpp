// SPDX-License-Identifier: Apache-2.0
// Everything that stays constant during a run: shapes, bodies, laws.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include "lmd/lmd_shape.hpp"
#include "mechanics/force_law.hpp"
#include "mechanics/rigid_body.hpp"

namespace aussois {

struct ContactLaw {
  double mu = 0.3;           // Coulomb friction [-], >= 0
  double restitution = 0.0;  // Newton restitution e [-], in [0, 1]
};

struct Model {
  Vec3 gravity = {0, 0, -9.81};                           // [m/s^2]
  ContactLaw contact_law{};                               // of every pair that is not named below
  std::map<std::pair<int, int>, ContactLaw> pair_laws{};  // by body indices, the smaller first
  std::vector<std::shared_ptr<const LmdShape>> shapes{};  // immutable, shared between bodies
  std::vector<RigidBody> bodies{};
  std::vector<ForceLaw> forces{};
};

int add(Model& model, LmdShape shape);  // returns its index
int add(Model& model, RigidBody body);  // returns its index; throws like validate
void add(Model& model, ForceLaw law);
const ContactLaw& contact_law(const Model& model, int body_a, int body_b);

/// Throws std::invalid_argument naming body, field, value and bound.
void validate(const Model& model);

}  // namespace aussois
