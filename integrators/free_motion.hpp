// SPDX-License-Identifier: Apache-2.0
// The dynamic bodies without contact over one step of the theta scheme, linearly implicit (MJ-4), (MJ-5).
#pragma once

#include "mechanics/state.hpp"

namespace aussois {

/// Which six rows of the problem belong to a body.
struct DofMap {
  std::vector<int> first{};  // per body: its first row, -1 if it is not dynamic
  int rows = 0;
};
DofMap dof_map(const Model& model);

/// Velocities of the bodies that are not dynamic, six per body of the model; zero rows for the dynamic ones.
/// A prescribed body moves from its pose at t to that at t + h at constant speeds.
VecX prescribed_velocity(const Model& model, const State& state, double h);

/// Rows of the dynamic bodies. M^ (v+ - v) = gravity + gyroscopic + laws + H r, where what depends on v+
/// stands in M^.
struct FreeMotion {
  SparseMatrix M{};  // M^ = mass + gyroscopic_D + law_D
  VecX f{};          // momentum: M^ v_free = f [N s, N m s]
  VecX v{};          // velocity at the start of the step
  VecX v_free{};     // velocity at its end without contact
  SparseMatrix mass{};
  VecX gravity{};               // impulse over the step [N s]
  VecX gyroscopic{};            // h (-omega x J omega) at the start
  SparseMatrix gyroscopic_D{};  // h theta d(omega x J omega)/d omega
  VecX laws{};                  // h F - h^2 theta K v
  SparseMatrix law_D{};         // h theta C + h^2 theta^2 K
};

/// `theta` in [1/2, 1].
FreeMotion free_motion(const Model& model, const State& state, const DofMap& dofs, double h, double theta);

}  // namespace aussois
