// SPDX-License-Identifier: Apache-2.0
// The Moreau-Jean velocity law with projection on the position constraints, which leaves no overlap after a
// step. Source: Acary 2013 (CMAME 256), the direct and the combined scheme; (PRJ-1) to (PRJ-5).
#pragma once

#include <memory>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

enum class ProjectionOrder {
  direct,    // velocities, then positions
  combined,  // then velocities again with contacts that positions asked for, until none is added (PRJ-5)
};
const char* to_string(ProjectionOrder order);
/// Finds the order by its name; throws std::invalid_argument listing the two.
ProjectionOrder projection_order(const std::string& name);

struct MoreauJeanProjectedOptions {
  double theta = 0.5;  // of the smooth forces and of the position update [-], in [1/2, 1]
  ProjectionOrder order = ProjectionOrder::combined;
  StepOptions step{.normal = {.law = NormalLaw::moreau}};  // the law must be Moreau's
};
void validate(
    const MoreauJeanProjectedOptions& options);  // throws std::invalid_argument: field, value, bound

class MoreauJeanProjected {
 public:
  /// Throws std::invalid_argument as MoreauJean does.
  MoreauJeanProjected(const Model& model, const MoreauJeanProjectedOptions& options);
  MoreauJeanProjected(Model&&, const MoreauJeanProjectedOptions&) = delete;  // the model outlives the scheme

  /// As MoreauJean::step. The certified path leads to the projected poses.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

 private:
  std::shared_ptr<const StepSetting> setting_;
  MoreauJeanProjectedOptions options_;
};

}  // namespace aussois
