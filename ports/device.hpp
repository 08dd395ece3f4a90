// SPDX-License-Identifier: Apache-2.0
// What a device in a hand says and what is said to it, and the four functions behind which a maker's library
// stands (doc/theory/ports.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "geometry/se3.hpp"

namespace aussois {

struct DeviceSample {
  SE3 pose{};                 // of the handle, in the world of the scene [m]
  std::uint32_t buttons = 0;  // one bit each
  double time = 0;            // of the device's clock [s]
  std::uint64_t serial = 0;   // grows with each reading; one that does not is no news
};

/// On the hand, in the world, held until the next one.
struct DeviceForce {
  Vec3 force = Vec3::Zero();   // [N]
  Vec3 torque = Vec3::Zero();  // [N m]
};

/// A device that is open. `read` gives nothing if there is none to read yet; `write` returns false if the
/// device is gone. Called by one thread alone.
struct HapticDevice {
  std::function<std::optional<DeviceSample>()> read{};
  std::function<bool(const DeviceForce&)> write{};
  std::function<void()> close{};
};
/// Opens a device, or throws std::runtime_error that says why not.
using OpenDevice = std::function<HapticDevice()>;

}  // namespace aussois
