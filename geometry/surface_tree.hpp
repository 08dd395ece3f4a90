// SPDX-License-Identifier: Apache-2.0
// Finds how far a point is from a surface, and on which side. A hierarchy of boxes over the triangles of a
// complex, for checks and measurements; contacts have their own search.
#pragma once

#include <optional>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

/// A point of the surface.
struct SurfacePoint {
  Vec3 x = Vec3::Zero();   // [m]
  double distance = kInf;  // from the query point [m]
  int triangle = -1;
  int dim = 2;      // of the simplex that carries x in its interior: 0 vertex, 1 edge, 2 triangle
  int simplex = 0;  // its index in the complex
};

class SurfaceTree {
 public:
  /// Keeps a reference to the complex. Throws std::invalid_argument for a complex without triangles.
  explicit SurfaceTree(const SimplicialComplex& complex);
  explicit SurfaceTree(SimplicialComplex&&) = delete;

  /// The point of the triangles nearest to p; of several, the one in the first triangle found.
  SurfacePoint nearest(const Vec3& p) const;

  /// Distance of p from the surface, negative inside [m]. The side is that of the angle-weighted normal at
  /// the nearest point [Baerentzen2005]: correct for solids.
  double signed_distance(const Vec3& p) const { return signed_distance(p, nearest(p)); }
  double signed_distance(const Vec3& p, const SurfacePoint& foot) const;

  /// Length [m] of the ray from `origin` along the unit `direction` to the first triangle beyond the length
  /// `from` whose outward normal n has n . direction > least_cosine; nullopt if there is none.
  std::optional<double> first_exit(const Vec3& origin, const Vec3& direction, double from,
                                   double least_cosine) const;

  const Vec3& normal(int triangle) const { return normal_[triangle]; }  // unit; 0: no area

 private:
  struct Node {
    Box box{};
    int begin = 0, end = 0;     // range in items_
    int left = -1, right = -1;  // -1: a leaf
  };
  int build(int begin, int end, const std::vector<Box>& boxes, const std::vector<Vec3>& centres);

  const SimplicialComplex& complex_;
  std::vector<Node> nodes_{};
  std::vector<int> items_{};
  std::vector<Vec3> normal_{}, vertex_normal_{};
};

}  // namespace aussois
