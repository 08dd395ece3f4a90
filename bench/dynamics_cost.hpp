// SPDX-License-Identifier: Apache-2.0
// What a scene of the peers costs in every engine, and how wrong it gets there: one judged run, then rounds
// that are only timed, all engines in turn, so that a busy machine hits them alike.
#pragma once

#include "bench/peer_engine.hpp"

namespace aussois {

/// A scene at a step, and the bars for our kernel; infinity: none.
struct DynamicsCase {
  std::string scene{};
  double h = 1e-3;      // [s]
  double error = kInf;  // by the measure of the scene
  double us = kInf;     // CPU time of a step [us]
  double t_least = 0;   // simulated time of a timed run at least: what the scene is about happens in it [s]
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

/// `step(what)` hears what comes next and answers whether to go on; if not, what is returned is not complete.
SceneCost measure_scene(const DynamicsCase& of, const std::vector<PeerEngine>& engines,
                        const DynamicsOptions& options, const std::function<bool(const std::string&)>& step);

}  // namespace aussois
