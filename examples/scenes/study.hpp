// SPDX-License-Identifier: Apache-2.0
// A scheme on a case at several steps: errors, observed orders, and whether they are those that theory
// promises (CONV-5) to (CONV-7).
#pragma once

#include <array>
#include <functional>
#include <string>

#include "examples/scenes/cases.hpp"
#include "examples/scenes/error_measures.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

struct StudyOptions {
  double h = 0;            // largest step [s]; 0: the one of the case
  int levels = 6;          // step sizes, each about half of the one before, in [3, 16]
  int phases = 4;          // errors are means over so many lengths of the first step, in [1, 64]
  double tolerance = 0;    // of the solver, on the scaled residual [-], in [0, 1); 0: the one of the case
  std::string settings{};  // of the scheme, what its name does not tell; only kept with the results
};
void validate(const StudyOptions& options);  // throws std::invalid_argument: field, value, bound

struct Study {
  std::string case_name{}, scheme{};  // the latter with its settings
  StudyOptions options{};
  std::vector<double> h{};       // [s], descending
  std::vector<Errors> errors{};  // per step size
  Errors order{};                // fitted; infinity: nothing but rounding errors
  Errors expected{};             // by theory
  long steps = 0;                // taken
  long cut = 0;                  // of them shorter than asked for
};

/// Fitted orders may miss the promised ones by this: what the phases of the impacts leave of their scatter.
inline constexpr double kOrderSlack = 0.1;
bool as_expected(const Study& study);

/// False: the case asks for bounces, or for impacts at once, and the scheme has none.
bool applies(const Case& c, const SchemeTraits& traits);
/// Throws std::invalid_argument naming case, scheme and what does not fit, unless it applies.
void require_applies(const Case& c, const std::string& scheme, const SchemeOptions& options);
/// (CONV-7), with steps of the lengths h.
Errors expected_orders(const Case& c, const SchemeTraits& traits, const std::vector<double>& h);

/// From the scene's state to the end of the case; the first step has the part `phase` of the step h. Throws
/// NumericalFailure naming case, time and reason where a step fails.
ComputedMotion run_case(const Case& c, const std::string& scheme, const SchemeOptions& options, double phase);

/// The study, without certificates: they would cut the long steps, and with them the order. Steps and
/// tolerance of the scheme are those of `options`. `level_done` is called after each level and
/// ends the study early if it returns false.
Study study(const Case& c, const std::string& scheme, SchemeOptions scheme_options,
            const StudyOptions& options, const std::function<bool(int level)>& level_done = {});

/// Errors and pairwise orders as a table, fitted and expected orders below.
std::string to_string(const Study& study);

}  // namespace aussois
