// SPDX-License-Identifier: Apache-2.0
#include "io/number_table.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/text.hpp"

namespace aussois {

NumberTable read_number_table(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  TextReader in(path, text);
  std::vector<std::string_view> fields;
  NumberTable table;
  if (!in.next_row(fields)) in.fail("file must have a header line that names the columns");
  for (const std::string_view name : fields) {
    if (std::ranges::find(table.columns, name) != table.columns.end())
      in.fail("column " + quoted(name) + " must occur once in the header");
    table.columns.emplace_back(name);
  }
  while (in.next_row(fields)) {
    if (fields.size() != table.columns.size())
      in.fail("fields = " + std::to_string(fields.size()) + " must be " +
              std::to_string(table.columns.size()) + ", as in the header");
    std::vector<double>& row = table.rows.emplace_back();
    for (std::size_t i = 0; i < fields.size(); ++i)
      row.push_back(in.number(fields[i], table.columns[i].c_str()));
  }
  return table;
}

std::size_t column_of(const NumberTable& table, const std::string& name, const std::filesystem::path& path) {
  const auto found = std::ranges::find(table.columns, name);
  if (found != table.columns.end()) return std::size_t(found - table.columns.begin());
  std::string all;
  for (const std::string& column : table.columns) all += (all.empty() ? "" : ", ") + column;
  throw std::runtime_error(path.string() + ": column '" + name + "' is missing; there are " + all);
}

SE3 pose_in(const NumberTable& table, std::size_t row, const std::array<std::size_t, 7>& columns,
            const std::filesystem::path& path) {
  const auto value = [&](std::size_t k) { return table.rows[row][columns[k]]; };
  SE3 g{Quat(value(3), value(4), value(5), value(6)), Vec3(value(0), value(1), value(2))};
  try {
    checked_pose(g, "pose");
  } catch (const std::invalid_argument& refused) {
    throw std::runtime_error(path.string() + ": row " + std::to_string(row + 1) + ": " + refused.what());
  }
  return g;
}

}  // namespace aussois
