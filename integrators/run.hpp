// SPDX-License-Identifier: Apache-2.0
// Runs: check the start, take the steps, and account for energy that nothing supplied.
#pragma once

#include <cmath>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// Throws std::invalid_argument, naming what is wrong, its value and its bound, if
/// - validate(model, state) refuses;
/// - base complexes of two bodies are nearer than the certificate allows (CA-6);
/// - a body lies inside the solid of another (CA-19), which no step after the first checks;
/// - a joint or coupling is off by more than the tolerance of `joints` (`consistent_state` corrects that);
/// - a block or gap function has matrices of the wrong size, or a mass that is not symmetric and positive
///   definite.
void validate_start(const Model& model, const State& state, const AdvancementOptions& options = {},
                    const JointOptions& joints = {});

/// Makes a start consistent (MJT-13). The poses are the nearest, in the metric of the masses, at which all
/// joints, couplings and position motors without a limit hold: Newton's method, to 1e-13 m and rad or as far
/// as rounding allows. The velocities are the nearest that keep them so and satisfy speed motors.
State consistent_state(const Model& model, const State& state);
/// Corrects the velocities only, at the poses of the state.
VecX consistent_velocity(const Model& model, const State& state);

/// Steps until State::t reaches `t_end` [s], a step leads nowhere (a repeat would not either), or
/// `go_on(report)`, called after every step, returns false. Returns the report of the last step, or that of a
/// step of length 0 if there is nothing to do.
template <class AnyScheme, class GoOn>
[[nodiscard]] StepReport run(const AnyScheme& scheme, State& state, double t_end, const GoOn& go_on) {
  constexpr double kSameTime = 1e-12;  // relative; a remainder this small is rounding of the summed steps
  StepReport report;
  report.t = state.t;
  bool on = true;
  while (on && report.moved() && t_end - state.t > kSameTime * std::abs(t_end)) {
    report = scheme.step(state, t_end - state.t);
    on = go_on(report);
  }
  return report;
}

/// The same, but also stops when a report is not ok.
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

/// A gain over a run is reported if it exceeds this fraction of the largest kinetic energy.
inline constexpr double kGainOfRun = 1e-3;

struct EnergyGain {
  double stored = 0;   // at the last state: kinetic energy, weight, springs of joints [J]
  double above = 0;    // rise of `stored` above its lowest value so far, less what was supplied since [J]
  double largest = 0;  // largest `above` so far: what the run gained [J]
  double kinetic = 0;  // largest so far, at least what the weight gives from rest in a step [J]
};

/// The gain of a run that begins at `start`.
EnergyGain energy_gain(const Model& model, const State& start);

/// Adds one more accepted step, which led to `state`. Energy that force laws, forces of coordinates, motors
/// and moved bodies supply is no gain.
void add_step(const Model& model, const State& state, const StepReport& report, EnergyGain& gain);

inline bool energy_rises(const EnergyGain& gain) {
  return gain.largest > kGainOfRun * gain.kinetic;
}

}  // namespace aussois
