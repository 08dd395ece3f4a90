// SPDX-License-Identifier: Apache-2.0
// Series of numbers in the shared data folder, computed by other programs (AUSSOIS_DATA_DIR/references).
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace aussois {

/// The shared data folder (AUSSOIS_DATA_DIR) is missing, or lacks the file.
struct MissingData : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SeriesRow {
  std::string path{};
  std::map<std::string, double> values{};  // by column
  /// Throws std::runtime_error naming the file if it has no such column.
  double at(const std::string& column) const;
};

/// The rows of a file, at least one; with `first`, those whose first column is this word. Throws
/// std::runtime_error "path:line: ..." where it is no table of numbers.
std::vector<SeriesRow> read_series(const std::filesystem::path& path, const std::string& first = "");
/// The same for references/NAME; throws MissingData if there is no such file.
std::vector<SeriesRow> shared_series(const std::string& name, const std::string& first = "");
/// The same for references-deformable/NAME.
std::vector<SeriesRow> deformable_series(const std::string& name, const std::string& first = "");
/// The row whose number in a column is `value`, to 1e-9; throws std::runtime_error naming the file if there
/// is none.
const SeriesRow& row_where(const std::vector<SeriesRow>& rows, const std::string& column, double value);
/// A digest of all files of both folders; 0 without any.
std::uint64_t shared_series_digest();

}  // namespace aussois
