// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/shared_series.hpp"

#include <cstdlib>
#include <filesystem>

#include "io/text.hpp"

namespace aussois {

double SeriesRow::at(const std::string& column) const {
  const auto found = values.find(column);
  if (found == values.end()) throw std::runtime_error(path + ":1: no column '" + column + "'");
  return found->second;
}

std::vector<SeriesRow> shared_series(const std::string& name, const std::string& first) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  const std::filesystem::path path = std::filesystem::path(data ? data : "") / "references" / name;
  if (!data || !*data || !std::filesystem::exists(path))
    throw MissingData("AUSSOIS_DATA_DIR names no folder with references/" + name);
  return read_series(path, first);
}

std::vector<SeriesRow> read_series(const std::filesystem::path& path, const std::string& first) {
  const std::string text = read_file(path);
  TextReader in(path, text);
  std::vector<std::string_view> fields;
  in.next_row(fields);
  const std::vector<std::string> columns(fields.begin(), fields.end());
  const std::size_t words = first.empty() ? 0 : 1;
  std::vector<SeriesRow> rows;
  while (in.next_row(fields)) {
    if (fields.size() != columns.size())
      in.fail(std::to_string(fields.size()) + " values must be " + std::to_string(columns.size()) +
              ", one for each column");
    if (words == 1 && fields[0] != first) continue;
    SeriesRow& row = rows.emplace_back(SeriesRow{.path = path.string()});
    for (std::size_t k = words; k < columns.size(); ++k)
      row.values[columns[k]] = in.any_number(fields[k], columns[k].c_str());
  }
  if (rows.empty()) in.fail("no row" + (first.empty() ? first : " of " + first));
  return rows;
}

}  // namespace aussois
