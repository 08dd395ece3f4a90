// SPDX-License-Identifier: Apache-2.0
#include "examples/common/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unistd.h>

namespace aussois {

std::string duration_text(double seconds) {
  char text[48];
  const long s = std::lround(std::clamp(seconds, 0.0, 1e9));
  if (s < 60)
    std::snprintf(text, sizeof text, "%ld s", s);
  else if (s < 3600)
    std::snprintf(text, sizeof text, "%ld min %02ld s", s / 60, s % 60);
  else
    std::snprintf(text, sizeof text, "%ld h %02ld min", s / 3600, s % 3600 / 60);
  return text;
}

Progress::Style Progress::style_of_stderr(bool quiet) {
  if (quiet) return Style::none;
  return isatty(STDERR_FILENO) != 0 ? Style::terminal : Style::log;
}

Progress::Progress(std::string what, double total, Style style)
    : what_(std::move(what)), total_(total > 0 ? total : 1), style_(style) {}

Progress::~Progress() {
  if (width_ > 0) std::fputc('\n', stderr);
}

std::string Progress::line(double done, double elapsed, std::string_view note) const {
  const double fraction = std::clamp(done / total_, 0.0, 1.0);
  char percent[16];
  std::snprintf(percent, sizeof percent, "%3.0f %%", std::floor(100 * fraction));
  std::string text = what_ + "  " + percent;
  if (fraction >= 1)
    text += "  " + duration_text(elapsed);
  else if (fraction > 0 && elapsed > 1)  // before that the rate says nothing
    text += "  " + duration_text(elapsed * (1 - fraction) / fraction) + " left";
  if (!note.empty()) text.append("  ").append(note);
  return text;
}

bool Progress::due_in_log(double done, double elapsed) {
  const bool any = next_ > kFirstLine;
  if (done >= total_) return any;
  if (elapsed < next_) return false;
  next_ = 2 * elapsed;
  return true;
}

void Progress::at(double done, std::string_view note) {
  if (style_ == Style::none) return;
  const Clock::time_point now = Clock::now();
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const bool complete = done >= total_;
  if (style_ == Style::log) {
    if (due_in_log(done, elapsed)) std::fprintf(stderr, "%s\n", line(done, elapsed, note).c_str());
    return;
  }
  if (!complete && now - shown_ < std::chrono::milliseconds(100)) return;
  shown_ = now;
  std::string text = line(done, elapsed, note);
  const std::size_t length = text.size();
  if (length < width_) text.append(width_ - length, ' ');  // covers the longer line before
  width_ = std::max<std::size_t>(length, 1);
  std::fprintf(stderr, "\r%s", text.c_str());
  std::fflush(stderr);
}

}  // namespace aussois
