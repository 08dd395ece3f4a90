// SPDX-License-Identifier: Apache-2.0
// The one open door of mechanics: anything that adds a generalised force (MEC-5).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

struct Model;
struct State;

/// Forces and their derivatives in the velocity coordinates: six rows per body of the model (fixed ones too),
/// force in the world at the centre of mass [N], torque in the body [N m]; then one per coordinate.
struct GeneralisedForce {
  VecX f{};                  // as State::v
  std::vector<Triplet> K{};  // -df/dq along the twist coordinates [N/m, N, N m]
  std::vector<Triplet> C{};  // -df/dv [N s/m, N s, N m s]
};

/// Appends the entries of `block` to a sparse matrix, its corner at (row, column).
inline void add_block(std::vector<Triplet>& matrix, int row, int column, const Mat3& block) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) matrix.emplace_back(row + i, column + j, block(i, j));
}

struct ForceLaw {
  std::string name{};
  /// Adds the force at time t, at the poses and velocities of the state (its own t is the start of the step).
  std::function<void(const Model&, const State&, double t, GeneralisedForce&)> add_to{};
  /// Potential energy [J] at the state; empty: none (dissipative or not conservative).
  std::function<double(const Model&, const State&, double t)> potential{};
};

}  // namespace aussois
