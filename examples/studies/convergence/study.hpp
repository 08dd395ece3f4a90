// SPDX-License-Identifier: Apache-2.0
// A scheme on a case at several steps: errors, observed orders, and whether they are those that theory
// promises (CONV-5) to (CONV-7).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <utility>

#include "examples/common/run_watch.hpp"
#include "examples/scenes/cases.hpp"
#include "examples/studies/convergence/error_measures.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct StudyOptions {
  double h = 0;            // largest step [s]; 0: the one of the case
  int levels = 6;          // step sizes, each about half of the one before
  int phases = 4;          // errors are means over so many lengths of the first step
  double tolerance = 0;    // of the solver, on the scaled residual [-]; 0: the one of the case
  int certify = 0;         // places of each step at which its certificate is checked; 0: no check
  std::string settings{};  // of the scheme, what its name does not tell; only kept with the results
};
void validate(const StudyOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, StudyOptions& options);

using Reasons = std::array<std::string, kMeasures.size()>;

struct Study {
  std::string case_name{}, scheme{};  // the latter with its settings
  StudyOptions options{};
  std::vector<double> h{};       // [s], descending
  std::vector<Errors> errors{};  // per step size
  std::vector<long> cut{};       // per step size: steps shorter than asked for
  Errors order{};     // fitted where none is cut; infinity: nothing but rounding errors; nan: too few
  Errors expected{};  // by theory
  Reasons why{};      // theory expects that
  long steps = 0;     // taken
  RunAudit audit{};   // of all runs
};

/// Fitted orders may miss the promised ones by this: what the phases of the impacts leave of their scatter.
inline constexpr double kOrderSlack = 0.1;

/// The largest error where steps were shortened, over what whole ones of twice the length would leave, by the
/// errors of the coarsest level without any and the order expected, or order one; 0 where none was. More than
/// 1: shortened steps are worse than whole ones.
double shortened_error(const Study& study);

enum class OrderVerdict {
  met,         // all orders are those of theory, one or more
  less,        // they are, but theory promises less than one of some
  missed,      // one is below what theory promises, or shortened steps are worse than whole ones
  not_judged,  // too few step sizes without a step that was shortened
};
const char* to_string(OrderVerdict verdict);
OrderVerdict order_verdict(const Study& study);
/// Nothing that theory promises is missed: met or less.
bool as_expected(const Study& study);

/// False: the case asks for bounces, or for impacts at once, and the scheme has none.
bool applies(const Case& c, const SchemeTraits& traits);
/// Throws std::invalid_argument naming case, scheme and what does not fit, unless it applies.
void require_applies(const Case& c, const std::string& scheme, const SchemeOptions& options);
/// (CONV-7), with steps of the lengths h, and why.
std::pair<Errors, Reasons> expected_orders(const Case& c, const SchemeTraits& traits,
                                           const std::vector<double>& h);

/// From the scene's state to the end of the case; the first step has the part `phase` of the step h. Throws
/// NumericalFailure naming case, time and reason where a step fails.
ComputedMotion run_case(const Case& c, const std::string& scheme, const SchemeOptions& options, double phase);
/// The same, watched. A watch is of one run.
ComputedMotion run_case(const Case& c, const std::string& scheme, const SchemeOptions& options, double phase,
                        RunWatch& watch);

/// How the runs of a study are watched, but for the places of StudyOptions::certify. Names of files of
/// problems begin with "NAME_level_1_phase_1".
struct StudyWatch {
  WatchFlags flags{};
  std::string name{};
};

inline constexpr int kMoreLevels = 4;
/// The study, of the scheme as it is delivered: with its certificate, which shortens long steps that would
/// end too deep in each other, and with them their errors. Step sizes where that happens do not count as
/// levels: up to kMoreLevels shorter ones are added. Steps and tolerance of the scheme are those of
/// `options`; they are refused in `scheme_options`. `level_done` is called after each step size and ends the
/// study early if it returns false.
Study study(const Case& c, const std::string& scheme, SchemeOptions scheme_options,
            const StudyOptions& options, const std::function<bool(int level)>& level_done = {},
            const StudyWatch& watches = {});

/// Errors and pairwise orders as a table, fitted and expected orders below, the reasons of the latter, and
/// the verdict.
std::string to_string(const Study& study);

}  // namespace aussois
