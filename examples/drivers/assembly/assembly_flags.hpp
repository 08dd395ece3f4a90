// SPDX-License-Identifier: Apache-2.0
// How a driver lets its user choose two parts and a path.
#pragma once

#include "examples/common/driver.hpp"
#include "examples/drivers/assembly/assembly_scene.hpp"

namespace aussois {

struct AssemblyFlags {
  std::filesystem::path data{}, fixed{}, moving{}, path{};
  std::string pair{}, builtin{};
  double scale = 1e-3;
  std::string gravity{};  // x,y,z; the driver's default
  AssemblyOptions scene{};
};

/// --data, --pair, --fixed, --moving, --path, --builtin, --scale, --cache.
void add_parts(Cli& cli, AssemblyFlags& flags);
void add_gravity(Cli& cli, AssemblyFlags& flags, const std::string& note);

/// Three numbers. Throws std::invalid_argument naming the flag.
Vec3 vector_of(const std::string& text, const char* flag);

/// The parts and the path that the user chose. Throws std::invalid_argument unless it is one kind of them.
AssemblyInput read_input(const AssemblyFlags& flags);

/// What a user should know of both parts: repairs of the meshes, what the cache could not do.
void print_warnings(const AssemblyInput& input, const AssemblyScene& scene);

}  // namespace aussois
