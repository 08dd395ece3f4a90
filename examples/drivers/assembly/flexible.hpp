// SPDX-License-Identifier: Apache-2.0
// Cables that the parts of an assembly hold, routed through clips, as a JSON file describes them
// (doc/howto/route_a_cable.md).
#pragma once

#include <string>
#include <vector>

#include "examples/drivers/assembly/assembly_scene.hpp"
#include "mechanics/beam.hpp"

namespace aussois {

/// Something on a part, in the frame of its mesh.
struct OnPart {
  bool moving = false;         // false: on the fixed part
  Vec3 at = Vec3::Zero();      // [m]
  Vec3 along = Vec3::UnitX();  // of the cable, from its first end to its last; not zero
};

/// A point that the cable runs through, or a ring: then with the ring's direction.
struct CableStop {
  OnPart place{};                  // a point: on the fixed part, without a direction
  double hole = 0, thickness = 0;  // of a ring: radius of its hole, diameter of its edge [m]; a point: 0
  bool is_clip() const { return hole > 0; }
};

struct FlexibleCable {
  std::string name{};
  RoundSection section{};
  int elements = 0;              // in [2, 10000]
  OnPart from{}, to{};           // its first and last node are held there, with their direction
  std::vector<CableStop> via{};  // between them, at the start
  bool touches_itself = true;
  bool straight = false;  // without stress where it is straight; false: as it is laid
};

/// One cable, or a list of them, as the text of a file. Names are unlike each other and `taken`. Throws
/// std::runtime_error naming `file` and what is wrong: the line, or the field, its value and its bound.
std::vector<FlexibleCable> flexible_in(const std::string& text, const std::string& file,
                                       const std::vector<std::string>& taken = {});

/// Where a cable runs at the start: a smooth curve through its ends and what lies between, in the frame of
/// the fixed part, cut into equal elements. `moving` is the pose of the moving part's mesh.
std::vector<Vec3> route(const FlexibleCable& cable, const SE3& moving);

/// Adds them to the model, their ends and clips held by the parts, and to AssemblyScene::cables.
void add_flexible(AssemblyScene& scene, const std::vector<FlexibleCable>& cables);

}  // namespace aussois
