// SPDX-License-Identifier: Apache-2.0
#include "ports/local_model.hpp"

#include "mechanics/motion.hpp"

namespace aussois {

DeviceForce local_force(const Posed& last, const PortHold& hold, const PortLimits& limits,
                        const HandleMotion& motion) {
  const PortPull pull =
      port_pull({retract(last.g, last.v, motion.since), last.v}, {motion.now, motion.twist}, hold, limits);
  return {-pull.force, -pull.torque};
}

}  // namespace aussois
