// SPDX-License-Identifier: Apache-2.0
// How a driver lets its user choose a scheme and set what the scheme knows.
#pragma once

#include "examples/common/driver.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

struct SchemeFlags {
  std::string scheme = "moreau_jean";
  std::vector<std::string> schemes = scheme_names();  // offered
  std::string not_offered{};                          // which are not, and why
  std::string normal = to_string(NormalLawOptions{}.law), contacts = to_string(ContactsAt::start);
  std::string impact = to_string(ImpactLaw::newton), impact_order = to_string(ImpactOrder::simultaneous);
  std::string projection = to_string(ProjectionOrder::combined), update = to_string(GroupUpdate::exponential);
  std::string gyroscopic = "midpoint";
  std::string reducer = to_string(ReductionOptions{}.reducer);
  std::string clustering = to_string(ClusteringOptions{}.rule);
  std::filesystem::path selector{};  // instead of a reducer; empty: none
  int selector_body = 0;
  bool patch_friction = false, not_passive = false;
  double min_h = 0;         // AdvancementOptions::min_h [s]; 0: what the driver takes
  SchemeOptions options{};  // but for those names
};

/// The group "scheme": --scheme and the settings of schemes.
void add_options(Cli& cli, SchemeFlags& flags);

/// Throws std::invalid_argument naming flag, scheme and who reads the flag, if the user said what the chosen
/// scheme does not read.
void refuse_unread(const Cli& cli, const SchemeFlags& flags);

/// What the user said, all names resolved. Throws std::runtime_error "path:line: ..." for a file of
/// --selector that cannot be read.
SchemeOptions scheme_options(const SchemeFlags& flags);

}  // namespace aussois
