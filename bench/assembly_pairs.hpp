// SPDX-License-Identifier: Apache-2.0
// The pairs that a benchmark asks for: those of a data folder, or our own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "examples/drivers/assembly/assembly_input.hpp"

namespace aussois {

/// Words of a list, separated by commas.
std::vector<std::string> words_of(const std::string& list);

/// The pairs named in `list`; if it is empty, all of DATA/assembly/pairs.csv, or without data our own. Throws
/// std::invalid_argument if pairs are named without data, std::runtime_error for a table without pairs.
std::vector<std::string> pair_names(const std::filesystem::path& data, const std::string& list);

AssemblyInput read_pair(const std::filesystem::path& data, const std::string& name, double scale);

}  // namespace aussois
