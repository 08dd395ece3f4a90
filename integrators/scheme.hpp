// SPDX-License-Identifier: Apache-2.0
// Schemes by name, for studies that compare them, drivers that offer them and tests that loop over them. A
// scheme that is offered by name is a member of SchemeOptions, and a group and an entry in scheme.cpp.
// (CONV-7)
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "integrators/events/event_driven.hpp"
#include "integrators/schemes/d1_minus_linear.hpp"
#include "integrators/schemes/generalised_alpha.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "integrators/schemes/moreau_jean_projected.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "integrators/schemes/schatzman_paoli.hpp"

namespace aussois {

/// The options of a step and those of every scheme; each scheme reads its own.
struct SchemeOptions {
  StepOptions step{};
  MoreauJeanOptions moreau_jean{};
  MoreauJeanProjectedOptions moreau_jean_projected{};
  SchatzmanPaoliOptions schatzman_paoli{};
  PassiveMidpointOptions passive_midpoint{};
  GeneralisedAlphaOptions generalised_alpha{};
  EventDrivenOptions event_driven{};
};
void describe(SettingVisitor& visit, SchemeOptions& options);

struct Scheme {
  std::string name{};
  /// Advances the state by at most min(h, h_limit).
  std::function<StepReport(State&, double h_limit)> step{};
};

/// The orders that theory promises: the error is O(h^order).
struct SchemeTraits {
  double nonsmooth = 1;     // order across impacts and across changes between stick and slip
  double smooth = 1;        // order where no contact changes its state and closed contacts keep their normals
  double rolling = 1;       // the same, where closed contacts roll, slide or turn on curved surfaces
  double landing = 1;       // order in the graph of v where an impact brings a body to rest (CONV-9)
  bool restitution = true;  // false: every impact is plastic, whatever the law of the contact says
  bool pairwise = false;    // contacts that close at the same time are struck one after the other
};

/// Options of moreau_jean for bodies that roll on curved surfaces (rattleback, rolling disc): contacts at the
/// midpoint, slip and gap conditions on the mean velocity of the step (MJ-10). The order is two where that of
/// all other schemes is one; the price is that a body that hits bounces with e = 1.
SchemeOptions rolling_options(const StepOptions& step = {});

/// One way of using a scheme that is worth comparing with others.
struct SchemeVariant {
  std::string name{};
  SchemeOptions options{};
};

std::vector<std::string> scheme_names();
/// The options that a scheme does not read, "step.update", "moreau_jean.theta": those of the step are refused
/// if they are set, those of other schemes are not looked at.
std::vector<std::string> unread_by(const std::string& scheme);
/// Every scheme whose error depends on h, with every setting that makes it a different method: the rows of a
/// comparison.
std::vector<SchemeVariant> scheme_variants();

/// All throw std::invalid_argument for an unknown name, listing the known ones; make_scheme also for bad
/// options and models. It ignores "step.solver.tolerance" for event_driven, which has one of its own: a
/// comparison sets it for all schemes. The model must outlive the scheme.
SchemeTraits scheme_traits(const std::string& name, const SchemeOptions& options);
Scheme make_scheme(const std::string& name, const Model& model, const SchemeOptions& options);
Scheme make_scheme(const std::string& name, Model&& model, const SchemeOptions& options) = delete;

/// The name with the settings that make it a different method: "moreau_jean theta 0.5 combined".
std::string label(const std::string& name, const SchemeOptions& options);

}  // namespace aussois
