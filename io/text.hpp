// SPDX-License-Identifier: Apache-2.0
// Reads and writes text: whole files read at once, tokens that know their line, numbers that read back
// unchanged. Every error in a file is a std::runtime_error "path:line: what, value, bound".
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace aussois {

/// The bytes of a file. Throws std::runtime_error if it is missing, a directory, empty or not readable.
std::string read_file(const std::filesystem::path& path);

/// Appends number_text(value).
void append_number(std::string& text, double value);

/// Sixteen digits.
std::string hex_text(std::uint64_t value);

/// The printable start of a token, in quotes, for messages: broken files may have anything in a token.
std::string quoted(std::string_view token);

/// Walks through a text by tokens (separated by blanks) or by lines. The text must outlive the reader.
class TextReader {
 public:
  TextReader(std::filesystem::path path, std::string_view text);

  /// The next token, across line ends; empty at the end of the text.
  std::string_view token();
  /// What is left of the current line, without its line end; the reader moves to the next line.
  std::string_view rest_of_line();
  /// The tokens of the next line that has any, without a comment that begins with `comment`; a line that ends
  /// in `continuation` continues on the next. False at the end of the text. Pass 0 for what the format does
  /// not have.
  bool next_line(std::vector<std::string_view>& tokens, char comment, char continuation = 0);

  /// The comma-separated fields, without blanks around them, of the next line that is neither empty nor
  /// begins with #. False at the end of the text.
  bool next_row(std::vector<std::string_view>& fields);

  /// Line of the last token, counted from 1.
  int line() const { return token_line_; }
  /// Offset of the next byte to be read.
  std::size_t position() const { return position_; }
  bool at_end() const { return position_ == text_.size(); }

  /// A finite number; `name` names it in the message: "part.obj:12: y = nan must be finite".
  double number(std::string_view token, const char* name) const;
  /// The same for values that may be nan or infinite, because they are not used.
  double any_number(std::string_view token, const char* name) const;
  /// A 64-bit integer.
  std::int64_t integer(std::string_view token, const char* name) const;

  [[noreturn]] void fail(const std::string& what) const { fail_at(token_line_, what); }
  [[noreturn]] void fail_at(int line, const std::string& what) const;

 private:
  std::filesystem::path path_;
  std::string_view text_;
  std::size_t position_ = 0;
  int line_ = 1;        // of position_
  int token_line_ = 1;  // of the last token
};

}  // namespace aussois
