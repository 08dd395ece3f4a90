// SPDX-License-Identifier: Apache-2.0
// Keeps a session while it goes on, in a journal of lines that any death of the program leaves readable.
#pragma once

#include <memory>

#include "io/session_file.hpp"

namespace aussois {

/// Appends to PATH.tmp, which no other session may write meanwhile; close() makes PATH of it.
class SessionWriter {
 public:
  /// A journal that a killed session left becomes "session_left_1.h5" beside it. Throws std::runtime_error if
  /// the file cannot be created or another session is writing it.
  SessionWriter(std::filesystem::path path, const std::map<std::string, std::string>& notes);
  SessionWriter(SessionWriter&&) noexcept;
  ~SessionWriter();  // without close(): what was written stays in PATH.tmp

  /// Adds what the log has beyond the last write; a killed process leaves all of it. Throws
  /// std::runtime_error if the disk takes no more.
  void write(const SessionLog& log);
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whether a file begins as a journal does.
bool is_journal(const std::filesystem::path& path);
/// All that was written, but for a last line that is not whole, and what comes after the last moment of its
/// take. Throws std::runtime_error "FILE:line: what".
SessionData read_journal(const std::filesystem::path& path);

}  // namespace aussois
