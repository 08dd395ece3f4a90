// SPDX-License-Identifier: Apache-2.0
// What a network is to learn from (PEG-9) to (PEG-12): how wrong each choice of contacts is for each sample,
// and three ways to make targets of it.
#pragma once

#include <functional>
#include <string>

#include "examples/studies/peg_plate/solver_view.hpp"

namespace aussois {

/// |F - F_e| / |F_e| of every choice (row) for every sample (column) (PEG-9). `progress` hears of each
/// sample, from any thread.
MatX choice_errors(const SolverView& view, PegScenario scenario, const std::vector<PegSample>& samples,
                   int threads = 1, const std::function<void()>& progress = {});

/// The choices that suffice, in order (PEG-10): the one that serves most samples, then the one that serves
/// most of the others, until none is left; it serves a sample if its error is within `delta` of the least.
/// Ties by mean square error, then by index.
std::vector<int> ranking(const MatX& errors, double delta);

enum class LabelMode {
  argmin,  // [Kim2019]: the choice of least error, one per sample (degenerate where forces are static)
  soft,    // all choices, by exp(-(e - e_min) / tau) (PEG-11)
  ranked,  // the first of the ranking that serves the sample (PEG-12)
};
inline constexpr LabelMode kLabelModes[] = {LabelMode::argmin, LabelMode::soft, LabelMode::ranked};
const char* to_string(LabelMode mode);

/// `describe` gives the ranges.
struct LabelOptions {
  LabelMode mode = LabelMode::ranked;
  double tau = 0.005;   // of soft [-]
  double delta = 0.01;  // of ranked [-]: two to three times the sensors' noise
};
void describe(SettingVisitor& visit, LabelOptions& options);

/// Target probabilities, outputs x samples; every column sums to one.
MatX targets(const MatX& errors, const std::vector<std::vector<int>>& choices, int outputs,
             const LabelOptions& options);

/// The choice that argmin and ranked make per sample.
std::vector<int> chosen_labels(const MatX& errors, const LabelOptions& options);

}  // namespace aussois
