// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/step_setting.hpp"

#include <cmath>
#include <cstring>
#include <sstream>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "geometry/settings.hpp"
#include "integrators/pose/joint_rows.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

ModelSize size_of(const Model& model) {
  return {.bodies = model.bodies.size(),
          .shapes = model.shapes.size(),
          .joints = model.joints.size(),
          .couplings = model.couplings.size(),
          .coordinates = model.coordinates.size(),
          .gaps = model.gaps.size()};
}

// Nothing is put together unless it is off.
template <class Now, class Wanted>
void check_count(Now now, Wanted wanted, const char* what, const char* why) {
  if (std::size_t(now) != std::size_t(wanted))
    require_field(false, what, now, ("be " + std::to_string(wanted) + why).c_str());
}

template <class Values>
bool same_bits(const Values& a, const Values& b) {
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void check_shape(const Model& model, BodyId b, const BodyShape& then, const char* why) {
  const RigidBody& body = model.bodies[b];
  const bool same = body.shape == then.id && (!then.id || model.shapes[then.id] == then.shape),
             there =
                 same_bits(body.g_bs.p, then.g_bs.p) && same_bits(body.g_bs.R.coeffs(), then.g_bs.R.coeffs());
  if (!same || !there)
    require(false, std::string("model: ") + (same ? "g_bs" : "shape") + " of body " + to_string(b) + " (" +
                       body.name + ") must stay" + why);
}

}  // namespace

void refuse_deforming(const Model& model, const char* who) {
  for (const BodyId b : model.bodies.ids())
    require(!deforms(model.bodies[b]), std::string(who) + ": body " + to_string(b) + " (" +
                                           model.bodies[b].name + ") deforms; only rigid bodies may");
}

void refuse_carrying(const Model& model, const char* who) {
  for (const BodyId b : model.bodies.ids())
    require(!is_carried(model.bodies[b]),
            std::string(who) + ": body " + to_string(b) + " (" + model.bodies[b].name +
                ") is carried by a tree; only bodies with poses of their own may");
}

void refuse_unread_by(NormalLaw law, const StepOptions& options) {
  refuse_unread(options, {law == NormalLaw::moreau ? "correction_speed" : "touching"},
                std::string("normal law ") + to_string(law));
}

void refuse_restitution(const Model& model) {
  const char* bound = "be 0 with the normal law gap_over_step, which is plastic";
  for (const ContactLaw& law : contact_laws(model))
    require_field(law.restitution == 0, "ContactLaw::restitution", law.restitution, bound);
  for (const Joint& joint : model.joints)
    for (const JointAxis& axis : joint.axis)
      if (axis.restitution != 0)
        require_field(false, ("joint " + joint.name + ": restitution").c_str(), axis.restitution, bound);
}

StepSetting step_setting(const Model& model, const StepOptions& options, NormalLaw law, double gamma) {
  validate(model);
  validate(options);
  require_field(options.levels == 0 ||
                    std::ranges::any_of(model.shapes, [](const auto& shape) { return bool(shape->levels); }),
                "StepOptions::levels", options.levels,
                "be 0: no shape was prepared with LmdShapeOptions::levels");
  require(options.levels == 0 || options.advancement.certify,
          "StepOptions::levels needs AdvancementOptions::certify: contacts of levels alone prove nothing");
  int undilated = 0;
  bool dynamic_undilated = false;
  for (const RigidBody& body : model.bodies) {
    if (!body.shape || model.shapes[body.shape]->radius > 0) continue;
    ++undilated;
    dynamic_undilated = dynamic_undilated || has_inertia(body);
  }
  require(!options.advancement.certify || undilated < 2 || !dynamic_undilated,
          "two bodies that can touch have dilation 0: at least one of them needs a positive one [m]");
  if (options.persistence.anchors) refuse_deforming(model, "PersistenceOptions::anchors");
  StepSetting out{.model = model,
                  .size = size_of(model),
                  .options = options,
                  .normal = {.law = law,
                             .gamma = gamma,
                             .correction_speed = options.correction_speed,
                             .touching = options.touching},
                  .dofs = layout(model),
                  .bounds = body_bounds(model),
                  .pieces = pieces_of_shapes(model)};
  out.laws = contact_laws(model);
  for (const RigidBody& body : model.bodies) {
    out.body_shapes.push_back({body.shape, body.shape ? model.shapes[body.shape] : nullptr, body.g_bs});
    out.shapes.push_back(out.body_shapes.back().shape.get());
  }
  if (out.options.advancement.min_h == 0) out.options.advancement.min_h = std::min(1e-7, 1e-4 * options.h);
  out.options.lmd.threads = options.threads;
  out.options.solver.for_all = [threads = options.threads](int n, const std::function<void(int)>& f) {
    parallel_for(n, threads, f);
  };
  return out;
}

void check_fits(const StepSetting& setting, const State& state, double h_limit) {
  require_field(h_limit > 0, "h_limit", h_limit, "be positive [s]");
  const ModelSize now = size_of(setting.model), &then = setting.size;
  constexpr const char* kMade = ", as when the scheme was made: make a new one";
  check_count(now.bodies, then.bodies, "model: number of bodies", kMade);
  check_count(now.shapes, then.shapes, "model: number of shapes", kMade);
  check_count(now.joints, then.joints, "model: number of joints", kMade);
  check_count(now.couplings, then.couplings, "model: number of couplings", kMade);
  check_count(now.coordinates, then.coordinates, "model: number of blocks of coordinates", kMade);
  check_count(now.gaps, then.gaps, "model: number of gap functions", kMade);
  const int speeds = velocity_count(setting.model);
  const int coordinates = speeds - first_velocity(setting.model.bodies.next());
  check_count(setting.dofs.rows - setting.dofs.coordinates, coordinates, "model: number of coordinates",
              kMade);
  constexpr const char* kModel = ", as in the model: see rest_state";
  check_count(state.g.size(), now.bodies, "size of State::g", kModel);
  check_count(state.v.size(), speeds, "size of State::v", kModel);
  check_count(state.q.size(), coordinates, "size of State::q", kModel);
  check_count(state.u.size(), setting.model.inputs, "size of State::u", kModel);
  if (!state.turns.empty()) check_count(state.turns.size(), 3 * now.joints, "size of State::turns", kModel);
  if (state.r.size() > 0) check_count(state.r.size(), row_count(setting.model), "size of State::r", kModel);
  if (state.a.size() > 0) check_count(state.a.size(), 2 * speeds, "size of State::a", kModel);
  for (const BodyId b : state.g.ids()) {
    const RigidBody& body = setting.model.bodies[b];
    if (is_dynamic(body) != (setting.dofs.first[b] >= 0))
      require(false, "model: motion of body " + to_string(b) + " (" + body.name + ") must stay" + kMade);
    check_shape(setting.model, b, setting.body_shapes[b], kMade);
    const double square = state.g[b].R.squaredNorm();
    if (std::isfinite(square) && std::abs(square - 1) > 2e-6)
      require_field(false, ("State::g, body " + to_string(b) + " (" + body.name + "): |R|").c_str(),
                    std::sqrt(square), "be 1 within 1e-6");
  }
  validate(setting.model, state.memory);
}

std::string joint_that_is_off(const StepSetting& setting, const State& state) {
  if (state.h > 0) return "";
  const Model& model = setting.model;
  const double tolerance = setting.options.joints.tolerance;
  std::ostringstream text;
  text << "start: ";
  const auto told = [&] {
    text << ", at most " << tolerance << " is allowed; see consistent_state()";
    return text.str();
  };
  for (const JointId j : model.joints.ids()) {
    const JointError error = joint_error(model, state, j);
    const double worst = std::max(error.translation, error.rotation);
    if (worst <= tolerance || !std::isfinite(error.translation + error.rotation)) continue;
    text << "joint " << j << " (" << model.joints[j].name << ") is off by " << error.translation << " m and "
         << error.rotation << " rad";
    return told();
  }
  for (std::size_t i = 0; i < model.couplings.size(); ++i) {
    const Coupling& c = model.couplings[i];
    const double error = std::abs(coupling_row(model, c, state.g, state.turns).value);
    if (error <= tolerance || !std::isfinite(error)) continue;
    text << "coupling " << i << " (" << c.name << ") is off by " << error
         << (is_angle(model.joints[c.joint_1].kind, c.axis_1) ? " rad" : " m");
    return told();
  }
  return "";
}

ContactSet contacts_within(const StepSetting& setting, const State& state, double threshold) {
  check_fits(setting, state);
  const PerBody<double> reach(setting.model.bodies.size(), threshold / 2);
  std::vector<StepPair> pairs =
      pairs_within(setting.model, state, setting.bounds, reach, setting.options.threads);
  for (StepPair& pair : pairs) pair.threshold = threshold;
  return contacts_of(setting.model, state, pairs, setting.options.lmd);
}

}  // namespace aussois
