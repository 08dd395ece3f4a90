// SPDX-License-Identifier: Apache-2.0
// Reads cables that the parts of an assembly hold, routed through clips (doc/howto/route_a_cable.md).
#pragma once

#include <string>
#include <vector>

#include "mechanics/beam.hpp"

namespace aussois {

/// Something on a part, in the frame of its mesh.
struct OnPart {
  bool moving = false;         // false: on the fixed part
  Vec3 at = Vec3::Zero();      // [m]
  Vec3 along = Vec3::UnitX();  // unit: of the cable, from its first end to its last
};

/// A point that the cable runs through, or a ring: then with the ring's direction.
struct CableStop {
  OnPart place{};                  // of a point, on the fixed part, only `at` counts
  double hole = 0, thickness = 0;  // of a ring: radius of its hole, diameter of its edge [m]; a point: 0
  bool is_clip() const { return hole > 0; }
};

struct RoutedCable {
  std::string name{};
  RoundSection section{};
  int elements = 0;              // in [2, 10000]
  OnPart from{}, to{};           // its first and last node are held there, with their direction
  std::vector<CableStop> via{};  // between them, at the start
  bool touches_itself = true;
  bool straight = false;  // without stress where it is straight; false: as it is laid
};

/// One cable, or a list of them, as the text of a JSON file. Names are unlike each other and `taken`. Throws
/// std::runtime_error naming `file` and what is wrong: the line, or the field, its value and its bound.
std::vector<RoutedCable> cables_in(const std::string& text, const std::string& file,
                                   const std::vector<std::string>& taken = {});
/// The name of a clip of a cable, counted from 1.
std::string clip_name(const RoutedCable& cable, int number);

}  // namespace aussois
