// SPDX-License-Identifier: Apache-2.0
// A run stopped and continued with the same bits: the state, where the output files stood, and what the
// driver counts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "mechanics/state.hpp"

namespace aussois {

struct Checkpoint {
  std::uint64_t fingerprint =
      0;                  // of model and options, made by the driver: what must not change between the parts
  std::int64_t step = 0;  // steps taken
  State state{};
  std::map<std::string, double> numbers{};       // running statistics of the driver
  std::map<std::string, std::int64_t> counts{};  // counters, rows of the output files
  std::string program{};  // program_version() of the one that wrote it; where it is written, empty: this one
};

/// The entry of that name. Throws std::runtime_error naming it and the program that left it out.
double checkpoint_number(const Checkpoint& checkpoint, const std::string& name);
std::int64_t checkpoint_count(const Checkpoint& checkpoint, const std::string& name);

/// A run that one program began and another goes on with has no program that gives its bits.
enum class OtherProgram { refuse, accept };

/// Writes all bits (also -0.0 and subnormal numbers) as HDF5, by write_atomically: the last whole checkpoint
/// survives whatever ends the process here. Throws std::runtime_error with the path.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws std::runtime_error if the file is missing, truncated, damaged (the hash of the state is stored and
/// compared), or of another version of the format; unless `other` accepts it, if another program wrote it
/// (the message names both and --resume-anyway); and if its fingerprint is not `fingerprint` (it names both).
Checkpoint read_checkpoint(const std::filesystem::path& path, std::uint64_t fingerprint,
                           OtherProgram other = OtherProgram::refuse);

/// 64-bit FNV-1a of a text: a fingerprint is made of the options written as text and the names of input
/// files.
std::uint64_t fingerprint_of(const std::string& text);

}  // namespace aussois
