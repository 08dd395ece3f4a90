// SPDX-License-Identifier: Apache-2.0
// Everything that a step changes, and nothing else. A copy is a checkpoint.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/se3.hpp"
#include "mechanics/model.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {

struct State {
  double t = 0;          // [s]
  double h = 0;          // length of the last accepted step [s], 0 before the first: impulses scale with it
  double h_next = 0;     // the step that the control would try next [s]; 0: as large as the scheme allows
  std::vector<SE3> g{};  // g_wb of every body
  VecX v{};              // six per body: v_G in the world [m/s], omega in the body [rad/s]
  ContactMemory memory{};
};

/// Bodies at the world's origin and at rest; prescribed ones where their path begins.
State rest_state(const Model& model);
/// Throws std::invalid_argument unless sizes fit the model, every number is finite, rotations are unit
/// quaternions (1e-6) and the memory is sorted by key.
void validate(const Model& model, const State& state);

SE3& pose(State& state, int body);
const SE3& pose(const State& state, int body);
Eigen::Ref<Vec6> twist(State& state, int body);
Vec6 twist(const State& state, int body);

/// 64-bit hash of all bits of the state: equal states have equal hashes, whatever computed them; -0.0 differs
/// from 0.0.
std::uint64_t hash(const State& state);

/// Of the dynamic bodies; `laws` is the sum of the potentials at the state's own time (MEC-4).
struct Energy {
  double kinetic = 0, gravity = 0, laws = 0;  // [J]
  double total() const { return kinetic + gravity + laws; }
};
Energy energy(const Model& model, const State& state);

}  // namespace aussois
