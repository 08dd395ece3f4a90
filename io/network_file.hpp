// SPDX-License-Identifier: Apache-2.0
// Networks and learned selectors as text files: sizes, scaling, weights and places, with hexadecimal floats,
// so that what is read has the bits of what was written. doc/theory/peg_plate.md describes the format.
#pragma once

#include <filesystem>

#include "reduction/learned_selector.hpp"

namespace aussois {

/// Throw std::invalid_argument for what is not valid, std::runtime_error if the file cannot be written.
void write_network(const std::filesystem::path& path, const Network& network);
void write_selector(const std::filesystem::path& path, const LearnedSelector& selector);

/// Throw std::runtime_error "path:line: ..." for a file that is missing or not of this format. A selector's
/// file is also one of its network; the other way round there are no places, and read_selector throws.
Network read_network(const std::filesystem::path& path);
LearnedSelector read_selector(const std::filesystem::path& path);

}  // namespace aussois
