// SPDX-License-Identifier: Apache-2.0
// Every reader of files as a target of libFuzzer. A reader may throw std::runtime_error and nothing else;
// what it gives back must be fit for its first use. doc/howto/fuzz_the_readers.md.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace aussois {

using Bytes = std::span<const unsigned char>;

struct FuzzedReader {
  std::string name{}, extension{};
  std::function<void(const std::filesystem::path& file, Bytes input)> make{};  // the file of an input
  std::function<void(const std::filesystem::path& file)> read{};               // and uses what came
};

/// OBJ, STL, PLY, OFF, networks, poses, tables, also unfinished ones: an input is the file, byte for byte.
std::vector<FuzzedReader> text_readers();

/// FCLIB problems, runs, runs that go on, checkpoints, cached shapes: an input is a list of changes of a good
/// file (hdf5_edits.hpp). Bytes that HDF5 itself cannot take are no matter of ours.
std::vector<FuzzedReader> hdf5_readers();

/// What drivers read beside that: tables of pairs, tosses, samples and series, cables, and what an earlier
/// call kept. An input is the file; for `kept` a digit that chooses the kind of result, then fields of it.
std::vector<FuzzedReader> driver_readers();

/// False: the reader that the environment variable AUSSOIS_FUZZ names refuses the input.
bool is_accepted(Bytes input);

/// The bytes as a file.
void write_input(const std::filesystem::path& file, Bytes input);

}  // namespace aussois
