// SPDX-License-Identifier: Apache-2.0
// The interface of bench_deformable to an engine, ours or a peer: ropes and soft blocks, stepped.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// A rope straight along x at rest: it hangs by its first end, or lies on a floor at z = 0, just above it.
struct RopeScene {
  int elements = 100;
  bool on_floor = false;
  double length = 1, radius = 5e-3;    // [m]
  double young = 5e6, density = 1100;  // [Pa, kg/m^3]
  double mu = 0.5;
};
/// A cube of tetrahedra, six to each of `cells`^3 cells, falls by a tenth of its side onto a floor at z = 0.
struct BlockScene {
  int cells = 6;
  double side = 0.1;                                  // [m]
  double young = 1e5, poisson = 0.4, density = 1000;  // [Pa, -, kg/m^3]
  double mu = 0.5;
};

/// A scene inside an engine. Owns everything; deleted with the last copy.
struct SoftRun {
  std::function<void()> step{};                 // by the h that the run was started with
  std::function<std::vector<Vec3>()> points{};  // along the rope, or of the block's mesh [m]
};

struct SoftEngine {
  std::string name{};
  /// Nothing if the engine has no such bodies, or too many for it to be worth while.
  std::function<std::optional<SoftRun>(const RopeScene&, double h)> rope{};
  std::function<std::optional<SoftRun>(const BlockScene&, double h)> block{};
};

SoftEngine aussois_soft_engine();
SoftEngine bullet_soft_engine();  // rope: capsules on ball joints; block: its implicit neo-Hookean solid
SoftEngine mujoco_soft_engine();  // rope: capsules on ball joints with the rope's stiffness

/// Ours first, then the peers found at configuration.
std::vector<SoftEngine> soft_engines();

}  // namespace aussois
