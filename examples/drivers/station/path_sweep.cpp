// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/station/path_sweep.hpp"

#include <algorithm>
#include <atomic>

#include "examples/common/kept_json.hpp"
#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "geometry/parallel.hpp"
#include "io/build_info.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kMisalignment = "misalignment";

double number_of(const std::string& text, const std::string& word) {
  std::size_t read = 0;
  double value = kInf;
  try {
    value = std::stod(text, &read);
  } catch (const std::exception&) {
  }
  require(read == text.size() && read > 0 && std::isfinite(value),
          "--sweep " + word + " must be NAME=VALUE,VALUE,... with numbers");
  return value;
}

std::vector<std::filesystem::path> paths_of(const SweepPlan& plan) {
  if (plan.sweep.paths.empty()) return {plan.station.parts.path};
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::directory_iterator(plan.sweep.paths)) {
    const std::string kind = entry.path().extension().string();
    if (kind == ".csv" || kind == ".path" || kind == ".npy") out.push_back(entry.path());
  }
  std::ranges::sort(out);
  if (out.empty()) throw std::runtime_error(plan.sweep.paths.string() + ": has no .csv, .path or .npy");
  return out;
}

// All combinations, the last axis fastest.
std::vector<std::vector<double>> combinations(const std::vector<SweepAxis>& axes) {
  std::vector<std::vector<double>> out{{}};
  for (const SweepAxis& axis : axes) {
    std::vector<std::vector<double>> longer;
    for (const std::vector<double>& one : out)
      for (const double value : axis.values) {
        longer.push_back(one);
        longer.back().push_back(value);
      }
    out = std::move(longer);
  }
  return out;
}

void set_values(const std::vector<SweepAxis>& axes, const std::vector<double>& values, Station& station) {
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (axes[i].name == kMisalignment) {
      station.scene.target = station.scene.path;
      for (SE3& pose : station.scene.target.pose)
        pose.p += values[i] * station.scene.clearance * Vec3(1, 1, 1).normalized();
    } else {
      set_parameter(station.parameters, axes[i].name, values[i]);
    }
  }
}

TakeAssessment assessed(const Station& station, double hold) {
  SessionStage stage(station.make, station.parameters, station.options);
  return assess_take(log_of_path(station, hold), 0, stage, {},
                     {.radius = station.scene.radius,
                      .clearance = station.scene.clearance,
                      .goal = TakeGoal{station.scene.path.pose.back(), kArrival * station.scene.radius},
                      .go_on = [](std::int64_t) { return !interrupted(); }});
}

// The rows of one path, with parts that are prepared once.
class PathRows {
 public:
  PathRows(const SweepPlan& plan, const std::vector<SweepAxis>& axes, const std::filesystem::path& path)
      : plan_(plan), axes_(axes) {
    StationFlags flags = plan.station;
    flags.parts.path = path;
    try {
      station_ = set_up(flags, plan.threads, true);
      station_->options.options.step.threads = 1;
    } catch (const std::runtime_error& wrong) {  // of files, or parts that begin in contact
      problem_ = wrong.what();
    }
  }

  // False: interrupted.
  bool assess(SweepRow& row, int& known) const {
    row.problem = problem_;
    if (!station_) return true;
    Json key{{"program", program_digest()},
             {"said", plan_.said},
             {"misalignment", plan_.station.parts.scene.misalignment},
             {"input", station_->input.fingerprint},
             {"hold_s", plan_.hold}};
    std::string name = file_stem(row.path.stem().string());
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      key[axes_[i].name] = row.values[i];
      name += "_" + file_stem(axes_[i].name + "_" + number_text(row.values[i]));
    }
    const std::filesystem::path file = plan_.out / "results" / (name + ".json");
    if (const auto kept =
            read_kept(file, key, [](const Json& json) { return assessment_in(json.at("assessment")); })) {
      row.assessment = *kept;
      ++known;
      return true;
    }
    try {
      Station station = *station_;
      set_values(axes_, row.values, station);
      row.assessment = assessed(station, plan_.hold);
    } catch (const std::invalid_argument& wrong) {  // a value that the parts do not allow
      row.problem = wrong.what();
      return true;
    }
    if (interrupted()) return false;
    write_kept(file, key, {{"assessment", json_of(row.assessment)}});
    return true;
  }

 private:
  const SweepPlan& plan_;
  const std::vector<SweepAxis>& axes_;
  std::optional<Station> station_{};
  std::string problem_{};
};

}  // namespace

void add_options(Cli& cli, SweepFlags& a) {
  cli.option(
      "--sweep", a.sweeps,
      "NAME=VALUE,VALUE,...: assess at each value of a parameter (mu, dilation, port.limits.force, ..., "
      "misalignment), and at all combinations of several");
  cli.input("--paths", a.paths, "folder of paths, each assessed: .csv, .path of OMPL, .npy");
  cli.option("--shard", a.shard, "K/N: only each N-th row from the K-th; a call without it collects all");
}

std::vector<SweepAxis> sweep_axes(const std::vector<std::string>& words) {
  std::vector<SweepAxis> out;
  for (const std::string& word : words) {
    const std::size_t is = word.find('=');
    if (is != word.npos) out.push_back({.name = word.substr(0, is)});
    require(!out.empty() && !out.back().name.empty(), "--sweep " + word + " must begin with NAME=");
    out.back().values.push_back(number_of(is == word.npos ? word : word.substr(is + 1), word));
  }
  for (const SweepAxis& axis : out) {
    SessionParameters any;
    if (axis.name == kMisalignment) continue;
    for (const double value : axis.values) set_parameter(any, axis.name, value);
  }
  return out;
}

std::optional<std::vector<SweepRow>> assess_all(const SweepPlan& plan) {
  const std::vector<SweepAxis> axes = sweep_axes(plan.sweep.sweeps);
  const auto [k, n] = shard_of(plan.sweep.shard);
  const std::vector<std::vector<double>> values = combinations(axes);
  const std::vector<std::filesystem::path> paths = paths_of(plan);
  std::filesystem::create_directories(plan.out / "results");
  Progress progress("assess_path", double(paths.size() * values.size()),
                    Progress::style_of_stderr(plan.quiet));
  std::vector<SweepRow> out;
  int known = 0;
  std::size_t number = 0;
  for (const std::filesystem::path& path : paths) {
    std::vector<SweepRow> rows;
    for (const std::vector<double>& value : values)
      if (int(number++ % std::size_t(n)) == k - 1) rows.push_back({.path = path, .values = value});
    if (rows.empty()) continue;
    const PathRows of_path(plan, axes, path);
    std::vector<int> found(rows.size());
    std::atomic<bool> whole = true;
    parallel_for(int(rows.size()), plan.threads, [&](int i) {
      if (!whole || interrupted() || !of_path.assess(rows[std::size_t(i)], found[std::size_t(i)]))
        whole = false;
    });
    if (!whole) return {};
    for (const int one : found) known += one;
    std::ranges::move(rows, std::back_inserter(out));
    progress.at(double(number));
  }
  tell_known(known, out.size(), plan.out / "results", "assessments");
  return out;
}

std::string csv_of(const std::vector<SweepAxis>& axes, const std::vector<SweepRow>& rows) {
  std::string out = "path";
  for (const SweepAxis& axis : axes) out += "," + axis.name;
  out += ",verdict";
  for (const AssessmentNumber& number : assessment_numbers()) (out += ',') += number.name;
  out += ",problem\n";
  for (const SweepRow& row : rows) {
    out += row.path.filename().string();
    for (const double value : row.values) append_number(out += ',', value);
    out += row.problem.empty() ? std::string(",") + name_of(row.assessment.verdict, kTakeVerdicts)
                               : ",not assessed";
    for (const AssessmentNumber& number : assessment_numbers())
      append_number(out += ',', row.problem.empty() ? number.get(row.assessment) : std::nan(""));
    std::string problem = row.problem;
    std::ranges::replace(problem, ',', ';');
    std::ranges::replace(problem, '\n', ' ');
    (out += ',') += problem + "\n";
  }
  return out;
}

}  // namespace aussois
