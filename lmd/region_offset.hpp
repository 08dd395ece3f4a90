// SPDX-License-Identifier: Apache-2.0
// Makes one attempt at an erosion: moves the planes of a solid's regions inwards (ERO-1). Regions whose
// vertices stay apart keep their triangles; the others are triangulated anew from the border that the
// wavefront leaves them.
#pragma once

#include <optional>
#include <string>

#include "lmd/erosion.hpp"
#include "lmd/wavefront.hpp"

namespace aussois {

/// What stopped an attempt.
struct Failure {
  ErosionStatus status = ErosionStatus::done;
  Vec3 place = Vec3::Zero();
  std::string what{};
  std::vector<int> regions{};  // regions whose vertices may be tried unsplit
  // Edges or triangles that are in each other's way, given by their vertices in the wavefront
  std::vector<std::array<std::vector<int>, 2>> crossing{};
};

struct RegionOffset {
  Wavefront wave{};
  std::vector<Vec3> vertices{};
  std::vector<int> wave_vertex{};  // of each vertex, in `wave`; -1: inside a chain or region of the solid
  std::vector<std::array<int, 3>> triangles{};
  std::vector<int> triangle_region{};
  std::optional<Failure> failure{};
};

/// Events of the wavefront within `together` depths of each other are taken as one.
RegionOffset offset_regions(const SimplicialComplex& solid, const Idealisation& ideal,
                            const std::vector<Fan>& fans, const FanOptions& of_fan,
                            const ErosionOptions& options, double together);

/// Where parts cross, joins the vertices of the solid from which their nearest vertices come; false if all
/// are joined already, or if they bound a wall.
bool join_crossing(const Failure& failure, const Idealisation& ideal, const Wavefront& wave,
                   FanOptions& of_fan);

/// Marks the fans around these regions that may deviate instead of being split; false if no more are found.
bool keep_whole(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                const std::vector<int>& regions, const ErosionOptions& options, FanOptions& of_fan);

}  // namespace aussois
