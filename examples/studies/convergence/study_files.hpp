// SPDX-License-Identifier: Apache-2.0
// Studies in files: JSON that reads back as the same bits, a table and a picture, and the orders of many
// studies as one page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "examples/studies/convergence/study.hpp"

namespace aussois {

/// "ball_e05_moreau_jean_theta_0.5_combined": the name of a study's files.
std::string stem_of(const Study& study);

/// All of a study as JSON text; infinite orders are null. `program` is program_digest().
std::string to_json(const Study& study, std::uint64_t program);
/// Of several, as a list.
std::string to_json(const std::vector<Study>& studies, std::uint64_t program);
/// Keeps it in a file, as this text.
void write_study(const std::filesystem::path& path, const Study& study, std::uint64_t program);
/// What was written by this program for the same case, scheme and options; nothing if there is no such file,
/// or it is of another study or damaged.
std::optional<Study> read_study(const std::filesystem::path& path, const Study& wanted,
                                std::uint64_t program);

/// DIR/STEM.csv (h, the errors, the pairwise orders), .gp and, where gnuplot is installed, .png: errors over
/// steps, with the slopes one and two. False: no picture.
bool write_picture(const std::filesystem::path& dir, const Study& study);

/// A table per scheme in Markdown: a row per case, a column per setting, the fitted orders of the four
/// measures; missed ones are bold, in brackets those of which theory promises less than one, "exact" stands
/// where nothing but rounding is left, a dash where the setting has no restitution, c where steps were
/// shortened at some step sizes.
std::string order_table(const std::vector<Study>& studies);

}  // namespace aussois
