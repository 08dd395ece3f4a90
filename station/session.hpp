// SPDX-License-Identifier: Apache-2.0
// A session of a hand with a scene: ticks, takes, going back, and a log by which all of it is repeated with
// the same bits (doc/theory/sessions.md). No clock, no socket: a test drives it as a server does.
#pragma once

#include <map>
#include <optional>

#include "io/session_file.hpp"
#include "station/session_stage.hpp"

namespace aussois {

class Session {
 public:
  /// Ticks between two hashes, and between states that are kept of the last minute.
  static constexpr std::int64_t kBlock = 64;
  static constexpr std::int64_t kOldBlock = 1024;  // and of what was before

  Session(SessionMaker make, const SessionParameters& parameters, const SessionOptions& options = {});

  /// One tick. Where the session is not at the end of its take, a new take begins here. Throws
  /// std::invalid_argument for a target that is not finite; nothing has changed then.
  TickReport tick(const PortTarget& target);
  /// Changes a parameter before the next tick (SES-3). Throws std::invalid_argument, and changes nothing, for
  /// a parameter that is unknown, a value out of range, or one with which the present state does not fit.
  void change(const std::string& name, double value);
  /// A note, now or at a moment of a take that was. Throws as `seek` does.
  void mark(const std::string& text, int take = -1, std::int64_t moment = 0);
  /// Goes to a moment of a take or of its past, by the nearest state that was kept and the ticks since. What
  /// was changed for the next tick is forgotten. Throws std::invalid_argument for a moment that never was.
  /// Returns what came of the tick that led there.
  TickReport seek(int take, std::int64_t moment);

  const Model& model() const { return stage_.model(); }
  const State& state() const { return stage_.state(); }
  const Port& port() const { return stage_.port(); }
  /// With what was changed for the next tick.
  const SessionParameters& parameters() const;
  int take() const { return take_; }
  std::int64_t moment() const { return moment_; }
  const SessionLog& log() const { return log_; }
  /// Adds the hash of the present state to the log, for the end of a session.
  void add_hash();
  std::size_t kept_bytes() const { return bytes_; }

 private:
  static constexpr std::int64_t kNever = std::int64_t{-1} << 60;
  struct Kept {
    State state{};
    SessionParameters parameters{};
  };
  using At = std::pair<int, std::int64_t>;  // take and moment

  void begin_take();
  void check_moment(int take, std::int64_t moment) const;
  void keep();
  void thin_out();
  void mark_by_itself(const TickReport& report);
  void add_mark(const char* kind, const std::string& text);

  SessionStage stage_;
  SessionOptions options_;
  SessionLog log_{};
  int take_ = 0;
  std::int64_t moment_ = 0;
  std::optional<PortTarget> said_{};  // in the last tick; none: it was of another take
  std::optional<SessionStage::Change> next_{};
  std::vector<SessionChange> changes_{};  // that make it
  std::map<At, Kept> kept_{};
  std::size_t bytes_ = 0;
  // The last moments at which a part touched, the pull was at its limit, a step was refused
  std::int64_t touched_ = kNever, limited_ = kNever, refused_ = kNever;
};

/// What came of repeating a take.
struct TakeRepeat {
  std::int64_t ticks = 0, hashes = 0;
  std::int64_t differs = -1;  // the first moment whose hash is another; -1: none
};
/// Repeats a take with its past from the start, without a clock; `look(stage, report)` is called after each
/// tick, and ends it with false. Throws what Session does for a log that does not fit the scene.
TakeRepeat repeat_take(const SessionLog& log, int take, SessionStage& stage,
                       const std::function<bool(const SessionStage&, const TickReport&)>& look = {});

}  // namespace aussois
