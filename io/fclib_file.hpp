// SPDX-License-Identifier: Apache-2.0
// One-step problems in the HDF5 layout of FCLIB, the library of frictional contact problems of Acary,
// Bremond, Koziara and Perignon [Acary2014]: what other codes have saved comes in, any step of ours goes out.
// Plain Coulomb and rolling problems are written so that FCLIB itself reads them; what FCLIB has no words for
// (mixed laws, compliance) goes to a group of another name, which it refuses. doc/fclib_file.md has the
// layout.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "nsgs/friction_problem.hpp"

namespace aussois {

/// A start or an answer; what the file does not have is empty.
struct FclibValues {
  VecX r{};  // impulses of the rows, m
  VecX u{};  // relative velocities of the rows, m
  VecX v{};  // generalised velocities, n (in a file of a LocalProblem of any size: it knows no bodies)
  VecX l{};  // impulses of the joints, p (the same)
};

struct FclibFile {
  std::variant<LocalProblem, FrictionProblem> problem{};
  std::string title{}, description{}, math_info{};  // without zeros inside
  std::vector<FclibValues> guesses{};               // starts, in the order of their numbers 1, 2, ...
  std::optional<FclibValues> solution{};
};

const std::vector<Law>& laws_of(const FclibFile& file);

/// The matrices in any of FCLIB's storages: compressed columns or rows, triplets; entries that are there
/// twice are summed. Numbers of matrices and vectors may be anything, also not finite. Throws
/// std::runtime_error "FILE: /dataset: what" with value and bound if the file is missing, damaged, or does
/// not fit together, and if it holds what no problem of ours can say (joints of a local problem).
FclibFile read_fclib(const std::filesystem::path& path);

/// Under a temporary name, then renamed; the same problem makes the same bytes. What read_fclib gives back is
/// the same to the last bit, but for fields that a law does not use. Throws std::invalid_argument with field,
/// value and bound if sizes do not fit together, std::runtime_error with the path if it cannot be written.
void write_fclib(const std::filesystem::path& path, const FclibFile& file);

}  // namespace aussois
