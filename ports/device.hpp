// SPDX-License-Identifier: Apache-2.0
// What a device in a hand says, and what is said to it (doc/theory/ports.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

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

/// A haptic device is four functions: a simulated one is built in, makers' libraries go behind the same. They
/// are called from one thread.
struct HapticDevice {
  std::string name{};
  std::function<void()> open{};                         // throws std::runtime_error if it cannot
  std::function<std::optional<DeviceSample>()> read{};  // the newest reading; none: the device is gone
  std::function<void(const DeviceForce&)> write{};
  std::function<void()> close{};
};

}  // namespace aussois
