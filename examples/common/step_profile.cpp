// SPDX-License-Identifier: Apache-2.0
#include "examples/common/step_profile.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "examples/common/quantile.hpp"

namespace aussois {
namespace {

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
  Row row{};
  StageTime other = report.total;
  for (std::size_t i = 0; i < std::size(kStages); ++i) {
    row[i] = report.stages.of[i];
    other.wall -= row[i].wall, other.cpu -= row[i].cpu;
  }
  row[kColumns - 3] = other, row[kColumns - 2] = recording, row[kColumns - 1] = report.total;
  for (std::size_t i = 0; i < kColumns; ++i) {
    sum_[i].wall += row[i].wall, sum_[i].cpu += row[i].cpu;
    most_[i] = {std::max(most_[i].wall, row[i].wall), std::max(most_[i].cpu, row[i].cpu)};
  }
  if (steps_++ % stride_ == 0) rows_.push_back(row);
  if (rows_.size() > kMostSteps) thin_out();
  kept_bytes_ = std::max(kept_bytes_, report.kept_bytes);
}

void StepProfile::thin_out() {  // every second one stays
  for (std::size_t i = 0; 2 * i < rows_.size(); ++i) rows_[i] = rows_[2 * i];
  rows_.resize((rows_.size() + 1) / 2);
  stride_ *= 2;
}

std::vector<StageFigures> StepProfile::figures() const {
  std::vector<StageFigures> out;
  const double per_step = 1e3 / double(steps_);
  for (std::size_t column = 0; column < kColumns; ++column) {
    std::vector<double> wall, cpu;
    for (const Row& row : rows_) {
      wall.push_back(1e3 * row[column].wall);
      cpu.push_back(1e3 * row[column].cpu);
    }
    constexpr const char* kLast[] = {"other", "recording", "step"};
    const bool is_stage = column < std::size(kStages);
    out.push_back({.stage = is_stage ? kStages[column].second : kLast[column - std::size(kStages)],
                   .p50 = quantile(wall, 0.5),
                   .p99 = quantile(wall, 0.99),
                   .most = 1e3 * most_[column].wall,
                   .mean = per_step * sum_[column].wall,
                   .cpu_p50 = quantile(cpu, 0.5),
                   .cpu_p99 = quantile(cpu, 0.99),
                   .cpu_most = 1e3 * most_[column].cpu,
                   .cpu_mean = per_step * sum_[column].cpu});
  }
  return out;
}

void SharedProfile::add(const StepReport& report) {
  const std::scoped_lock lock(mutex_);
  profile_.add(report);
}

StepProfile SharedProfile::all() const {
  const std::scoped_lock lock(mutex_);
  return profile_;
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
