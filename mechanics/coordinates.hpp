// SPDX-License-Identifier: Apache-2.0
// Generalised coordinates beside the bodies: the extension point for user-defined models (GEN-1) to (GEN-5),
// and what solids and trees are made of.
// A block obeys M(q) dv = f(t, q, v) dt + H dr, dq = v dt; gap functions say where it, or a body, may not go.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "geometry/id.hpp"
#include "mechanics/contact_law.hpp"
#include "mechanics/joint.hpp"

namespace aussois {

using GapId = Id<struct GapTag>;

struct Model;
struct State;

/// The force on one block. An empty K or C is zero, and that part of the force is then integrated explicitly.
struct CoordinateForce {
  VecX f{};  // the whole force, including Coriolis terms of M(q)
  MatX K{};  // -df/dq
  MatX C{};  // -df/dv
};

/// A point that moves on its own (GEN-5), as a node of a solid does. Its three coordinates are its
/// displacement.
struct PointMass {
  Vec3 place = Vec3::Zero();  // in the world, where its displacement is zero [m]
  double mass = 0;            // [kg], >= 0
  // The axes of the world along which nothing changes its speed: it stays, or moves as State::v says
  std::array<bool, 3> held{};
};

/// A body that hangs on another by one joint, whose axes are coordinates (TREE-1).
struct TreeLink {
  JointId joint{};
  BodyId body{};
  int parent = -1;  // the link that it hangs on, one before it; -1: the base
  int first = 0;    // of the joint's coordinates in the block
};
/// What a block of coordinates carries; no links: nothing (`add_tree`).
struct Tree {
  BodyId base = kWorld;  // the world, a fixed body or a dynamic one
  std::vector<TreeLink> links{};
};

struct Coordinates {
  std::string name{};
  int size = 0;                               // n, >= 1
  std::function<MatX(const VecX& q)> mass{};  // n x n, symmetric and positive definite
  std::vector<PointMass> points{};            // instead of a mass: n / 3 points, on which gravity acts
  Tree tree{};                                // instead of a mass: bodies carried by their joints
  std::function<CoordinateForce(double t, const VecX& q, const VecX& v)> force{};  // empty: none
  std::function<double(const VecX& q)> potential{};  // of the conservative part of the force [J]; empty: none
};

/// Whether the block carries bodies.
inline bool is_tree(const Coordinates& block) {
  return !block.tree.links.empty();
}

/// The value of a gap function at a state, and its velocities u = J v + rate, the normal one first.
struct GapRows {
  double gap = 0;  // [m], negative in penetration
  MatX J{};        // 1 row: frictionless, 2: friction in a plane, 3: in space
  VecX rate{};     // dgap/dt and tangential speeds at fixed q [m/s]; empty: zero
};

/// A user-defined contact. It is always a candidate: no search finds it, and no certificate covers it.
struct GapFunction {
  std::string name{};
  BlockId block{};  // J has a column per velocity of this block of coordinates; none: of all of State::v
  std::function<GapRows(const Model&, const State&, double t)> evaluate{};
  ContactLaw law{};  // its Contensou radius must be 0
};

}  // namespace aussois
