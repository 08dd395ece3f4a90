// SPDX-License-Identifier: Apache-2.0
// Reads and writes one-step problems in the HDF5 layout of FCLIB, the library of frictional contact problems
// by Acary, Bremond, Koziara and Perignon [Acary2014]. It reads what other codes have saved, and writes any
// step of ours. Plain Coulomb and rolling problems are written so that FCLIB itself reads them; what FCLIB
// cannot express (mixed laws, compliance) goes to a group of another name, which FCLIB refuses.
// doc/fclib_file.md has the layout.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "nsgs/friction_problem.hpp"

namespace aussois {

/// Initial values or a solution; what the file does not have is empty.
struct FclibValues {
  VecX r{};  // impulses of the rows, m
  VecX u{};  // relative velocities of the rows, m
  VecX v{};  // generalised velocities, n (of any size in the file of a LocalProblem, which knows no bodies)
  VecX l{};  // impulses of the joints, p (the same)
};

struct FclibFile {
  std::variant<LocalProblem, FrictionProblem> problem{};
  std::string title{}, description{}, math_info{};  // without null characters inside
  std::vector<FclibValues> guesses{};               // starts, in the order of their numbers 1, 2, ...
  std::optional<FclibValues> solution{};
};

const std::vector<Law>& laws_of(const FclibFile& file);

/// Reads matrices in any of FCLIB's storages: compressed columns or rows, triplets; duplicate entries are
/// summed. The values of matrices and vectors may be anything, including non-finite ones. Throws
/// std::runtime_error "FILE: /dataset: what" with value and bound if the file is missing, damaged or
/// inconsistent, or if it holds what our problems cannot express (joints of a local problem).
FclibFile read_fclib(const std::filesystem::path& path);

/// Writes under a temporary name, then renames; the same problem makes the same bytes. read_fclib gives back
/// the same data to the last bit, except for fields that a law does not use. Throws std::invalid_argument
/// with field, value and bound if sizes do not fit together, std::runtime_error with the path if the file
/// cannot be written.
void write_fclib(const std::filesystem::path& path, const FclibFile& file);

}  // namespace aussois
