// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/list.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>

#include <nlohmann/json.hpp>

#include "examples/common/kept_json.hpp"
#include "examples/common/many_tasks.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kBegin = "<!-- verify --page writes from here -->\n";
constexpr const char* kEnd = "<!-- to here -->\n";

const std::map<char, std::string> kGroups = {{'A', "Impacts without friction"},
                                             {'B', "Friction and rolling"},
                                             {'C', "Mechanisms and loops"},
                                             {'D', "Rotations"},
                                             {'E', "Beams"},
                                             {'F', "Solids"},
                                             {'G', "Stacks and scenes"},
                                             {'H', "Balances"},
                                             {'J', "Trees in joint coordinates"},
                                             {'K', "Cables in contact"},
                                             {'P', "Pegs in holes"},
                                             {'S', "All that deforms"}};

std::string digits(double figure) {
  char text[32];
  const bool counted = figure == std::round(figure) && std::abs(figure) < 1e6;
  std::snprintf(text, sizeof text, counted ? "%.0f" : "%.2g", figure);
  return text;
}

/// What a case runs, and whether certified.
std::string what_of(const VerificationCase& c) {
  return c.certified ? c.what + "; certified" : c.what;
}

Json key_of(const VerificationCase& c, std::uint64_t program) {
  return {{"case", c.name}, {"setting", c.setting}, {"program", program}};
}

}  // namespace

std::string stem_of(const VerificationCase& c) {
  return file_stem(c.setting.empty() ? c.name : c.name + "_" + c.setting);
}

void write_measured(const std::filesystem::path& path, const VerificationCase& c, const Measured& measured,
                    std::uint64_t program) {
  Json json{{"failure", measured.failure}, {"figures", Json::object()}};
  for (const auto& [name, value] : measured.figures) json["figures"][name] = number_json(value);
  write_kept(path, key_of(c, program), json);
}

std::optional<Measured> read_measured(const std::filesystem::path& path, const VerificationCase& c,
                                      std::uint64_t program) {
  const auto known = read_kept(path, key_of(c, program), [&](const Json& json) {
    Measured out{.failure = json.at("failure")};
    for (const auto& [name, value] : json.at("figures").items()) out.figures[name] = number_in(value);
    return out;
  });
  const bool whole = known && (!known->failure.empty() || std::ranges::all_of(c.rows, [&](const Asked& row) {
                       return known->figures.contains(row.figure);
                     }));
  return whole ? known : std::nullopt;
}

int count(const List& list, Verdict wanted) {
  int out = 0;
  for (const auto& [c, measured] : list)
    for (const Asked& row : c->rows) out += measured && verdict(row, *measured) == wanted;
  return out;
}

int count_guards(const List& list) {
  int out = 0;
  for (const auto& [c, measured] : list)
    for (const Asked& row : c->rows)
      out += measured && verdict(row, *measured) == Verdict::pass &&
             row.source.find("guard") != std::string::npos;
  return out;
}

std::map<std::string, int> missing(const List& list) {
  std::map<std::string, int> out;
  for (const auto& [c, measured] : list)
    if (measured && !measured->missing.empty()) out[measured->missing] += int(c->rows.size());
  return out;
}

std::string to_text(const List& list) {
  std::ostringstream out;
  for (const auto& [c, measured] : list) {
    out << full_name(*c) << ": " << what_of(*c) << '\n';
    if (measured && !measured->failure.empty())
      out << "  does not come to its end: " << measured->failure << '\n';
    if (measured && !measured->missing.empty()) out << "  skipped: " << measured->missing << '\n';
    for (const Asked& row : c->rows) {
      char line[128];
      const Verdict is = measured ? verdict(row, *measured) : Verdict::skipped;
      std::snprintf(line, sizeof line, "  %-8s%-16s %9s %-22s ",
                    is == Verdict::pass   ? "holds"
                    : is == Verdict::fail ? "FAILS"
                                          : "",
                    row.figure.c_str(),
                    measured && is != Verdict::skipped ? digits(figure(row, *measured)).c_str() : "",
                    bound_text(row).c_str());
      out << line << row.what << " (" << row.source << ")\n";
    }
  }
  return out.str();
}

std::string to_json(const List& list) {
  Json rows = Json::array();
  for (const auto& [c, measured] : list)
    for (const Asked& row : c->rows) {
      const Verdict is = measured ? verdict(row, *measured) : Verdict::skipped;
      const double value = measured ? figure(row, *measured) : std::nan("");
      rows.push_back({{"case", row_name(*c, row)},
                      {"figure", std::isfinite(value) ? Json(value) : Json()},
                      {"sense", symbol(row.sense)},
                      {"bound", row.bound},
                      {"unit", row.unit},
                      {"pass", is == Verdict::skipped ? Json() : Json(is == Verdict::pass)},
                      {"what", what_of(*c) + ": " + row.what},
                      {"source", row.source}});
    }
  return Json{{"cases", rows}}.dump(2) + "\n";
}

namespace {

/// A line of the page: one row, or those of several settings.
struct Line {
  std::string name{}, what{}, bound{}, source{};
  std::vector<std::string> settings{};
  std::optional<double> worst{};  // of those measured
  bool same_row(const Line& other) const {
    return name == other.name && what == other.what && bound == other.bound && source == other.source;
  }
};

/// The larger, the worse for the bound.
double badness(const Asked& row, double value) {
  if (std::isnan(value)) return HUGE_VAL;
  return row.sense == Sense::at_most    ? value
         : row.sense == Sense::at_least ? -value
                                        : std::abs(value - row.bound);
}

std::vector<Line> lines_of(const List& list) {
  std::vector<Line> out;
  for (const auto& [c, measured] : list)
    for (const Asked& row : c->rows) {
      const Line line{.name = c->name + "." + row.figure,
                      .what = what_of(*c) + ": " + row.what,
                      .bound = bound_text(row),
                      .source = row.source};
      auto known = std::ranges::find_if(out, [&](const Line& other) { return other.same_row(line); });
      if (known == out.end()) known = out.insert(out.end(), line);
      if (!c->setting.empty()) known->settings.push_back(c->setting);
      if (!measured || !measured->missing.empty()) continue;
      const double value = figure(row, *measured);
      if (!known->worst || !(badness(row, value) <= badness(row, *known->worst))) known->worst = value;
    }
  return out;
}

std::string settings_text(const std::vector<std::string>& settings) {
  if (settings.size() > 3) return std::to_string(settings.size()) + " settings";
  std::string out;
  for (const std::string& setting : settings) out += (out.empty() ? "" : "; ") + setting;
  return out;
}

}  // namespace

std::string to_markdown(const List& list) {
  std::ostringstream out;
  char group = 0;
  for (const Line& line : lines_of(list)) {
    if (line.name[0] != group) {
      group = line.name[0];
      out << "\n### " << group << ". " << kGroups.at(group)
          << ", by `verify`\n\n| row | what | in | bound | source of the bound | measured "
             "|\n|---|---|---|---|---|---|\n";
    }
    out << "| `" << line.name << "` | " << line.what << " | " << settings_text(line.settings) << " | "
        << line.bound << " | " << line.source << " | " << (line.worst ? digits(*line.worst) : "-") << " |\n";
  }
  out << '\n';
  return out.str();
}

bool has_list(const std::string& page) {
  const std::size_t begin = page.find(kBegin);
  return begin != std::string::npos && page.find(kEnd, begin) != std::string::npos;
}

std::string list_in(const std::string& page) {
  const std::size_t first = page.find(kBegin) + std::strlen(kBegin);
  return page.substr(first, page.find(kEnd, first) - first);
}

std::string with_list(const std::string& page, const std::string& markdown) {
  const std::size_t first = page.find(kBegin) + std::strlen(kBegin);
  return std::string(page).replace(first, list_in(page).size(), markdown);
}

std::string without_figures(const std::string& markdown) {
  std::istringstream in(markdown);
  std::string out, line;
  while (std::getline(in, line)) {
    if (line.starts_with("| `")) line.erase(line.rfind('|', line.size() - 2));
    out += line + "\n";
  }
  return out;
}

}  // namespace aussois
