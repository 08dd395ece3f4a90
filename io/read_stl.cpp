// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <stdexcept>
#include <string>

#include "geometry/number_text.hpp"
#include "io/mesh_formats.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

constexpr std::size_t kHeader = 84;    // 80 bytes of text, then the number of triangles
constexpr std::size_t kTriangle = 50;  // normal and three corners of three floats each, then two bytes

std::size_t binary_size(std::string_view bytes) {
  return kHeader + kTriangle * std::size_t(load<std::uint32_t>(bytes, 80));
}

// The size decides, not the word "solid", which many programs write into the header of binary files, too. A
// text cannot pass by chance: its bytes 80 to 83 would announce some 10^8 triangles at least.
bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kHeader && bytes.size() == binary_size(bytes)) return true;
  return bytes.find('\0') != bytes.npos;  // no text, then: a binary file of the wrong size
}

MeshFile read_binary(const std::filesystem::path& path, std::string_view bytes) {
  const auto fail = [&](std::size_t byte, const std::string& what) {
    throw std::runtime_error(path.string() + ": byte " + std::to_string(byte) + ": " + what);
  };
  if (bytes.size() < kHeader)
    fail(bytes.size(), "file must have at least the 84 bytes of a binary STL header");
  const auto count = std::size_t(load<std::uint32_t>(bytes, 80));
  if (bytes.size() != binary_size(bytes))
    fail(80, counted_noun(std::int64_t(count), "triangle") +
                 (count == 1 ? " announced needs " : " announced need ") +
                 std::to_string(binary_size(bytes)) + " bytes, the file has " + std::to_string(bytes.size()));
  MeshFile mesh;
  mesh.vertices.reserve(3 * count);
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t byte = kHeader + kTriangle * t + 12 * (corner + 1);  // the normal comes first
      const Vec3 x = {load<float>(bytes, byte), load<float>(bytes, byte + 4), load<float>(bytes, byte + 8)};
      if (!x.allFinite())
        fail(byte,
             "triangle " + std::to_string(t) + ", corner " + std::to_string(corner) + " must be finite");
      mesh.vertices.push_back(x);
    }
    const int last = int(mesh.vertices.size()) - 1;
    mesh.triangles.push_back({last - 2, last - 1, last});
  }
  return mesh;
}

MeshFile read_ascii(const std::filesystem::path& path, std::string_view text) {
  TextReader in(path, text);
  const auto expect = [&](const char* word) {
    const std::string_view token = in.token();
    if (token.empty()) in.fail("file ends where " + quoted(word) + " must follow");
    if (token != word) in.fail(quoted(token) + " must be '" + word + "'");
  };
  MeshFile mesh;
  const auto read_facet = [&] {
    in.rest_of_line();  // the normal follows from the corners; some exporters write nan here
    expect("outer");
    expect("loop");
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      const double x = in.number(in.token(), "x");
      const double y = in.number(in.token(), "y");
      mesh.vertices.emplace_back(x, y, in.number(in.token(), "z"));
    }
    expect("endloop");
    expect("endfacet");
    const int last = int(mesh.vertices.size()) - 1;
    mesh.triangles.push_back({last - 2, last - 1, last});
  };
  expect("solid");
  in.rest_of_line();  // its name
  bool inside = true;
  for (std::string_view word = in.token(); !word.empty(); word = in.token()) {
    if (inside && word == "facet") {
      read_facet();
    } else if (word == (inside ? "endsolid" : "solid")) {
      in.rest_of_line();
      inside = !inside;
    } else {
      in.fail(quoted(word) + " must be " + (inside ? "'facet' or 'endsolid'" : "'solid'"));
    }
  }
  if (inside) in.fail("file ends where 'facet' or 'endsolid' must follow");
  return mesh;
}

}  // namespace

MeshFile read_stl(const std::filesystem::path& path, std::string_view bytes) {
  MeshFile mesh = is_binary(bytes) ? read_binary(path, bytes) : read_ascii(path, bytes);
  weld_mesh_file(mesh);  // every triangle brings its own three vertices
  return mesh;
}

}  // namespace aussois
