// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/families/problem_families.hpp"

#include <array>
#include <cmath>

#include "geometry/check.hpp"

namespace aussois {
namespace {

constexpr std::array kFamilies{
    ProblemFamily{"box_stack", "n x n x n cubes, flush or with play between neighbours", box_stack},
    ProblemFamily{"kapla_tower", "crossed layers of flat planks, slightly turned", kapla_tower},
    ProblemFamily{"arch", "barrel vault of voussoirs near its least thickness and friction", arch},
    ProblemFamily{"bridge", "flat arch with deck slabs and a heavy load", bridge},
    ProblemFamily{"masonry_wall", "running bond with missing bricks in an earthquake", masonry_wall},
    ProblemFamily{"sphere_pile", "balls of several sizes settled in a bin", sphere_pile},
    ProblemFamily{"chain", "closed chain whose pins fill their holes up to a tiny clearance", chain},
    ProblemFamily{"gyroscopic", "columns of fast disks that drive each other, unsymmetric M", gyroscopic},
    ProblemFamily{"mass_ratio", "columns under a slab, densities over two to six decades", mass_ratio},
    ProblemFamily{"redundant_joints", "tables on parallel cranks with doubled hinges, loaded",
                  redundant_joints},
    ProblemFamily{"mixed_laws", "planks on rolling balls under hinged arms: every law of the solver",
                  mixed_laws},
    ProblemFamily{"impacts", "a pyramid of balls struck everywhere at once, with restitution", impacts},
};

}  // namespace

std::span<const ProblemFamily> problem_families() {
  return kFamilies;
}

const ProblemFamily& family_named(const std::string& name) {
  std::string names;
  for (const ProblemFamily& family : kFamilies) {
    if (name == family.name) return family;
    names += std::string(names.empty() ? "" : ", ") + family.name;
  }
  throw std::invalid_argument("family '" + name + "' must be one of " + names);
}

FrictionScene family_scene(const ProblemFamily& family, int contacts, std::uint64_t seed) {
  require_field(contacts >= 1 && contacts <= 1000000, "contacts", contacts, "lie in [1, 1000000]");
  Random random(seed);
  return family.scene(contacts, random);
}

FclibFile family_file(const ProblemFamily& family, int contacts, std::uint64_t seed) {
  const FrictionScene scene = family_scene(family, contacts, seed);
  return {.problem = friction_problem(scene),
          .title = family_file_stem(family, contacts, seed),
          .description = std::string(family.name) + ": " + family.what,
          .math_info = "h = " + std::to_string(scene.h) + " s"};
}

std::string family_file_stem(const ProblemFamily& family, int contacts, std::uint64_t seed) {
  return std::string(family.name) + "_n" + std::to_string(contacts) + "_s" + std::to_string(seed);
}

void disturb(FrictionScene& scene, Random& random) {
  scene.h = random.log_uniform(1e-4, 1e-2);
  if (random.index(3) > 0) {
    const double heading = random.uniform(0, 2 * kPi), strength = random.uniform(0, 0.5 * 9.81);
    scene.gravity += strength * Vec3(std::cos(heading), std::sin(heading), 0);
  }
  if (random.index(2) > 0) {
    const double speed = random.log_uniform(1e-4, 1e-1);
    for (SceneBody& body : scene.bodies) {
      if (body.mass == 0) continue;
      const double size = std::sqrt(body.inertia.trace() / body.mass);  // of the body [m]
      body.twist.head<3>() += random.vector(speed);
      body.twist.tail<3>() += random.vector(speed / size);
    }
  }
}

}  // namespace aussois
