// SPDX-License-Identifier: Apache-2.0
#include "integrators/scheme.hpp"

#include <memory>
#include <type_traits>

#include "geometry/settings.hpp"

namespace aussois {
namespace {

using Step = std::function<StepReport(State&, double)>;

/// All that other code uses of a scheme.
struct Entry {
  const char* name = "";
  Step (*make)(const Model&, const SchemeOptions&) = nullptr;
  std::string (*settings)(const SchemeOptions&) = nullptr;  // that make it another method
  std::vector<std::string> (*unread)() = nullptr;           // of the options of a step
  SchemeTraits (*traits)(const SchemeOptions&) = nullptr;
  std::vector<SchemeOptions> (*variants)() = nullptr;
};

template <class S>
StepOptions step_of(StepOptions step) {
  if constexpr (std::is_same_v<S, EventDriven>) step.solver.tolerance = SolverOptions{}.tolerance;
  return step;
}

/// The scheme S, whose options are the member `own`; null: it has none.
template <class S, auto own>
Entry entry_of(const char* name, SchemeTraits (*traits)(const SchemeOptions&),
               std::vector<SchemeOptions> (*variants)()) {
  constexpr bool kHasOwn = !std::is_null_pointer_v<decltype(own)>;
  Entry out{.name = name, .unread = &S::unread, .traits = traits, .variants = variants};
  out.make = [](const Model& model, const SchemeOptions& o) -> Step {
    std::shared_ptr<const S> scheme;
    if constexpr (kHasOwn)
      scheme = std::make_shared<const S>(model, step_of<S>(o.step), o.*own);
    else
      scheme = std::make_shared<const S>(model, o.step);
    return [scheme](State& state, double h_limit) { return scheme->step(state, h_limit); };
  };
  out.settings = [](const SchemeOptions& o) {
    std::string settings;
    if constexpr (kHasOwn) settings = label_of(o.*own);
    const std::string of_step = label_of(o.step);
    return settings + (settings.empty() || of_step.empty() ? "" : " ") + of_step;
  };
  return out;
}

// Moreau's law stops a body up to half a step before the plate: if that is where the step ends it falls once
// more, for a time O(sqrt h). With the other laws it ends closed (MJ-17).
double landing_order(NormalLaw law, double theta, bool stops_first) {
  return law == NormalLaw::moreau && (theta == 1 || stops_first) ? 0.5 : 1;
}

bool refers_to_the_mean(const MoreauJeanOptions& o) {
  return o.theta == 0.5 && o.contacts == ContactsAt::midpoint && o.law == NormalLaw::gap_over_step &&
         o.gamma == 0.5;
}

// The impact law and the gap over the step are of order one in h; the midpoint is of order two between.
SchemeTraits moreau_jean_traits(const SchemeOptions& options) {
  const MoreauJeanOptions& o = options.moreau_jean;
  return {.nonsmooth = 1,
          .smooth = o.theta == 0.5 ? 2.0 : 1.0,
          .rolling = refers_to_the_mean(o) ? 2.0 : 1.0,
          .landing = landing_order(o.law, o.theta, o.impact.order == ImpactOrder::sequential),
          .restitution = o.law != NormalLaw::gap_over_step || o.gamma < 1,
          .pairwise = o.impact.order == ImpactOrder::sequential};
}

std::vector<SchemeOptions> moreau_jean_variants() {
  std::vector<SchemeOptions> out;
  const auto add = [&](const MoreauJeanOptions& own, GroupUpdate update = GroupUpdate::exponential) {
    out.push_back({.step = {.update = update}, .moreau_jean = own});
  };
  for (const double theta : {0.5, 1.0})
    for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined, NormalLaw::gap_over_step})
      add({.theta = theta, .law = law});
  add({.theta = 0.5, .law = NormalLaw::moreau, .contacts = ContactsAt::midpoint});
  for (const GroupUpdate update : {GroupUpdate::exponential, GroupUpdate::cayley})
    add({.theta = 0.5,
         .law = NormalLaw::moreau,
         .contacts = ContactsAt::midpoint,
         .newton = {.max_iterations = 50}},
        update);
  add({.theta = 1,
       .law = NormalLaw::gap_over_step,
       .contacts = ContactsAt::end,
       .newton = {.max_iterations = 50}});
  add({.theta = 0.5, .law = NormalLaw::moreau, .impact = {.law = ImpactLaw::poisson}});
  add({.theta = 0.5, .law = NormalLaw::moreau, .impact = {.order = ImpactOrder::sequential}});
  return out;
}

// The projection moves an impact to the wall, where it is, but not to the time when it was.
SchemeTraits projected_traits(const SchemeOptions& options) {
  const MoreauJeanProjectedOptions& o = options.moreau_jean_projected;
  return {.nonsmooth = 1,
          .smooth = o.theta == 0.5 ? 2.0 : 1.0,
          .landing = o.order == ProjectionOrder::combined ? 0.5 : 1};
}

std::vector<SchemeOptions> projected_variants() {
  std::vector<SchemeOptions> out;
  for (const ProjectionOrder order : {ProjectionOrder::direct, ProjectionOrder::combined})
    out.push_back({.moreau_jean_projected = {.theta = 0.5, .order = order}});
  return out;
}

// Positions are of order two between impacts, but the velocities are those of the last path, half a step old.
SchemeTraits schatzman_paoli_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 1};
}

// With the torque of the start the momentum of a free body is of order one (PMI-2).
SchemeTraits passive_midpoint_traits(const SchemeOptions& options) {
  const PassiveMidpointOptions& o = options.passive_midpoint;
  return {.nonsmooth = 1,
          .smooth = o.gyroscopic == GyroscopicTerm::midpoint ? 2.0 : 1.0,
          .landing = landing_order(o.law, 0.5, false),
          .restitution = o.law != NormalLaw::gap_over_step};
}

// Without the torque of the start: its momentum has run away at the steps of a comparison.
std::vector<SchemeOptions> passive_midpoint_variants() {
  std::vector<SchemeOptions> out;
  const auto add = [&](GroupUpdate update, NormalLaw law) {
    out.push_back({.step = {.update = update},
                   .passive_midpoint = {.gyroscopic = GyroscopicTerm::midpoint, .law = law}});
  };
  add(GroupUpdate::cayley, NormalLaw::moreau);
  add(GroupUpdate::cayley, NormalLaw::combined);
  add(GroupUpdate::screw, NormalLaw::moreau);
  return out;
}

// Of order two between contacts for every spectral radius.
SchemeTraits generalised_alpha_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2, .restitution = true};
}

std::vector<SchemeOptions> generalised_alpha_variants() {
  return {{.generalised_alpha = {.spectral_radius = 0.8}},
          {.generalised_alpha = {.spectral_radius = 1}},
          {.step = {.update = GroupUpdate::screw}, .generalised_alpha = {.spectral_radius = 0.8}}};
}

// The explicit trapezoidal rule between impacts.
SchemeTraits d1_minus_linear_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2, .restitution = true};
}

// At the ends of steps the error is that of the tolerances. What a line between two of them misses is an
// impact between (order one) or a curve (order two).
SchemeTraits event_driven_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2, .rolling = 2};
}

std::vector<SchemeOptions> one_variant() {
  return {{}};
}
// Its errors are those of tolerances: they do not fall with h, they grow with the number of starts.
std::vector<SchemeOptions> no_variants() {
  return {};
}

const std::vector<Entry>& entries() {
  using O = SchemeOptions;
  static const std::vector<Entry> all = {
      entry_of<MoreauJean, &O::moreau_jean>("moreau_jean", moreau_jean_traits, moreau_jean_variants),
      entry_of<EventDriven, &O::event_driven>("event_driven", event_driven_traits, no_variants),
      entry_of<MoreauJeanProjected, &O::moreau_jean_projected>("moreau_jean_projected", projected_traits,
                                                               projected_variants),
      entry_of<SchatzmanPaoli, &O::schatzman_paoli>("schatzman_paoli", schatzman_paoli_traits, one_variant),
      entry_of<PassiveMidpoint, &O::passive_midpoint>("passive_midpoint", passive_midpoint_traits,
                                                      passive_midpoint_variants),
      entry_of<GeneralisedAlpha, &O::generalised_alpha>("generalised_alpha", generalised_alpha_traits,
                                                        generalised_alpha_variants),
      entry_of<D1MinusLinear, nullptr>("d1_minus_linear", d1_minus_linear_traits, one_variant),
  };
  return all;
}

const Entry& entry(const std::string& name) {
  std::string known;
  for (const Entry& e : entries()) {
    if (name == e.name) return e;
    known += (known.empty() ? "" : ", ") + std::string(e.name);
  }
  throw std::invalid_argument("scheme = " + name + " must be one of " + known);
}

}  // namespace

void describe(SettingVisitor& visit, SchemeOptions& o) {
  visit.begin("SchemeOptions");
  visit.group("step", o.step);
  visit.group("moreau_jean", o.moreau_jean);
  visit.group("moreau_jean_projected", o.moreau_jean_projected);
  visit.group("schatzman_paoli", o.schatzman_paoli);
  visit.group("passive_midpoint", o.passive_midpoint);
  visit.group("generalised_alpha", o.generalised_alpha);
  visit.group("event_driven", o.event_driven);
}

std::vector<std::string> scheme_names() {
  std::vector<std::string> names;
  for (const Entry& e : entries()) names.emplace_back(e.name);
  return names;
}

std::vector<SchemeVariant> scheme_variants() {
  std::vector<SchemeVariant> out;
  for (const Entry& e : entries())
    for (const SchemeOptions& options : e.variants()) out.push_back({e.name, options});
  return out;
}

std::vector<std::string> unread_by(const std::string& scheme) {
  static const std::vector<SettingValue> all = values_of(SchemeOptions{});
  std::vector<std::string> out;
  for (const std::string& path : entry(scheme).unread()) out.push_back("step." + path);
  for (const SettingValue& value : all) {
    const std::string of = value.path.substr(0, value.path.find('.'));
    if (of != "step" && of != scheme) out.push_back(value.path);
  }
  return out;
}

SchemeOptions rolling_options(const StepOptions& step) {
  return {.step = step,
          .moreau_jean = {
              .theta = 0.5, .law = NormalLaw::gap_over_step, .gamma = 0.5, .contacts = ContactsAt::midpoint}};
}

SchemeTraits scheme_traits(const std::string& name, const SchemeOptions& options) {
  return entry(name).traits(options);
}

Scheme make_scheme(const std::string& name, const Model& model, const SchemeOptions& options) {
  return {.name = name, .step = entry(name).make(model, options)};
}

std::string label(const std::string& name, const SchemeOptions& options) {
  const std::string settings = entry(name).settings(options);
  return settings.empty() ? name : name + " " + settings;
}

}  // namespace aussois
