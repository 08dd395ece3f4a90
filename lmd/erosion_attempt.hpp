// SPDX-License-Identifier: Apache-2.0
// From a solid to one that is eroded, by several ways to order and join the events of the wavefront; the
// first result that stands all checks is taken.
#pragma once

#include "geometry/surface_tree.hpp"
#include "lmd/region_offset.hpp"

namespace aussois {

struct ErosionTrial {
  RegionOffset made{};  // with what stopped the first way, if none leads to an eroded solid
  SimplicialComplex complex{};
};

/// `tree` is that of the solid.
ErosionTrial attempt_erosion(const SimplicialComplex& solid, const SurfaceTree& tree,
                             const Idealisation& ideal, const std::vector<Fan>& fans,
                             const ErosionOptions& options);

/// What the whole eroded surface must keep of the depth: digits of files and accepted deviations are forgiven
/// [m].
double least_depth(const Wavefront& wave, const ErosionOptions& options, double size);

}  // namespace aussois
