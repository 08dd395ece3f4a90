// SPDX-License-Identifier: Apache-2.0
// Runs: check the start, take the steps, and account for energy that nothing supplied.
#pragma once

#include <cmath>
#include <string>
#include <utility>

#include "geometry/settings.hpp"
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

/// `describe` gives the ranges.
struct SettleOptions {
  double first_h = 1e-3;        // first step [s]
  double growth = 2;            // each step is so many times as long as the one before, up to the scheme's
  double turn = 0.5;            // a step in which a body turns farther is taken again, half as long [rad]
  double displacement = 1e-12;  // in a step of the scheme's length, at rest [m, rad]
  int max_steps = 1000;
};
void describe(SettingVisitor& visit, SettleOptions& options);
/// The largest |v| [m/s, rad/s] of a state, and the largest |omega| of its bodies.
struct LargestSpeeds {
  double all = 0, turning = 0;
};
LargestSpeeds largest_speeds(const State& state);

/// Goes to an equilibrium by steps that grow to the scheme's own length, which must be far longer than the
/// slowest motion of the model. With moreau_jean, theta = 1 and one iteration, such a step is one of Newton's
/// method for the equilibrium, with the tangent where it stands; shorter ones lead there from afar. Ends
/// where a step of that length moves nothing farther than `displacement`. Returns the report of the last
/// step: `not_solved` after max_steps, or the first that led nowhere. State::t goes on by the length of all
/// steps, so loads must not depend on time. Throws std::invalid_argument for bad options.
template <class AnyScheme>
[[nodiscard]] StepReport settle(const AnyScheme& scheme, State& state, const SettleOptions& options = {}) {
  check_ranges(options);
  StepReport report;
  double h = options.first_h;
  for (int k = 0; k < options.max_steps; ++k) {
    State next = state;
    next.h_next = 0;  // the length is this function's
    report = scheme.step(next, h);
    if (!report.moved()) return report;
    const LargestSpeeds speed = largest_speeds(next);
    if (speed.turning * report.h > options.turn) {
      h = report.h / 2;
      continue;
    }
    state = std::move(next);
    state.h_next = 0;
    const bool whole = report.attempts == 1 && report.h < h;
    if (whole && report.ok() && speed.all * report.h <= options.displacement) return report;
    h = (report.attempts == 1 ? options.growth : 1) * report.h;
  }
  report.status = StepStatus::not_solved;
  report.reason = "not at rest after " + std::to_string(options.max_steps) + " steps";
  return report;
}

/// A gain over a run is reported if it exceeds this fraction of the largest kinetic energy.
inline constexpr double kGainOfRun = 1e-3;

struct EnergyGain {
  double stored = 0;   // at the last state: kinetic energy, weight, springs of joints, passive laws [J]
  double above = 0;    // rise of `stored` above its lowest value so far, less what was supplied since [J]
  double largest = 0;  // largest `above` so far: what the run gained [J]
  double kinetic = 0;  // largest so far, at least what the weight gives from rest in a step [J]
};

/// The gain of a run that begins at `start`.
EnergyGain energy_gain(const Model& model, const State& start);

/// Adds one more accepted step, which led to `state`. Energy that force laws, forces of coordinates, motors
/// and moved bodies supply is no gain. Where all laws are passive (ForceLaw::passive), neither axes of
/// joints nor coordinates have forces, and no body is moved, what laws give beyond their potential is one.
void add_step(const Model& model, const State& state, const StepReport& report, EnergyGain& gain);

inline bool energy_rises(const EnergyGain& gain) {
  return gain.largest > kGainOfRun * gain.kinetic;
}

}  // namespace aussois
