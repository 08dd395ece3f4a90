// SPDX-License-Identifier: Apache-2.0
// A table of numbers as text: one header line, one line per row, comma-separated, independent of the locale.
#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/atomic_file.hpp"

namespace aussois {

/// Rows go to PATH.tmp, which no other run may write meanwhile and which becomes PATH at close(). Doubles are
/// written in the shortest form that reads back as the same bits, whole numbers without a point, nan and inf
/// as these words. Without close() (after an error or an interruption) the rows stay in PATH.tmp for
/// `resume`.
class CsvTable {
 public:
  /// Throws std::invalid_argument if there are no columns or a name has a comma, quote or line end;
  /// std::runtime_error if the file cannot be created or another run is writing it.
  CsvTable(std::filesystem::path path, const std::vector<std::string>& columns);

  /// Reopens PATH.tmp, keeps its first `rows` rows and cuts off the rest, even half a line. Throws
  /// std::runtime_error if the file is missing, has other columns, fewer rows, or another writer.
  static CsvTable resume(std::filesystem::path path, const std::vector<std::string>& columns,
                         std::size_t rows);

  /// Throws std::invalid_argument unless there is one value per column.
  void add(std::span<const double> values);
  void add(std::initializer_list<double> values) { add(std::span(values.begin(), values.size())); }

  void flush();  // to the disk; call it before a checkpoint counts the rows
  void close();  // flush and rename; further rows are refused
  std::size_t rows() const { return rows_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  CsvTable() = default;
  void write(const std::string& text);

  std::filesystem::path path_{};
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::unique_ptr<std::FILE, CloseFile> file_{};
  WriterLock lock_{};
};

}  // namespace aussois
