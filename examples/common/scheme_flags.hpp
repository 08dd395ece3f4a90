// SPDX-License-Identifier: Apache-2.0
// How a driver lets its user choose a scheme and set what the scheme knows.
#pragma once

#include "examples/common/setting_flags.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

struct SchemeFlags {
  SchemeFlags();  // not inline: with all options of all schemes it is long
  std::string scheme = "moreau_jean";
  std::vector<std::string> schemes = scheme_names();  // offered
  std::string not_offered{};                          // which are not, and why
  // Flags that the driver has itself, or that its models cannot use: most have shapes without levels
  std::vector<std::string> left_out{"--detail-levels"};
  std::filesystem::path selector{};  // instead of a reducer; empty: none
  int selector_body = 0;
  SchemeOptions options{};  // the defaults of the flags, and what has none
  SaidSettings said{};
};

/// Sets theta of all schemes that have one, for a driver that starts from another than the schemes do.
void start_from_theta(SchemeOptions& options, double theta);

/// The groups "scheme" and "solver": --scheme and the settings of schemes. `flags` must stay where it is.
/// Throws std::logic_error if options that share a flag differ: its default would be that of one of them.
void add_options(Cli& cli, SchemeFlags& flags);

/// Throws std::invalid_argument naming flag and readers, if the user set what the chosen scheme, or its
/// solver, clustering or matching, does not read.
void refuse_unread_flags(const Cli& cli, const SchemeFlags& flags);

/// What the user said. Throws std::runtime_error "path:line: ..." for a file of --selector that cannot be
/// read.
SchemeOptions scheme_options(const SchemeFlags& flags);
/// The same, with `others` for what the user did not say.
SchemeOptions scheme_options(const Cli& cli, const SchemeFlags& flags, SchemeOptions others);

/// All of the choice that the bits of a run depend on, one a line: the scheme, its settings, and the content
/// of a selector.
std::string choice_text(const SchemeFlags& flags, const SchemeOptions& options);

}  // namespace aussois
