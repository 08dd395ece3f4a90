// SPDX-License-Identifier: Apache-2.0
#include "ports/local_model.hpp"

#include "mechanics/motion.hpp"

namespace aussois {

DeviceForce local_force(const TrajectoryPoint& last, const PortHold& hold, const PortLimits& limits,
                        const HandleMotion& motion) {
  const PortPull pull = port_pull({retract(last.pose, last.twist, motion.since), last.twist},
                                  {motion.now, motion.twist}, hold, limits);
  return {-pull.force, -pull.torque};
}

}  // namespace aussois
