// SPDX-License-Identifier: Apache-2.0
// Checkpoints, with which a run stops and continues with the same bits: the state, the position in the output
// files, and what the driver counts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "mechanics/state.hpp"

namespace aussois {

struct Checkpoint {
  // Of model and options, made by the driver; must not change between the parts of a run
  std::uint64_t fingerprint = 0;
  std::int64_t step = 0;  // steps taken
  State state{};
  std::map<std::string, double> numbers{};       // running statistics of the driver
  std::map<std::string, std::int64_t> counts{};  // counters, rows of the output files
  // program_version() of the program that wrote it; when writing, empty means this one
  std::string program{};
};

/// The entry of that name. Throws std::runtime_error naming it and the program that left it out.
double checkpoint_number(const Checkpoint& checkpoint, const std::string& name);
std::int64_t checkpoint_count(const Checkpoint& checkpoint, const std::string& name);

/// Whether to continue the run of another program. If one program begins a run and another continues it, no
/// single program reproduces its bits.
enum class OtherProgram { refuse, accept };

/// Writes all bits (including -0.0 and subnormal numbers) as HDF5, by write_atomically: the last whole
/// checkpoint survives whatever ends the process here. Throws std::runtime_error with the path.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws std::runtime_error if
/// - the file is missing, truncated, damaged (the hash of the state is stored and compared), or of another
///   version of the format;
/// - another program wrote it, unless `other` accepts that; the message names both and --resume-anyway;
/// - its fingerprint is not `fingerprint`; the message names both.
Checkpoint read_checkpoint(const std::filesystem::path& path, std::uint64_t fingerprint,
                           OtherProgram other = OtherProgram::refuse);

/// 64-bit FNV-1a of a text. A fingerprint is made from the options, written as text, and the names of input
/// files.
std::uint64_t fingerprint_of(const std::string& text);

}  // namespace aussois
