// SPDX-License-Identifier: Apache-2.0
#include "integrators/step_setting.hpp"

#include <chrono>
#include <cmath>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"

namespace aussois {

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
}

void refuse_anchors(const StepOptions& options, const char* scheme) {
  require(!options.persistence.anchors, std::string("PersistenceOptions::anchors: ") + scheme +
                                            " has none; moreau_jean and moreau_jean_projected do");
}

StepSetting step_setting(const Model& model, const StepOptions& options) {
  validate(model);
  validate(options);
  int undilated = 0;
  bool dynamic_undilated = false;
  for (const RigidBody& body : model.bodies) {
    if (body.shape < 0 || model.shapes[std::size_t(body.shape)]->radius > 0) continue;
    ++undilated;
    dynamic_undilated = dynamic_undilated || is_dynamic(body);
  }
  require(!options.advancement.certify || undilated < 2 || !dynamic_undilated,
          "two bodies that can touch have dilation 0: at least one of them needs a positive one [m]");
  StepSetting out{.model = model,
                  .options = options,
                  .dofs = dof_map(model),
                  .bounds = body_bounds(model),
                  .pieces = pieces_of_shapes(model)};
  out.laws = contact_laws(model);
  for (const RigidBody& body : model.bodies)
    out.shapes.push_back(body.shape < 0 ? nullptr : model.shapes[std::size_t(body.shape)].get());
  out.options.lmd.threads = options.threads;
  out.options.solver.for_all = [threads = options.threads](int n, const std::function<void(int)>& f) {
    parallel_for(n, threads, f);
  };
  return out;
}

ContactSet contacts_within(const StepSetting& setting, const State& state, double threshold) {
  const std::vector<double> reach(setting.model.bodies.size(), threshold / 2);
  std::vector<StepPair> pairs =
      pairs_within(setting.model, state, setting.bounds, reach, setting.options.threads);
  for (StepPair& pair : pairs) pair.threshold = threshold;
  return contacts_of(setting.model, state, pairs, setting.options.lmd);
}

double step_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace aussois
