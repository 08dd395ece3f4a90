// SPDX-License-Identifier: Apache-2.0
#include "integrators/scheme.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "integrators/event_driven.hpp"

namespace aussois {
namespace {

using Step = std::function<StepReport(State&, double)>;

/// All that the rest of the house knows about a scheme.
struct Entry {
  const char* name = "";
  SchemeTraits (*traits)(const SchemeOptions&) = nullptr;
  Step (*make)(const Model&, const SchemeOptions&) = nullptr;
  std::string (*settings)(const SchemeOptions&) = nullptr;  // that make it another method
  std::vector<SchemeOptions> (*variants)() = nullptr;
};

// The impact law and the gap over the step are of order one in h; the midpoint is of order two between.
SchemeTraits moreau_jean_traits(const SchemeOptions& o) {
  return {.nonsmooth = 1,
          .smooth = o.theta == 0.5 ? 2.0 : 1.0,
          .restitution = o.normal.law != NormalLaw::gap_over_step};
}

Step moreau_jean_step(const Model& model, const SchemeOptions& o) {
  const auto scheme =
      std::make_shared<const MoreauJean>(model, MoreauJeanOptions{.h = o.h,
                                                                  .theta = o.theta,
                                                                  .normal = o.normal,
                                                                  .joints = o.joints,
                                                                  .lmd = o.lmd,
                                                                  .reduction = o.reduction,
                                                                  .solver = o.solver,
                                                                  .advancement = o.advancement,
                                                                  .threads = o.threads});
  return [scheme](State& state, double h_limit) { return scheme->step(state, h_limit); };
}

std::string moreau_jean_settings(const SchemeOptions& o) {
  char text[40];
  std::snprintf(text, sizeof text, "theta %g %s", o.theta, to_string(o.normal.law));
  return text;
}

std::vector<SchemeOptions> moreau_jean_variants() {
  std::vector<SchemeOptions> out;
  for (const double theta : {0.5, 1.0})
    for (const NormalLaw law : {NormalLaw::moreau, NormalLaw::combined, NormalLaw::gap_over_step})
      out.push_back({.theta = theta, .normal = {.law = law}});
  return out;
}

// At the ends of steps the error is that of the tolerances. What a line between two of them misses is an
// impact between (order one) or a curve (order two).
SchemeTraits event_driven_traits(const SchemeOptions&) {
  return {.nonsmooth = 1, .smooth = 2};
}

Step event_driven_step(const Model& model, const SchemeOptions& o) {
  EventDrivenOptions options;
  const double tolerance = std::min(o.solver.tolerance, options.step.solver.tolerance);
  options.step = {.h = o.h,
                  .normal = o.normal,
                  .joints = o.joints,
                  .lmd = o.lmd,
                  .reduction = o.reduction,
                  .solver = o.solver,
                  .advancement = o.advancement,
                  .threads = o.threads};
  options.step.solver.tolerance = tolerance;
  const auto scheme = std::make_shared<const EventDriven>(model, options);
  return [scheme](State& state, double h_limit) { return scheme->step(state, h_limit); };
}

std::string no_settings(const SchemeOptions&) {
  return "";
}
// Its errors are those of tolerances: they do not fall with h, they grow with the number of starts.
std::vector<SchemeOptions> no_variants() {
  return {};
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {
      {"moreau_jean", moreau_jean_traits, moreau_jean_step, moreau_jean_settings, moreau_jean_variants},
      {"event_driven", event_driven_traits, event_driven_step, no_settings, no_variants},
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
