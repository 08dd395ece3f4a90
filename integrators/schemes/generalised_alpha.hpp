// SPDX-License-Identifier: Apache-2.0
// The nonsmooth generalised-alpha scheme on Lie groups (doc/theory/generalised_alpha.md). It computes the
// motion between contacts to second order with damping of high frequencies, then positions that satisfy
// joints and gaps, then velocities that satisfy both and the laws of impact and friction. Source: Bruls,
// Acary, Cardona 2014, 2018; (GA-1) to (GA-10).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

/// `describe` gives the ranges.
struct GeneralisedAlphaOptions {
  double spectral_radius = 0.8;  // of infinitely stiff motions, per step [-]; 1: no damping
};
void validate(const GeneralisedAlphaOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, GeneralisedAlphaOptions& options);

class GeneralisedAlpha {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  explicit GeneralisedAlpha(const Model& model, const StepOptions& step = {},
                            const GeneralisedAlphaOptions& own = {});
  explicit GeneralisedAlpha(Model&&, const StepOptions& = {}, const GeneralisedAlphaOptions& = {}) =
      delete;  // the model must outlive the scheme

  /// Advances by at most min(StepOptions::h, h_limit); less if the advancement needs it. The state is
  /// unchanged unless the report says moved(). Throws for arguments that do not fit (check_fits), not for
  /// numerical trouble. Keeps accelerations in State::a; a state without them is a fresh start.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Options of a step that the scheme does not read; they are refused if they are set.
  static std::vector<std::string> unread() { return {"joints.stabilisation", "persistence.anchors"}; }

 private:
  std::shared_ptr<const StepSetting> setting_;
  GeneralisedAlphaOptions own_;
};

}  // namespace aussois
