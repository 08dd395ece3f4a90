// SPDX-License-Identifier: Apache-2.0
// Bodies carried by joints whose coordinates stand for their poses: where they are and how they move
// (TREE-1), (TREE-2).
#pragma once

#include <string>
#include <vector>

#include "mechanics/state.hpp"

namespace aussois {

/// Turns the axes of `joints` into a block of coordinates and the bodies that hang by them into carried ones,
/// whose motion was dynamic before. The base is the world or a fixed body if a joint holds on to it, or else
/// body B of the first joint. Throws std::invalid_argument naming the joint unless its kind has coordinates
/// and the joints form a tree.
BlockId add_tree(Model& model, std::string name, const std::vector<JointId>& joints);

/// The place in State::q of the coordinate of an axis of a tree's joint [m, rad].
int tree_coordinate(const Model& model, JointId joint, int axis = 0);
/// The place of its speed in State::v.
int tree_speed(const Model& model, JointId joint, int axis = 0);

/// Puts all carried bodies where the coordinates of the state put them, with the velocities that the speeds
/// give them.
void carry(const Model& model, State& state);
/// The two parts of it: poses from the coordinates `q` of all blocks and the poses of bases; twists at these
/// poses from the speeds and the twists of bases, laid out as State::v.
void carry_poses(const Model& model, const VecX& q, PerBody<SE3>& g);
void carry_twists(const Model& model, const PerBody<SE3>& g, VecX& v);

/// The state of a model with trees that has the poses and velocities of `state`, one of the same bodies
/// before `add_tree`, and its coordinates of other blocks. What joints of the trees lock must hold there.
State in_joint_coordinates(const Model& model, const State& state);

/// The twist of a carried body, laid out as in State::v, per unit of a speed that carries it.
struct TwistColumn {
  int velocity = 0;  // entry of State::v
  Vec6 twist = Vec6::Zero();
};
std::vector<TwistColumn> carried_columns(const Model& model, const PerBody<SE3>& g, BodyId body);

/// An axis of a tree. Its screw is a twist (v, omega) in the world, v at the tree's origin (TREE-2).
struct TreeAxis {
  Vec6 screw = Vec6::Zero();
  int parent = -1;     // the axis before it; -1: the base
  int coordinate = 0;  // in the block
  int link = -1;       // that its motion ends with; -1: the next axis of the same joint follows
};
/// All axes of a tree, from the base outwards.
std::vector<TreeAxis> tree_axes(const Model& model, const Tree& tree, const PerBody<SE3>& g);
/// The origin of a tree's base [m].
Vec3 tree_origin(const Tree& tree, const PerBody<SE3>& g);

}  // namespace aussois
