// SPDX-License-Identifier: Apache-2.0
// Measures cost and error of a scene of the peers in every engine: one judged run, then rounds that are only
// timed. Engines take turns, so that a busy machine slows them alike.
#pragma once

#include "bench/peer_engine.hpp"

namespace aussois {

/// A scene at a step, and the bars for our kernel; infinity: none.
struct DynamicsCase {
  std::string scene{};
  double h = 1e-3;      // [s]
  double error = kInf;  // by the measure of the scene
  double us = kInf;     // CPU time of a step [us]
  double t_least = 0;  // simulated time of a timed run at least, so that it contains the essential motion [s]
};
const std::vector<DynamicsCase>& dynamics_cases();

struct DynamicsOptions {
  int rounds = 5;       // of timing, >= 1
  double length = 1;    // of every run, over that of its scene [-], in (0, 1]
  double t_timed = 20;  // simulated time of a timed run at most, unless the case needs more [s], > 0
};

struct EngineCost {
  std::string engine{};
  double error = kInf;               // by the measure of the scene; the start does not count
  double fall_time = kInf;           // of scenes at rest [s]
  double us = kInf, us_slowest = 0;  // CPU time of a step, of the fastest and the slowest round
};

struct SceneCost {
  DynamicsCase of{};
  double t_end = 0, t_timed = 0;      // of the judged run, of the timed ones [s]
  std::vector<EngineCost> engines{};  // those that can run it, ours first
};

/// `step(what)` is called with the name of the next part and returns whether to go on. If not, the result is
/// incomplete.
SceneCost measure_scene(const DynamicsCase& of, const std::vector<PeerEngine>& engines,
                        const DynamicsOptions& options, const std::function<bool(const std::string&)>& step);

}  // namespace aussois
