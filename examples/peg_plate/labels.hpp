// SPDX-License-Identifier: Apache-2.0
// What a network is to learn from (PEG-9) to (PEG-12): how wrong each choice of contacts is for each sample,
// and three ways to make targets of it.
#pragma once

#include <functional>
#include <string>

#include "examples/peg_plate/solver_view.hpp"

namespace aussois {

/// |F - F_e| / |F_e| of every choice (row) for every sample (column) (PEG-9). `progress` hears of each
/// sample, from any thread.
MatX choice_errors(const SolverView& view, PegScenario scenario, const std::vector<PegSample>& samples,
                   int threads = 1, const std::function<void()>& progress = {});

/// Choices by their mean square error over the samples, the best first; ties by index (PEG-10).
std::vector<int> ranking(const MatX& errors);

enum class LabelMode {
  argmin,  // [Kim2019]: the choice of least error, one per sample (degenerate where forces are static)
  soft,    // all choices, by exp(-(e - e_min) / tau) (PEG-11)
  ranked,  // the best-ranked choice within delta of the least error (PEG-12)
};
const char* to_string(LabelMode mode);

struct LabelOptions {
  LabelMode mode = LabelMode::ranked;
  double tau = 0.005;   // of soft [-], > 0
  double delta = 0.01;  // of ranked [-], >= 0: two to three times the sensors' noise
};

/// Target probabilities, outputs x samples; every column sums to one.
MatX targets(const MatX& errors, const std::vector<std::vector<int>>& choices, int outputs,
             const LabelOptions& options);

/// The choice that argmin and ranked make per sample.
std::vector<int> chosen_labels(const MatX& errors, const LabelOptions& options);

}  // namespace aussois
