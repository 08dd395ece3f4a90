// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/verification.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include "examples/common/driver.hpp"
#include "examples/scenes/shared_series.hpp"

namespace aussois {
namespace {

std::string with_setting(const std::string& name, const VerificationCase& c) {
  return c.setting.empty() ? name : name + " (" + c.setting + ")";
}

/// Group and number: {'A', 10} of "A10.case".
std::pair<char, int> item(const VerificationCase& c) {
  return {c.name[0], std::stoi(c.name.substr(1))};
}

}  // namespace

bool holds(double figure, Sense sense, double bound) {
  switch (sense) {
    case Sense::at_most:
      return figure <= bound;
    case Sense::at_least:
      return figure >= bound;
    case Sense::exactly:
      return figure == bound;
  }
  return false;
}

const char* symbol(Sense sense) {
  return sense == Sense::at_most ? "<=" : sense == Sense::at_least ? ">=" : "=";
}

const std::vector<VerificationCase>& verification_cases() {
  static const std::vector<VerificationCase> all = [] {
    std::vector<VerificationCase> out;
    for (const auto& group : {impact_verification,        friction_verification,     mechanism_verification,
                              rotation_verification,      beam_verification,         beam_frame_verification,
                              solid_verification,         soft_contact_verification, soft_part_verification,
                              hertz_verification,         soft_impact_verification,  order_verification,
                              stack_verification,         balance_verification,      tree_verification,
                              cable_contact_verification, knot_verification,         belt_verification,
                              soft_fold_verification,     soft_repeat_verification,  soft_oracle_verification,
                              soft_throw_verification,    insertion_verification})
      for (VerificationCase& c : group()) out.push_back(std::move(c));
    std::ranges::stable_sort(out, {}, item);
    return out;
  }();
  return all;
}

Measured measure(const VerificationCase& c) {
  Measured out;
  try {
    out.figures = c.measure();
  } catch (const NumericalFailure& failure) {
    out.failure = failure.what();
    return out;
  } catch (const MissingData& missing) {
    out.missing = missing.what();
    return out;
  }
  for (const Asked& row : c.rows)
    if (!out.figures.contains(row.figure)) throw std::logic_error(row_name(c, row) + " is not measured");
  return out;
}

double figure(const Asked& row, const Measured& measured) {
  const auto found = measured.figures.find(row.figure);
  return found == measured.figures.end() ? std::numeric_limits<double>::quiet_NaN() : found->second;
}

Verdict verdict(const Asked& row, const Measured& measured) {
  if (!measured.missing.empty()) return Verdict::skipped;
  return holds(figure(row, measured), row.sense, row.bound) ? Verdict::pass : Verdict::fail;
}

std::string full_name(const VerificationCase& c) {
  return with_setting(c.name, c);
}

std::string row_name(const VerificationCase& c, const Asked& row) {
  return with_setting(c.name + "." + row.figure, c);
}

std::string bound_text(const Asked& row) {
  char text[64];
  std::snprintf(text, sizeof text, "%s %.4g", symbol(row.sense), row.bound);
  return row.unit == "-" ? text : std::string(text) + " " + row.unit;
}

bool is_named(const VerificationCase& c, const std::string& name) {
  if (name == full_name(c) || (c.name + ".").starts_with(name + ".")) return true;
  for (const Asked& row : c.rows)
    if (name == row_name(c, row) || name == c.name + "." + row.figure) return true;
  return false;
}

}  // namespace aussois
