// SPDX-License-Identifier: Apache-2.0
// What a device in a hand says, and what is said to it (doc/theory/ports.md).
#pragma once

#include <cstdint>

#include "geometry/se3.hpp"

namespace aussois {

struct DeviceSample {
  SE3 pose{};                // of the handle, in the world of the scene [m]
  double time = 0;           // of the device's clock [s]
  std::uint64_t serial = 0;  // grows with each reading; a sample whose serial does not is no news
};

/// On the hand, in the world, held until the next one.
struct DeviceForce {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N m]
};

}  // namespace aussois
