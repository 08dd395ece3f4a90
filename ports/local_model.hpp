// SPDX-License-Identifier: Apache-2.0
// What a hand is told between two steps of the bodies (PORT-5).
#pragma once

#include "ports/device.hpp"
#include "ports/port_law.hpp"

namespace aussois {

/// The opposite of the pull of a port, `since` a step [s] that left the body at `last`, if the body went on
/// as it went there. `handle` is where it is now, with its mean twist since the step.
DeviceForce local_force(const TrajectoryPoint& last, const PortOptions& options,
                        const TrajectoryPoint& handle, double since);

}  // namespace aussois
