// SPDX-License-Identifier: Apache-2.0
// The verification list on paper: results of a case in a file, all rows as text, as JSON and as a page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "examples/studies/verification/verification.hpp"

namespace aussois {

/// "A1.elastic_ball_at_the_midpoint", with the setting if there is one: the name of a case's file.
std::string stem_of(const VerificationCase& c);
/// Keeps the figures of a case as JSON that reads back as the same bits. `program` is a digest of the program
/// and of what it reads.
void write_measured(const std::filesystem::path& path, const VerificationCase& c, const Measured& measured,
                    std::uint64_t program);
/// What was written by this program for this case; nothing if there is no such file, or it is another's or
/// damaged.
std::optional<Measured> read_measured(const std::filesystem::path& path, const VerificationCase& c,
                                      std::uint64_t program);

/// A case and what was measured of it; nothing: not run.
struct Entry {
  const VerificationCase* asked = nullptr;
  std::optional<Measured> measured{};
};
using List = std::vector<Entry>;

/// How many rows of the list have this verdict. Cases that were not run have none.
int count(const List& list, Verdict verdict);
/// How many of the rows that hold are guards: their bounds say that nothing got worse, and no more.
int count_guards(const List& list);
/// Of the rows that are skipped, how many lack what.
std::map<std::string, int> missing(const List& list);
/// A line for each case, below it one for each row.
std::string to_text(const List& list);
/// {"cases": [{"case", "figure", "bound", "unit", "pass"}]}: `figure` and `pass` are null where the shared
/// data is missing, `figure` also where it is not finite. `sense` says what `bound` bounds: "<=", ">=", "=".
std::string to_json(const List& list);

/// The rows as Markdown, a table for each group: rows that are the same in several settings of a case in one
/// line, with the figure that is worst for their bound; one that is no number is worse than any.
std::string to_markdown(const List& list);
/// True if the page has the two lines between which the list stands; the next two ask for that.
bool has_list(const std::string& page);
std::string list_in(const std::string& page);
std::string with_list(const std::string& page, const std::string& markdown);
/// The rows but for their figures, the last column.
std::string without_figures(const std::string& markdown);

}  // namespace aussois
