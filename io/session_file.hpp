// SPDX-License-Identifier: Apache-2.0
// Reads and writes session.h5: what a hand did in a session, by which it is repeated with the same bits.
// doc/session_file.md has the layout.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ports/port.hpp"

namespace aussois {

/// Time in a session is counted in ticks; moment n is after n of them. A take has the past of its parent up
/// to where it begins.
struct SessionTake {
  int parent = -1;          // -1: none, it begins at the start
  std::int64_t begins = 0;  // moment, of the parent too
  std::int64_t ends = 0;    // its last moment
};

struct SessionInput {
  int take = 0;
  std::int64_t tick = 0;  // from this one on, until the next row of the take
  PortTarget target{};
};

struct SessionChange {
  int take = 0;
  std::int64_t tick = 0;  // before this one
  std::string name{};     // of a parameter
  double value = 0;
};

struct SessionMark {
  int take = 0;
  std::int64_t moment = 0;
  std::string kind{};  // "note" of the engineer's own; "touch", "limit", "refused" of themselves
  std::string text{};
};

struct SessionHash {
  int take = 0;
  std::int64_t moment = 0;
  std::uint64_t hash = 0;  // of the state
};

/// All that happened, in order; each take begins with an input of its own.
struct SessionLog {
  std::vector<SessionTake> takes{};
  std::vector<SessionInput> inputs{};
  std::vector<SessionChange> changes{};
  std::vector<SessionMark> marks{};
  std::vector<SessionHash> hashes{};
};

struct SessionData {
  std::map<std::string, std::string> notes{};  // how to make the scene again, and by which program
  SessionLog log{};
};

/// Throws std::invalid_argument naming the row, the field, its value and its bound.
void validate(const SessionLog& log);

/// Writes it whole, as write_atomically does.
void write_session(const std::filesystem::path& path, const SessionData& session);

/// Also reads the journal of a session that was not closed (SessionWriter). Throws std::runtime_error "FILE:
/// /dataset: what", or "FILE:line: what", for a file that is missing, damaged, no session, of another
/// version, or inconsistent.
SessionData read_session(const std::filesystem::path& path);

}  // namespace aussois
