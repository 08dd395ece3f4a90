// SPDX-License-Identifier: Apache-2.0
// The scheme of Schatzman and Paoli: central differences, and restitution from a constraint on the position
// (q_{k+1} + e q_{k-1}) / (1 + e). Velocities are those of the last path, (q_k - q_{k-1}) / h. Source: Paoli
// and Schatzman 2002; (SP-1) to (SP-6).
#pragma once

#include <memory>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

struct SchatzmanPaoliOptions {
  double theta = 0;  // where in the step the force laws are evaluated, linearly implicit [-], in [0, 1]; 0:
                     // central differences, stable up to 2 / h [rad/s]
  StepOptions step{.normal = {.law = NormalLaw::gap_over_step}};  // the law and gamma must be these
};
void validate(const SchatzmanPaoliOptions& options);  // throws std::invalid_argument: field, value, bound

class SchatzmanPaoli {
 public:
  /// Throws std::invalid_argument as MoreauJean does.
  SchatzmanPaoli(const Model& model, const SchatzmanPaoliOptions& options);
  SchatzmanPaoli(Model&&, const SchatzmanPaoliOptions&) = delete;  // the model outlives the scheme

  /// As MoreauJean::step. A step of another length than the last keeps the restitution of an impact already
  /// begun (SP-5).
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

 private:
  std::shared_ptr<const StepSetting> setting_;
  double theta_;
};

}  // namespace aussois
