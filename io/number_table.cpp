// SPDX-License-Identifier: Apache-2.0
#include "io/number_table.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/text.hpp"

namespace aussois {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r"), text.size());
  const std::size_t end = text.find_last_not_of(" \t\r") + 1;
  return text.substr(begin, begin < end ? end - begin : 0);
}

// The fields of the next line that is neither empty nor a comment; none at the end.
std::vector<std::string_view> next_fields(TextReader& in) {
  std::vector<std::string_view> fields;
  while (!in.at_end() && fields.empty()) {
    std::string_view line = trimmed(in.rest_of_line());
    if (line.empty() || line[0] == '#') continue;
    for (std::size_t comma = line.find(','); comma != line.npos; comma = line.find(',')) {
      fields.push_back(trimmed(line.substr(0, comma)));
      line.remove_prefix(comma + 1);
    }
    fields.push_back(trimmed(line));
  }
  return fields;
}

}  // namespace

NumberTable read_number_table(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  TextReader in(path, text);
  NumberTable table;
  for (const std::string_view name : next_fields(in)) {
    if (std::ranges::find(table.columns, name) != table.columns.end())
      in.fail("column " + quoted(name) + " must stand once in the header");
    table.columns.emplace_back(name);
  }
  if (table.columns.empty()) in.fail("file must have a header line that names the columns");
  for (auto fields = next_fields(in); !fields.empty(); fields = next_fields(in)) {
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

}  // namespace aussois
