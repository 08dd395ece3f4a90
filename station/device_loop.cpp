// SPDX-License-Identifier: Apache-2.0
#include "station/device_loop.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mechanics/motion.hpp"
#include "ports/local_model.hpp"

namespace aussois {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kFrozen = 0.05;               // the same reading for so long: the device is gone [s]
constexpr double kStands = 0.1;                // a session without a tick for so long gives no force [s]
constexpr double kSlow = 0.5, kTooSlow = 0.1;  // below which forces shrink, and vanish

// Forces of a scene in slow motion.
DeviceForce slowed(const DeviceForce& force, double slow) {
  const double part = slow >= kSlow ? 1 : slow < kTooSlow ? 0 : slow / kSlow;
  return {part * force.force, part * force.torque};
}

// One hand on one device: what it is told from sample to sample.
class Telling {
 public:
  explicit Telling(const ReserveOptions& options) : options_(options) { record.reserve.level = options.lend; }

  DeviceForce next(const SE3& handle, const PortView& view) {
    const DeviceMotion motion = record.samples > 0 ? motion_between(last_, handle) : DeviceMotion{};
    const bool jumped = record.samples++ > 0 && has_jumped(motion);
    record.jumps += jumped;
    free_ = jumped ? kFree : std::max(0, free_ - 1);
    const double put_in = std::max(0.0, view.put_in - std::exchange(put_in_, view.put_in));
    record.reserve = after_sample(record.reserve, work_left(sent_, motion, options_), put_in);
    if (view.moment != moment_) {
      moment_ = view.moment;
      at_tick_ = handle;
      record.reserve = after_tick(record.reserve, view.stored, options_);
    }
    const SE3 before = std::exchange(last_, handle);
    const double since = std::clamp(Seconds(Clock::now() - view.at).count(), 0.0, 10 * options_.period);
    const Vec6 twist = since >= options_.period ? twist_between(at_tick_, handle, since)
                                                : twist_between(before, handle, options_.period);
    const bool stands = Seconds(Clock::now() - view.at).count() > kStands;
    const bool held = view.moment >= 0 && view.hold.gains.stiffness > 0 && holds() && !stands;
    const DeviceForce wish =
        held ? slowed(local_force(view.body, view.hold, view.limits, {handle, twist, since}), view.slow)
             : DeviceForce{};
    const Valve valve = let_through(wish, motion, record.reserve, options_);
    record.reserve = valve.reserve;
    record.largest_force = std::max(record.largest_force, valve.force.force.norm());
    return sent_ = valve.force;
  }
  /// False after a jump, for a while.
  bool holds() const { return free_ == 0; }

  DeviceRecord record{};

 private:
  static constexpr int kFree = 200;  // samples
  ReserveOptions options_;
  SE3 last_{}, at_tick_{};
  DeviceForce sent_{};
  std::int64_t moment_ = -1;
  double put_in_ = 0;
  int free_ = 0;
};

}  // namespace

DeviceLoop::DeviceLoop(LiveSession& session, HapticDevice device, const ReserveOptions& options)
    : session_(session), device_(std::move(device)), options_(options) {
  validate(options_);
  thread_ = std::thread([this] { run(); });
}

DeviceLoop::~DeviceLoop() {
  stop_ = true;
  thread_.join();
}

namespace {

// Why a reading cannot lead; empty if it can.
std::string wrong_with(const std::optional<DeviceSample>& sample) {
  if (!sample) return "it does not answer";
  const double norm = sample->pose.R.norm();
  if (!sample->pose.p.allFinite() || !(std::abs(norm - 1) < 1e-3)) return "its readings are no poses";
  return "";
}

}  // namespace

void DeviceLoop::run() {
  Telling telling(options_);
  try {
    device_.open();
    follow(telling.record, [&](const SE3& handle) {
      device_.write(telling.next(handle, session_.port_view()));
      session_.device(telling.holds() ? std::optional(handle) : std::nullopt);
    });
  } catch (const std::exception& failed) {
    telling.record.lost = failed.what();
  }
  session_.device({});
  record_.set(telling.record);
  try {
    device_.write({});
    device_.close();
  } catch (const std::exception&) {  // it is lost already
  }
}

void DeviceLoop::follow(DeviceRecord& record, const std::function<void(const SE3&)>& next) {
  const auto period = std::chrono::duration_cast<Clock::duration>(Seconds(options_.period));
  Clock::time_point due = Clock::now(), fresh = due;
  std::uint64_t serial = 0;
  while (!stop_) {
    const std::optional<DeviceSample> sample = device_.read();
    const Clock::time_point now = Clock::now();
    record.lost = wrong_with(sample);
    if (sample && (sample->serial != serial || record.samples == 0)) serial = sample->serial, fresh = now;
    if (Seconds(now - fresh).count() > kFrozen) record.lost = "its readings have stopped";
    if (!record.lost.empty()) return;
    next({sample->pose.R.normalized(), sample->pose.p});
    record.late += now - due > period;
    record_.set(record);
    due = std::max(due + period, now);
    std::this_thread::sleep_until(due);
  }
}

}  // namespace aussois
