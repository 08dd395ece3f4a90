// SPDX-License-Identifier: Apache-2.0
// The internals of read_mesh: one reader per format, and what they share. Readers check every index and every
// coordinate; collapsed triangles, unused vertices and the scale are left to read_mesh.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

#include "io/mesh_file.hpp"

namespace aussois {

MeshFile read_obj(const std::filesystem::path& path, std::string_view text);
MeshFile read_stl(const std::filesystem::path& path, std::string_view bytes);
MeshFile read_ply(const std::filesystem::path& path, std::string_view bytes);
MeshFile read_off(const std::filesystem::path& path, std::string_view text);

/// Adds the fan of a polygon with at least three corners.
void add_polygon(MeshFile& mesh, std::span<const int> corners);

/// The number of type T at an offset; the caller has checked that it lies within the bytes.
template <class T>
T load(std::string_view bytes, std::size_t offset, std::endian order = std::endian::little) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

}  // namespace aussois
