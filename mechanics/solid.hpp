// SPDX-License-Identifier: Apache-2.0
// Solids under finite strain: points with masses, the force between them, and a surface that touches what is
// in its way (doc/theory/solids.md).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "geometry/se3.hpp"
#include "lmd/body_id.hpp"
#include "mechanics/coordinates.hpp"
#include "mechanics/material.hpp"
#include "mechanics/solid_cells.hpp"

namespace aussois {

struct Model;
struct State;

enum class SolidMass {
  lumped,         // each point has what is around it
  redistributed,  // points that can touch give theirs to others of their cells (FEM-7)
};
inline constexpr Named<SolidMass> kSolidMasses[] = {{SolidMass::lumped, "lumped"},
                                                    {SolidMass::redistributed, "redistributed"}};

/// A change of volume below which a solid is refused [-].
inline constexpr double kSmallestVolume = 0.05;

struct SolidOptions {
  std::string name = "solid";
  std::vector<Material> materials{};  // of each group of the mesh
  SE3 place{};                        // of the mesh in the world
  bool smooth_strain = true;          // of tetrahedra, around edges
  bool mean_volume = true;            // around points, or in each hexahedron; for the neo-Hookean law
  SolidMass mass = SolidMass::lumped;
  std::vector<int> touching{};  // points that give their mass away; empty: those of the surface
  bool touches_itself = false;  // its surface, but for parts nearer than four radii or an edge along it
  double radius = 0;            // of its surface [m]; 0: it has none and touches nothing
  std::vector<std::array<bool, 3>> held{};  // axes along which each point is held; empty: none
};

struct Solid {
  std::shared_ptr<const VolumeMesh> mesh{};   // where it is laid, without stress
  BlockId points{};                           // three coordinates for each point of the mesh
  BodyId surface{};                           // none without a radius
  std::vector<int> surface_points{};          // the point under each vertex of its shape
  int massless = 0;                           // points without a mass
  std::shared_ptr<const SolidCells> cells{};  // where its energy is summed
  std::vector<Material> materials{};          // of each group of the mesh
};

/// Adds the points, the force between them and the surface. Throws std::invalid_argument: field, value,
/// bound.
Solid add_solid(Model& model, const VolumeMesh& mesh, const SolidOptions& options);

/// Where the points are [m].
std::vector<Vec3> solid_places(const Model& model, const State& state, const Solid& solid);
/// Cauchy stress of each cell, the mean over its rest volume [Pa].
std::vector<Mat3> solid_stresses(const Model& model, const State& state, const Solid& solid);
/// Von Mises' stress at each vertex of the surface: that of the mean over the cells around it [Pa].
std::vector<double> surface_stresses(const Model& model, const State& state, const Solid& solid);

/// A pressure that pushes on triangles of the surface from outside, and follows them [Pa] (FEM-8).
/// `triangles` as of boundary_triangles().
void add_pressure(Model& model, const Solid& solid, const std::vector<std::array<int, 3>>& triangles,
                  const std::function<double(double t)>& pressure);

}  // namespace aussois
