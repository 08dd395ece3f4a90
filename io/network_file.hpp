// SPDX-License-Identifier: Apache-2.0
// Reads and writes networks and learned selectors as text files: sizes, scaling, weights and places. Floats
// are hexadecimal, so that they read back with the same bits. doc/theory/peg_plate.md describes the format.
#pragma once

#include <filesystem>

#include "reduction/learned_selector.hpp"

namespace aussois {

/// Throw std::invalid_argument for invalid input, std::runtime_error if the file cannot be written.
void write_network(const std::filesystem::path& path, const Network& network);
void write_selector(const std::filesystem::path& path, const LearnedSelector& selector);

/// Throw std::runtime_error "path:line: ..." for a file that is missing or not of this format. A selector's
/// file can also be read as its network. A network's file has no places, so read_selector throws.
Network read_network(const std::filesystem::path& path);
LearnedSelector read_selector(const std::filesystem::path& path);

}  // namespace aussois
