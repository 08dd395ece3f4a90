// SPDX-License-Identifier: Apache-2.0
// A session on its own thread, paced by the clock: it takes what hands and pages say, and shows the newest
// frame. A tick that is late is late: lost time is never caught up, and no tolerance, contact or step depends
// on the clock.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "io/live_message.hpp"
#include "io/session_writer.hpp"
#include "station/mailbox.hpp"
#include "station/session.hpp"

namespace aussois {

struct LiveOptions {
  std::string title{};
  std::filesystem::path file{};                // session.h5
  std::map<std::string, std::string> notes{};  // of that file
  bool hold = true;                            // a part that is let go stays where it is; false: it is free
  // Writes what belongs to a take (a run, a page, an assessment) on a thread of its own, and returns what to
  // say of it; empty: only the session is saved
  std::function<std::string(const SessionLog&, int take)> save{};
};

/// Text for a page, a JSON object.
struct LiveAnswer {
  std::uint64_t page = 0;  // 0: for all
  std::string text{};
};

/// What a device must know of the bodies between their ticks.
struct PortView {
  std::int64_t moment = -1;
  TrajectoryPoint body{};
  PortHold hold{};
  PortLimits limits{};
  double stored = 0;  // kinetic energy, and that of springs and laws [J]
  double put_in = 0;  // by gravity, motors and gains that grew, since the session began [J]
  double slow = 1;    // simulated seconds per second
  std::chrono::steady_clock::time_point at{};
};

/// Since the last command a hand stands still after so long, and has let go after so long [s].
inline constexpr double kHandStands = 0.15, kHandLost = 0.5;

class LiveSession {
 public:
  /// Throws what SessionWriter throws. Time stands until `begin`.
  LiveSession(Session session, LiveOptions options);
  /// Ends the thread, and the file.
  ~LiveSession();

  void begin();
  /// The newest of each source wins; a space mouse that moves leads before a page.
  enum class From { page, space_mouse };
  void hand(const LiveCommand& command, From from = From::page);
  void let_go();
  /// Where the handle of a haptic device is, in the world; it leads the part before any other hand. None: it
  /// has let go.
  void device(const std::optional<SE3>& handle);
  PortView port_view() const { return view_.get(); }
  /// What a page asks for: set, mark, seek, pause, save. Throws std::invalid_argument, naming field, value
  /// and bound, for what is not understood; the answer comes by `answers`.
  void ask(std::uint64_t page, const std::string& text);

  LiveFrame frame() const { return frame_.get(); }
  std::vector<LiveAnswer> answers() { return answers_.take_all(); }
  /// What a page must know first, a JSON object: title, bodies, parameters.
  std::string facts() const;
  const std::vector<LiveMesh>& meshes() const { return meshes_; }
  const Vec3& origin() const { return origin_; }
  /// Ends the thread and the file; no other call but this, `failed` and `failure` follows.
  void end();
  bool failed() const { return failed_; }
  std::string failure() const { return failure_.get(); }  // why

 private:
  using Clock = std::chrono::steady_clock;
  struct Hand {
    LiveCommand command{};
    Clock::time_point at{};
  };
  struct Request {
    std::uint64_t page = 0;
    std::string kind{}, name{};  // of set: the parameter; of mark: the text
    double value = 0;
    int take = 0;
    std::int64_t moment = 0;
  };

  void run();
  void take_requests();
  void do_request(const Request& request);
  void tick();
  PortTarget target();
  PortTarget wanted();
  PortTarget stay() const;
  void publish();
  void tell_marks();
  void tell_parameters();
  void save(std::uint64_t page);
  void measure_pace();
  void show_port();
  bool is_led() const;

  Session session_;
  LiveOptions options_;
  SessionWriter writer_;
  Vec3 origin_ = Vec3::Zero();
  std::vector<LiveMesh> meshes_{};
  std::vector<int> mesh_of_{};  // of each body; -1: none

  struct DeviceHand {
    std::optional<SE3> handle{};
    Clock::time_point at{};
  };
  Hand hand_now() const;

  Latest<Hand> hand_{}, space_mouse_{};
  Latest<DeviceHand> device_{};
  Latest<PortView> view_{};
  double put_in_ = 0;
  Latest<LiveFrame> frame_{};
  std::string facts_{};  // that never change
  Latest<std::string> parameters_{}, failure_{};
  Mail<Request> requests_{1024};
  Mail<LiveAnswer> answers_{4096};
  std::atomic<bool> stop_ = false, begun_ = false, failed_ = false;
  std::atomic<bool> must_let_go_ = false;  // after a seek, before a hand takes hold again
  std::mutex wake_mutex_{};
  std::condition_variable wake_{};

  // Of the thread alone
  TickReport last_{};
  bool paused_ = false, holding_ = false, idle_ = false;  // idle: nothing is new to show
  std::uint64_t serial_ = 0;
  std::int64_t free_until_ = 0;  // moment; brakes fade until then
  PortTarget stay_{};
  std::size_t marks_told_ = 0;
  std::vector<std::pair<Clock::time_point, double>> pace_{};
  double slow_ = 1;
  Clock::time_point published_{};
  std::atomic<bool> is_saving_ = false;
  std::thread saving_{};
  std::thread thread_{};
};

}  // namespace aussois
