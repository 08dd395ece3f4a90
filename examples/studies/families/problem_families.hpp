// SPDX-License-Identifier: Apache-2.0
// Families of one-step problems of any size, from a seed: scenes that the public libraries have few or none
// of (doc/theory/problem_families.md).
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "examples/common/random.hpp"
#include "examples/studies/families/friction_scene.hpp"
#include "io/fclib_file.hpp"

namespace aussois {

struct ProblemFamily {
  const char* name;
  const char* what;
  FrictionScene (*scene)(int contacts, Random& random);  // with about that many contacts
};
std::span<const ProblemFamily> problem_families();
/// By its name; throws std::invalid_argument naming all.
const ProblemFamily& family_named(const std::string& name);
/// The same bits for the same arguments. Throws std::invalid_argument unless 1 <= contacts <= 1000000.
FrictionScene family_scene(const ProblemFamily& family, int contacts, std::uint64_t seed);
/// The problem of that scene as a file that tells where it comes from, and a name for it: box_stack_n300_s7.
FclibFile family_file(const ProblemFamily& family, int contacts, std::uint64_t seed);
std::string family_file_stem(const ProblemFamily& family, int contacts, std::uint64_t seed);

// stack_families.cpp
FrictionScene box_stack(int contacts, Random& random);
FrictionScene kapla_tower(int contacts, Random& random);
FrictionScene masonry_wall(int contacts, Random& random);
FrictionScene mass_ratio(int contacts, Random& random);
/// `side` x `side` x `levels` cubes of 0.1 m and 1 kg, with up to `play` [m] between neighbours.
FrictionScene cube_grid(int side, int levels, double play, const Law& law, Random& random);

// vault_families.cpp
FrictionScene arch(int contacts, Random& random);
FrictionScene bridge(int contacts, Random& random);
/// Half circle of mean radius 1 m on two fixed springers, `courses` of 0.2 m side by side. `thickness` [m]:
/// it stands above 0.1075 [Milankovitch1907] if friction is enough.
struct Vault {
  int voussoirs = 20, courses = 1;
  double thickness = 0.15, mu = 0.6;
};
FrictionScene vault(const Vault& spec);

// ball_families.cpp
FrictionScene sphere_pile(int contacts, Random& random);
FrictionScene impacts(int contacts, Random& random);

// machine_families.cpp
FrictionScene chain(int contacts, Random& random);
FrictionScene gyroscopic(int contacts, Random& random);
FrictionScene redundant_joints(int contacts, Random& random);
FrictionScene mixed_laws(int contacts, Random& random);

/// What the seed does to a scene at rest: the time step, in two of three cases an acceleration of the ground
/// up to half of gravity, in one of two velocities of the free bodies.
void disturb(FrictionScene& scene, Random& random);

}  // namespace aussois
