// SPDX-License-Identifier: Apache-2.0
// Compares the cost of all contacts of a pair with the cost of a peer's distance query, on real assemblies in
// one run. Read the ratios, not the times.
//
// Theory   doc/theory/lmd.md (LMD-9)
// Run      bench_lmd
//          bench_lmd --data DIR --json out/bench_lmd.json
//          bench_lmd --data DIR --pair press_p1p2,own_tslot --ablation
// Expect   a line per verdict, with PASS; the last one is the geometric mean of the ratios to FCL
#include <algorithm>
#include <charconv>
#include <cstdio>

#include "bench/assembly_pairs.hpp"
#include "bench/cost_report.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "geometry/check.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path data{}, json{};
  std::string pairs{}, thresholds = "0.001,0.01,0.05";
  double scale = 1e-3;
  bool ablation = false;
  int poses = 9, repeats = 3, ablation_triangles = 10000;
  CommonOptions common{};
};

std::vector<double> parse_thresholds(const std::string& list) {
  std::vector<double> out;
  for (const std::string& word : words_of(list)) {
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    require(error == std::errc{} && end == word.data() + word.size() && value > 0 && value <= 10,
            "--thresholds: " + word + " must be a number in (0, 10] moving radii");
    out.push_back(value);
  }
  require(std::ranges::count(out, kVerdictThreshold) == 1,
          "--thresholds = " + list + " must contain 0.01 once: verdicts refer to it");
  return out;
}

ExitCode bench(const Arguments& a) {
  CostOptions options{.thresholds = parse_thresholds(a.thresholds), .poses = a.poses, .repeats = a.repeats};
  require(a.common.threads == 1, "--threads must be 1: one thread is timed");
  const std::vector<std::string> names = pair_names(a.data, a.pairs);
  make_folders(a.common);
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());

  // 1. Measure.
  std::vector<PairCost> pairs;
  Progress progress("bench_lmd", double(names.size()), Progress::style_of_stderr(a.common.quiet));
  for (const std::string& name : names) {
    const AssemblyInput input = read_pair(a.data, name, a.scale);
    const auto triangles = input.fixed.complex.triangles.size() + input.moving.complex.triangles.size();
    const bool cheap = !a.pairs.empty() || a.data.empty() || triangles <= std::size_t(a.ablation_triangles);
    options.ablation = a.ablation && cheap ? kVerdictThreshold : 0;
    pairs.push_back(measure_pair(input, options, [&](double done) {
      progress.at(double(pairs.size()) + done, name);
      return !interrupted();
    }));
    if (interrupted()) return ExitCode::interrupted;
  }

  // 2. Report.
  std::printf("\n%s", header_line().c_str());
  for (const PairCost& p : pairs) std::printf("%s", lines_of(p).c_str());
  if (a.ablation) {
    std::printf("\nWithout one of the tests, at 1 %%, in ratios to the query with all of them\n");
    std::printf("%-24s %-12s %10s%10s%10s%10s\n", "pair", "without", "time", "nodes", "leaves", "exact");
    for (const PairCost& p : pairs) std::printf("%s", ablation_lines(p).c_str());
  }
  if (!a.json.empty()) write_cost_json(a.json, pairs);
  if (!write_cost_plot(a.common.out, pairs))
    std::fprintf(stderr, "no picture: gnuplot is missing, or fails on %s\n",
                 (a.common.out / "bench_lmd.gp").c_str());
  std::printf("\n");
  return print_verdicts(verdicts(pairs)) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli(
      "bench_lmd",
      "Times contact queries along assembly paths against FCL's distance and CGAL's pairs of triangles. "
      "Figures are CPU times of one thread: the fastest repeat of each pose, the median of all poses. "
      "Bytes per triangle count what a search reads: vertices, triangles, planes, normal cones and trees.");
  cli.group("scene");
  cli.input("--data", a.data, "folder with meshes/ and assembly/; without it, our own bolt and nut");
  cli.option("--pair", a.pairs, "names of assembly/pairs.csv, comma separated; empty: all");
  cli.option("--scale", a.scale, "metres per unit of the files", "m", {1e-12, 1e12});
  cli.group("measurement");
  cli.option("--thresholds", a.thresholds,
             "largest distances, in radii of the moving part, comma separated; 0.01 among them");
  cli.option("--poses", a.poses, "of each path, spread evenly", "", {1, 1000});
  cli.option("--repeats", a.repeats, "per pose; the fastest counts", "", {1, 1000});
  cli.flag("--ablation", a.ablation, "leave out each test of the search in turn, at 1 % and three poses");
  cli.option("--ablation-triangles", a.ablation_triangles,
             "largest pair for --ablation, unless pairs are named", "", {0, 1e9});
  cli.option("--json", a.json, "file for all numbers");
  cli.common(a.common);
  cli.example("bench_lmd -o out", "our own bolt and nut");
  cli.example("bench_lmd --data DIR --json out/bench_lmd.json", "all pairs, with a picture in out/");
  cli.example("bench_lmd --data DIR --pair press_p1p2,own_tslot --ablation", "what each test saves");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
