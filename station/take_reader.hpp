// SPDX-License-Identifier: Apache-2.0
// A take of a session with its past, as one line of ticks (SES-2).
#pragma once

#include "io/session_file.hpp"

namespace aussois {

class TakeReader {
 public:
  /// Throws std::invalid_argument if the log has no such take. The log must outlive the reader.
  TakeReader(const SessionLog& log, int take);

  std::int64_t ends() const { return ends_; }
  /// What the hand said in a tick, 0 <= tick < ends().
  const PortTarget& input(std::int64_t tick) const;
  /// What was changed before a tick, in order.
  std::vector<SessionChange> changes(std::int64_t tick) const;
  /// Rows of this take and of its past, in the order of time.
  const std::vector<SessionHash>& hashes() const { return hashes_; }
  const std::vector<SessionMark>& marks() const { return marks_; }

 private:
  std::int64_t ends_ = 0;
  std::vector<const SessionInput*> inputs_{};
  std::vector<const SessionChange*> changes_{};
  std::vector<SessionHash> hashes_{};
  std::vector<SessionMark> marks_{};
};

}  // namespace aussois
