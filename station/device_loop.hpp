// SPDX-License-Identifier: Apache-2.0
// A haptic device on its own thread: reads the handle, leads the part by it, and gives the hand the force
// that the local model and the reserve allow (PORT-3) to (PORT-5).
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "ports/reserve.hpp"
#include "station/live_session.hpp"

namespace aussois {

/// What became of a device until now.
struct DeviceRecord {
  std::int64_t samples = 0, late = 0, jumps = 0;  // late: read more than a period after it was due
  Reserve reserve{};
  double largest_force = 0;  // that was sent [N]
  std::string lost{};        // why it is no longer heard; empty: it is
};

class DeviceLoop {
 public:
  /// A sample each `options.period`, all calls from the loop's own thread; what they throw stands in
  /// DeviceRecord::lost. The session must outlive the loop. Throws std::invalid_argument for bad options.
  DeviceLoop(LiveSession& session, HapticDevice device, const ReserveOptions& options = {});
  /// Lets go, sends no force and closes the device.
  ~DeviceLoop();

  DeviceRecord record() const { return record_.get(); }

 private:
  void run();
  void follow(DeviceRecord& record, const std::function<void(const SE3&)>& next);

  LiveSession& session_;
  HapticDevice device_;
  ReserveOptions options_;
  Latest<DeviceRecord> record_{};
  std::atomic<bool> stop_ = false;
  std::thread thread_{};
};

}  // namespace aussois
