// SPDX-License-Identifier: Apache-2.0
// A half-explicit time-stepping scheme on velocity level (doc/theory/d1_minus_linear.md). It comes from a
// discontinuous Galerkin method with velocities linear in a step and a jump at its end: the explicit
// trapezoidal rule, which includes the contacts that last, and then the impacts. Sources: Schindler, Acary
// 2014; Schindler, Rezaei, Kursawe, Acary 2015; (DML-1) to (DML-7).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

class D1MinusLinear {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  explicit D1MinusLinear(const Model& model, const StepOptions& step = {});
  explicit D1MinusLinear(Model&&, const StepOptions& = {}) = delete;  // the model must outlive the scheme

  /// Advances by at most min(StepOptions::h, h_limit); less if the advancement needs it. The state is
  /// unchanged unless the report says moved(). Throws for arguments that do not fit (check_fits), not for
  /// numerical trouble. Explicit in the forces: a spring k on a mass m needs h < 2 sqrt(m / k).
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Options of a step that the scheme does not read; they are refused if they are set.
  static std::vector<std::string> unread() { return {"persistence.anchors"}; }

 private:
  std::shared_ptr<const StepSetting> setting_;
};

}  // namespace aussois
