// SPDX-License-Identifier: Apache-2.0
// The ways of choosing contacts that are compared (PEG-14): reducers of the kernel, clusterings that make new
// contacts, fixed and learned choices, and the best choice in hindsight.
#pragma once

#include <functional>
#include <string>

#include "examples/studies/peg_plate/solver_view.hpp"
#include "reduction/network.hpp"

namespace aussois {

/// The contacts of one sample. Samples of a case come in order, `first` at its first one: a method may
/// remember.
using PegMethod = std::function<std::vector<PegContact>(const PegSample& sample, bool first)>;

struct NamedMethod {
  std::string name{};
  std::function<PegMethod()> make{};  // one per run: a memory is not shared
  bool dear = false;                  // a solve per choice: asked for few samples only
};

/// full, hull_exact, hull_margin, extreme_points, load_carrier, kmc, kmcw: all that needs no training.
std::vector<NamedMethod> untrained_methods(PegScenario scenario, const SolverView& view, std::uint64_t seed);

/// The same outputs for every sample.
NamedMethod fixed_method(const std::string& name, PegScenario scenario, std::vector<int> outputs);
/// The places, or the normal, that a network finds most probable.
NamedMethod learned_method(const std::string& name, PegScenario scenario, Network network);
/// The choice of least error (PEG-9), which is not known in advance.
NamedMethod oracle_method(PegScenario scenario, const SolverView& view);

/// Outputs that a network chooses for a sample.
std::vector<int> learned_outputs(PegScenario scenario, const Network& network, const PegSample& sample);

}  // namespace aussois
