// SPDX-License-Identifier: Apache-2.0
// Compares two assessed ways of a part, aligned by the length of the way and not by time: clearance, forces
// and work, and where they differ most.
//
// Theory   doc/theory/sessions.md (SES-1)
// Run      compare_paths data/ways/straight data/ways/aside
// Expect   a line per quantity with its largest difference and where; exit code 1 if a tolerance is given and
// exceeded
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "examples/common/driver.hpp"
#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/number_table.hpp"
#include "io/pose_file.hpp"
#include "io/summary.hpp"
#include "io/text.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> ways{};
  double clearance = kInf, force = kInf;  // tolerances [m], [N]
  CommonOptions common{};
};

constexpr std::array<const char*, 3> kColumns{"clearance", "hand_force", "contact_force"};
constexpr std::array<const char*, 3> kUnits{"m", "N", "N"};
constexpr int kSamples = 400;

struct Way {
  std::string table{};          // ticks.csv as it stands
  std::vector<double> share{};  // of the length, at each row, from 0 to 1
  std::array<std::vector<double>, 3> values{};
  double length = 0, work = 0;  // [m], [J]
};

// Rows of ticks.csv: some words are inf, which a table of finite numbers has not.
std::vector<double> column_in(const std::filesystem::path& path, const std::string& text,
                              const std::string& name) {
  TextReader in(path, text);
  std::vector<std::string_view> fields;
  if (!in.next_row(fields)) in.fail("must have a header");
  const auto at = std::size_t(std::ranges::find(fields, std::string_view(name)) - fields.begin());
  if (at == fields.size()) in.fail("has no column " + name);
  const std::size_t width = fields.size();
  std::vector<double> out;
  while (in.next_row(fields)) {
    if (fields.size() != width)
      in.fail("fields = " + std::to_string(fields.size()) + " must be " + std::to_string(width));
    out.push_back(in.any_number(fields[at], name.c_str()));
  }
  if (out.empty()) in.fail("has no rows");
  return out;
}

double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
  const auto after = std::ranges::upper_bound(x, at);
  if (after == x.begin()) return y.front();
  if (after == x.end()) return y.back();
  const auto i = std::size_t(after - x.begin());
  const double part = (at - x[i - 1]) / (x[i] - x[i - 1]);
  return part == 0 ? y[i - 1] : std::lerp(y[i - 1], y[i], part);
}

Way read_way(const std::filesystem::path& folder) {
  const std::filesystem::path table = folder / "ticks.csv";
  Way out{.table = read_file(table)};
  const PoseFile poses = read_poses(folder / "path.csv", 1);
  std::vector<double> length{0};
  for (std::size_t i = 1; i < poses.pose.size(); ++i)
    length.push_back(length.back() + (poses.pose[i].p - poses.pose[i - 1].p).norm());
  out.length = length.back();
  for (const double t : column_in(table, out.table, "t"))
    out.share.push_back(out.length > 0 ? between(poses.t, length, t) / out.length : 0);
  for (std::size_t k = 0; k < kColumns.size(); ++k) out.values[k] = column_in(table, out.table, kColumns[k]);
  out.work = column_in(table, out.table, "hand_work").back();
  return out;
}

struct Difference {
  double largest = 0, at = 0;  // at: share of the length
};
Difference difference(const Way& a, const Way& b, std::size_t k) {
  Difference out;
  for (int i = 0; i <= kSamples; ++i) {
    const double at = double(i) / kSamples, x = between(a.share, a.values[k], at),
                 y = between(b.share, b.values[k], at);
    const double off = x == y ? 0 : std::abs(x - y);  // both may be infinite
    if (off > out.largest) out = {off, at};
  }
  return out;
}

ExitCode compare(const Arguments& a) {
  require_field(a.ways.size() == 2, "folders", a.ways.size(), "be two");
  const Way first = read_way(a.ways[0]), second = read_way(a.ways[1]);
  std::array<Difference, 3> off;
  for (std::size_t k = 0; k < off.size(); ++k) off[k] = difference(first, second, k);
  const bool same = first.table == second.table;
  make_folders(a.common);
  std::string csv =
      "share,clearance_a,clearance_b,hand_force_a,hand_force_b,contact_force_a,contact_force_b\n";
  for (int i = 0; i <= kSamples; ++i) {
    const double at = double(i) / kSamples;
    append_number(csv, at);
    for (std::size_t k = 0; k < off.size(); ++k)
      for (const Way* way : {&first, &second})
        append_number(csv += ',', between(way->share, way->values[k], at));
    csv += '\n';
  }
  write_whole_file(a.common.out / "compared.csv", csv);
  for (std::size_t k = 0; k < off.size(); ++k)
    std::printf("%-14s largest difference %.4g %s at %.1f %% of the way\n", kColumns[k], off[k].largest,
                kUnits[k], 100 * off[k].at);
  std::printf("length         %.6g and %.6g m\nwork           %.4g and %.4g J\n", first.length, second.length,
              first.work, second.work);
  if (!a.common.summary.empty()) {
    Summary summary;
    for (std::size_t k = 0; k < off.size(); ++k) {
      summary.set(std::string(kColumns[k]) + "_difference", off[k].largest);
      summary.set(std::string(kColumns[k]) + "_where", off[k].at);
    }
    summary.set("length_difference", second.length - first.length);
    summary.set("work_difference", second.work - first.work);
    summary.set("same_rows", same);
    write_summary(a.common.summary, summary);
  }
  std::printf("%s\n", same ? "the same numbers in every row" : "two ways");
  const bool near = off[0].largest <= a.clearance && std::max(off[1].largest, off[2].largest) <= a.force;
  return near ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("compare_paths", "Compares two ways that assess_path or assembly_station left in two folders.");
  cli.files(a.ways, "two folders with ticks.csv and path.csv");
  cli.group("tolerances");
  cli.option("--clearance-tolerance", a.clearance, "largest difference of the clearance", "m",
             not_negative_range());
  cli.option("--force-tolerance", a.force, "largest difference of a force", "N", not_negative_range());
  cli.common(a.common, Cli::Restart::no, Cli::Threads::no);
  cli.example("compare_paths by_hand planned -o out", "curves of both in out/compared.csv");
  cli.example("compare_paths out again --force-tolerance 0 --clearance-tolerance 0",
              "a session and its repetition");
  return run_driver(cli, argc, argv, [&] { return compare(a); });
}
