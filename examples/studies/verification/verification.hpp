// SPDX-License-Identifier: Apache-2.0
// The verification list (doc/theory/verification_list.md) as data: what is run, which figures come out, and
// what each is held to. The driver `verify` prints the rows, the tests assert them, and the page is written
// from them.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace aussois {

/// What a figure must be of its bound. A figure that is not a number fulfils none.
enum class Sense { at_most, at_least, exactly };
bool holds(double figure, Sense sense, double bound);
const char* symbol(Sense sense);  // "<=", ">=", "="

/// A row of the list before it is measured.
struct Asked {
  std::string figure{};  // a word: the row is CASE.FIGURE
  std::string what{};    // what the figure is, a few words
  std::string unit{};    // "-" for a pure number
  double bound = 0;      // [unit]
  std::string source{};  // where the bound comes from
  Sense sense = Sense::at_most;
};

using Figures = std::map<std::string, double>;  // by Asked::figure

/// A set-up and its rows. Pure: the same figures whenever and on whichever thread it is run.
struct VerificationCase {
  std::string name{};     // "A1.energy_at_the_midpoint"; its first letter is the group
  std::string setting{};  // of a case that runs in several: the scheme, a law, a scene
  std::string what{};     // the set-up, one line
  std::vector<Asked> rows{};
  /// The figures of all rows. Throws NumericalFailure where a run does not come to its end, MissingData where
  /// it lacks the shared data.
  std::function<Figures()> measure{};
  bool slow = false;       // over ten seconds
  bool certified = false;  // its steps have their certificate, as schemes are delivered
};

/// All of them, sorted as on the page: groups A to S, in each by number. No two have name and
/// setting in common.
const std::vector<VerificationCase>& verification_cases();
std::vector<VerificationCase> impact_verification();         // group A
std::vector<VerificationCase> friction_verification();       // group B
std::vector<VerificationCase> mechanism_verification();      // group C
std::vector<VerificationCase> rotation_verification();       // group D
std::vector<VerificationCase> beam_verification();           // group E
std::vector<VerificationCase> beam_frame_verification();     // frames and loops of group E
std::vector<VerificationCase> solid_verification();          // group F
std::vector<VerificationCase> soft_contact_verification();   // contacts of group F
std::vector<VerificationCase> soft_part_verification();      // parts and stacks of group F
std::vector<VerificationCase> hertz_verification();          // smooth contacts of group F
std::vector<VerificationCase> soft_impact_verification();    // impacts of group F
std::vector<VerificationCase> order_verification();          // orders and events of exact motions, A to D
std::vector<VerificationCase> stack_verification();          // group G
std::vector<VerificationCase> balance_verification();        // group H
std::vector<VerificationCase> tree_verification();           // group J
std::vector<VerificationCase> cable_contact_verification();  // group K
std::vector<VerificationCase> knot_verification();           // loose knots of group K
std::vector<VerificationCase> belt_verification();           // belts of group K
std::vector<VerificationCase> soft_fold_verification();      // group S: self-contact
std::vector<VerificationCase> soft_repeat_verification();    // group S: the same bits
std::vector<VerificationCase> soft_oracle_verification();    // group S: slow ways to the same
std::vector<VerificationCase> soft_throw_verification();     // group S: nothing tunnels
std::vector<VerificationCase> insertion_verification();      // group P: pegs in holes

/// What became of a case.
struct Measured {
  Figures figures{};
  std::string failure{};  // why there are none
  std::string missing{};  // the data that it lacks; it neither holds nor fails
};
/// Runs it; throws std::logic_error if a figure of a row is missing, and what is no NumericalFailure or
/// MissingData.
Measured measure(const VerificationCase& c);

enum class Verdict { pass, fail, skipped };
Verdict verdict(const Asked& row, const Measured& measured);
/// The figure of a row; NaN if there is none.
double figure(const Asked& row, const Measured& measured);

/// "A1.energy_at_the_midpoint" or "B1.rest (event_driven)".
std::string full_name(const VerificationCase& c);
/// "A1.energy_at_the_midpoint.energy" or "B1.rest.creep (event_driven)".
std::string row_name(const VerificationCase& c, const Asked& row);
/// "<= 1e-12 m/s".
std::string bound_text(const Asked& row);

/// True if `name` is the case's, with or without its setting, one of its rows, or their beginning up to a dot
/// ("A5").
bool is_named(const VerificationCase& c, const std::string& name);

}  // namespace aussois
