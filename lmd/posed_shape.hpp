// SPDX-License-Identifier: Apache-2.0
// What contact determination sees of a body: its geometry and its pose, no mass, no material.
#pragma once

#include <memory>

#include "geometry/se3.hpp"
#include "lmd/body_id.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

struct PosedShape {
  const LmdShape* shape = nullptr;
  SE3 g_ws{};                             // shape frame in the world
  BodyId body{};                          // copied into the features
  std::shared_ptr<const LmdShape> own{};  // owns `shape` if it was made for this pose alone
};

}  // namespace aussois
