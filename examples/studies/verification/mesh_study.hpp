// SPDX-License-Identifier: Apache-2.0
// Errors of elements on finer and finer meshes: what rows of groups E and F and the page of orders are made
// of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "examples/common/convergence.hpp"

namespace aussois {

struct MeshStudy {
  std::string name{};                  // of the case in the verification list
  std::string setting{};               // where it has several
  std::string error_of{}, unit{};      // what is off, "-" for a pure number
  std::string counted{};               // what the sizes count: "elements", "cells through the wall"
  std::vector<int> sizes{};            // ascending, at least 3
  double order = 2;                    // that theory promises
  std::function<double(int)> error{};  // of a size. Throws NumericalFailure, MissingData
};

std::vector<MeshStudy> beam_mesh_studies();
std::vector<MeshStudy> solid_mesh_studies();
/// All of them, in the order of the list.
const std::vector<MeshStudy>& mesh_studies();
/// The one of a name and setting; throws std::logic_error if there is none.
const MeshStudy& mesh_study(const std::string& name, const std::string& setting = {});

/// Errors over 1 / size. Throws as MeshStudy::error does.
Convergence measured(const MeshStudy& study);
/// A fitted order may fall short of that of theory by as much: the coarsest meshes are no limit yet.
inline constexpr double kMeshOrderSlack = 0.2;
bool reaches_its_order(const MeshStudy& study, const Convergence& result);

/// "E6.elastica": the name of its files.
std::string stem_of(const MeshStudy& study);
/// Keeps a result in a file; reads what this program wrote for the same sizes and shared data, if anything.
void write_mesh_study(const std::filesystem::path& path, const MeshStudy& study, const Convergence& result,
                      std::uint64_t program);
std::optional<Convergence> read_mesh_study(const std::filesystem::path& path, const MeshStudy& study,
                                           std::uint64_t program);
/// DIR/STEM.csv (1 / size, error, pairwise order), .gp and, where gnuplot is installed, .png: errors over
/// 1 / size, with the slope of theory. False: no picture.
bool write_picture(const std::filesystem::path& dir, const MeshStudy& study, const Convergence& result);

struct MeshResult {
  const MeshStudy* study = nullptr;
  Convergence errors{};
};
std::string to_json(const std::vector<MeshResult>& results, std::uint64_t program);
/// In Markdown, a row each: case, what is off, sizes, errors, fitted order, that of theory; missed ones are
/// bold.
std::string mesh_table(const std::vector<MeshResult>& results);

}  // namespace aussois
