// SPDX-License-Identifier: Apache-2.0
// Measures whole steps along the whole path of an assembly, and one distance of the same meshes by FCL at
// poses of the same run. Times are CPU times of one thread.
#pragma once

#include <functional>
#include <limits>
#include <string>

#include "examples/common/step_profile.hpp"
#include "examples/drivers/assembly/assembly_input.hpp"

namespace aussois {

struct StepCostOptions {
  int steps = 0;       // at most; 0: the whole path
  int fcl_poses = 20;  // spread evenly over the steps
};

struct StepCost {
  std::string pair{};
  StepProfile profile{};
  double contacts = 0;                                       // found, mean of all steps
  double ms_fcl = std::numeric_limits<double>::quiet_NaN();  // mean of one distance; nan without FCL
  std::string ended{};                                       // why the run ended early; empty: it did not
};

/// The figures of one stage, or of "step".
StageFigures figures_of(const StepCost& cost, const std::string& stage);
/// Of the mean CPU times.
double ratio_to_fcl(const StepCost& cost);

/// Pulls the moving part along its path as `replay_assembly` does by default. `go_on(done)` is called with
/// the fraction done, from 0 to 1, and returns whether to go on.
StepCost measure_steps(const AssemblyInput& input, const StepCostOptions& options,
                       const std::function<bool(double)>& go_on);

}  // namespace aussois
