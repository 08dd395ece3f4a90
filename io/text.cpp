// SPDX-License-Identifier: Apache-2.0
#include "io/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "geometry/number_text.hpp"

namespace aussois {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  const std::size_t end = text.find_last_not_of(kBlanks) + 1;
  return text.substr(begin, begin < end ? end - begin : 0);
}

// from_chars takes no leading plus; "+-1" stays an error.
std::string_view without_plus(std::string_view token) {
  const bool plus = token.size() > 1 && token[0] == '+' && token[1] != '-';
  return plus ? token.substr(1) : token;
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw std::runtime_error(path.string() + ": no such file");
  if (std::filesystem::is_directory(status))
    throw std::runtime_error(path.string() + ": is a directory, not a file");
  if (!std::filesystem::is_regular_file(status))  // a device may never end
    throw std::runtime_error(path.string() + ": is not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be opened for reading");
  std::string content;
  std::array<char, 1 << 16> block{};
  while (file.read(block.data(), block.size()) || file.gcount() > 0)
    content.append(block.data(), std::size_t(file.gcount()));
  if (file.bad()) throw std::runtime_error(path.string() + ": cannot be read");
  if (content.empty()) throw std::runtime_error(path.string() + ": is empty");
  return content;
}

std::string hex_text(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

void append_number(std::string& text, double value) {
  text += number_text(value);
}

std::string quoted(std::string_view token) {
  std::string shown = "'";
  for (const char c : token.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
  shown += token.size() > 40 ? "...'" : "'";
  return shown;
}

TextReader::TextReader(std::filesystem::path path, std::string_view text)
    : path_(std::move(path)), text_(text) {
  if (text_.substr(0, 3) == "\xEF\xBB\xBF") position_ = 3;  // the mark some editors put before UTF-8
}

std::string_view TextReader::token() {
  while (!at_end()) {
    if (text_[position_] == '\n')
      ++line_;
    else if (kBlanks.find(text_[position_]) == kBlanks.npos)
      break;
    ++position_;
  }
  token_line_ = line_;
  const std::size_t begin = position_;
  while (!at_end() && text_[position_] != '\n' && kBlanks.find(text_[position_]) == kBlanks.npos) ++position_;
  return text_.substr(begin, position_ - begin);
}

std::string_view TextReader::rest_of_line() {
  token_line_ = line_;
  const std::size_t end = std::min(text_.find('\n', position_), text_.size());
  std::string_view rest = text_.substr(position_, end - position_);
  position_ = std::min(end + 1, text_.size());
  if (end < text_.size()) ++line_;
  if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
  return rest;
}

bool TextReader::next_line(std::vector<std::string_view>& tokens, char comment, char continuation) {
  tokens.clear();
  while (!at_end()) {
    std::string_view rest = rest_of_line();
    if (comment) rest = rest.substr(0, rest.find(comment));
    while (true) {
      const std::size_t begin = rest.find_first_not_of(kBlanks);
      if (begin == rest.npos) break;
      const std::size_t end = std::min(rest.find_first_of(kBlanks, begin), rest.size());
      tokens.push_back(rest.substr(begin, end - begin));
      rest.remove_prefix(end);
    }
    const bool goes_on = continuation && !tokens.empty() && tokens.back().back() == continuation;
    if (goes_on) {
      tokens.back().remove_suffix(1);
      if (tokens.back().empty()) tokens.pop_back();
    } else if (!tokens.empty()) {
      return true;
    }
  }
  return !tokens.empty();
}

bool TextReader::next_row(std::vector<std::string_view>& fields) {
  fields.clear();
  while (!at_end()) {
    std::string_view line = trimmed(rest_of_line());
    if (line.empty() || line[0] == '#') continue;
    for (std::size_t comma = line.find(','); comma != line.npos; comma = line.find(',')) {
      fields.push_back(trimmed(line.substr(0, comma)));
      line.remove_prefix(comma + 1);
    }
    fields.push_back(trimmed(line));
    return true;
  }
  return false;
}

double TextReader::number(std::string_view token, const char* name) const {
  const double value = any_number(token, name);
  if (!std::isfinite(value)) fail(std::string(name) + " = " + std::string(token) + " must be finite");
  return value;
}

double TextReader::any_number(std::string_view token, const char* name) const {
  const std::string_view digits = without_plus(token);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    fail(std::string(name) + " = " + quoted(token) + " must fit a double, 1e-308 to 1e308");
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(std::string(name) + " = " + quoted(token) + " must be a number");
  return value;
}

std::int64_t TextReader::integer(std::string_view token, const char* name) const {
  const std::string_view digits = without_plus(token);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size())
    fail(std::string(name) + " = " + quoted(token) + " must be an integer");
  return value;
}

void TextReader::fail_at(int line, const std::string& what) const {
  throw std::runtime_error(path_.string() + ":" + std::to_string(line) + ": " + what);
}

}  // namespace aussois
