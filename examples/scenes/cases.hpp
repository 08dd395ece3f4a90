// SPDX-License-Identifier: Apache-2.0
// Scenes whose exact motion is known (doc/theory/convergence.md): shared by examples, tests and benchmarks. A
// new case is one entry in the file of its kind.
#pragma once

#include <string>

#include "examples/scenes/exact_motion.hpp"
#include "mechanics/state.hpp"

namespace aussois {

struct CaseScene {
  Model model{};
  State state{};
  BodyId body{};  // the one that is looked at
};

struct Case {
  std::string name{};
  std::string what{};        // one line
  double t_end = 1;          // [s]
  double h = 1e-2;           // largest step of a study [s]
  double tolerance = 1e-12;  // of the solver, on the scaled residual [-]
  bool smooth = false;       // no impact, no change between stick and slip
  bool bounces = false;      // needs a scheme with restitution
  bool lands = false;        // comes to rest by one impact (CONV-9)
  bool hops_out = false;     // comes to rest by infinitely many, in finite time
  bool at_once = false;      // several contacts close together: struck one after the other, another motion
  std::function<CaseScene()> scene{};
  std::function<MotionSample(const CaseScene&, const State&)> observe{};
  std::function<ExactMotion(double t_end)> exact{};  // good up to t_end at least
};

const std::vector<Case>& cases();
/// Throws std::invalid_argument naming those there are.
const Case& case_named(const std::string& name);

/// The entries of each kind, in the order of `cases`.
std::vector<Case> impact_cases();
std::vector<Case> friction_cases();
std::vector<Case> rotation_cases();
std::vector<Case> mechanism_cases();

}  // namespace aussois
