// SPDX-License-Identifier: Apache-2.0
// The event-driven reference scheme (doc/theory/event_driven.md). CVODE integrates the smooth motion, with
// contacts and joints on the level of accelerations; every impact, release, slip, stick and reversal has its
// own time; the solvers of the one-step problem resolve impacts. For small systems, exact to its tolerances
// (EVD-2) to (EVD-10).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

enum class OdeMethod {
  adams,  // orders 1 to 12, iterated by fixed point: smooth motion
  bdf,    // orders 1 to 5, Newton's method with a dense matrix of differences: stiff springs
};
inline constexpr Named<OdeMethod> kOdeMethods[] = {{OdeMethod::adams, "adams"}, {OdeMethod::bdf, "bdf"}};

/// `describe` gives the ranges.
struct OdeOptions {
  OdeMethod method = OdeMethod::adams;
  // Tolerances of every component, per 0.1 s of motion. Shorter steps of event_driven reduce both by the
  // same factor, in proportion to their length, down to 1e-14 relative (EVD-12)
  double relative = 1e-10, absolute = 1e-12;
  double largest_step = kInf;  // [s]
  int max_steps = 100000;      // internal steps in one step of event_driven; a step that needs more is
                               // refused
};
void describe(SettingVisitor& visit, OdeOptions& options);

/// `describe` gives the ranges.
struct EventDrivenOptions {
  OdeOptions ode{};
  double horizon = 1e-2;         // smaller gaps are watched [m]
  double gap_tolerance = 1e-10;  // a smaller gap counts as closed [m, rad]
  double rest_speed = 1e-5;      // a contact that leaves more slowly stays closed [m/s, rad/s] (EVD-9)
  double stick_speed = 1e-8;     // a contact that slips more slowly may stick [m/s, rad/s]
  double stiff_slip = 0.1;   // a piece that begins with a slower slip in space uses BDF: friction damps what
                             // is across the slip at the rate mu g / |slip| [m/s]
  int max_events = 2000;     // in one step
  double tolerance = 1e-13;  // of the problems of impacts and accelerations, on their scaled residuals [-]
};
void validate(const EventDrivenOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, EventDrivenOptions& options);

class EventDriven {
 public:
  /// Throws std::invalid_argument for a bad option or model, if two bodies that can touch have no dilation at
  /// all, or for a speed or position motor with a limit, which has no law on the level of accelerations.
  explicit EventDriven(const Model& model, const StepOptions& step = {}, const EventDrivenOptions& own = {});
  explicit EventDriven(Model&&, const StepOptions& = {},
                       const EventDrivenOptions& = {}) = delete;  // the model must outlive the scheme

  /// Advances by min(StepOptions::h, h_limit), through all events on the way. The state is unchanged unless
  /// the report says moved(). Throws for arguments that do not fit (check_fits), not for numerical trouble.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Options of a step that the scheme does not read; they are refused if they are set. Joints are always
  /// projected, and EventDrivenOptions::tolerance stands for "solver.tolerance".
  static std::vector<std::string> unread();

 private:
  std::shared_ptr<const StepSetting> setting_;
  EventDrivenOptions own_;
};

}  // namespace aussois
