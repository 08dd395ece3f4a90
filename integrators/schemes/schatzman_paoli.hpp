// SPDX-License-Identifier: Apache-2.0
// The scheme of Schatzman and Paoli: central differences, and restitution from a constraint on the position
// (q_{k+1} + e q_{k-1}) / (1 + e). Velocities are those of the last path, (q_k - q_{k-1}) / h. Source: Paoli
// and Schatzman 2002; (SP-1) to (SP-6).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

/// `describe` gives the ranges.
struct SchatzmanPaoliOptions {
  double force_theta = 0;  // where in the step the force laws are evaluated, linearly implicit [-]; 0:
                           // central differences, stable up to 2 / h [rad/s]
};
void validate(const SchatzmanPaoliOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, SchatzmanPaoliOptions& options);

class SchatzmanPaoli {
 public:
  /// Throws std::invalid_argument as MoreauJean does.
  explicit SchatzmanPaoli(const Model& model, const StepOptions& step = {},
                          const SchatzmanPaoliOptions& own = {});
  explicit SchatzmanPaoli(Model&&, const StepOptions& = {},
                          const SchatzmanPaoliOptions& = {}) = delete;  // the model must outlive the scheme

  /// As MoreauJean::step. A step of another length than the last keeps the restitution of an impact already
  /// begun (SP-5).
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Options of a step that the scheme does not read; they are refused if they are set.
  static std::vector<std::string> unread() { return {"persistence.anchors", "touching", "update"}; }

 private:
  std::shared_ptr<const StepSetting> setting_;
  SchatzmanPaoliOptions own_;
};

}  // namespace aussois
