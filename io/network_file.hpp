// SPDX-License-Identifier: Apache-2.0
// A learned selector as a text file: sizes, scaling, weights and places, with hexadecimal floats, so that
// what is read has the bits of what was written. doc/theory/peg_plate.md describes the format.
#pragma once

#include <filesystem>

#include "reduction/learned_selector.hpp"

namespace aussois {

/// Throws std::invalid_argument for a selector that is not valid, std::runtime_error if the file cannot be
/// written.
void write_network(const std::filesystem::path& path, const LearnedSelector& selector);

/// Throws std::runtime_error "path:line: ..." for a file that is missing or not of this format.
LearnedSelector read_network(const std::filesystem::path& path);

}  // namespace aussois
