// SPDX-License-Identifier: Apache-2.0
// A verdict: a measured number compared with its bound.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "examples/common/driver.hpp"
#include "io/summary.hpp"

namespace aussois {

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

struct Bar {
  std::string key{}, what{};  // for scripts, for people
  std::string where{};        // the case that gave it; empty: all of them
  double value = 0, wanted = 0;
  bool pass() const { return value <= wanted; }
};

/// "... 0.12, wanted <= 0.2: PASS", or "short".
inline std::string line_of(const Bar& v) {
  const std::string where = v.where.empty() ? "" : " (" + v.where + ")";
  return v.what + where +
         formatted(": %.3g, wanted <= %.3g: %s\n", v.value, v.wanted, v.pass() ? "PASS" : "short");
}

/// One line each; true if all pass.
inline bool print_verdicts(const std::vector<Bar>& verdicts) {
  bool pass = true;
  for (const Bar& v : verdicts) {
    std::printf("%s", line_of(v).c_str());
    pass = pass && v.pass();
  }
  return pass;
}

/// Prints them and writes the summary, with "pass", where the user wants it.
inline ExitCode conclude(const std::vector<Bar>& verdicts, Summary summary, const CommonOptions& common) {
  const bool pass = print_verdicts(verdicts);
  summary.set("pass", pass);
  if (!common.summary.empty()) write_summary(common.summary, summary);
  return pass ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace aussois
