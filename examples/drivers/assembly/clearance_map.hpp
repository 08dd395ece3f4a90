// SPDX-License-Identifier: Apache-2.0
// How near each vertex of a part comes to another part over a way, and when.
#pragma once

#include <filesystem>
#include <vector>

#include "lmd/posed_shape.hpp"

namespace aussois {

struct ClearanceMap {
  std::vector<double> distance{};  // of each vertex, the least at the poses that were added [m]
  std::vector<int> pose{};         // at which; -1: none was nearer than the cutoff
  double between = 0;              // between two poses no vertex is nearer than its distance less this [m]
};

/// Asks a vertex again only if it may have come nearer than its record (CA-4).
class ClearanceMapper {
 public:
  /// `part` and `other` must outlive it; distances above `cutoff` [m] are not told apart.
  ClearanceMapper(const LmdShape& part, const LmdShape& other, double cutoff, int threads = 1);

  /// Another pose of the part, seen from the other.
  void add(const SE3& part_in_other);
  const ClearanceMap& map() const { return map_; }
  std::int64_t asked() const { return asked_; }  // distances that were computed

 private:
  const LmdShape &part_, &other_;
  int threads_;
  LmdShape point_;
  ClearanceMap map_{};
  std::vector<Vec3> asked_at_{};  // where a vertex was when it was asked last
  std::vector<double> then_{};    // and its distance there, or a lower bound
  std::vector<Vec3> last_{};
  int poses_ = 0;
  std::int64_t asked_ = 0;
};

/// The mesh of the part as PLY with the distance of each vertex as `quality` [m] and as a colour: dark blue
/// at zero to yellow at `largest`, grey beyond.
void write_clearance_ply(const std::filesystem::path& path, const SimplicialComplex& mesh,
                         const ClearanceMap& map, double largest);

}  // namespace aussois
