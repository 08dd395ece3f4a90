// SPDX-License-Identifier: Apache-2.0
#include "ports/local_model.hpp"

#include "mechanics/motion.hpp"

namespace aussois {

DeviceForce local_force(const TrajectoryPoint& last, const PortOptions& options,
                        const TrajectoryPoint& handle, double since) {
  const PortPull pull = port_pull({retract(last.pose, last.twist, since), last.twist}, handle, options);
  return {-pull.force, -pull.torque};
}

}  // namespace aussois
