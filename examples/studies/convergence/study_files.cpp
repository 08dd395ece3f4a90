// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/convergence/study_files.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include <nlohmann/json.hpp>

#include "examples/common/gnuplot.hpp"
#include "examples/common/kept_json.hpp"
#include "examples/common/many_tasks.hpp"
#include "io/atomic_file.hpp"
#include "io/csv_table.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Errors& errors) {
  Json out;
  for (std::size_t m = 0; m < errors.size(); ++m) out[kMeasures[m]] = errors[m];  // infinity becomes null
  return out;
}

Errors errors_in(const Json& json) {
  Errors out;
  for (std::size_t m = 0; m < out.size(); ++m) {
    const Json& number = json.at(kMeasures[m]);
    out[m] = number.is_null() ? kInf : number.get<double>();
  }
  return out;
}

// What has to agree before a file counts as the study that is wanted.
Json key_of(const Study& s, std::uint64_t program) {
  return {{"case", s.case_name},
          {"scheme", s.scheme},
          {"options", settings_json(s.options)},
          {"settings", s.options.settings},
          {"program", program}};
}

// What is kept beside the key.
Json fields_of(const Study& s) {
  Json out;
  out["as_expected"] = as_expected(s);
  out["verdict"] = to_string(order_verdict(s));
  out["order"] = json_of(s.order);
  out["expected"] = json_of(s.expected);
  for (std::size_t m = 0; m < s.why.size(); ++m) out["why"][kMeasures[m]] = s.why[m];
  out["steps"] = s.steps;
  if (s.options.certify > 0) out["audit"] = aussois::json_of(s.audit);
  for (std::size_t i = 0; i < s.h.size(); ++i) {
    Json level = json_of(s.errors[i]);
    level["h_s"] = s.h[i];
    level["cut"] = s.cut[i];
    out["levels_done"].push_back(level);
  }
  return out;
}

std::string order_text(const Study& s) {
  std::string out;
  char text[24];
  for (std::size_t m = 0; m < s.order.size(); ++m) {
    const bool exact = std::isinf(s.order[m]), missed = !(s.order[m] >= s.expected[m] - kOrderSlack);
    const bool less = !exact && !missed && s.expected[m] < 1;
    std::snprintf(text, sizeof text, exact ? "exact" : less ? "(%.2f)" : "%.2f", s.order[m]);
    if (m > 0) out += ' ';
    out.append(missed ? "**" : "").append(text).append(missed ? "**" : "");
  }
  if (order_verdict(s) == OrderVerdict::not_judged) out = "not judged";
  return std::ranges::count(s.cut, 0) < std::ptrdiff_t(s.cut.size()) ? out + " c" : out;
}

// Every value of `names` once, in the order in which they come.
std::vector<std::string> once(std::vector<std::string> names) {
  std::vector<std::string> out;
  for (std::string& name : names)
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(std::move(name));
  return out;
}

std::string scheme_of(const Study& s) {
  return s.scheme.substr(0, s.scheme.find(' '));
}

}  // namespace

std::string stem_of(const Study& s) {
  return file_stem(s.case_name + "_" + s.scheme);
}

std::string to_json(const Study& study, std::uint64_t program) {
  return file_text(with_key(key_of(study, program), fields_of(study)));
}

std::string to_json(const std::vector<Study>& studies, std::uint64_t program) {
  Json out = Json::array();
  for (const Study& s : studies) out.push_back(with_key(key_of(s, program), fields_of(s)));
  return file_text(out);
}

void write_study(const std::filesystem::path& path, const Study& study, std::uint64_t program) {
  write_kept(path, key_of(study, program), fields_of(study));
}

std::optional<Study> read_study(const std::filesystem::path& path, const Study& wanted,
                                std::uint64_t program) {
  return read_kept(path, key_of(wanted, program), [&](const Json& json) {
    Study out = wanted;
    out.order = errors_in(json.at("order")), out.expected = errors_in(json.at("expected"));
    for (std::size_t m = 0; m < out.why.size(); ++m) out.why[m] = json.at("why").at(kMeasures[m]);
    out.steps = json.at("steps");
    if (wanted.options.certify > 0) out.audit = audit_in(json.at("audit"));
    out.h.clear(), out.errors.clear(), out.cut.clear();
    for (const Json& level : json.at("levels_done")) {
      out.h.push_back(level.at("h_s"));
      out.errors.push_back(errors_in(level));
      out.cut.push_back(level.at("cut"));
    }
    require_field(int(out.h.size()) >= wanted.options.levels, "levels_done", out.h.size(),
                  "be no fewer than asked for");
    return out;
  });
}

bool write_picture(const std::filesystem::path& dir, const Study& s) {
  const std::string stem = stem_of(s);
  std::vector<std::string> columns = {"h_s"};
  for (const char* measure : kMeasures) columns.emplace_back(measure);
  for (const char* measure : kMeasures) columns.push_back(std::string("order_") + measure);
  CsvTable csv(dir / (stem + ".csv"), columns);
  for (std::size_t i = 0; i < s.h.size(); ++i) {
    std::vector<double> row = {s.h[i]};
    row.insert(row.end(), s.errors[i].begin(), s.errors[i].end());
    for (std::size_t m = 0; m < kMeasures.size(); ++m)
      row.push_back(i == 0 ? std::nan("")
                           : std::log(s.errors[i][m] / s.errors[i - 1][m]) / std::log(s.h[i] / s.h[i - 1]));
    csv.add(row);
  }
  csv.close();

  // The slopes pass below all curves, at the largest step.
  double lowest = kInf, range = s.h.front();
  for (const double e : s.errors.front()) lowest = e > 0 ? std::min(lowest, e) : lowest;
  std::ostringstream gp;
  gp << "# draws " << stem << ".png: gnuplot " << stem << ".gp\n"
     << "set terminal pngcairo size 1100,700; set output '" << stem << ".png'\n"
     << "set datafile separator ','; set logscale xy; set format y '%.0e'; set grid; set key outside right "
        "center vertical\n"
     << "set title '" << s.case_name << ", " << s.scheme
     << "' noenhanced; set xlabel 'step h [s]'; set ylabel 'error [SI units of the case]'\nset xtics (";
  for (std::size_t i = 0; i < s.h.size(); ++i) {
    char tick[48];
    std::snprintf(tick, sizeof tick, "%s'%.2g' %.17g", i > 0 ? ", " : "", s.h[i], s.h[i]);
    gp << tick;
  }
  gp << ") rotate by 30 right\n"
     << "plot [" << 0.8 * s.h.back() << ":" << 1.25 * range << "] \\\n";
  for (std::size_t m = 0; m < kMeasures.size(); ++m) {
    char title[80];
    std::snprintf(title, sizeof title, std::isinf(s.order[m]) ? "%s, exact" : "%s, order %.2f", kMeasures[m],
                  s.order[m]);
    gp << "  '" << stem << ".csv' every ::1 using 1:" << m + 2 << " with linespoints pt " << 4 + 2 * m
       << " ps " << 2.2 - 0.4 * double(m) << " lw " << 4 - m << " title '" << title << "' noenhanced, \\\n";
  }
  for (int p = 1; p <= 2; ++p)
    gp << "  " << 0.5 * lowest << "*(x/" << range << ")**" << p << " with lines dt 2 lc 'grey" << 30 * p
       << "' title 'slope " << p << "'" << (p == 1 ? ", \\\n" : "\n");
  write_whole_file(dir / (stem + ".gp"), gp.str());
  return run_gnuplot(dir, stem + ".gp");
}

std::string order_table(const std::vector<Study>& studies) {
  std::vector<std::string> schemes;
  for (const Study& s : studies) schemes.push_back(scheme_of(s));
  std::string out;
  for (const std::string& scheme : once(schemes)) {
    std::vector<std::string> rows, columns;
    for (const Study& s : studies)
      if (scheme_of(s) == scheme) rows.push_back(s.case_name), columns.push_back(s.scheme);
    rows = once(rows), columns = once(columns);
    std::string head = "| case |", rule = "|---|";
    for (const std::string& column : columns) {
      const std::string settings = column.substr(std::min(scheme.size() + 1, column.size()));
      head.append(" ").append(settings.empty() ? "defaults" : settings).append(" |"), rule += "---|";
    }
    out += (out.empty() ? "## " : "\n## ") + scheme + "\n\n" + head + "\n" + rule + "\n";
    for (const std::string& row : rows) {
      out.append("| `").append(row).append("` |");
      for (const std::string& column : columns) {
        const auto cell = std::find_if(studies.begin(), studies.end(), [&](const Study& s) {
          return s.case_name == row && s.scheme == column;
        });
        out.append(" ").append(cell == studies.end() ? "-" : order_text(*cell)).append(" |");
      }
      out += '\n';
    }
  }
  return out;
}

}  // namespace aussois
