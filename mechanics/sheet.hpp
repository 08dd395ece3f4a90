// SPDX-License-Identifier: Apache-2.0
// Sheets: membranes that bend about their inner edges, for cloth, bags and boots (doc/theory/sheets.md).
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "geometry/simplicial_complex.hpp"
#include "lmd/body_id.hpp"
#include "mechanics/coordinates.hpp"
#include "mechanics/material.hpp"

namespace aussois {

struct Model;
struct State;

/// Energy of the unit of rest area and thickness in plane stress (SHE-1), its derivatives by the two columns
/// of the gradient F of the place in the plane of a triangle.
struct MembraneStress {
  double energy = 0;      // [J/m^3]
  Vec6 P = Vec6::Zero();  // [Pa]
  Mat6 A = Mat6::Zero();  // dP/dF [Pa]
};
MembraneStress membrane_stress(const Material& material, const Eigen::Matrix<double, 3, 2>& F);

/// The angle between two triangles (x0, x1, x2) and (x1, x0, x3) about their edge (SHE-2), zero where they
/// are flat, and its derivatives by the places of x0 to x3.
struct HingeAngle {
  double angle = 0;  // in (-pi, pi)
  Eigen::Matrix<double, 12, 1> gradient{};
  Eigen::Matrix<double, 12, 12> hessian{};
};
HingeAngle hinge_angle(const std::array<Vec3, 4>& x);

struct SheetOptions {
  std::string name = "sheet";
  Material material{};                      // its viscosity must be 0
  double thickness = 0;                     // [m]
  SE3 place{};                              // of the mesh in the world
  double radius = 0;                        // of its surface [m]; 0: it has none and touches nothing
  bool touches_itself = false;              // but for parts nearer than four radii or two edges along it
  std::vector<std::array<bool, 3>> held{};  // axes along which each vertex is held; empty: none
};

struct Sheet {
  std::shared_ptr<const SimplicialComplex> mesh{};  // where it is laid, without stress
  BlockId points{};                                 // three coordinates for each vertex
  BodyId surface{};                                 // none without a radius
};

/// Adds the vertices of a mesh of triangles as points, the force between them and the surface. Throws
/// std::invalid_argument: field, value, bound.
Sheet add_sheet(Model& model, const SimplicialComplex& mesh, const SheetOptions& options);

/// Where the vertices are [m].
std::vector<Vec3> sheet_places(const Model& model, const State& state, const Sheet& sheet);

}  // namespace aussois
