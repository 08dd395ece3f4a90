// SPDX-License-Identifier: Apache-2.0
#include "integrators/scheme.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "integrators/events/event_driven.hpp"

namespace aussois {
namespace {

using Step = std::function<StepReport(State&, double)>;

/// The step of a scheme that is made here and lives as long as its step does.
template <class S, class Options>
Step step_of(const Model& model, const Options& options) {
  return [scheme = std::make_shared<const S>(model, options)](State& state, double h_limit) {
    return scheme->step(state, h_limit);
  };
}

/// All that the rest of the house knows about a scheme.
struct Entry {
  const char* name = "";
  SchemeTraits (*traits)(const SchemeOptions&) = nullptr;
  Step (*make)(const Model&, const SchemeOptions&) = nullptr;
  std::string (*settings)(const SchemeOptions&) = nullptr;  // that make it another method
  std::vector<SchemeOptions> (*variants)() = nullptr;
};

// Moreau's law stops a body up to half a step before the plate: if that is where the step ends it falls once
// more, for a time O(sqrt h). With the other laws it ends closed (MJ-17), or overlapped by O(h) and is pushed
// out at a speed that does not depend on h.
double landing_order(NormalLaw law, double theta, bool stops_first, bool overlaps) {
  if (law == NormalLaw::moreau) return theta == 1 || stops_first ? 0.5 : 1;
  return overlaps ? 0 : 1;
}

bool speaks_of_the_mean(const SchemeOptions& o) {
  return o.theta == 0.5 && o.contacts == ContactsAt::midpoint && o.normal.law == NormalLaw::gap_over_step &&
         o.normal.gamma == 0.5;
}

// The impact law and the gap over the step are of order one in h; the midpoint is of order two between.
SchemeTraits moreau_jean_traits(const SchemeOptions& o) {
  return {.nonsmooth = 1,
          .smooth = o.theta == 0.5 ? 2.0 : 1.0,
          .rolling = speaks_of_the_mean(o) ? 2.0 : 1.0,
          .landing = landing_order(o.normal.law, o.theta, o.impact.order == ImpactOrder::sequential,
                                   o.theta < 1 && (o.normal.gamma < 1 || o.contacts == ContactsAt::end)),
          .restitution = o.normal.law != NormalLaw::gap_over_step || o.normal.gamma < 1,
          .pairwise = o.impact.order == ImpactOrder::sequential};
}

Step moreau_jean_step(const Model& model, const SchemeOptions& o) {
  return step_of<MoreauJean>(model, MoreauJeanOptions{.h = o.h,
                                                      .theta = o.theta,
                                                      .contacts = o.contacts,
                                                      .newton = o.newton,
                                                      .impact = o.impact,
                                                      .normal = o.normal,
                                                      .joints = o.joints,
                                                      .lmd = o.lmd,
                                                      .reduction = o.reduction,
                                                      .persistence = o.persistence,
                                                      .solver = o.solver,
                                                      .advancement = o.advancement,
                                                      .update = o.update,
                                                      .threads = o.threads,
                                                      .keep_problem = o.keep_problem});
}

std::string number(const char* format, double value) {
  char text[40];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

std::string moreau_jean_settings(const SchemeOptions& o) {
  std::string text = number("theta %g ", o.theta) + to_string(o.normal.law);
  if (o.normal.gamma < 1) text += number(" gamma %g", o.normal.gamma);
  if (o.contacts != ContactsAt::start) text += std::string(" contacts ") + to_string(o.contacts);
  if (o.newton.max_iterations > 1) text += " implicit";
  if (o.update != GroupUpdate::exponential) text += std::string(" ") + to_string(o.update);
  if (o.impact.law != ImpactLaw::newton) text += std::string(" ") + to_string(o.impact.law);
  if (o.impact.order != ImpactOrder::simultaneous) text += std::string(" ") + to_string(o.impact.order);
  return text;
}

std::vector<SchemeOptions> moreau_jean_variants() {
  std::vector<SchemeOptions> out;
  for (const double theta : {0.5, 1.0})
    for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined, NormalLaw::gap_over_step})
      out.push_back({.theta = theta, .normal = {.law = law}});
  out.push_back({.theta = 0.5, .contacts = ContactsAt::midpoint, .normal = {.law = NormalLaw::moreau}});
  out.push_back({.theta = 0.5,
                 .contacts = ContactsAt::midpoint,
                 .newton = {.max_iterations = 50},
                 .normal = {.law = NormalLaw::moreau}});
  out.push_back({.theta = 0.5,
                 .contacts = ContactsAt::midpoint,
                 .newton = {.max_iterations = 50},
                 .normal = {.law = NormalLaw::moreau},
                 .update = GroupUpdate::cayley});
  out.push_back({.theta = 1,
                 .contacts = ContactsAt::end,
                 .newton = {.max_iterations = 50},
                 .normal = {.law = NormalLaw::gap_over_step}});
  out.push_back({.theta = 0.5, .impact = {.law = ImpactLaw::poisson}, .normal = {.law = NormalLaw::moreau}});
  out.push_back(
      {.theta = 0.5, .impact = {.order = ImpactOrder::sequential}, .normal = {.law = NormalLaw::moreau}});
  return out;
}

StepOptions step_options(const SchemeOptions& o) {
  return {.h = o.h,
          .normal = o.normal,
          .joints = o.joints,
          .lmd = o.lmd,
          .reduction = o.reduction,
          .persistence = o.persistence,
          .solver = o.solver,
          .advancement = o.advancement,
          .update = o.update,
          .threads = o.threads,
          .keep_problem = o.keep_problem};
}

// The projection moves an impact to the wall, where it is, but not to the time when it was.
SchemeTraits projected_traits(const SchemeOptions& o) {
  return {.nonsmooth = 1,
          .smooth = o.theta == 0.5 ? 2.0 : 1.0,
          .landing = o.projection == ProjectionOrder::combined ? 0.5 : 1};
}

Step projected_step(const Model& model, const SchemeOptions& o) {
  MoreauJeanProjectedOptions options{.theta = o.theta, .order = o.projection, .step = step_options(o)};
  options.step.normal.law = NormalLaw::moreau;  // its own
  return step_of<MoreauJeanProjected>(model, options);
}

std::string projected_settings(const SchemeOptions& o) {
  return number("theta %g ", o.theta) + to_string(o.projection);
}

std::vector<SchemeOptions> projected_variants() {
  std::vector<SchemeOptions> out;
  for (const ProjectionOrder order : {ProjectionOrder::direct, ProjectionOrder::combined})
    out.push_back({.theta = 0.5, .projection = order, .normal = {.law = NormalLaw::moreau}});
  return out;
}

// Positions are of order two between impacts, but the velocities are those of the last path, half a step old.
SchemeTraits schatzman_paoli_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 1};
}

Step schatzman_paoli_step(const Model& model, const SchemeOptions& o) {
  SchatzmanPaoliOptions options{.theta = o.force_theta, .step = step_options(o)};
  options.step.normal.law = NormalLaw::gap_over_step;  // its own
  return step_of<SchatzmanPaoli>(model, options);
}

std::string schatzman_paoli_settings(const SchemeOptions& o) {
  return o.force_theta == 0 ? "central" : number("theta %g", o.force_theta);
}

std::vector<SchemeOptions> schatzman_paoli_variants() {
  return {{.normal = {.law = NormalLaw::gap_over_step}}};
}

// With the torque of the start the momentum of a free body is of order one (PMI-2).
SchemeTraits passive_midpoint_traits(const SchemeOptions& o) {
  return {.nonsmooth = 1,
          .smooth = o.gyroscopic == GyroscopicTerm::midpoint ? 2.0 : 1.0,
          .landing = landing_order(o.normal.law, 0.5, false, true),
          .restitution = o.normal.law != NormalLaw::gap_over_step};
}

Step passive_midpoint_step(const Model& model, const SchemeOptions& o) {
  return step_of<PassiveMidpoint>(model, PassiveMidpointOptions{.gyroscopic = o.gyroscopic,
                                                                .passive = o.passive,
                                                                .mean_joints = o.mean_joints,
                                                                .step = step_options(o)});
}

std::string passive_midpoint_settings(const SchemeOptions& o) {
  return std::string(o.gyroscopic == GyroscopicTerm::midpoint ? "midpoint " : "start ") +
         to_string(o.update) + " " + to_string(o.normal.law) + (o.mean_joints ? " mean joints" : "") +
         (o.passive ? "" : " not passive");
}

std::vector<SchemeOptions> passive_midpoint_variants() {
  std::vector<SchemeOptions> out;
  const auto add = [&](GyroscopicTerm gyroscopic, GroupUpdate update, NormalLaw law) {
    out.push_back({.normal = {.law = law}, .update = update, .gyroscopic = gyroscopic});
  };
  add(GyroscopicTerm::midpoint, GroupUpdate::cayley, NormalLaw::moreau);
  add(GyroscopicTerm::midpoint, GroupUpdate::cayley, NormalLaw::combined);
  add(GyroscopicTerm::midpoint, GroupUpdate::screw, NormalLaw::moreau);
  return out;  // without the torque of the start: its momentum has run away at the steps of a comparison
}

// Of order two between contacts for every spectral radius.
SchemeTraits generalised_alpha_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2, .restitution = true};
}

Step generalised_alpha_step(const Model& model, const SchemeOptions& o) {
  return step_of<GeneralisedAlpha>(
      model, GeneralisedAlphaOptions{.spectral_radius = o.spectral_radius, .step = step_options(o)});
}

std::string generalised_alpha_settings(const SchemeOptions& o) {
  return number("rho %g ", o.spectral_radius) + to_string(o.update);
}

std::vector<SchemeOptions> generalised_alpha_variants() {
  return {{.spectral_radius = 0.8},
          {.spectral_radius = 1},
          {.update = GroupUpdate::screw, .spectral_radius = 0.8}};
}

// The explicit trapezoidal rule between impacts.
SchemeTraits d1_minus_linear_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2, .restitution = true};
}

Step d1_minus_linear_step(const Model& model, const SchemeOptions& o) {
  return step_of<D1MinusLinear>(model, D1MinusLinearOptions{.step = step_options(o)});
}

std::string d1_minus_linear_settings(const SchemeOptions& o) {
  return to_string(o.update);
}

std::vector<SchemeOptions> d1_minus_linear_variants() {
  return {{}};
}

// At the ends of steps the error is that of the tolerances. What a line between two of them misses is an
// impact between (order one) or a curve (order two).
SchemeTraits event_driven_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2, .rolling = 2};
}

Step event_driven_step(const Model& model, const SchemeOptions& o) {
  EventDrivenOptions options{.ode = o.ode};
  const double tolerance = std::min(o.solver.tolerance, options.step.solver.tolerance);
  options.step = step_options(o);
  options.step.update = GroupUpdate::exponential;  // its path is the dense one of the integration
  options.step.solver.tolerance = tolerance;
  return step_of<EventDriven>(model, options);
}

std::string event_driven_settings(const SchemeOptions& o) {
  const OdeOptions usual;
  std::string text;
  if (o.ode.relative != usual.relative) text += number("relative %g ", o.ode.relative);
  if (o.ode.absolute != usual.absolute) text += number("absolute %g ", o.ode.absolute);
  return text.empty() ? text : text.substr(0, text.size() - 1);
}

// Its errors are those of tolerances: they do not fall with h, they grow with the number of starts.
std::vector<SchemeOptions> no_variants() {
  return {};
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {
      {"moreau_jean", moreau_jean_traits, moreau_jean_step, moreau_jean_settings, moreau_jean_variants},
      {"event_driven", event_driven_traits, event_driven_step, event_driven_settings, no_variants},
      {"moreau_jean_projected", projected_traits, projected_step, projected_settings, projected_variants},
      {"schatzman_paoli", schatzman_paoli_traits, schatzman_paoli_step, schatzman_paoli_settings,
       schatzman_paoli_variants},
      {"passive_midpoint", passive_midpoint_traits, passive_midpoint_step, passive_midpoint_settings,
       passive_midpoint_variants},
      {"generalised_alpha", generalised_alpha_traits, generalised_alpha_step, generalised_alpha_settings,
       generalised_alpha_variants},
      {"d1_minus_linear", d1_minus_linear_traits, d1_minus_linear_step, d1_minus_linear_settings,
       d1_minus_linear_variants},
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

SchemeOptions rolling_options(SchemeOptions others) {
  others.theta = 0.5;
  others.contacts = ContactsAt::midpoint;
  others.normal.law = NormalLaw::gap_over_step;
  others.normal.gamma = 0.5;
  return others;
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
