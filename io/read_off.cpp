// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <string>

#include "io/mesh_formats.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

using Words = std::span<const std::string_view>;

class OffReader {
 public:
  OffReader(const std::filesystem::path& path, std::string_view text) : in_(path, text) {}

  MeshFile read() {
    Words words = read_keyword();
    if (words.empty()) words = line("the numbers of vertices and faces");
    if (words.size() < 2) in_.fail("line must hold the numbers of vertices and faces");
    const std::int64_t vertex_count = count(words[0], "number of vertices");
    const std::int64_t face_count = count(words[1], "number of faces");
    for (std::int64_t i = 0; i < vertex_count; ++i) add_vertex(line("a vertex"));
    for (std::int64_t i = 0; i < face_count; ++i) add_face(line("a face"));
    if (in_.next_line(tokens_, '#')) in_.fail("more lines than the header announces");
    return std::move(mesh_);
  }

 private:
  // OFF, COFF, NOFF, STOFF and their mixtures: positions come first, so the rest of a vertex line is not
  // needed.
  Words read_keyword() {
    const Words words = line("the keyword OFF");
    if (words[0] != "OFF" && words[0] != "COFF" && words[0] != "NOFF" && words[0] != "CNOFF" &&
        words[0] != "STOFF")
      in_.fail(quoted(words[0]) + " must be OFF, COFF, NOFF, CNOFF or STOFF");
    if (words.size() > 1 && words[1] == "BINARY")
      in_.fail("binary OFF is not read; convert it to text or PLY");
    return words.subspan(1);
  }

  Words line(const char* expected) {
    if (!in_.next_line(tokens_, '#')) in_.fail(std::string("file ends where ") + expected + " must follow");
    return tokens_;
  }

  std::int64_t count(std::string_view word, const char* name) const {
    const std::int64_t value = in_.integer(word, name);
    if (value < 0 || value > std::numeric_limits<int>::max())
      in_.fail(std::string(name) + " = " + std::to_string(value) + " must lie in [0, 2147483647]");
    return value;
  }

  void add_vertex(Words words) {
    if (words.size() < 3)
      in_.fail("coordinates of the vertex = " + std::to_string(words.size()) + " must be at least 3");
    mesh_.vertices.emplace_back(in_.number(words[0], "x"), in_.number(words[1], "y"),
                                in_.number(words[2], "z"));
  }

  void add_face(Words words) {
    const std::int64_t corner_count = in_.integer(words[0], "number of corners");
    if (corner_count < 3) in_.fail("corners = " + std::to_string(corner_count) + " must be at least 3");
    if (corner_count >= std::int64_t(words.size()))
      in_.fail("corners = " + std::to_string(corner_count) + " must be at most the " +
               std::to_string(words.size() - 1) + " numbers that follow");
    corners_.clear();
    for (const std::string_view word : words.subspan(1, std::size_t(corner_count))) {  // a colour may follow
      const std::int64_t index = in_.integer(word, "vertex index");
      if (index < 0 || index >= std::int64_t(mesh_.vertices.size()))
        in_.fail("vertex index = " + std::to_string(index) + " must lie in [0, " +
                 std::to_string(mesh_.vertices.size()) + ")");
      corners_.push_back(int(index));
    }
    add_polygon(mesh_, corners_);
  }

  TextReader in_;
  MeshFile mesh_{};
  std::vector<std::string_view> tokens_{};
  std::vector<int> corners_{};
};

}  // namespace

MeshFile read_off(const std::filesystem::path& path, std::string_view text) {
  return OffReader(path, text).read();
}

}  // namespace aussois
