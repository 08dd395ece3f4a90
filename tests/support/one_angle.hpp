// SPDX-License-Identifier: Apache-2.0
// C7: the N-four-bar against the equation of its one angle.
#pragma once

#include <algorithm>
#include <cmath>

#include "examples/scenes/mechanisms.hpp"
#include "mechanics/mechanism.hpp"
#include "tests/support/stepping.hpp"

namespace aussois {

/// (MCH-7): th'' = (G / I) g sin th from the vertical, th' = 1 rad/s.
inline std::function<VecX(double t)> one_angle(int windows, double t_end) {
  const double I = (windows + 1) / 3.0 + windows, G = (windows + 1) / 2.0 + windows;
  const auto rates = [pull = 9.81 * G / I](double, const VecX& y) -> VecX {
    return Vec2(y[1], pull * std::sin(y[0]));
  };
  return ode_solution(rates, Vec2(0, 1), t_end, 1e-3);
}

/// At most, over a run.
struct FourBarErrors {
  double angle = 0;   // [rad]
  double energy = 0;  // of that at the start [-]
  double drift = 0;   // of the joints [m]
};
inline FourBarErrors four_bar_errors(int windows, const char* scheme, double h, double t_end) {
  const CaseScene s = four_bars(windows);
  const auto exact = one_angle(windows, t_end);
  const double before = energy(s.model, s.state).total();
  FourBarErrors out;
  run_scene(s, scheme, mechanism_options(h), t_end, [&](const State& now, const StepReport& report) {
    out.angle = std::max(out.angle, std::abs(joint_coordinate(s.model, now, 0) - exact(now.t)[0]));
    out.energy = std::max(out.energy, std::abs(energy(s.model, now).total() / before - 1));
    out.drift = std::max(out.drift, report.joint_error.translation);
  });
  return out;
}

}  // namespace aussois
