// SPDX-License-Identifier: Apache-2.0
#include "lmd/shape_levels.hpp"

#include <algorithm>

#include "geometry/coarse_surface.hpp"
#include "lmd/covering_distance.hpp"

namespace aussois {
namespace {

constexpr std::size_t kFewTriangles = 256;  // what is cheap anyway has no levels
constexpr double kFirst = 1.0 / 4;          // of the dilation: what the first level aims at
constexpr double kGrowth = 4;               // from level to level, as triangles over curved surfaces shrink
constexpr std::size_t kFewer =
    4;                          // times at least: all levels together have less than a third of the triangles
constexpr double kAgain = 1.5;  // where too many triangles are left
constexpr double kLargest = 1.0 / 8;  // of the bounding radius: coarser than that is of no use

ShapeLevel level_of(const LmdShape& shape, const SimplicialComplex& coarse, int threads) {
  ShapeLevel level{.shape = prepare({.complex = coarse, .radius = shape.radius}, {.threads = threads})};
  const SimplicialComplex& moved = level.shape.complex;  // onto chords of chains
  level.off = std::max(covering_distance(shape.complex, moved, threads),
                       covering_distance(moved, shape.complex, threads)) +
              2 * (shape.tolerance + level.shape.tolerance);
  level.shape.radius += level.off;
  return level;
}

// Null: the shape itself.
const ShapeLevel* level_at(const LmdShape& shape, int level) {
  const int k = std::min(level, level_count(shape));
  return k > 0 ? &shape.levels->coarse[k - 1] : nullptr;
}

}  // namespace

int level_count(const LmdShape& shape) {
  return shape.levels ? int(shape.levels->coarse.size()) : 0;
}

const LmdShape& level_shape(const LmdShape& shape, int level) {
  const ShapeLevel* at = level_at(shape, level);
  return at ? at->shape : shape;
}

double level_off(const LmdShape& shape, int level) {
  const ShapeLevel* at = level_at(shape, level);
  return at ? at->off : 0;
}

ShapeLevels make_levels(const LmdShape& shape, int count, int threads) {
  ShapeLevels out;
  if (!is_surface(shape.complex)) return out;
  std::size_t triangles = shape.complex.triangles.size();
  const double largest = kLargest * shape.bounding_radius;
  double aim = std::max(kFirst * shape.radius, 1e-5 * shape.bounding_radius);
  while (int(out.coarse.size()) < count && triangles > kFewTriangles && aim < largest) {
    const SimplicialComplex coarse = coarse_surface(shape.complex, aim);
    const std::size_t left = coarse.triangles.size();
    if (left == 0) break;
    if (left > triangles / kFewer) {
      aim *= kAgain;
      continue;
    }
    ShapeLevel level = level_of(shape, coarse, threads);
    if (level.off > largest) break;
    triangles = left;
    out.coarse.push_back(std::move(level));
    aim *= kGrowth;
  }
  return out;
}

}  // namespace aussois
