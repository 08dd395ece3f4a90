// SPDX-License-Identifier: Apache-2.0
#include "bench/cost_report.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "examples/common/gnuplot.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// "1.25", or "-" for a ratio to nothing.
std::string ratio_text(double value, double to) {
  return to > 0 ? formatted("%10.2f", value / to) : formatted("%10s", "-");
}

const PairCost* named(const std::vector<PairCost>& pairs, const std::string& name) {
  for (const PairCost& p : pairs)
    if (p.name == name) return &p;
  return nullptr;
}

// The largest `value` of the pairs; nan does not count.
template <class Value>
void add_worst(std::vector<Bar>& out, const std::vector<PairCost>& pairs, Bar verdict, const Value& value) {
  verdict.value = -kInf;
  for (const PairCost& p : pairs)
    if (const double v = value(p); v > verdict.value) verdict.value = v, verdict.where = p.name;
  if (!verdict.where.empty()) out.push_back(verdict);
}

// The same surface with more triangles: the query may take longer in total, but not per contact.
void add_growth(std::vector<Bar>& out, const PairCost& coarse, const PairCost& fine) {
  const QueryCost *c = query_at(coarse, kVerdictThreshold), *f = query_at(fine, kVerdictThreshold);
  if (c && f && c->contacts > 0 && f->contacts > 0)
    out.push_back({"growth_per_contact", "time per contact, finer mesh to coarser", fine.name,
                   (f->ms / f->contacts) / (c->ms / c->contacts), 1.5});
  const QueryCost *empty_c = nullptr, *empty_f = nullptr;  // at the largest threshold without a contact
  for (const QueryCost& q : coarse.queries) {
    const QueryCost* same = query_at(fine, q.threshold);
    if (same && q.contacts == 0 && same->contacts == 0 && (!empty_c || q.threshold > empty_c->threshold))
      empty_c = &q, empty_f = same;
  }
  if (empty_c)
    out.push_back({"growth_without_contacts", "time below the clearance, finer mesh to coarser", fine.name,
                   empty_f->ms / empty_c->ms, 2});
}

nlohmann::ordered_json json_of(const QueryCost& q, double ms_fcl) {
  return {{"threshold", q.threshold},      {"contacts", q.contacts},     {"ms_query", q.ms},
          {"ratio_to_fcl", q.ms / ms_fcl}, {"ms_cgal", q.ms_cgal},       {"cgal_pairs", q.cgal_pairs},
          {"node_pairs", q.node_pairs},    {"leaf_pairs", q.leaf_pairs}, {"exact_tests", q.exact_tests}};
}

nlohmann::ordered_json json_of(const PairCost& p) {
  nlohmann::ordered_json out{{"pair", p.name}};
  if (const QueryCost* q = query_at(p, kVerdictThreshold)) out.update(json_of(*q, p.ms_fcl));
  out["ms_fcl"] = p.ms_fcl;
  out["triangles"] = p.triangles;
  out["leaves"] = p.leaves;
  out["moving_radius"] = p.radius;
  out["ms_build"] = p.ms_build;
  out["ms_build_fcl"] = p.ms_build_fcl;
  out["ratio_build"] = p.ms_build / p.ms_build_fcl;
  out["bytes_per_triangle"] = p.bytes_per_triangle;
  out["thresholds"] = nlohmann::ordered_json::array();
  for (const QueryCost& q : p.queries) out["thresholds"].push_back(json_of(q, p.ms_fcl));
  for (const AblationCost& a : p.ablation) out["without"][a.without] = json_of(a.cost, p.ms_fcl);
  return out;
}

}  // namespace

double ratio_to_fcl(const PairCost& pair) {
  const QueryCost* q = query_at(pair, kVerdictThreshold);
  return q ? q->ms / pair.ms_fcl : kNotMeasured;
}

std::vector<Bar> verdicts(const std::vector<PairCost>& pairs) {
  std::vector<Bar> out;
  add_worst(out, pairs, {"worst_bytes_per_triangle", "most bytes per triangle", "", 0, 200},
            [](const PairCost& p) { return p.bytes_per_triangle; });
  add_worst(out, pairs, {"worst_build_ratio", "longest build to FCL's", "", 0, 3},
            [](const PairCost& p) { return p.ms_build / p.ms_build_fcl; });
  const PairCost *coarse = named(pairs, "own_bolt_nut"), *fine = named(pairs, "own_bolt_nut_fine");
  if (coarse && fine) add_growth(out, *coarse, *fine);
  add_worst(out, pairs, {"worst_ratio_to_fcl", "longest query at 1 % to one distance of FCL", "", 0, 1},
            ratio_to_fcl);
  double sum = 0, count = 0;
  for (const PairCost& p : pairs)
    if (const double r = ratio_to_fcl(p); r > 0) sum += std::log(r), ++count;
  if (count > 0)
    out.push_back({"geometric_mean_ratio_to_fcl", "query at 1 % to one distance of FCL, geometric mean", "",
                   std::exp(sum / count), 0.2});
  return out;
}

std::string header_line() {
  return formatted("%-24s %8s %6s %8s %9s %9s %9s %8s %9s %9s %9s %6s %6s\n", "pair", "triangl.", "reach",
                   "contacts", "query ms", "FCL ms", "CGAL ms", "to FCL", "nodes", "leaves", "exact", "build",
                   "B/tri.");
}

std::string lines_of(const PairCost& p) {
  std::string text;
  for (const QueryCost& q : p.queries) {
    text += formatted("%-24s %8.0f %4.3g %% %8.0f %9.3f %9.3f %9.3f %8.3f %9.0f %9.0f %9.0f", p.name.c_str(),
                      p.triangles, 100 * q.threshold, q.contacts, q.ms, p.ms_fcl, q.ms_cgal, q.ms / p.ms_fcl,
                      q.node_pairs, q.leaf_pairs, q.exact_tests);
    text += formatted(" %6.2f %6.0f\n", p.ms_build / p.ms_build_fcl, p.bytes_per_triangle);
  }
  return text;
}

std::string ablation_lines(const PairCost& p) {
  std::string text;
  for (const AblationCost& a : p.ablation) {
    const QueryCost &q = a.cost, &all = p.ablation.front().cost;
    text += formatted("%-24s %-12s ", p.name.c_str(), a.without.c_str()) + ratio_text(q.ms, all.ms) +
            ratio_text(q.node_pairs, all.node_pairs) + ratio_text(q.leaf_pairs, all.leaf_pairs) +
            ratio_text(q.exact_tests, all.exact_tests) + '\n';
  }
  return text;
}

void write_cost_json(const std::filesystem::path& path, const std::vector<PairCost>& pairs) {
  nlohmann::ordered_json out{{"pairs", nlohmann::ordered_json::array()},
                             {"summary", nlohmann::ordered_json::object()}};
  for (const PairCost& p : pairs) out["pairs"].push_back(json_of(p));
  bool pass = true;
  for (const Bar& v : verdicts(pairs)) {
    out["summary"][v.key] = {{"value", v.value}, {"wanted", v.wanted}, {"pass", v.pass()}, {"pair", v.where}};
    pass = pass && v.pass();
  }
  out["summary"]["pass"] = pass;
  write_whole_file(path, out.dump(1) + "\n");
}

bool write_cost_plot(const std::filesystem::path& dir, const std::vector<PairCost>& pairs) {
  std::string csv = "pair,ms_query,ms_fcl,ms_cgal,contacts\n";
  for (const PairCost& p : pairs) {
    const QueryCost* q = query_at(p, kVerdictThreshold);
    csv += p.name;
    for (const double value : {q->ms, p.ms_fcl, q->ms_cgal, q->contacts}) {
      csv += ',';
      append_number(csv, value);
    }
    csv += '\n';
  }
  const std::string last = std::to_string(pairs.size()) + " - 0.5";
  write_whole_file(dir / "bench_lmd.csv", csv);
  write_whole_file(
      dir / "bench_lmd.gp",
      "# draws bench_lmd.png: gnuplot bench_lmd.gp\n"
      "set terminal pngcairo size 1200,700 font ',11'; set output 'bench_lmd.png'\n"
      "set datafile separator ','; set datafile missing 'nan'; set logscale y; set format y '10^{%L}'\n"
      "set grid y; set xtics rotate by -40 noenhanced; set rmargin 12; set key above\n"
      "set ylabel 'CPU time on one thread [ms]'; set xrange [-0.5:" +
          last +
          "]\n"
          "plot 'bench_lmd.csv' every ::1 using 0:3:xtic(1) with points pt 5 ps 1.6 lc rgb '#c0702a' "
          "title 'FCL: one distance', \\\n"
          "     '' every ::1 using 0:4 with points pt 9 ps 1.6 lc rgb '#888888' "
          "title 'CGAL: pairs of triangles near each other, no distance computed', \\\n"
          "     '' every ::1 using 0:2 with points pt 7 ps 1.6 lc rgb '#1f5fa8' "
          "title 'all contacts within 1 %'\n");
  return run_gnuplot(dir, "bench_lmd.gp");
}

}  // namespace aussois
