// SPDX-License-Identifier: Apache-2.0
// Contacts as people and scripts read them: a table, a table of statistics, JSON, a page.
#pragma once

#include <filesystem>
#include <optional>

#include "examples/drivers/contacts/contact_pair.hpp"
#include "lmd/contact_kinematics.hpp"
#include "lmd/find_contacts.hpp"
#include "lmd/nesting.hpp"

namespace aussois {

/// One pose asked.
struct ContactQuery {
  SE3 pose{};             // of A in the frame of B
  ContactSet contacts{};  // of a path they are kept for a page only
  std::size_t contact_count = 0;
  double min_gap = kInf;  // [m]
  LmdStatistics count{};
  double ms = 0;                      // CPU
  std::optional<bool> bases_touch{};  // then contacts are missing: there a normal is not defined;
                                      // empty: not checked
  std::optional<Nesting> nesting{};   // of bases that do not touch: then contacts see nothing of it
  std::optional<bool> covered{};      // of bases that are no farther apart than the threshold (LMD-14)
};

struct ContactReport {
  const ContactPair* pair = nullptr;
  const LmdShape *a = nullptr, *b = nullptr;
  LmdOptions options{};
  std::string command_line{};
  std::vector<ContactQuery> queries{};
};

/// "V-F", "E-E", ...
std::string type_of(const ContactPoint& contact);

/// A line per contact, at most `rows` of them: type, gap, points, normal, angle margin, features.
std::string contact_table(const ContactReport& report, const ContactQuery& query, int rows);

/// Smallest, median, 95th percentile (nearest rank) and largest of what the poses of a path took and gave.
/// Gaps are those of the poses with a contact.
struct Quantiles {
  double smallest = 0, median = 0, p95 = 0, largest = 0;
};
Quantiles quantiles_of(std::vector<double> values);  // of none: all nan
std::string statistics_table(const ContactReport& report);

/// One pose: all its contacts; a path: a row of numbers per pose and their quantiles.
void write_contact_json(const std::filesystem::path& path, const ContactReport& report);

/// Both parts and all contacts at all poses, as a page that any browser shows.
void write_contact_page(const std::filesystem::path& html, const ContactReport& report);

}  // namespace aussois
