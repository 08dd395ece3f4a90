// SPDX-License-Identifier: Apache-2.0
// The peer for one number: FCL's smallest distance of two triangle meshes (OBBRSS trees, double). FCL's
// kernel of two triangles takes squared normals below 1e-15 for zero and then returns 0, so the meshes are
// scaled until the box of A is 100 long. In metres, FCL reported contact for screw_387266 and spot_link_dock,
// which do not touch.
#pragma once

#include <memory>

#include "geometry/simplicial_complex.hpp"

namespace aussois {

class FclPair {
 public:
  FclPair(const SimplicialComplex& a, const SimplicialComplex& b);
  ~FclPair();
  double distance(const SE3& g_a, const SE3& g_b) const;  // [m]; <= 0 if they touch

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aussois
