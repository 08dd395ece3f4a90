// SPDX-License-Identifier: Apache-2.0
// Meshes whose planes and borders are off by less than the tolerance of regions and chains, as those of CAD
// programs are after the repair.
#pragma once

#include <vector>

#include "geometry/mesh_repair.hpp"
#include "geometry/primitives.hpp"
#include "tests/support/mesh_damage.hpp"

namespace aussois {

/// A box of 1 m about the origin; the vertices of `front` stand between the left and the right lower corner
/// of its face y = -0.5 and its upper border, at (x, depth behind the face) each.
inline SimplicialComplex box_with_border(const std::vector<Vec2>& front) {
  std::vector<Vec3> v;
  for (const double y : {-0.5, 0.5})
    for (const double z : {-0.5, 0.5})
      for (const double x : {-0.5, 0.5}) v.emplace_back(x, y, z);
  std::vector<std::array<int, 3>> t{{4, 6, 7}, {4, 7, 5},   // back
                                    {0, 4, 5}, {0, 5, 1},   // below
                                    {0, 2, 6}, {0, 6, 4},   // left
                                    {1, 5, 7}, {1, 7, 3}};  // right
  std::vector<int> border{2};
  for (const Vec2& p : front) {
    border.push_back(int(v.size()));
    v.emplace_back(p.x(), -0.5 + p.y(), 0.5);
  }
  border.push_back(3);
  for (std::size_t i = 0; i + 1 < border.size(); ++i) {
    t.push_back({0, border[i + 1], border[i]});
    t.push_back({6, border[i], border[i + 1]});
  }
  t.push_back({0, 1, 3});
  t.push_back({6, 3, 7});
  return make_complex(v, t, {}, true);
}

/// Soups, T-junctions, needles and cuts of a cylinder, a box or a torus, put together again by the repair.
inline SimplicialComplex damaged_and_repaired(unsigned seed) {
  Random random(seed);
  LooseMesh mesh = loose(seed % 3 == 0   ? make_cylinder(0.5, 1, 12)
                         : seed % 3 == 1 ? make_box(1, 0.8, 0.6, 2)
                                         : make_torus(0.6, 0.2, 8, 6));
  for (int i = 0; i < 12; ++i) {
    const Cut kind{random.index(3)};
    cut_a_side(mesh, kind, 1e-3, random.log_uniform(1e-9, 1e-6), random);
  }
  return repair_mesh(complex_of(soup_of(mesh, 1e-8, random))).complex;
}

}  // namespace aussois
