// SPDX-License-Identifier: Apache-2.0
// Gauges: numbers that are read off every step of a run. One list of them sets what a recording writes into
// its table, keeps in its checkpoints and reports at the end.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "integrators/step_report.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// One accepted step of a run.
struct Frame {
  const Model& model;
  const State &start, &before, &state;  // at the start of the run, at the start of the step, at its end
  const StepReport& report;
  std::int64_t step = 0;  // its number, from 1
};

/// What a gauge keeps of its values.
enum class GaugeTotal { nothing, least, most, sum };

struct Gauge {
  std::string column{};  // name in the table; empty: no column
  std::string total{};   // name of its total in summary and checkpoint; empty: no total
  GaugeTotal keep = GaugeTotal::nothing;
  std::function<double(const Frame&)> value{};
  bool whole = false;  // its total is a count
  bool clock = false;  // time that passed, which differs from run to run: not in run.h5
};

/// The total of a run without steps: infinity for the least, 0 for all others.
double total_of_nothing(GaugeTotal keep);
double next_total(GaugeTotal keep, double total, double value);

/// Finds a gauge of the kernel by the name of its column, or of its total if it has no column. Throws
/// std::invalid_argument listing the known names.
Gauge gauge(const std::string& name);
std::vector<Gauge> gauges(const std::vector<std::string>& names);

/// Gauges for the columns of a model: work:LAW of every contact law [J], work:joint:NAME [J], q:BLOCK:i and
/// joint:NAME:axis [m, rad, or units of the block].
std::vector<Gauge> model_gauges(const Model& model);

}  // namespace aussois
