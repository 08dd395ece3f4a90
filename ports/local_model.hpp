// SPDX-License-Identifier: Apache-2.0
// What a hand is told between two steps of the bodies (PORT-5).
#pragma once

#include "ports/device.hpp"
#include "ports/port_law.hpp"

namespace aussois {

/// A handle, some time after the last step of the bodies.
struct HandleMotion {
  SE3 now{};
  Vec6 twist = Vec6::Zero();  // its mean since the step, laid out as a body's
  double since = 0;           // the time since the step [s]
};

/// The opposite of the pull of a port, if the body went on as it went at its `last` step.
DeviceForce local_force(const TrajectoryPoint& last, const PortHold& hold, const PortLimits& limits,
                        const HandleMotion& motion);

}  // namespace aussois
