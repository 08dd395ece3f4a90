// SPDX-License-Identifier: Apache-2.0
// Compares the cost and loss of each reducer, and of the default one with each clustering, with the rule of
// four points that engines use. Times a contact in patches of ten to a million contacts.
//
// Theory   doc/theory/reduction.md (RED-1) to (RED-15)
// Run      bench_reduction
//          bench_reduction --largest 1000000 --json reduction.json
// Expect   hull_margin keeps at least the margin of the four points in every family; the cost per contact
//          stays below three times that at ten thousand contacts
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "bench/call_time.hpp"
#include "bench/verdict.hpp"
#include "examples/common/driver.hpp"
#include "examples/common/random.hpp"
#include "examples/studies/reduction/patch_of_four.hpp"
#include "io/csv_table.hpp"
#include "io/summary.hpp"
#include "reduction/reduce.hpp"

using namespace aussois;

namespace {

struct Arguments {
  int largest = 1000000, pairs = 15;
  CommonOptions common{};
};

ContactSet patch(const std::vector<Vec2>& points) {
  ContactSet set;
  for (const Vec2& x : points) {
    ContactPoint c;
    c.a = {.body = 0, .simplex = int(set.points.size()), .region = int(set.points.size())};
    c.b = {.body = 1, .dim = 2};
    c.x_a = c.x_b = Vec3(x.x(), x.y(), 0);
    set.points.push_back(c);
  }
  return set;
}

struct Family {
  std::string name{};
  ContactSet set{};
  std::vector<double> mu{};
  std::vector<Vec3> impulse{};  // as if all carried the same

  Family(std::string name_of, const std::vector<Vec2>& points)
      : name(std::move(name_of)),
        set(patch(points)),
        mu(points.size(), 0.3),
        impulse(points.size(), Vec3::UnitZ()) {}
  ReductionInput input() const { return {.contacts = set, .impulse = impulse, .mu = mu}; }
};

std::vector<Vec2> in_disc(int n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec2> points;
  while (int(points.size()) < n) {
    const double y = random.uniform(-1, 1), x = random.uniform(-1, 1);
    if (std::hypot(x, y) <= 1) points.push_back(0.05 * Vec2(x, y));
  }
  return points;
}

std::vector<Family> families() {
  std::vector<Vec2> rim, grid, l;
  for (int i = 0; i < 48; ++i)
    rim.push_back(0.05 * Vec2(std::cos(2 * kPi * i / 48), std::sin(2 * kPi * i / 48)));
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 8; ++column) {
      grid.push_back(0.01 * Vec2(column, row));
      if (column < 2 || row < 2) l.push_back(grid.back());
    }
  return {{"rim", rim}, {"grid", grid}, {"l", l}, {"scattered", in_disc(48, 7)}};
}

// Microseconds of both calls, measured in turn: the fastest of some batches each, and the median of their
// ratios.
struct Paired {
  double us = kInf, us_other = kInf, ratio = 0;
};
Paired paired(const std::function<void()>& call, const std::function<void()>& other, int pairs) {
  const auto seconds = [](const std::function<void()>& f, int times) {
    const double begin = cpu_seconds();
    for (int i = 0; i < times; ++i) f();
    return (cpu_seconds() - begin) / times;
  };
  const int times = std::max(1, int(2e-3 / std::max(seconds(other, 1), 1e-7)));
  Paired out;
  std::vector<double> ratios;
  for (int i = 0; i < pairs; ++i) {
    const double a = seconds(call, std::max(1, times / 4)), b = seconds(other, times);
    out.us = std::min(out.us, 1e6 * a);
    out.us_other = std::min(out.us_other, 1e6 * b);
    ratios.push_back(a / b);
  }
  std::nth_element(ratios.begin(), ratios.begin() + pairs / 2, ratios.end());
  out.ratio = ratios[pairs / 2];
  return out;
}

struct Rule {
  std::string name{};
  ReductionOptions options{};
};
// Compared with the whole patch, whatever groups a rule makes of it.
LossReport loss_of_patch(const ContactSet& set, Selection selection) {
  selection.cluster.assign(set.points.size(), 0);
  selection.cluster_count = 1;
  return measure_loss(set, selection);
}

std::vector<Rule> rules() {
  std::vector<Rule> out = {
      {"patch_of_four", {.reducer = Reducer::selector, .selector = patch_of_four_selector()}},
      {"paper_exact", {.reducer = Reducer::extreme_points, .paper_exact = true}}};
  for (const std::string& name : reducer_names())
    if (name != "selector" && name != "none") out.push_back({name, {.reducer = reducer(name)}});
  for (const std::string& name : clustering_names())  // by angle is hull_margin
    if (name != "angle") out.push_back({"by " + name, {.clustering = {.rule = clustering(name)}}});
  return out;
}

// Prints what each rule leaves of each family. The margin of the four points less that of hull_margin, at
// most.
double bench_families(const Arguments& a, const std::vector<Rule>& all, Summary& summary) {
  double worst_difference = -kInf;
  for (const Family& family : families()) {
    std::printf("%s, %zu contacts\n%-27s %5s %7s %6s %8s %9s %7s %6s\n", family.name.c_str(),
                family.set.points.size(), "", "kept", "margin", "area", "torsion", "d_H mm", "us", "ratio");
    CsvTable csv(
        a.common.out / ("bench_reduction_" + family.name + ".csv"),  // a row per rule, as they are printed
        {"kept", "margin", "area", "torsion", "hausdorff", "us", "ratio"});
    std::vector<double> margins, ratios, us;
    const auto four = [&] { reduce(family.input(), all.front().options); };
    for (const Rule& rule : all) {
      const Selection selection = reduce(family.input(), rule.options);
      const Paired time = paired([&] { reduce(family.input(), rule.options); }, four, a.pairs);
      const LossReport loss = loss_of_patch(family.set, selection);
      std::printf("%-27s %5zu %7.3f %6.3f %8.3f %9.3f %7.1f %6.2f\n", rule.name.c_str(),
                  selection.kept.size(), loss.margin, loss.area, loss.torsion, 1e3 * loss.hausdorff, time.us,
                  time.ratio);
      csv.add({double(selection.kept.size()), loss.margin, loss.area, loss.torsion, loss.hausdorff, time.us,
               time.ratio});
      margins.push_back(loss.margin);
      ratios.push_back(time.ratio);
      us.push_back(time.us);
      if (rule.name == "hull_margin")
        worst_difference = std::max(worst_difference, margins.front() - loss.margin);
    }
    csv.close();
    summary.set(family.name + "_margin", margins);
    summary.set(family.name + "_us", us);
    summary.set(family.name + "_ratio", ratios);
  }
  return worst_difference;
}

// Prints what a contact costs in larger and larger patches. The cost in the largest over that in one of ten
// thousand; not a number if there is none.
double bench_scaling(const Arguments& a, const std::vector<Rule>& all, Summary& summary) {
  std::printf("ns per contact\n%10s %12s %14s %12s %6s\n", "contacts", "hull_margin", "patch_of_four",
              "rule alone", "ratio");
  CsvTable scaling(a.common.out / "bench_reduction_scaling.csv",
                   {"contacts", "ns_hull_margin", "ns_patch_of_four", "ns_rule_alone", "ratio"});
  std::vector<double> counts, costs;
  double at_ten_thousand = std::nan("");  // below, a processor predicts all branches of a sort
  for (int n = 10; n <= a.largest && !interrupted(); n *= 10) {
    const Family family("disc", in_disc(n, 11));
    std::vector<int> members(std::size_t(n), 0);
    for (int i = 0; i < n; ++i) members[i] = i;
    const int pairs = n > 100000 ? 3 : a.pairs;
    const Paired margin = paired([&] { reduce(family.input(), {}); },
                                 [&] { reduce(family.input(), all.front().options); }, pairs);
    const Paired alone = paired([&] { patch_of_four(family.set, members); },
                                [&] { patch_of_four(family.set, members); }, pairs);
    const double ns = 1e3 / n;
    std::printf("%10d %12.1f %14.1f %12.1f %6.2f\n", n, ns * margin.us, ns * margin.us_other, ns * alone.us,
                margin.ratio);
    std::fflush(stdout);
    scaling.add({double(n), ns * margin.us, ns * margin.us_other, ns * alone.us, margin.ratio});
    counts.push_back(n);
    costs.push_back(ns * margin.us);
    if (n == 10000) at_ten_thousand = costs.back();
  }
  scaling.close();
  summary.set("contacts", counts);
  summary.set("ns_hull_margin", costs);
  return costs.empty() ? at_ten_thousand : costs.back() / at_ten_thousand;
}

ExitCode bench(const Arguments& a) {
  make_folders(a.common);
  Summary summary;
  const std::vector<Rule> all = rules();
  std::vector<std::string> names;
  for (const Rule& rule : all) names.push_back(rule.name);
  summary.set("rules", names);
  const double worst_difference = bench_families(a, all, summary), growth = bench_scaling(a, all, summary);
  if (interrupted()) return ExitCode::interrupted;
  std::vector<Bar> verdicts = {
      {"margin", "margin of the four points less that of hull_margin", "", worst_difference, 0}};
  if (a.largest >= 10000)
    verdicts.push_back(
        {"growth", "cost per contact of the largest patch over that of ten thousand", "", growth, 3});
  for (const Bar& v : verdicts) summary.set(v.key, v.value);
  return conclude(verdicts, std::move(summary), a.common);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_reduction", "Compares the cost and loss of reducers with the four points of engines.");
  cli.group("size");
  cli.option("--largest", a.largest, "number of contacts of one patch", "", {10, 1e7});
  cli.option("--pairs", a.pairs, "of measurements, taken in turn; the median ratio counts", "", {1, 1000});
  cli.group("output");
  cli.option("--json", a.common.summary, "the same as --summary");
  cli.common(a.common);
  cli.example("bench_reduction", "all families, up to a million contacts");
  cli.example("bench_reduction --largest 10000 --json reduction.json", "a short run");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
