// SPDX-License-Identifier: Apache-2.0
// Lays cables in the scene of an assembly: along their route, their ends and clips held by the parts.
#pragma once

#include "examples/drivers/assembly/assembly_scene.hpp"
#include "examples/drivers/assembly/cable_file.hpp"

namespace aussois {

/// Where a cable runs at the start: a smooth curve through its ends and what lies between, in the frame of
/// the fixed part, cut into equal elements. `moving` is the pose of the moving part's mesh. Throws
/// std::invalid_argument if all its points are at one place.
std::vector<Vec3> route(const RoutedCable& cable, const SE3& moving);

/// Adds them to the model and to AssemblyScene::cables. Throws std::invalid_argument where an element turns
/// too far.
void lay_cables(const std::vector<RoutedCable>& cables, AssemblyScene& scene);

}  // namespace aussois
