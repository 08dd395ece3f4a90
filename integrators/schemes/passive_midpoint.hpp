// SPDX-License-Identifier: Apache-2.0
// The passive midpoint scheme (doc/theory/passive_midpoint.md): at any step length it gives back no more
// energy than its ports put in. Source: Kim, Lee, Lee, Lee 2017; (PMI-1) to (PMI-6).
#pragma once

#include <memory>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

/// Where the gyroscopic torque of a step is taken (PMI-2), (PMI-3).
enum class GyroscopicTerm {
  start,     // S(J omega) at the start times the mean omega: linear, no work
  midpoint,  // at the mean omega: no work either; linearised about a guess of the mean
};

struct PassiveMidpointOptions {
  /// `midpoint` and StepOptions::update = cayley keep energy and angular momentum of a free body exactly.
  GyroscopicTerm gyroscopic = GyroscopicTerm::midpoint;
  bool passive = true;  // contacts that would give energy get their law at the midpoint (PMI-6)
  /// States joints on the mean of both ends (MJT-14): to rounding, they neither drift, nor do work, nor turn
  /// the system as a whole; JointOptions::project is then off. Needs StepOptions::update = cayley. False: as
  /// in other schemes.
  bool mean_joints = false;
  StepOptions step{};
};
void validate(const PassiveMidpointOptions& options);  // throws std::invalid_argument: field, value, bound

class PassiveMidpoint {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  PassiveMidpoint(const Model& model, const PassiveMidpointOptions& options);
  PassiveMidpoint(Model&&, const PassiveMidpointOptions&) = delete;  // the model must outlive the scheme

  /// Advances by at most min(options.step.h, h_limit); less if the advancement needs it. The state is
  /// unchanged unless the report says moved(). Throws for arguments that do not fit (check_fits), not for
  /// numerical trouble.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

 private:
  std::shared_ptr<const StepSetting> setting_;
  GyroscopicTerm gyroscopic_;
  bool passive_, mean_joints_;
};

}  // namespace aussois
