// SPDX-License-Identifier: Apache-2.0
// A port: what a hand asks for, and how handle and hold follow it from tick to tick (PORT-9) to (PORT-11).
#pragma once

#include "ports/port_law.hpp"

namespace aussois {

/// What a hand says; constant over a tick.
struct PortTarget {
  enum class Mode { none, pose, twist };  // none: it holds nothing
  Mode mode = Mode::none;
  SE3 pose{};                 // of the grip: its place, and how the body should be turned [m]
  Vec6 twist = Vec6::Zero();  // of the handle, as a body's [m/s, rad/s]
  Vec3 grip = Vec3::Zero();   // where the hand takes hold, in the frame of the body [m]
  bool firm = true;           // false: the body hangs by its grip
};

/// `describe` gives the ranges.
struct PortOptions {
  PortGains gains{};  // once the hand holds fast
  PortLimits limits{};
  double ramp = 0.2;  // in which gains grow when it takes hold, and brakes fade when it lets go [s]
  double stride = 4;  // of the handle in a tick, at most, in sums of dilations
};
void validate(const PortOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, PortOptions& options);

struct Port {
  BodyId body{}, handle{};
  int place = 0;  // of its hold in State::u
  PortOptions options{};
};
/// Adds a handle, a body without a shape, and the law of the port. Zero dampings among the gains become
/// critical ones. Throws std::invalid_argument: field, value, bound.
Port add_port(Model& model, BodyId body, const PortOptions& options);

/// Sets hold and handle for the next tick [s]: gains grow, the handle goes no faster than its stride, and a
/// hand that lets go leaves the body with brakes that fade. Returns the energy that growing gains put in [J].
double follow(const Model& model, State& state, const Port& port, const PortTarget& target, double tick);

/// What the port exerts at a state, and whether that is as much as it can.
PortPull port_pull(const State& state, const Port& port);
bool is_at_limit(const PortPull& pull, const PortLimits& limits);

/// Whether a hand holds the body.
bool is_held(const State& state, const Port& port);

}  // namespace aussois
