// SPDX-License-Identifier: Apache-2.0
// What the cases of the verification list are made of: runs that must come to their end, the worst of many
// figures, and the series of the shared data folder.
#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "examples/common/driver.hpp"
#include "examples/scenes/cases.hpp"
#include "examples/verification/verification.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

/// The step of `scheme`, over at most `h_max` [s]; throws NumericalFailure with its reason if it is not ok.
inline StepReport step(const Scheme& scheme, State& state, double h_max = kInf) {
  StepReport report = scheme.step(state, h_max);
  if (!report.ok()) {
    std::ostringstream text;
    text << report.reason << " at t = " << state.t << " s";
    throw NumericalFailure(text.str());
  }
  return report;
}

/// Steps up to t_end [s]; `look` sees the state after each.
inline State run_to(const CaseScene& scene, const std::string& name, const SchemeOptions& options,
                    double t_end, const std::function<void(const State&, const StepReport&)>& look = {}) {
  const Scheme scheme = make_scheme(name, scene.model, options);
  State state = scene.state;
  while (state.t < t_end * (1 - 1e-12)) {
    const StepReport report = step(scheme, state, t_end - state.t);
    if (look) look(state, report);
  }
  return state;
}

/// Steps of theta = 1/2 solved to rounding, without certificates: for motions that meet nothing by surprise.
inline SchemeOptions exact_options(double h, NormalLaw law = NormalLaw::combined, double tolerance = 1e-13) {
  return {.h = h,
          .theta = 0.5,
          .normal = {.law = law},
          .solver = {.tolerance = tolerance},
          .advancement = {.certify = false},
          .spectral_radius = 1};
}

/// The largest of the figures that it was given, none of which is negative. A NaN stays.
class Worst {
 public:
  void add(double figure) {
    if (!std::isnan(value_) && !(figure <= value_)) value_ = figure;
  }
  operator double() const { return value_; }

 private:
  double value_ = 0;
};

/// The smallest of the figures that it was given; infinite without one. A NaN stays.
class Least {
 public:
  void add(double figure) {
    if (!std::isnan(value_) && !(figure >= value_)) value_ = figure;
  }
  operator double() const { return value_; }

 private:
  double value_ = kInf;
};

using SeriesRow = std::map<std::string, double>;  // by column

/// The rows of references/NAME in the shared data folder. Throws MissingData without it.
inline std::vector<SeriesRow> shared_series(const std::string& name) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  const std::filesystem::path path = std::filesystem::path(data ? data : "") / "references" / name;
  std::ifstream file(path);
  if (!data || !*data || !file) throw MissingData("AUSSOIS_DATA_DIR names no folder with references/" + name);
  std::string line, word;
  std::getline(file, line);
  std::vector<std::string> columns;
  for (std::istringstream head(line); std::getline(head, word, ',');) columns.push_back(word);
  std::vector<SeriesRow> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (const std::string& column : columns) {
      std::getline(cells, word, ',');
      rows.back()[column] = std::stod(word);
    }
  }
  if (rows.empty()) throw MissingData(path.string() + " has no rows");
  return rows;
}

}  // namespace aussois
