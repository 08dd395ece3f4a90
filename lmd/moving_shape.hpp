// SPDX-License-Identifier: Apache-2.0
// A shape on the path of a step.
#pragma once

#include <memory>
#include <span>

#include "lmd/body_id.hpp"
#include "lmd/lmd_shape.hpp"
#include "lmd/motion_bound.hpp"

namespace aussois {

struct MovingShape {
  const LmdShape* shape = nullptr;  // at the start of the step
  SE3 g_bs{};                       // shape frame in the body frame
  RigidMotion motion{};
  // Constant velocities of the vertices of a deforming shape, in its frame [m/s]; empty: it does not deform
  std::span<const Vec3> velocity{};
  std::shared_ptr<const LmdShape> own{};  // owns `shape` if it was made for this path alone
  BodyId body{};  // two of one body: its shape meets itself, if LmdShape::self lets it
};

}  // namespace aussois
