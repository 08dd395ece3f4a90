// SPDX-License-Identifier: Apache-2.0
#include "integrators/moreau_jean.hpp"

#include <cmath>

#include "geometry/check.hpp"
#include "integrators/advance_step.hpp"

namespace aussois {
namespace {

StepOptions step_options(const MoreauJeanOptions& o) {
  return {.h = o.h,
          .normal = o.normal,
          .joints = o.joints,
          .lmd = o.lmd,
          .reduction = o.reduction,
          .solver = o.solver,
          .advancement = o.advancement,
          .threads = o.threads,
          .keep_problem = o.keep_problem};
}

}  // namespace

void validate(const MoreauJeanOptions& o) {
  require_field(o.theta >= 0.5 && o.theta <= 1, "MoreauJeanOptions::theta", o.theta, "lie in [0.5, 1]");
  validate(step_options(o));
}

MoreauJean::MoreauJean(const Model& model, const MoreauJeanOptions& options)
    : setting_(step_setting(model, step_options(options))), theta_(options.theta) {
  validate(options);
}

StepReport MoreauJean::step(State& state, double h_limit) const {
  const auto free = [&](const State& start, double h) {
    return free_motion(setting_.model, start, setting_.dofs, h, theta_);  // (MJ-4), (MJ-5)
  };
  const auto estimate = [&](const State& start, double h) {
    return estimate_without_contacts(setting_, start, free(start, h), h, theta_);
  };
  const auto attempt = [&](const State& start, const VecX& v_estimate, double h) {
    const Found found = find_ahead(setting_, start, v_estimate, h);
    const ImpulseStep step = solve_step(setting_, start, found, free(start, h), theta_);
    const VecX& v = step.solved.solution.v;
    return go(setting_, start, found, step,
              {.v_path = theta_ * v + (1 - theta_) * step.free.v, .v_end = v});  // (MJ-7)
  };
  return advance_step(setting_, state, h_limit, {estimate, attempt});
}

ContactSet MoreauJean::contacts(const State& state, double threshold) const {
  return contacts_within(setting_, state, threshold);
}

}  // namespace aussois
