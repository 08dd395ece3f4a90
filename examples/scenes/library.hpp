// SPDX-License-Identifier: Apache-2.0
// Every scene there is, by its name, ready to run: cases with exact motions, scenes of the peers, mechanisms,
// tops, dimers and cables.
#pragma once

#include <string>
#include <vector>

#include "examples/scenes/cases.hpp"

namespace aussois {

struct LibraryScene {
  std::string name{};
  std::string what{};  // one line
  double t_end = 1;    // [s]
  double h = 1e-3;     // a sensible step [s]
  std::function<CaseScene()> make{};
};

/// Sorted by name.
const std::vector<LibraryScene>& library_scenes();
/// Throws std::invalid_argument naming those there are.
const LibraryScene& library_scene(const std::string& name);

}  // namespace aussois
