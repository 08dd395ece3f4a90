// SPDX-License-Identifier: Apache-2.0
// A run: whether it can begin at a state, how it goes on, and what it gained that nothing gave.
#pragma once

#include <cmath>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// Throws std::invalid_argument naming what is wrong, its value and its bound: what validate(model, state)
/// refuses; bodies whose base complexes are nearer than the certificate will allow (CA-6); a body inside the
/// solid of another (CA-19), which no step after the first looks for; a joint that is off by
/// more than `joint_tolerance` [m, rad] (`consistent` mends that); a block or gap function whose matrices
/// have the wrong size, or whose mass is not symmetric and positive definite.
void validate_start(const Model& model, const State& state, const AdvancementOptions& options = {},
                    double joint_tolerance = 1e-6);

/// The nearest poses, in the metric of the masses, at which all joints, couplings and position motors without
/// a limit hold (Newton, to 1e-13 m and rad or as far as rounding lets it), and the nearest velocities that
/// keep them so, and speed motors too (MJT-13). Also the way to a consistent start.
State consistent(const Model& model, const State& state);
/// The velocities only, at the poses of the state.
VecX consistent_velocity(const Model& model, const State& state);

/// Steps until State::t is `t_end` [s], a step leads nowhere (it would not the next time either), or
/// `go_on(report)`, which hears of every step, says no. Returns the report of the last step; if there is
/// nothing to do, one of a step of length 0.
template <class AnyScheme, class GoOn>
[[nodiscard]] StepReport run(const AnyScheme& scheme, State& state, double t_end, const GoOn& go_on) {
  constexpr double kSameTime = 1e-12;  // relative; what the sum of many steps leaves of a run is no step
  StepReport report;
  report.t = state.t;
  bool on = true;
  while (on && report.moved() && t_end - state.t > kSameTime * std::abs(t_end)) {
    report = scheme.step(state, t_end - state.t);
    on = go_on(report);
  }
  return report;
}

/// The same, also until a report is not ok.
template <class AnyScheme, class Look>
[[nodiscard]] StepReport run_until(const AnyScheme& scheme, State& state, double t_end, const Look& look) {
  return run(scheme, state, t_end, [&](const StepReport& report) {
    look(report);
    return report.ok();
  });
}
template <class AnyScheme>
[[nodiscard]] StepReport run_until(const AnyScheme& scheme, State& state, double t_end) {
  return run_until(scheme, state, t_end, [](const StepReport&) {});
}

/// Told is a gain in a run of more than this, of its largest kinetic energy.
inline constexpr double kGainOfRun = 1e-3;

struct EnergyGain {
  double stored = 0;   // at the last state: kinetic energy, weight, springs of joints [J]
  double above = 0;    // of it: over the lowest value so far, without what was given since [J]
  double largest = 0;  // `above` at its largest: what the run gained [J]
  double kinetic = 0;  // the largest so far, at least what the weight gives from rest in a step [J]
};

/// Of a run that begins with `start`.
EnergyGain energy_gain(const Model& model, const State& start);

/// One more step, accepted, that led to `state`. Force laws, forces of coordinates, motors and moved bodies
/// may give what they like.
void add(const Model& model, const State& state, const StepReport& report, EnergyGain& gain);

inline bool energy_rises(const EnergyGain& gain) {
  return gain.largest > kGainOfRun * gain.kinetic;
}

}  // namespace aussois
