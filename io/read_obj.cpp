// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <string>

#include "io/mesh_formats.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

using Words = std::span<const std::string_view>;

// Decoration that says nothing about the shape. Everything else that is not v, f, l, p is refused: free-form
// curves and surfaces would be lost without a word.
bool is_decoration(std::string_view keyword) {
  static constexpr std::string_view kDecoration[] = {
      "vt",     "vn",     "vp",    "g",        "o",        "s",   "mg",         "usemtl",   "mtllib",
      "usemap", "maplib", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"};
  return std::find(std::begin(kDecoration), std::end(kDecoration), keyword) != std::end(kDecoration);
}

class ObjReader {
 public:
  ObjReader(const std::filesystem::path& path, std::string_view text) : in_(path, text) {}

  MeshFile read() {
    std::vector<std::string_view> tokens;
    while (in_.next_line(tokens, '#', '\\')) {
      const std::string_view keyword = tokens[0];
      const Words words = Words(tokens).subspan(1);
      if (keyword == "v")
        add_vertex(words);
      else if (keyword == "f")
        add_polygon(mesh_, corners(words, 3));
      else if (keyword == "l")
        add_polyline(corners(words, 2));
      else if (keyword == "p")
        for (const int point : corners(words, 1)) mesh_.points.push_back(point);
      else if (!is_decoration(keyword))
        in_.fail("keyword " + quoted(keyword) + " must be v, f, l, p or decoration (vt, vn, g, usemtl ...)");
    }
    check_forward_references();
    return std::move(mesh_);
  }

 private:
  struct Reference {
    int line = 0, index = 0;
  };

  void add_vertex(Words words) {
    if (words.size() < 3)
      in_.fail("coordinates of the vertex = " + std::to_string(words.size()) + " must be at least 3");
    mesh_.vertices.emplace_back(in_.number(words[0], "x"), in_.number(words[1], "y"),
                                in_.number(words[2], "z"));
    for (const std::string_view weight_or_colour : words.subspan(3)) in_.number(weight_or_colour, "w");
  }

  void add_polyline(const std::vector<int>& corners) {
    for (std::size_t k = 0; k + 1 < corners.size(); ++k) mesh_.wires.push_back({corners[k], corners[k + 1]});
  }

  const std::vector<int>& corners(Words words, std::size_t at_least) {
    if (words.size() < at_least)
      in_.fail("corners = " + std::to_string(words.size()) + " must be at least " + std::to_string(at_least));
    corners_.clear();
    for (const std::string_view word : words) corners_.push_back(vertex_index(word));
    return corners_;
  }

  // v, v/vt, v//vn or v/vt/vn; v counts from 1, or from -1 backwards from the vertex read last.
  int vertex_index(std::string_view word) {
    const std::size_t slash = word.find('/');
    const auto count = std::int64_t(mesh_.vertices.size());
    const std::int64_t given = in_.integer(word.substr(0, slash), "vertex index");
    const std::int64_t index = given < 0 ? given + count : given - 1;
    if (given == 0 || index < 0 || index >= std::numeric_limits<int>::max()) fail_index(in_.line(), given);
    if (slash != word.npos) check_decoration(word.substr(slash + 1));
    if (index >= count) forward_.push_back({in_.line(), int(index)});
    return int(index);
  }

  // The texture and normal indices are not used, but letters there mean a broken file.
  void check_decoration(std::string_view rest) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    if (slash > 0) in_.integer(rest.substr(0, slash), "texture index");
    if (slash + 1 < rest.size()) in_.integer(rest.substr(slash + 1), "normal index");
  }

  // Vertices may follow the faces that name them; whether they did is known at the end.
  void check_forward_references() const {
    for (const Reference& reference : forward_)
      if (reference.index >= int(mesh_.vertices.size())) fail_index(reference.line, reference.index + 1);
  }

  [[noreturn]] void fail_index(int line, std::int64_t index) const {
    const std::string count = std::to_string(mesh_.vertices.size());
    in_.fail_at(line, "vertex index = " + std::to_string(index) + " must lie in [1, " + count + "] or [-" +
                          count + ", -1]");
  }

  TextReader in_;
  MeshFile mesh_{};
  std::vector<int> corners_{};
  std::vector<Reference> forward_{};
};

}  // namespace

MeshFile read_obj(const std::filesystem::path& path, std::string_view text) {
  return ObjReader(path, text).read();
}

}  // namespace aussois
