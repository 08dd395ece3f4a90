// SPDX-License-Identifier: Apache-2.0
#include "io/volume_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "geometry/check.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// A mesh as a file has it: points and groups have any numbers.
struct Read {
  std::map<std::int64_t, Vec3> points{};
  struct Cell {
    std::vector<std::int64_t> corners{};
    std::int64_t group = 0;
    int line = 0;
  };
  std::vector<Cell> tets{}, hexes{};
  std::map<std::int64_t, std::string> names{};  // of groups
};

std::int64_t count_of(TextReader& in, const char* name) {
  const std::int64_t value = in.integer(in.token(), name);
  if (value < 0 || value > std::int64_t(1) << 40)
    in.fail(std::string(name) + " = " + std::to_string(value) + " must lie in [0, 2^40]");
  return value;
}

Vec3 read_place(TextReader& in) {
  const double x = in.number(in.token(), "x"), y = in.number(in.token(), "y"), z = in.number(in.token(), "z");
  return {x, y, z};
}

void add_point(TextReader& in, std::int64_t number, const Vec3& place, Read& out) {
  if (!out.points.emplace(number, place).second)
    in.fail("point " + std::to_string(number) + " must be given once");
}

class GmshReader {
 public:
  GmshReader(const std::filesystem::path& path, std::string_view text) : in_(path, text) {}

  Read read() {
    while (next_section()) {
      if (section_ == "MeshFormat")
        read_format();
      else if (section_ == "PhysicalNames")
        read_names();
      else if (section_ == "Entities")
        read_entities();
      else if (section_ == "Nodes")
        is_new_ ? read_new_nodes() : read_old_nodes();
      else if (section_ == "Elements")
        is_new_ ? read_new_elements() : read_old_elements();
      else {
        skip_section();
        continue;
      }
      if (const std::string_view end = in_.token(); end != "$End" + section_)
        in_.fail(quoted(end) + " must be $End" + section_);
    }
    return std::move(out_);
  }

 private:
  bool next_section() {
    const std::string_view word = in_.token();
    if (word.empty()) return false;
    if (word.size() < 2 || word[0] != '$')
      in_.fail(aussois::quoted(word) + " must begin a section, as $Nodes does");
    section_ = word.substr(1);
    if (!has_format_ && section_ != "MeshFormat")
      in_.fail(aussois::quoted(word) + " must follow $MeshFormat");
    return true;
  }
  void skip_section() {
    for (std::string_view word = in_.token(); word != "$End" + section_; word = in_.token())
      if (word.empty()) in_.fail("file ends within section " + section_);
  }

  void read_format() {
    const std::string version(in_.token());
    if (version != "2.2" && version != "4.1")
      in_.fail("version " + aussois::quoted(version) + " must be 2.2 or 4.1");
    if (in_.integer(in_.token(), "file type") != 0)
      in_.fail("binary files of Gmsh are not read: save the mesh as text");
    in_.rest_of_line();
    is_new_ = version == "4.1";
    has_format_ = true;
  }
  void read_names() {
    for (std::int64_t k = count_of(in_, "number of names"); k > 0; --k) {
      const std::int64_t dimension = in_.integer(in_.token(), "dimension"),
                         number = in_.integer(in_.token(), "physical number");
      const std::string line(in_.rest_of_line());
      const std::size_t from = line.find('"'), to = line.rfind('"');
      if (from == std::string::npos || to == from) in_.fail("the name of a group must stand in quotes");
      if (dimension == 3) out_.names[number] = line.substr(from + 1, to - from - 1);
    }
  }
  // Which physical group each volume belongs to.
  void read_entities() {
    std::array<std::int64_t, 4> counts{};
    for (std::int64_t& count : counts) count = count_of(in_, "number of entities");
    for (std::size_t dimension = 0; dimension < 4; ++dimension)
      for (std::int64_t k = 0; k < counts[dimension]; ++k) {
        const std::int64_t number = in_.integer(in_.token(), "entity");
        for (int i = 0; i < (dimension == 0 ? 3 : 6); ++i) in_.number(in_.token(), "bound");
        std::int64_t group = 0;
        for (std::int64_t i = count_of(in_, "number of physical groups"); i > 0; --i) {
          const std::int64_t own = in_.integer(in_.token(), "physical group");
          if (group == 0) group = own;
        }
        if (dimension == 3) group_of_volume_[number] = group;
        if (dimension > 0)
          for (std::int64_t i = count_of(in_, "number of bounding entities"); i > 0; --i)
            in_.integer(in_.token(), "bounding entity");
      }
  }

  void read_old_nodes() {
    for (std::int64_t k = count_of(in_, "number of nodes"); k > 0; --k) {
      const std::int64_t number = in_.integer(in_.token(), "node");
      add_point(in_, number, read_place(in_), out_);
    }
  }
  void read_new_nodes() {
    std::int64_t blocks = count_of(in_, "number of blocks");
    for (int i = 0; i < 3; ++i) count_of(in_, "number of nodes");
    for (; blocks > 0; --blocks) {
      in_.integer(in_.token(), "dimension");
      in_.integer(in_.token(), "entity");
      if (in_.integer(in_.token(), "parametric") != 0)
        in_.fail("parametric nodes are not read: save without");
      std::vector<std::int64_t> numbers;
      for (std::int64_t k = count_of(in_, "nodes of the block"); k > 0; --k)
        numbers.push_back(in_.integer(in_.token(), "node"));
      for (const std::int64_t number : numbers) add_point(in_, number, read_place(in_), out_);
    }
  }

  void read_old_elements() {
    for (std::int64_t k = count_of(in_, "number of elements"); k > 0; --k) {
      in_.integer(in_.token(), "element");
      const std::int64_t type = in_.integer(in_.token(), "type");
      std::int64_t group = 0;
      const std::int64_t tags = count_of(in_, "number of tags");
      for (std::int64_t i = 0; i < tags; ++i) {
        const std::int64_t tag = in_.integer(in_.token(), "tag");
        if (i == 0) group = tag;
      }
      read_corners(type, group);
    }
  }
  void read_new_elements() {
    std::int64_t blocks = count_of(in_, "number of blocks");
    for (int i = 0; i < 3; ++i) count_of(in_, "number of elements");
    for (; blocks > 0; --blocks) {
      const std::int64_t dimension = in_.integer(in_.token(), "dimension"),
                         entity = in_.integer(in_.token(), "entity"), type = in_.integer(in_.token(), "type");
      const auto found = group_of_volume_.find(entity);
      const std::int64_t group = dimension == 3 && found != group_of_volume_.end() ? found->second : 0;
      for (std::int64_t k = count_of(in_, "elements of the block"); k > 0; --k) {
        in_.integer(in_.token(), "element");
        read_corners(type, group);
      }
    }
  }
  void read_corners(std::int64_t type, std::int64_t group) {
    // Points, lines, triangles, quadrangles, tetrahedra, hexahedra of the first order
    static const std::map<std::int64_t, int> corners{{15, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 4}, {5, 8}};
    const auto count = corners.find(type);
    if (count == corners.end())
      in_.fail(
          "element type " + std::to_string(type) +
          " is not read: only points, lines, triangles, quadrangles, tetrahedra and hexahedra of order one");
    Read::Cell cell{.group = group};
    for (int i = 0; i < count->second; ++i) cell.corners.push_back(in_.integer(in_.token(), "corner"));
    cell.line = in_.line();
    if (type == 4)
      out_.tets.push_back(std::move(cell));
    else if (type == 5)
      out_.hexes.push_back(std::move(cell));
  }

  TextReader in_;
  Read out_{};
  std::string section_{};
  bool has_format_ = false, is_new_ = false;
  std::map<std::int64_t, std::int64_t> group_of_volume_{};
};

class MeditReader {
 public:
  MeditReader(const std::filesystem::path& path, std::string_view text) : in_(path, text) {}

  Read read() {
    std::string word(token());
    if (word != "MeshVersionFormatted") in_.fail(aussois::quoted(word) + " must be MeshVersionFormatted");
    in_.integer(token(), "version");
    for (word = token(); !word.empty() && word != "End";) {
      if (word == "Dimension") {
        if (const std::int64_t dimension = in_.integer(token(), "dimension"); dimension != 3)
          in_.fail("dimension = " + std::to_string(dimension) + " must be 3");
      } else if (word == "Vertices") {
        for (std::int64_t k = 1, count = size(); k <= count; ++k) {
          const double x = in_.number(token(), "x"), y = in_.number(token(), "y"),
                       z = in_.number(token(), "z");
          in_.integer(token(), "reference");
          add_point(in_, k, {x, y, z}, out_);
        }
      } else if (word == "Tetrahedra") {
        read_cells(4, out_.tets);
      } else if (word == "Hexahedra") {
        read_cells(8, out_.hexes);
      } else if (std::isalpha(static_cast<unsigned char>(word[0])) == 0) {
        in_.fail(aussois::quoted(word) + " must be a keyword");
      } else {  // what else a file may have: numbers up to the next keyword
        for (word = token(); !word.empty() && std::isalpha(static_cast<unsigned char>(word[0])) == 0;)
          word = token();
        continue;
      }
      word = token();
    }
    return std::move(out_);
  }

 private:
  std::string_view token() {
    std::string_view word = in_.token();
    while (!word.empty() && word[0] == '#') in_.rest_of_line(), word = in_.token();
    return word;
  }
  std::int64_t size() {
    const std::int64_t value = in_.integer(token(), "count");
    if (value < 0) in_.fail("count = " + std::to_string(value) + " must not be negative");
    return value;
  }
  void read_cells(int corners, std::vector<Read::Cell>& cells) {
    for (std::int64_t k = size(); k > 0; --k) {
      Read::Cell& cell = cells.emplace_back();
      for (int i = 0; i < corners; ++i) cell.corners.push_back(in_.integer(token(), "corner"));
      cell.group = in_.integer(token(), "reference");
      cell.line = in_.line();
    }
  }

  TextReader in_;
  Read out_{};
};

VolumeFile numbered(const std::filesystem::path& path, const Read& read, double scale,
                    bool drop_free_points) {
  const auto fail = [&](int line, const std::string& what) {
    throw std::runtime_error(path.string() + (line > 0 ? ":" + std::to_string(line) : "") + ": " + what);
  };
  VolumeFile out;
  std::set<std::int64_t> used;
  std::map<std::int64_t, int> groups;
  for (const auto* cells : {&read.tets, &read.hexes})
    for (const Read::Cell& cell : *cells) {
      for (const std::int64_t corner : cell.corners) {
        if (!read.points.contains(corner))
          fail(cell.line, "corner = " + std::to_string(corner) + " must be one of the points");
        used.insert(corner);
      }
      groups.emplace(cell.group, 0);
    }
  if (used.empty()) fail(0, "has neither tetrahedra nor hexahedra");
  out.dropped = int(read.points.size() - used.size());
  if (out.dropped > 0 && !drop_free_points)
    fail(0, std::to_string(out.dropped) + " of its points are in no cell; they may be dropped");
  std::map<std::int64_t, int> place;
  for (const std::int64_t number : used) {
    place[number] = int(out.mesh.points.size());
    out.mesh.points.push_back(scale * read.points.at(number));
  }
  for (auto& [number, index] : groups) {
    index = int(out.groups.size());
    const auto name = read.names.find(number);
    out.groups.push_back(name == read.names.end() ? std::to_string(number) : name->second);
  }
  const auto add = [&](const std::vector<Read::Cell>& from, auto& to) {
    for (const Read::Cell& cell : from) {
      auto& corners = to.emplace_back();
      for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = place.at(cell.corners[i]);
      out.mesh.group_of.push_back(groups.at(cell.group));
    }
  };
  add(read.tets, out.mesh.tets);
  add(read.hexes, out.mesh.hexes);
  return out;
}

}  // namespace

std::string notes_of(const VolumeFile& file) {
  std::string out;
  if (file.turned > 0) out += std::to_string(file.turned) + " cells, all inside out, were turned";
  if (file.dropped > 0)
    out += (out.empty() ? "" : "; ") + std::to_string(file.dropped) + " points in no cell were dropped";
  return out;
}

VolumeFile read_volume_mesh(const std::filesystem::path& path, double scale, bool drop_free_points) {
  require_field(scale > 0 && std::isfinite(scale), "read_volume_mesh: scale", scale,
                "be positive and finite");
  std::string kind = path.extension().string();
  std::ranges::transform(kind, kind.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  if (kind != ".msh" && kind != ".mesh")
    throw std::runtime_error(path.string() + ": extension " + aussois::quoted(kind) +
                             " must be .msh or .mesh");
  const std::string text = read_file(path);
  VolumeFile out =
      numbered(path, kind == ".msh" ? GmshReader(path, text).read() : MeditReader(path, text).read(), scale,
               drop_free_points);
  out.turned = turn_outside_out(out.mesh);
  try {
    validate(out.mesh);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
  return out;
}

}  // namespace aussois
