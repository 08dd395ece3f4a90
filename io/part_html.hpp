// SPDX-License-Identifier: Apache-2.0
// Writes a part as one self-contained page: coloured layers of surfaces, lines and points, each with a
// switch, and a table of facts.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

using Colour = std::int32_t;  // 0xrrggbb

struct SurfaceLayer {
  std::string name{};
  std::vector<Vec3> vertices{};  // [m]
  std::vector<std::array<int, 3>> triangles{};
  std::vector<Colour> colour{};  // of each triangle
  double opacity = 1;            // in (0, 1]; below 1 only the side that faces the viewer is drawn
  bool shown = true;
};

struct LineLayer {
  std::string name{};
  std::vector<std::array<Vec3, 2>> lines{};  // [m]
  std::vector<Colour> colour{};              // of each line
  bool shown = true;
};

struct PointLayer {
  std::string name{};
  std::vector<Vec3> points{};  // [m]
  std::vector<Colour> colour{};
  bool shown = true;
};

struct PartPicture {
  std::string title{}, command_line{}, build{};
  std::vector<SurfaceLayer> surfaces{};
  std::vector<LineLayer> lines{};
  std::vector<PointLayer> points{};
  std::vector<std::pair<Colour, std::string>> legend{};
  std::vector<std::pair<std::string, std::string>> facts{};  // name and value, as shown
};

/// Writes the page atomically (see write_whole_file). Coordinates are moved near the origin before they
/// become float32. Throws std::invalid_argument if a layer does not have one colour for each item or a
/// triangle names a vertex that does not exist, std::runtime_error if the page cannot be written.
void write_part_html(const std::filesystem::path& html, const PartPicture& picture);

}  // namespace aussois
