// SPDX-License-Identifier: Apache-2.0
// How far a computed motion is from the exact one, where velocities jump: (CONV-1) to (CONV-4) of
// doc/theory/convergence.md.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "examples/scenes/exact_motion.hpp"

namespace aussois {

/// What a scheme computed: the state at the start and after every step.
struct ComputedMotion {
  std::vector<double> t{};           // ascending [s]
  std::vector<MotionSample> node{};  // one per time
};

enum Measure { q_max, v_l1, v_graph, v_nodes };  // indices into Errors
inline constexpr std::array<const char*, 4> kMeasures = {"q_max", "v_l1", "v_graph", "v_nodes"};
using Errors = std::array<double, kMeasures.size()>;

/// All four over the time that `computed` covers; velocities count as they are, 1 s as much as 1 unit of
/// them.
Errors errors_of(const ComputedMotion& computed, const ExactMotion& exact);

/// A curve in time and velocity: the columns (t, v), joined by straight lines; t does not descend. A jump is
/// two columns of the same time.
using Graph = MatX;
Graph graph_of(const ComputedMotion& computed);
/// Points at least every `spacing` [s], and both sides of every jump.
Graph graph_of(const ExactMotion& exact, double t_end, double spacing);

/// Hausdorff distance of the two curves (CONV-3), to 1e-3 of itself from below; segments that are nearer in
/// time than the distance are looked at, so two graphs of n points that are close take O(n log n).
double graph_distance(const Graph& a, const Graph& b);

}  // namespace aussois
