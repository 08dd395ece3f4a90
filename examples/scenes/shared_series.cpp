// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/shared_series.hpp"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <span>

#include "geometry/digest.hpp"
#include "io/text.hpp"

namespace aussois {

double SeriesRow::at(const std::string& column) const {
  const auto found = values.find(column);
  if (found == values.end()) throw std::runtime_error(path + ":1: no column '" + column + "'");
  return found->second;
}

namespace {

// Empty: there is none.
std::filesystem::path series_folder(const char* name) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) return {};
  std::filesystem::path folder = std::filesystem::path(data) / name;
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

std::vector<SeriesRow> series_of(const std::string& folder_name, const std::string& name,
                                 const std::string& first) {
  const std::filesystem::path folder = series_folder(folder_name.c_str());
  if (folder.empty() || !std::filesystem::exists(folder / name))
    throw MissingData("AUSSOIS_DATA_DIR names no folder with " + folder_name + "/" + name);
  return read_series(folder / name, first);
}

constexpr const char* kRigid = "references";
constexpr const char* kDeformable = "references-deformable";

}  // namespace

std::vector<SeriesRow> shared_series(const std::string& name, const std::string& first) {
  return series_of(kRigid, name, first);
}
std::vector<SeriesRow> deformable_series(const std::string& name, const std::string& first) {
  return series_of(kDeformable, name, first);
}

const SeriesRow& row_where(const std::vector<SeriesRow>& rows, const std::string& column, double value) {
  for (const SeriesRow& row : rows)
    if (std::abs(row.at(column) - value) <= 1e-9) return row;
  throw std::runtime_error(rows.front().path + ": no row with " + column + " = " + std::to_string(value));
}

std::uint64_t shared_series_digest() {
  Digest digest;
  bool any = false;
  for (const char* name : {kRigid, kDeformable}) {
    const std::filesystem::path folder = series_folder(name);
    if (folder.empty()) continue;
    any = true;
    std::set<std::filesystem::path> files;
    for (const std::filesystem::directory_entry& entry :
         std::filesystem::recursive_directory_iterator(folder))
      if (entry.is_regular_file()) files.insert(entry.path());
    for (const std::filesystem::path& file : files)
      for (const std::string& text : {file.lexically_relative(folder).string(), read_file(file)})
        digest.add(std::as_bytes(std::span(text)));
  }
  return any ? digest.value : 0;
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
