// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/assess_report.hpp"

#include <cmath>
#include <cstdio>

#include "examples/common/gnuplot.hpp"
#include "io/atomic_file.hpp"
#include "io/number_table.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else
      out += c;
  return out;
}

// With a prefix: "12.3 um".
std::string with_unit(double value, const std::string& unit) {
  if (!std::isfinite(value)) return std::isnan(value) ? "-" : value > 0 ? "none" : "-inf";
  char text[40];
  if (unit.empty()) {
    std::snprintf(text, sizeof text, "%.0f", value);
    return text;
  }
  constexpr const char* kPrefixes[] = {"n", "u", "m", "", "k"};
  int at = 3;
  double scaled = value;
  while (scaled != 0 && std::abs(scaled) < 1 && at > 0) scaled *= 1e3, --at;
  while (std::abs(scaled) >= 1e3 && at < 4) scaled /= 1e3, ++at;
  std::snprintf(text, sizeof text, "%.4g %s%s", scaled, kPrefixes[at], unit.c_str());
  return text;
}

std::string row(const std::string& what, const std::string& value) {
  return "<tr><td>" + escaped(what) + "</td><td>" + escaped(value) + "</td></tr>\n";
}

std::string numbers(const TakeAssessment& a) {
  std::string out = "<table>\n";
  for (const AssessmentNumber& number : assessment_numbers())
    out += row(number.what, with_unit(number.get(a), number.unit));
  return out + "</table>\n";
}

std::string asked(const AssessBands& bands, const AssessBounds& bounds) {
  std::string out;
  if (bounds.clearance_min > 0)
    out += row("clearance below " + with_unit(bounds.clearance_min, "m"), with_unit(bands.below, "s"));
  if (bounds.clearance_min > 0 || std::isfinite(bounds.clearance_max))
    out += row("clearance within its bounds", with_unit(bands.within, "s"));
  if (std::isfinite(bounds.clearance_max))
    out += row("clearance above " + with_unit(bounds.clearance_max, "m"), with_unit(bands.above, "s"));
  if (std::isfinite(bounds.force_max))
    out += row("a force above " + with_unit(bounds.force_max, "N"), with_unit(bands.forced, "s"));
  return out.empty() ? "" : "<h2>Asked</h2>\n<table>\n" + out + "</table>\n";
}

std::string marks(const ReportText& text) {
  if (text.marks.empty()) return "";
  std::string out = "<h2>Marks</h2>\n<table>\n";
  for (const SessionMark& mark : text.marks)
    out += row("take " + std::to_string(mark.take) + ", tick " + std::to_string(mark.moment) + " (" +
                   with_unit(double(mark.moment) * text.tick, "s") + ")",
               mark.kind + ": " + mark.text);
  return out + "</table>\n";
}

// A curve over the time as SVG; empty without gnuplot.
std::string drawn(const std::filesystem::path& folder, const std::string& label, const std::string& plots,
                  const std::string& more) {
  const std::string script =
      "set terminal svg size 760,260 font 'sans-serif,12'\nset output 'curve.svg'\nset datafile separator "
      "','\n"
      "set xlabel 'time [s]'\nset ylabel '" +
      label + "'\nset grid\nset key top right\n" + more + "plot " + plots + "\n";
  write_whole_file(folder / "curve.gp", script);
  const bool done = run_gnuplot(folder, "curve.gp");
  std::string out = done ? read_file(folder / "curve.svg") : "";
  std::filesystem::remove(folder / "curve.gp");
  std::filesystem::remove(folder / "curve.svg");
  return out.substr(std::min(out.size(), out.find("<svg") == out.npos ? out.size() : out.find("<svg")));
}

std::string curves(const std::filesystem::path& folder, const AssessBounds& bounds) {
  const auto line = [](double at, const char* name) {
    return ", " + number_text(at) + " title '" + name + "' dashtype 2 linecolor '#a3161b'";
  };
  std::string clearance =
      "'ticks.csv' using (column('t')):(1e6*column('clearance')) every ::1 with lines title 'clearance' "
      "linecolor '#1769d2'";
  if (bounds.clearance_min > 0) clearance += line(1e6 * bounds.clearance_min, "asked for");
  std::string force =
      "'ticks.csv' using (column('t')):(column('hand_force')) every ::1 with lines title 'hand' linecolor "
      "'#2a62b8', "
      "'' using (column('t')):(column('contact_force')) every ::1 with lines title 'contacts' linecolor "
      "'#c2185b'";
  if (std::isfinite(bounds.force_max)) force += line(bounds.force_max, "allowed");
  const std::string first = drawn(folder, "clearance [um]", clearance, ""),
                    second = drawn(folder, "force [N]", force, "");
  if (first.empty() || second.empty()) return "<p>Curves need gnuplot; their numbers are in ticks.csv.</p>\n";
  return "<h2>Clearance</h2>\n" + first + "\n<h2>Forces</h2>\n" + second + "\n";
}

constexpr const char* kStyle =
    ":root{color-scheme:light}body{font:15px/1.5 system-ui,sans-serif;max-width:52rem;margin:2rem "
    "auto;padding:0 1rem;color:#1c2430}"
    "h1{font-size:1.4rem}h2{font-size:1.05rem;margin:1.6rem 0 .3rem}table{border-collapse:collapse}"
    "td{padding:.1rem 1.2rem .1rem 0;border-bottom:1px solid #d5dae1;font-variant-numeric:tabular-nums}"
    ".verdict{font-size:1.2rem;padding:.4rem .8rem;border-left:.4rem solid "
    "#a3161b}.good{border-color:#1b6e3c}"
    "svg{max-width:100%;height:auto}small{color:#4d5866}";

}  // namespace

AssessBands bands_in(const std::filesystem::path& folder, const AssessBounds& bounds) {
  const std::filesystem::path path = folder / "ticks.csv";
  AssessBands out;
  const std::string text = read_file(path);
  TextReader in(path, text);
  std::vector<std::string_view> fields;
  (void)in.next_row(fields);
  const auto column = [&](std::string_view name) {
    return std::size_t(std::ranges::find(fields, name) - fields.begin());
  };
  const std::size_t t = column("t"), clearance = column("clearance"), hand = column("hand_force"),
                    contact = column("contact_force");
  double last = 0;
  while (in.next_row(fields)) {
    const auto value = [&](std::size_t k) { return in.any_number(fields.at(k), "value"); };
    const double dt = value(t) - std::exchange(last, value(t)), gap = value(clearance);
    (gap < bounds.clearance_min ? out.below : gap > bounds.clearance_max ? out.above : out.within) += dt;
    if (std::max(value(hand), value(contact)) > bounds.force_max) out.forced += dt;
  }
  return out;
}

void write_report(const std::filesystem::path& folder, const TakeAssessment& a, const AssessBounds& bounds,
                  const ReportText& text) {
  const bool good = a.verdict == TakeVerdict::arrived || a.verdict == TakeVerdict::ended;
  std::string page =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(text.title) +
      "</title><style>" + kStyle + "</style></head><body>\n<h1>" + escaped(text.title) +
      "</h1>\n<p class=\"verdict" + (good ? " good" : "") + "\">" + name_of(a.verdict, kTakeVerdicts) +
      (a.free_push.empty()
           ? ""
           : "; pushed " + escaped(a.free_push) + " it moves by " + with_unit(a.free_way, "m")) +
      "</p>\n" +
      "<p><a href=\"replay.html\">Replay</a> (in this folder, with ticks.csv, path.csv, run.h5)</p>\n";
  page += asked(bands_in(folder, bounds), bounds) + curves(folder, bounds) + "<h2>Numbers</h2>\n" +
          numbers(a) + marks(text);
  page += "<p><small>" + escaped(text.command_line) + "<br>" + escaped(text.build) +
          "</small></p>\n</body></html>\n";
  write_whole_file(folder / "report.html", page);
}

}  // namespace aussois
