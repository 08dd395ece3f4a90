// SPDX-License-Identifier: Apache-2.0
// The passive midpoint scheme (doc/theory/passive_midpoint.md): at any step length it gives back no more
// energy than its ports put in. Source: Kim, Lee, Lee, Lee 2017; (PMI-1) to (PMI-12).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

/// Where the gyroscopic torque of a step is taken (PMI-2), (PMI-3).
enum class GyroscopicTerm {
  start,     // S(J omega) at the start times the mean omega: linear, no work
  midpoint,  // at the mean omega: no work either; linearised about a guess of the mean
};
inline constexpr Named<GyroscopicTerm> kGyroscopicTerms[] = {{GyroscopicTerm::midpoint, "midpoint"},
                                                             {GyroscopicTerm::start, "start"}};

/// How a step takes the forces of laws, joint axes and coordinates.
enum class MiddleForce {
  linear,     // linearised about its start (MJ-4)
  conserving  // at the middle of its path, and a passive law does as much work as its potential loses (PMI-9)
};
inline constexpr Named<MiddleForce> kMiddleForces[] = {{MiddleForce::linear, "linear"},
                                                       {MiddleForce::conserving, "conserving"}};

struct PassiveMidpointOptions {
  /// `midpoint` and StepOptions::update = cayley keep energy and angular momentum of a free body exactly.
  GyroscopicTerm gyroscopic = GyroscopicTerm::midpoint;
  /// `conserving` keeps the energy of elastic bodies; it solves a step several times. Bodies that turn, such
  /// as nodes of cables, also need GyroscopicTerm::midpoint and StepOptions::update = cayley for it.
  MiddleForce forces = MiddleForce::linear;
  NormalLaw law = NormalLaw::combined;
  bool passive = true;  // contacts that would give energy get their law at the midpoint (PMI-6)
  /// States joints on the mean of both ends (MJT-14): to rounding, they neither drift, nor do work, nor turn
  /// the system as a whole; JointOptions::project is then off. Needs StepOptions::update = cayley. False: as
  /// in other schemes.
  bool mean_joints = false;
};
void validate(const PassiveMidpointOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, PassiveMidpointOptions& options);

class PassiveMidpoint {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  explicit PassiveMidpoint(const Model& model, const StepOptions& step = {},
                           const PassiveMidpointOptions& own = {});
  explicit PassiveMidpoint(Model&&, const StepOptions& = {},
                           const PassiveMidpointOptions& = {}) = delete;  // the model must outlive the scheme

  /// Advances by at most min(StepOptions::h, h_limit); less if the advancement needs it. The state is
  /// unchanged unless the report says moved(). Throws for arguments that do not fit (check_fits), not for
  /// numerical trouble.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Options of a step that the scheme does not read; they are refused if they are set.
  static std::vector<std::string> unread() { return {"persistence.anchors"}; }

 private:
  std::shared_ptr<const StepSetting> setting_;
  PassiveMidpointOptions own_;
};

}  // namespace aussois
