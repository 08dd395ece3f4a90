// SPDX-License-Identifier: Apache-2.0
#include "examples/common/step_profile.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numeric>

#include "examples/common/quantile.hpp"

namespace aussois {
namespace {

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

struct NamedFigure {
  const char* name;
  double StageFigures::*value;
};
constexpr NamedFigure kFigures[] = {
    {"wall_ms_p50", &StageFigures::p50},     {"wall_ms_p99", &StageFigures::p99},
    {"wall_ms_max", &StageFigures::most},    {"wall_ms_mean", &StageFigures::mean},
    {"cpu_ms_p50", &StageFigures::cpu_p50},  {"cpu_ms_p99", &StageFigures::cpu_p99},
    {"cpu_ms_max", &StageFigures::cpu_most}, {"cpu_ms_mean", &StageFigures::cpu_mean}};

}  // namespace

void StepProfile::add(const StepReport& report, const StageTime& recording) {
  StageTime other = report.total;
  for (const StageTime& stage : report.stages.of) {
    all_.push_back(stage);
    other.wall -= stage.wall, other.cpu -= stage.cpu;
  }
  all_.insert(all_.end(), {other, recording, report.total});
  kept_bytes_ = std::max(kept_bytes_, report.kept_bytes);
}

std::vector<StageFigures> StepProfile::figures() const {
  std::vector<StageFigures> out;
  for (std::size_t column = 0; column < kColumns; ++column) {
    std::vector<double> wall, cpu;
    for (std::size_t i = column; i < all_.size(); i += kColumns) {
      wall.push_back(1e3 * all_[i].wall);
      cpu.push_back(1e3 * all_[i].cpu);
    }
    constexpr const char* kLast[] = {"other", "recording", "step"};
    const bool is_stage = column < std::size(kStages);
    out.push_back({.stage = is_stage ? kStages[column].second : kLast[column - std::size(kStages)],
                   .p50 = quantile(wall, 0.5),
                   .p99 = quantile(wall, 0.99),
                   .most = quantile(wall, 1),
                   .mean = mean(wall),
                   .cpu_p50 = quantile(cpu, 0.5),
                   .cpu_p99 = quantile(cpu, 0.99),
                   .cpu_most = quantile(cpu, 1),
                   .cpu_mean = mean(cpu)});
  }
  return out;
}

std::string table_of(const StepProfile& profile) {
  char line[200];
  std::snprintf(line, sizeof line, "%-12s %9s %9s %9s %9s   %9s %9s %9s %9s\n", "ms a step", "wall p50",
                "p99", "max", "mean", "CPU p50", "p99", "max", "mean");
  std::string out = line;
  for (const StageFigures& f : profile.figures()) {
    std::snprintf(line, sizeof line, "%-12s %9.4f %9.4f %9.4f %9.4f   %9.4f %9.4f %9.4f %9.4f\n",
                  f.stage.c_str(), f.p50, f.p99, f.most, f.mean, f.cpu_p50, f.cpu_p99, f.cpu_most,
                  f.cpu_mean);
    out += line;
  }
  std::snprintf(line, sizeof line, "kept from step to step: up to %.3g MB\n",
                1e-6 * double(profile.kept_bytes()));
  return out + line;
}

void set_profile(const StepProfile& profile, Summary& summary) {
  if (profile.steps() == 0) return;
  const std::vector<StageFigures> figures = profile.figures();
  std::vector<std::string> stages;
  for (const StageFigures& f : figures) stages.push_back(f.stage);
  summary.set("profile_stages", stages);
  for (const auto& [name, value] : kFigures) {
    std::vector<double> column;
    for (const StageFigures& f : figures) column.push_back(f.*value);
    summary.set(std::string("profile_") + name, column);
  }
  summary.set("profile_kept_bytes", std::int64_t(profile.kept_bytes()));
}

}  // namespace aussois
