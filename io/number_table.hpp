// SPDX-License-Identifier: Apache-2.0
// Reads measured data from text: a header line that names the columns, then rows of finite numbers,
// comma-separated.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace aussois {

struct NumberTable {
  std::vector<std::string> columns{};
  std::vector<std::vector<double>> rows{};  // each as long as `columns`
};

/// Throws std::runtime_error "path:line: what" for a missing or empty file, a column that is named twice, a
/// row of another length, or a field that is not a finite number. Lines that are empty or begin with # are
/// skipped.
NumberTable read_number_table(const std::filesystem::path& path);

/// The index of a column; throws std::runtime_error naming the file, the column and the columns that exist.
std::size_t column_of(const NumberTable& table, const std::string& name, const std::filesystem::path& path);

}  // namespace aussois
