// SPDX-License-Identifier: Apache-2.0
// The input and the output of a reducer.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "geometry/se3.hpp"
#include "reduction/clusters.hpp"
#include "reduction/loss.hpp"

namespace aussois {

/// What a selector may know about a body.
struct BodyLoad {
  SE3 g_wb{};
  Vec6 twist = Vec6::Zero();   // v_G in the world [m/s], omega in the body [rad/s]
  Vec6 wrench = Vec6::Zero();  // of all but contacts and joints (gravity, force laws, gyroscopic torque):
                               // force in the world [N], torque about the centre of mass in the body [N m]
};

/// Everything that a selection may depend on. Vectors hold one entry per contact of the set, or none if not
/// known.
struct ReductionInput {
  const ContactSet& contacts;
  std::vector<char> kept_before{};  // 1: it was in the problem of the last step
  std::vector<Vec3> impulse{};      // last step's on A, turned to the present normal, world [N s]; zero: none
  std::vector<double> mu{};         // Coulomb friction [-], >= 0
  double h = 0;                     // the step length that the impulses scale with [s]; 0: not known
  std::span<const SE3> g{};         // g_wb by Feature::body; empty: the identity
  PerBody<BodyLoad> bodies{};       // only for Reducer::selector
};

/// A user-defined reducer: returns indices of the contacts to keep, in any order. It must be a pure function.
/// The deepest contact of every cluster is kept in addition.
using ContactSelector = std::function<std::vector<int>(const ReductionInput&, const Clusters&)>;

/// What a reduction kept.
struct Selection {
  std::vector<int> kept{};     // indices into the set, ascending
  std::vector<int> cluster{};  // cluster of every contact of the set
  int cluster_count = 0;
  LossReport loss{};  // the worst of all clusters
};

/// The kept contacts, in order. Throws std::invalid_argument if an index is out of range.
ContactSet select(const ContactSet& found, const std::vector<int>& kept);

}  // namespace aussois
