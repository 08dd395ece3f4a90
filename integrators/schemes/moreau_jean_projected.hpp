// SPDX-License-Identifier: Apache-2.0
// The Moreau-Jean velocity law with projection on the position constraints, which leaves no overlap after a
// step. Source: Acary 2013 (CMAME 256), the direct and the combined scheme; (PRJ-1) to (PRJ-5).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

enum class ProjectionOrder {
  direct,    // velocities, then positions
  combined,  // then velocities again with contacts that positions asked for, until none is added (PRJ-5)
};
inline constexpr Named<ProjectionOrder> kProjectionOrders[] = {{ProjectionOrder::direct, "direct"},
                                                               {ProjectionOrder::combined, "combined"}};

/// `describe` gives the ranges.
struct MoreauJeanProjectedOptions {
  double theta = 0.5;  // of the smooth forces and of the position update [-]
  ProjectionOrder order = ProjectionOrder::combined;
};
void validate(
    const MoreauJeanProjectedOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, MoreauJeanProjectedOptions& options);

class MoreauJeanProjected {
 public:
  /// Throws std::invalid_argument as MoreauJean does.
  explicit MoreauJeanProjected(const Model& model, const StepOptions& step = {},
                               const MoreauJeanProjectedOptions& own = {});
  explicit MoreauJeanProjected(Model&&, const StepOptions& = {}, const MoreauJeanProjectedOptions& = {}) =
      delete;  // the model must outlive the scheme

  /// As MoreauJean::step. The certified path leads to the projected poses.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Options of a step that the scheme does not read; they are refused if they are set.
  static std::vector<std::string> unread() { return {"correction_speed"}; }

 private:
  std::shared_ptr<const StepSetting> setting_;
  MoreauJeanProjectedOptions own_;
};

}  // namespace aussois
