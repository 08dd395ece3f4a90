// SPDX-License-Identifier: Apache-2.0
// What the cases of the verification list are made of: runs that must come to their end, and the worst of
// many figures.
#pragma once

#include <cmath>
#include <sstream>

#include "examples/common/driver.hpp"
#include "examples/scenes/cases.hpp"
#include "examples/scenes/shared_series.hpp"
#include "examples/studies/verification/verification.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

/// Throws NumericalFailure with the reason of a step that is not ok.
inline void require_accepted(const StepReport& report) {
  if (report.ok()) return;
  std::ostringstream text;
  text << (report.reason.empty() ? to_string(report.solve.status) : report.reason) << " at t = " << report.t
       << " s";
  throw NumericalFailure(text.str());
}

/// The step of a scheme, over at most `h_max` [s], accepted.
template <class AnyScheme>
StepReport step(const AnyScheme& scheme, State& state, double h_max = kInf) {
  StepReport report = scheme.step(state, h_max);
  require_accepted(report);
  return report;
}

/// Steps until State::t is t_end [s], accepted, or `go_on(report)`, called after each, returns false.
template <class AnyScheme, class GoOn>
void run_accepted(const AnyScheme& scheme, State& state, double t_end, const GoOn& go_on) {
  require_accepted(
      run(scheme, state, t_end, [&](const StepReport& report) { return report.ok() && go_on(report); }));
}
template <class AnyScheme>
void run_accepted(const AnyScheme& scheme, State& state, double t_end) {
  run_accepted(scheme, state, t_end, [](const StepReport&) { return true; });
}

/// Whole steps, accepted, until State::t is `t` [s] or more, or `go_on`
/// returns false: none is shortened so that it ends at `t`, which is later than the start by a step or more.
template <class AnyScheme, class GoOn>
void run_past(const AnyScheme& scheme, State& state, double t, const GoOn& go_on) {
  run_accepted(scheme, state, t + (t - state.t),
               [&](const StepReport& report) { return go_on(report) && state.t < t; });
}
template <class AnyScheme>
void run_past(const AnyScheme& scheme, State& state, double t) {
  run_past(scheme, state, t, [](const StepReport&) { return true; });
}

/// Steps up to t_end [s], accepted; `look` sees the state after each.
inline State run_to(const CaseScene& scene, const std::string& name, const SchemeOptions& options,
                    double t_end, const std::function<void(const State&, const StepReport&)>& look = {}) {
  State state = scene.state;
  require_accepted(
      run_until(make_scheme(name, scene.model, options), state, t_end, [&](const StepReport& report) {
        if (look && report.ok()) look(state, report);
      }));
  return state;
}

/// Steps of theta = 1/2 solved to rounding, without certificates: for motions that meet nothing by surprise.
inline SchemeOptions exact_options(double h, NormalLaw law = NormalLaw::combined, double tolerance = 1e-13) {
  return {.step = {.h = h, .solver = {.tolerance = tolerance}, .advancement = {.certify = false}},
          .moreau_jean = {.theta = 0.5, .law = law},
          .passive_midpoint = {.law = law},
          .generalised_alpha = {.spectral_radius = 1}};
}
/// The same with Moreau's law, which mechanisms want, to 1e-12.
inline SchemeOptions moreau_options(double h) {
  return exact_options(h, NormalLaw::moreau, 1e-12);
}

/// The sum of the forces of contacts on a body in a step [N].
inline Vec3 contact_force(const StepReport& report, BodyId on) {
  Vec3 sum = Vec3::Zero();
  for (const StepContact& c : report.contacts) {
    if (c.point.a.body == on) sum += c.impulse / report.h;
    if (c.point.b.body == on) sum -= c.impulse / report.h;
  }
  return sum;
}

/// The largest of the figures that it was given, none of which is negative. A NaN stays.
class Worst {
 public:
  void add(double figure) {
    if (!std::isnan(value_) && !(figure <= value_)) value_ = figure;
  }
  operator double() const { return value_; }

 private:
  double value_ = 0;
};

/// The smallest of the figures that it was given; infinite without one. A NaN stays.
class Least {
 public:
  void add(double figure) {
    if (!std::isnan(value_) && !(figure >= value_)) value_ = figure;
  }
  operator double() const { return value_; }

 private:
  double value_ = kInf;
};

}  // namespace aussois
