// SPDX-License-Identifier: Apache-2.0
#include "nsgs/law.hpp"

#include <cmath>
#include <string>

#include "geometry/check.hpp"
#include "geometry/named.hpp"

namespace aussois {

constexpr Named<LawKind> kLawKinds[] = {
    {LawKind::coulomb, "coulomb"},     {LawKind::rolling, "rolling"},
    {LawKind::contensou, "contensou"}, {LawKind::unilateral, "unilateral"},
    {LawKind::bilateral, "bilateral"}, {LawKind::dry_friction, "dry_friction"}};

const char* to_string(LawKind kind) {
  return name_of(kind, kLawKinds);
}

void validate(const Law& law, std::size_t index) {
  const auto must = [&](bool condition, const char* name, double value, const char* bound) {
    if (condition) return;  // before any text is made: laws are many
    const std::string field = "laws[" + std::to_string(index) + "]." + name;
    require_field(false, field.c_str(), value, bound);
  };
  const auto non_negative = [&](const char* name, double value) {
    must(std::isfinite(value) && value >= 0, name, value, "be finite and >= 0");
  };
  const auto rows = [&](int low, int high, const char* bound) {
    must(law.rows >= low && law.rows <= high, "rows", law.rows, bound);
  };
  switch (law.kind) {
    case LawKind::coulomb:
      rows(2, 3, "be 2 or 3 of a coulomb law");
      break;
    case LawKind::rolling:
      rows(5, 5, "be 5 of a rolling law");
      break;
    case LawKind::contensou:
      rows(4, 4, "be 4 of a contensou law");
      break;
    case LawKind::bilateral:
      rows(1, kMaxRows, "lie in [1, 6] of a bilateral law");
      break;
    case LawKind::unilateral:
    case LawKind::dry_friction:
      rows(1, 1, "be 1 of this law");
      break;
  }
  non_negative("mu", law.mu);
  non_negative("mu_r", law.mu_r);
  non_negative("limit", law.limit);
  must(std::isfinite(law.radius) && law.radius > 0, "radius", law.radius, "be finite and > 0");
}

}  // namespace aussois
