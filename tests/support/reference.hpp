// SPDX-License-Identifier: Apache-2.0
// The shared reference series (AUSSOIS_DATA_DIR/references): rows by column.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace aussois {

using ReferenceRow = std::map<std::string, double>;

/// Empty without the shared data.
inline std::vector<ReferenceRow> reference(const std::string& name) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  const std::filesystem::path path = std::filesystem::path(data ? data : "") / "references" / name;
  std::vector<ReferenceRow> rows;
  if (!data || !*data || !std::filesystem::exists(path)) return rows;
  std::ifstream file(path);
  std::string line, word;
  std::getline(file, line);
  std::vector<std::string> columns;
  for (std::istringstream head(line); std::getline(head, word, ',');) columns.push_back(word);
  while (std::getline(file, line)) {
    ReferenceRow row;
    std::istringstream cells(line);
    for (const std::string& column : columns) std::getline(cells, word, ','), row[column] = std::stod(word);
    rows.push_back(row);
  }
  EXPECT_FALSE(rows.empty()) << path;
  return rows;
}

}  // namespace aussois

/// Declares the rows, or skips the test.
#define REFERENCE(rows, name)                             \
  const std::vector<ReferenceRow> rows = reference(name); \
  if (rows.empty()) GTEST_SKIP() << "no shared data: set AUSSOIS_DATA_DIR"
