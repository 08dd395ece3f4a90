// SPDX-License-Identifier: Apache-2.0
// One attempt of an erosion: moves the planes of a solid's regions inwards (ERO-1) and cuts each region anew
// from the border that the wavefront leaves it.
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
  std::vector<int> regions{};  // whose vertices may be tried unsplit
};

struct RegionOffset {
  Wavefront wave{};
  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> triangles{};
  std::vector<int> triangle_region{};
  std::optional<Failure> failure{};
};

/// `whole` marks the fans that may not be split.
RegionOffset offset_regions(const SimplicialComplex& solid, const Idealisation& ideal,
                            const std::vector<Fan>& fans, const std::vector<char>& whole,
                            const ErosionOptions& options);

/// Marks the fans around these regions that may deviate instead of being split; false if there are no more.
bool keep_whole(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                const std::vector<int>& regions, const ErosionOptions& options, std::vector<char>& whole);

}  // namespace aussois
