// SPDX-License-Identifier: Apache-2.0
// What preparation makes of a part, counted and drawn: regions, chains, classes, eroded and dilated surface.
#pragma once

#include "io/part_html.hpp"
#include "lmd/erosion.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

/// Simplices of the idealised complex by what they are to a contact (LMD-7): faces are the triangles of
/// regions, creases and wide edges are chains, corners and wide vertices are ends of chains, wires or points.
struct ClassCounts {
  int v_corner = 0, v_wide = 0, e_crease = 0, e_wide = 0, face = 0, silent = 0;
};
ClassCounts count_classes(const LmdShape& shape, const Idealisation& ideal);

/// Median over the chains with two regions of the angle by which the surface bends there, 0 for none [rad].
double median_bend(const SimplicialComplex& complex, const Idealisation& ideal);

/// The boundary of a dilated solid for pictures: faces moved outwards, convex edges and corners rounded with
/// a few strips. Where concave edges end in a corner, its ball is left out.
SurfaceLayer dilated_surface(const SimplicialComplex& solid, double radius);

/// Layers of the part, of the eroded part (if there is one) and of what the dilation makes of it.
PartPicture part_picture(const LmdShape& shape, const Idealisation& ideal, const SimplicialComplex& eroded,
                         const std::vector<int>& eroded_region);

}  // namespace aussois
