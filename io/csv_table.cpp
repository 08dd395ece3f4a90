// SPDX-License-Identifier: Apache-2.0
#include "io/csv_table.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

std::string header_line(const std::vector<std::string>& columns) {
  require(!columns.empty(), "CsvTable: no columns");
  std::string line;
  for (const std::string& name : columns) {
    require(!name.empty() && name.find_first_of(",\"\r\n") == std::string::npos,
            "CsvTable: column name '" + name + "' must be non-empty without comma, quote or line end");
    line += (line.empty() ? "" : ",") + name;
  }
  return line + '\n';
}

/// Bytes of the header and the first `rows` rows.
std::uintmax_t size_of_rows(const std::filesystem::path& growing, const std::string& header,
                            std::size_t rows) {
  std::ifstream file(growing, std::ios::binary);
  if (!file) throw std::runtime_error(growing.string() + ": cannot be opened to resume the table");
  std::string line;
  std::getline(file, line);
  if (line + '\n' != header || file.eof())
    throw std::runtime_error(growing.string() + ":1: the columns are '" + line + "', not '" +
                             header.substr(0, header.size() - 1) + "'");
  for (std::size_t row = 0; row < rows; ++row)
    if (!std::getline(file, line) || file.eof())  // a row without its line end was not finished
      throw std::runtime_error(growing.string() + ": has " + std::to_string(row) + " whole rows, " +
                               std::to_string(rows) + " are needed to resume");
  return std::uintmax_t(file.tellg());
}

}  // namespace

CsvTable::CsvTable(std::filesystem::path path, const std::vector<std::string>& columns)
    : path_(std::move(path)), columns_(columns.size()) {
  const std::string header = header_line(columns);
  const std::filesystem::path growing = growing_name(path_);
  {
    WriterLock left(growing);
    left.remove_file();
    file_.reset(std::fopen(growing.c_str(), "wbx"));
    if (!file_) throw std::runtime_error(path_.string() + ": cannot be created: " + std::strerror(errno));
  }
  lock_ = WriterLock(growing);
  write(header);
}

CsvTable CsvTable::resume(std::filesystem::path path, const std::vector<std::string>& columns,
                          std::size_t rows) {
  const std::filesystem::path growing = growing_name(path);
  CsvTable table;
  table.lock_ = WriterLock(growing);
  const std::uintmax_t size = size_of_rows(growing, header_line(columns), rows);
  std::error_code failed;
  std::filesystem::resize_file(growing, size, failed);
  table.path_ = std::move(path);
  table.columns_ = columns.size();
  table.rows_ = rows;
  if (!failed) table.file_.reset(std::fopen(growing.c_str(), "ab"));
  if (!table.file_) throw std::runtime_error(growing.string() + ": cannot be cut and reopened");
  return table;
}

void CsvTable::add(std::span<const double> values) {
  require_field(values.size() == columns_, "CsvTable::add: values", values.size(), "be one per column");
  std::string line;
  for (const double value : values) {
    if (!line.empty()) line += ',';
    append_number(line, value);
  }
  write(line + '\n');
  ++rows_;
}

void CsvTable::write(const std::string& text) {
  if (!file_) throw std::runtime_error(path_.string() + ": the table is closed");
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size())
    throw std::runtime_error(path_.string() + ": cannot be written");
}

void CsvTable::flush() {
  if (!file_) return;
  if (std::fflush(file_.get()) != 0) throw std::runtime_error(path_.string() + ": cannot be written");
  sync_to_disk(growing_name(path_));
}

void CsvTable::close() {
  if (!file_) return;
  if (std::fclose(file_.release()) != 0) throw std::runtime_error(path_.string() + ": cannot be written");
  publish_file(growing_name(path_), path_);
  lock_ = {};
}

}  // namespace aussois
