// SPDX-License-Identifier: Apache-2.0
// Lays a cable: nodes along a line, elements between them, and a surface of the cable's radius that touches
// what is in its way (doc/theory/beams.md).
#pragma once

#include "mechanics/beam.hpp"

namespace aussois {

struct Model;
struct State;

/// `count` points, at least 2, at equal distances along a polyline, its ends included. Throws if the line has
/// no length.
std::vector<Vec3> points_along(const std::vector<Vec3>& polyline, int count);
/// Frames at the points, at least 2, with x along the line, that turn about it as little as possible. y of
/// the first is as near to `up` as it can be. Throws if two neighbours are at one place.
std::vector<SE3> frames_along(const std::vector<Vec3>& points, const Vec3& up = Vec3::UnitZ());

/// A node at which a cable turns no more touches on all sides (DEF-5) [rad].
inline constexpr double kLargestStraightTurn = 0.3;

struct CableOptions {
  std::string name = "cable";
  std::vector<SE3> nodes{};  // as it is laid, x along it, at least 2; see frames_along
  BeamSection section{};
  double radius = 0;            // of its surface [m]; 0: it has none and touches nothing
  bool touches_itself = false;  // but for parts nearer than pi radii along it (DEF-4)
  bool straight = false;        // without stress where it is straight; false: as it is laid
  bool closed = false;          // a last element leads from the last node to the first
};

struct Cable {
  Beam beam{};
  std::vector<BodyId> nodes{};
  std::vector<SE3> laid{};  // poses of the nodes
  BodyId surface{};         // none without a radius
};

/// Adds the nodes as dynamic bodies, the beam and the surface. Throws std::invalid_argument: field, value,
/// bound.
Cable add_cable(Model& model, const CableOptions& options);
/// Says where a cable is laid too coarsely: its line turns by more than kLargestStraightTurn at a node. How
/// far, and how many elements it needs at least; where it bends evenly, they are enough. Empty: nowhere.
std::string too_coarse(const Cable& cable);
/// Lays the nodes of a state as they were laid in the model.
void lay(const Cable& cable, State& state);

}  // namespace aussois
