// SPDX-License-Identifier: Apache-2.0
// Coarser surfaces that stand for a part where the other body is far, each with a proven bound of how far it
// is off (LOD-1), (LOD-2).
#pragma once

#include <vector>

#include "lmd/lmd_shape.hpp"

namespace aussois {

inline constexpr int kMostLevels = 8;

struct ShapeLevel {
  // Dilated by `off` more than the part, so that its dilated shape contains the part's
  LmdShape shape{};
  // Neither base complex has a point farther than this from the other, tolerances of idealisation included
  // [m]
  double off = 0;
};

/// The levels of a shape from fine to coarse; the shape itself, level 0, is not among them.
struct ShapeLevels {
  std::vector<ShapeLevel> coarse{};
};

/// How many coarser levels a shape has.
int level_count(const LmdShape& shape);
/// The shape that stands for it on a level: the shape itself on level 0, its coarsest on levels beyond.
const LmdShape& level_shape(const LmdShape& shape, int level);
/// How far that is off: ShapeLevel::off, 0 for the shape itself [m].
double level_off(const LmdShape& shape, int level);

/// At most `count` levels, each with at most a quarter of the triangles of the one before. None for a complex
/// with wires or points, and where there are few triangles already. The same for any number of threads.
ShapeLevels make_levels(const LmdShape& shape, int count, int threads = 1);

}  // namespace aussois
