// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/toss/toss_report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "examples/common/gnuplot.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/csv_table.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"

namespace aussois {
namespace {

constexpr int kBins = 24;                               // of the histograms
constexpr double kPositionBin = 2.5, kRotationBin = 5;  // [% of the edge], [deg]

double percent(const TossErrors& e) {
  return 100 * e.position / kTossEdge;
}
double degrees(const TossErrors& e) {
  return 180 / kPi * e.rotation;
}

std::vector<double> each(const std::vector<TossRun>& runs, double (*of)(const TossErrors&)) {
  std::vector<double> out;
  for (const TossRun& run : runs) out.push_back(of(run.errors));
  return out;
}

// Where the toss goes: the whole board would reach to the horizon.
RunMesh board_below(const Toss& toss) {
  Vec2 lo = Vec2::Constant(kInf), hi = -lo;
  for (const SE3& g : toss.pose) lo = lo.cwiseMin(g.p.head<2>()), hi = hi.cwiseMax(g.p.head<2>());
  lo.array() -= 2 * kTossEdge, hi.array() += 2 * kTossEdge;
  return {.vertices = {{lo.x(), lo.y(), 0}, {hi.x(), lo.y(), 0}, {hi.x(), hi.y(), 0}, {lo.x(), hi.y(), 0}},
          .faces = {{0, 1, 2}, {0, 2, 3}}};
}

SE3 recorded_pose(const Toss& toss, double t) {
  const auto after = std::ranges::lower_bound(toss.t, t);
  if (after == toss.t.begin()) return toss.pose.front();
  if (after == toss.t.end()) return toss.pose.back();
  const auto i = std::size_t(after - toss.t.begin());
  const SE3 &a = toss.pose[i - 1], &b = toss.pose[i];
  const double s = (t - toss.t[i - 1]) / (toss.t[i] - toss.t[i - 1]);
  return {a.R.slerp(s, b.R), (1 - s) * a.p + s * b.p};
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  const double n = double(values.size());
  Spread out{.mean = std::accumulate(values.begin(), values.end(), 0.0) / n};
  for (const double v : values) out.sd += (v - out.mean) * (v - out.mean);
  out.sd = std::sqrt(out.sd / std::max(n - 1, 1.0));
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  out.median = values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
  return out;
}

std::vector<int> bin_counts(const std::vector<double>& values, double width, int bins) {
  std::vector<int> out(std::size_t(bins), 0);
  for (const double v : values) ++out[std::size_t(std::max(0.0, std::min(bins - 1.0, v / width)))];
  return out;
}

TossStatistics statistics_of(const std::vector<TossRun>& runs) {
  return {.position = spread_of(each(runs, percent)),
          .rotation = spread_of(each(runs, degrees)),
          .loss = spread_of(each(runs, [](const TossErrors& e) { return e.loss; })).mean};
}

void set_errors(Summary& summary, const std::string& prefix, const TossStatistics& errors) {
  const auto set = [&](const std::string& key, const Spread& s) {
    summary.set(prefix + key + "_mean", s.mean);
    summary.set(prefix + key + "_sd", s.sd);
    summary.set(prefix + key + "_median", s.median);
  };
  set("position_error_percent", errors.position);
  set("rotation_error_deg", errors.rotation);
  summary.set(prefix + "loss_mean", errors.loss);
}

void write_toss_table(const std::filesystem::path& folder, const std::vector<Toss>& tosses,
                      const std::vector<TossRun>& runs) {
  CsvTable csv(folder / "tosses.csv", {"toss", "rows", "start_row", "steps", "most_contacts", "lifted_m",
                                       "position_error_percent", "rotation_error_deg", "loss"});
  for (std::size_t i = 0; i < tosses.size(); ++i) {
    const TossRun& run = runs[i];
    csv.add({std::strtod(tosses[i].name.c_str() + 5, nullptr), double(tosses[i].t.size()), double(run.start),
             double(run.steps), double(run.most_contacts), run.lifted, percent(run.errors),
             degrees(run.errors), run.errors.loss});
  }
  csv.close();
}

bool write_toss_histogram(const std::filesystem::path& folder, const std::vector<TossRun>& runs) {
  const std::vector<int> position = bin_counts(each(runs, percent), kPositionBin, kBins),
                         rotation = bin_counts(each(runs, degrees), kRotationBin, kBins);
  CsvTable csv(folder / "histogram.csv",
               {"position_percent", "tosses", "rotation_deg", "tosses_by_rotation"});
  for (int i = 0; i < kBins; ++i)
    csv.add({(i + 0.5) * kPositionBin, double(position[i]), (i + 0.5) * kRotationBin, double(rotation[i])});
  csv.close();
  write_whole_file(folder / "histogram.gp",
                   "# draws histogram.png: gnuplot histogram.gp\n"
                   "set terminal pngcairo size 1000,420; set output 'histogram.png'\n"
                   "set datafile separator ','; set style fill solid 0.6; set boxwidth 0.9 relative\n"
                   "set grid y; unset key; set ylabel 'tosses'; set multiplot layout 1,2\n"
                   "set xlabel 'position error [% of the edge], the last bin and beyond'\n"
                   "plot 'histogram.csv' every ::1 using 1:2 with boxes lc rgb '#33658a'\n"
                   "set xlabel 'rotation error [deg], the last bin and beyond'\n"
                   "plot 'histogram.csv' every ::1 using 3:4 with boxes lc rgb '#f26419'\n"
                   "unset multiplot\n");
  return run_gnuplot(folder, "histogram.gp");
}

void write_toss_replay(const std::filesystem::path& folder, const Toss& toss, const TossWorld& world,
                       const std::string& command_line) {
  const Model model = toss_model(world);
  const TossStart start = start_of(toss);
  RunData data{.header = run_header(model)};
  data.header.title = "cube_toss " + toss.name + ": simulated and recorded";
  data.header.command_line = command_line;
  data.header.build = build_info();
  data.header.bodies[0].name = "simulated";
  data.header.bodies.push_back(data.header.bodies[0]);
  data.header.bodies.back().name = "recorded";
  data.header.meshes.at("board") = board_below(toss);
  roll_out(toss, start, world, [&](const State& state, const StepReport& report) {
    RunStep step = run_step(std::int64_t(data.steps.size()), model, state, report);
    step.pose.push_back(recorded_pose(toss, toss.t[start.row] + state.t));
    step.velocity.conservativeResizeLike(VecX::Zero(18));
    data.steps.push_back(std::move(step));
  });
  write_replay_html(folder / (toss.name + ".html"), data);
}

}  // namespace aussois
