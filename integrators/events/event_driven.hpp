// SPDX-License-Identifier: Apache-2.0
// The event-driven reference scheme (doc/theory/event_driven.md). CVODE integrates the smooth motion, with
// contacts and joints on the level of accelerations; every impact, release, slip, stick and reversal has its
// own time; the solvers of the one-step problem resolve impacts. For small systems, exact to its tolerances
// (EVD-2) to (EVD-10).
#pragma once

#include <memory>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

struct EventDrivenOptions {
  OdeOptions ode{};
  double horizon = 1e-2;         // smaller gaps are watched [m], > 0
  double gap_tolerance = 1e-10;  // a smaller gap counts as closed [m, rad], > 0
  double rest_speed = 1e-5;      // a contact that leaves more slowly stays closed [m/s, rad/s], > 0 (EVD-9)
  double stick_speed = 1e-8;     // a contact that slips more slowly may stick [m/s, rad/s], > 0
  double stiff_slip = 0.1;  // a piece that begins with a slower slip in space uses BDF: friction damps what
                            // is across the slip at the rate mu g / |slip| [m/s], >= 0
  int max_events = 2000;    // in one step, >= 1
  StepOptions step{.solver = {.tolerance = 1e-13}};
};
void validate(const EventDrivenOptions& options);  // throws std::invalid_argument: field, value, bound

class EventDriven {
 public:
  /// Throws std::invalid_argument for a bad option or model, if two bodies that can touch have no dilation at
  /// all, or for a speed or position motor with a limit, which has no law on the level of accelerations.
  EventDriven(const Model& model, const EventDrivenOptions& options);
  EventDriven(Model&&, const EventDrivenOptions&) = delete;  // the model must outlive the scheme

  /// Advances by min(options.step.h, h_limit), through all events on the way. The state is unchanged unless
  /// the report says moved(). Throws for arguments that do not fit (check_fits), not for numerical trouble.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

 private:
  std::shared_ptr<const StepSetting> setting_;
  EventDrivenOptions options_;
};

}  // namespace aussois
