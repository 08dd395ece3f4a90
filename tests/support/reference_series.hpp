// SPDX-License-Identifier: Apache-2.0
// Series of numbers in the shared data folder that AUSSOIS_DATA_DIR names.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace aussois {

/// The rows of references/NAME without its header; empty if there is no such file.
inline std::vector<std::vector<double>> reference_series(const std::string& name) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  std::vector<std::vector<double>> rows;
  if (!data) return rows;
  std::ifstream file(std::string(data) + "/references/" + name);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

}  // namespace aussois
