// SPDX-License-Identifier: Apache-2.0
// A recorded motion on SE(3) (TRJ-1): between two poses the position moves on a straight line and the
// rotation on a geodesic, both at constant speed.
#pragma once

#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

struct Trajectory {
  std::vector<double> t{};  // ascending [s]
  std::vector<SE3> pose{};  // of the body's frame, in the world
};

/// Throws std::invalid_argument naming the row unless there are at least two rows, times ascend strictly and
/// poses are valid.
void validate(const Trajectory& path);

struct TrajectoryPoint {
  SE3 pose{};
  Vec6 twist = Vec6::Zero();  // velocity of the origin, world [m/s]; angular velocity, body [rad/s]
};
/// At times outside [t.front(), t.back()]: the end pose with zero twist. At the time of a row, the segment
/// that begins there counts; at the last row, the one that ends there. The path must be valid.
TrajectoryPoint trajectory_point(const Trajectory& path, double t);

/// The same path for the frame g_old_new attached to the moving frame: pose * g_old_new, interpolated anew.
/// It is exact at the rows and off between them by at most |g_old_new.p| phi^2 / 8 for a rotation by phi from
/// row to row (TRJ-2).
Trajectory path_of_attached_frame(const Trajectory& path, const SE3& g_old_new);

}  // namespace aussois
