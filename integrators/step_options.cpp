// SPDX-License-Identifier: Apache-2.0
#include "integrators/step_options.hpp"

#include <cmath>

#include "geometry/check.hpp"

namespace aussois {

const char* to_string(NormalLaw law) {
  switch (law) {
    case NormalLaw::moreau:
      return "moreau";
    case NormalLaw::gap_over_step:
      return "gap_over_step";
    case NormalLaw::combined:
      return "combined";
  }
  return "?";
}

NormalLaw normal_law(const std::string& name) {
  for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::gap_over_step, NormalLaw::combined})
    if (name == to_string(law)) return law;
  throw std::invalid_argument("normal law = " + name + " must be moreau, gap_over_step or combined");
}

const char* to_string(ImpactLaw law) {
  return law == ImpactLaw::newton ? "newton" : "poisson";
}
const char* to_string(ImpactOrder order) {
  return order == ImpactOrder::simultaneous ? "simultaneous" : "sequential";
}
ImpactLaw impact_law(const std::string& name) {
  for (const ImpactLaw law : {ImpactLaw::newton, ImpactLaw::poisson})
    if (name == to_string(law)) return law;
  throw std::invalid_argument("impact law = " + name + " must be newton or poisson");
}
ImpactOrder impact_order(const std::string& name) {
  for (const ImpactOrder order : {ImpactOrder::simultaneous, ImpactOrder::sequential})
    if (name == to_string(order)) return order;
  throw std::invalid_argument("impact order = " + name + " must be simultaneous or sequential");
}

void validate(const ImpactOptions& options) {
  require_field(options.max_pairs >= 1, "ImpactOptions::max_pairs", options.max_pairs, "be at least 1");
}

void validate(const JointOptions& options) {
  require_field(options.stabilisation >= 0 && options.stabilisation <= 1, "JointOptions::stabilisation",
                options.stabilisation, "lie in [0, 1]");
  require_field(options.tolerance > 0, "JointOptions::tolerance", options.tolerance, "be positive [m, rad]");
}

void validate(const AdvancementOptions& o) {
  require_field(o.enlargement >= 1 && o.enlargement <= 4, "AdvancementOptions::enlargement", o.enlargement,
                "lie in [1, 4]");
  require_field(o.floor > 0 && o.floor <= 1, "AdvancementOptions::floor", o.floor, "lie in (0, 1]");
  require_field(o.max_overlap >= 0 && o.max_overlap <= 0.99, "AdvancementOptions::max_overlap", o.max_overlap,
                "lie in [0, 0.99]");
  require_field(o.min_h > 0, "AdvancementOptions::min_h", o.min_h, "be positive [s]");
  require_field(o.growth >= 1 && o.growth <= 4, "AdvancementOptions::growth", o.growth, "lie in [1, 4]");
  require_field(o.max_attempts >= 1, "AdvancementOptions::max_attempts", o.max_attempts, "be at least 1");
}

void validate(const OdeOptions& o) {
  require_field(o.relative > 0 && o.relative < 1, "OdeOptions::relative", o.relative, "lie in (0, 1)");
  require_field(o.absolute > 0 && o.absolute < kInf, "OdeOptions::absolute", o.absolute,
                "be positive and finite");
  require_field(o.largest_step > 0, "OdeOptions::largest_step", o.largest_step, "be positive [s]");
  require_field(o.max_steps >= 1, "OdeOptions::max_steps", o.max_steps, "be at least 1");
}

void validate(const StepOptions& o) {
  require_field(std::isfinite(o.h) && o.h > 0, "StepOptions::h", o.h, "be positive [s]");
  require_field(o.threads >= 1, "StepOptions::threads", o.threads, "be at least 1");
  require_field(o.normal.correction_speed >= 0, "NormalLawOptions::correction_speed",
                o.normal.correction_speed, "not be negative [m/s]");
  require_field(std::isfinite(o.normal.touching) && o.normal.touching >= 0, "NormalLawOptions::touching",
                o.normal.touching, "be finite and not negative [m]");
  require_field(o.normal.gamma >= 0.5 && o.normal.gamma <= 1, "NormalLawOptions::gamma", o.normal.gamma,
                "lie in [0.5, 1]");
  validate(o.joints);
  validate(o.advancement);
  require_field(o.advancement.min_h <= o.h, "AdvancementOptions::min_h", o.advancement.min_h,
                "not exceed h [s]");
  validate(o.lmd);
  validate(o.reduction);
  validate(o.persistence);
  require(!o.persistence.anchors || o.reduction.friction == FrictionAt::contacts,
          "PersistenceOptions::anchors need ReductionOptions::friction at contacts: a patch has no point to "
          "pull back");
  validate(o.solver);
  const LmdOptions usual;
  require_field(o.lmd.threads == usual.threads || o.lmd.threads == o.threads, "StepOptions::lmd.threads",
                o.lmd.threads, "not be set: StepOptions::threads is for all");
  require(!o.solver.for_all, "StepOptions::solver.for_all must be empty: StepOptions::threads is for all");
}

void refuse_anchors(const StepOptions& options, const char* scheme) {
  require(!options.persistence.anchors, std::string("PersistenceOptions::anchors: ") + scheme +
                                            " has none; moreau_jean and moreau_jean_projected do");
}

}  // namespace aussois
