// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "io/mesh_formats.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::optional<Type> type_named(std::string_view name) {
  using enum Type;
  struct Name {
    std::string_view name{};
    Type type{};
  };
  static constexpr Name kNames[] = {
      {"char", int8},   {"uchar", uint8},   {"short", int16},     {"ushort", uint16},
      {"int", int32},   {"uint", uint32},   {"float", float32},   {"double", float64},
      {"int8", int8},   {"uint8", uint8},   {"int16", int16},     {"uint16", uint16},
      {"int32", int32}, {"uint32", uint32}, {"float32", float32}, {"float64", float64}};
  for (const Name& known : kNames)
    if (known.name == name) return known.type;
  return std::nullopt;
}

std::size_t size_of(Type type) {
  static constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[std::size_t(type)];
}

double load_as(Type type, std::string_view bytes, std::size_t offset, std::endian order) {
  switch (type) {
    case Type::int8:
      return load<std::int8_t>(bytes, offset, order);
    case Type::uint8:
      return load<std::uint8_t>(bytes, offset, order);
    case Type::int16:
      return load<std::int16_t>(bytes, offset, order);
    case Type::uint16:
      return load<std::uint16_t>(bytes, offset, order);
    case Type::int32:
      return load<std::int32_t>(bytes, offset, order);
    case Type::uint32:
      return load<std::uint32_t>(bytes, offset, order);
    case Type::float32:
      return double(load<float>(bytes, offset, order));
    case Type::float64:
      return load<double>(bytes, offset, order);
  }
  return 0;
}

struct Property {
  std::string name{};
  Type type{};
  std::optional<Type> count_type{};  // set for a list
};

struct Element {
  std::string name{};
  std::int64_t count = 0;  // of its rows
  int line = 0;            // where the header announces it
  std::vector<Property> properties{};

  // Position of a property among the properties; -1 if absent.
  int find(std::string_view wanted) const {
    for (std::size_t k = 0; k < properties.size(); ++k)
      if (properties[k].name == wanted) return int(k);
    return -1;
  }
};

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& path, std::string_view bytes)
      : path_(path), bytes_(bytes), in_(path, bytes) {}

  MeshFile read() {
    read_header();
    byte_ = in_.position();
    for (const Element& element : elements_) read_element(element);
    if (ascii_ ? !in_.token().empty() : byte_ != bytes_.size()) fail("more data than the header announces");
    return std::move(mesh_);
  }

 private:
  // --- header
  // -------------------------------------------------------------------------------------------------

  void read_header() {
    std::vector<std::string_view> words;
    if (!in_.next_line(words, 0) || words[0] != "ply") in_.fail("the first line must be 'ply'");
    bool format_known = false;
    while (true) {
      if (!in_.next_line(words, 0)) in_.fail("file ends before 'end_header'");
      if (words[0] == "end_header") break;
      if (words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "format" && words.size() == 3)
        read_format(words[1]), format_known = true;
      else if (words[0] == "element" && words.size() == 3)
        elements_.push_back({std::string(words[1]), row_count(words[2]), in_.line(), {}});
      else if (words[0] == "property" && (words.size() == 3 || words.size() == 5) && !elements_.empty())
        elements_.back().properties.push_back(read_property(words));
      else
        in_.fail(quoted(words[0]) +
                 " must be a complete line 'format', 'element', 'property' or 'end_header'");
    }
    if (!format_known) in_.fail("header must have a line 'format'");
    for (const Element& element : elements_) check(element);
    if (vertex_count_ < 0) in_.fail("header must have an element 'vertex'");
  }

  void read_format(std::string_view name) {
    ascii_ = name == "ascii";
    order_ = name == "binary_big_endian" ? std::endian::big : std::endian::little;
    if (!ascii_ && name != "binary_little_endian" && name != "binary_big_endian")
      in_.fail("format = " + quoted(name) + " must be ascii, binary_little_endian or binary_big_endian");
  }

  std::int64_t row_count(std::string_view word) const {
    const std::int64_t count = in_.integer(word, "number of rows");
    if (count < 0) in_.fail("number of rows = " + std::to_string(count) + " must be >= 0");
    return count;
  }

  Property read_property(std::span<const std::string_view> words) const {
    const auto type = [&](std::string_view name) {
      const std::optional<Type> known = type_named(name);
      if (!known) in_.fail("type " + quoted(name) + " must be one of char, uchar, ..., double");
      return *known;
    };
    if (words.size() == 3) return {std::string(words[2]), type(words[1]), std::nullopt};
    if (words[1] != "list")
      in_.fail("property must be 'property type name' or 'property list type type name'");
    return {std::string(words[4]), type(words[3]), type(words[2])};
  }

  void check(const Element& element) {
    const auto demand = [&](const char* name, bool list) {
      const int k = element.find(name);
      if (k < 0 || element.properties[k].count_type.has_value() != list)
        in_.fail_at(element.line, "element '" + element.name + "' must have a " +
                                      (list ? "list property '" : "number property '") + name + "'");
    };
    if (element.properties.empty())
      in_.fail_at(element.line, "element '" + element.name + "' has no property");
    if (element.name == "tristrips")
      in_.fail_at(element.line, "triangle strips are not read; convert them to faces");
    if (element.name == "vertex") {
      for (const char* axis : {"x", "y", "z"}) demand(axis, false);
      vertex_count_ = element.count;
    }
    if (element.name == "face") demand(corner_list(element), true);
    if (element.name == "edge")
      for (const char* end : {"vertex1", "vertex2"}) demand(end, false);
  }

  // Both names are in use.
  static const char* corner_list(const Element& element) {
    return element.find("vertex_index") >= 0 ? "vertex_index" : "vertex_indices";
  }

  // --- rows
  // ---------------------------------------------------------------------------------------------------

  void read_element(const Element& element) {
    check_announced_size(element);
    element_ = &element;
    std::vector<std::vector<double>> row(element.properties.size());  // one value each, or those of a list
    for (row_ = 0; row_ < element.count; ++row_) {
      read_row(row);
      const auto values = [&](const char* name) { return std::span(row[element.find(name)]); };
      if (element.name == "vertex") {
        mesh_.vertices.emplace_back(finite(values("x")[0], "x"), finite(values("y")[0], "y"),
                                    finite(values("z")[0], "z"));
      } else if (element.name == "face") {
        add_face(values(corner_list(element)));
      } else if (element.name == "edge") {
        mesh_.wires.push_back({vertex_index(values("vertex1")[0]), vertex_index(values("vertex2")[0])});
      }
    }
    element_ = nullptr;
  }

  // A header may announce anything: what cannot fit into the file is refused before memory is asked for.
  void check_announced_size(const Element& element) const {
    std::size_t row_size = 0;  // at least: empty lists; in text one digit and one blank per number
    for (const Property& property : element.properties)
      row_size += ascii_ ? 2 : size_of(property.count_type.value_or(property.type));
    const std::size_t rest = bytes_.size() - (ascii_ ? in_.position() : byte_);
    if (std::size_t(element.count) > (rest + 1) / row_size)
      in_.fail_at(element.line, "element '" + element.name + "' announces " + std::to_string(element.count) +
                                    " rows of at least " + std::to_string(row_size) + " bytes, " +
                                    std::to_string(rest) + " bytes follow");
  }

  void read_row(std::vector<std::vector<double>>& row) {
    row_line_ = 0;
    row_byte_ = byte_;
    for (std::size_t k = 0; k < row.size(); ++k) {
      const Property& property = element_->properties[k];
      row[k].clear();
      double count = 1;
      if (property.count_type) {
        count = next(*property.count_type, property.name);
        const double room = double(bytes_.size() - (ascii_ ? in_.position() : byte_));
        if (!(count >= 0 && count <= room) || count != std::floor(count))
          fail("length of list '" + property.name + "' = " + shown(count) + " must be an integer in [0, " +
               shown(room) + "], the bytes that follow");
      }
      for (double i = 0; i < count; ++i) row[k].push_back(next(property.type, property.name));
    }
    if (ascii_ && in_.rest_of_line().find_first_not_of(" \t\r") != std::string_view::npos)
      in_.fail_at(row_line_, "row has more values than its element has properties");
  }

  // The next number of the body. Not finite is fine here: normals and colours may be anything.
  double next(Type type, const std::string& name) {
    if (!ascii_) {
      if (bytes_.size() - byte_ < size_of(type)) fail("file ends within the row");
      const double value = load_as(type, bytes_, byte_, order_);
      byte_ += size_of(type);
      return value;
    }
    const std::string_view token = in_.token();
    if (row_line_ == 0) row_line_ = in_.line();
    if (token.empty()) in_.fail("file ends within a row of element '" + element_->name + "'");
    if (in_.line() != row_line_) in_.fail_at(row_line_, "row ends before its last value");
    return in_.any_number(token, name.c_str());
  }

  void add_face(std::span<const double> indices) {
    if (indices.size() < 3) fail("corners = " + std::to_string(indices.size()) + " must be at least 3");
    corners_.clear();
    for (const double index : indices) corners_.push_back(vertex_index(index));
    add_polygon(mesh_, corners_);
  }

  int vertex_index(double index) const {
    if (!(index >= 0 && index < double(vertex_count_)) || index != std::floor(index))
      fail("vertex index = " + shown(index) + " must be an integer in [0, " + std::to_string(vertex_count_) +
           ")");
    return int(index);
  }

  double finite(double value, const char* name) const {
    if (!std::isfinite(value)) fail(std::string(name) + " = " + shown(value) + " must be finite");
    return value;
  }

  static std::string shown(double value) {
    std::string text;
    append_number(text, value);
    return text;
  }

  [[noreturn]] void fail(const std::string& what) const {
    if (ascii_) in_.fail(what);
    const std::string row = element_ ? element_->name + " " + std::to_string(row_) + ": " : "";
    throw std::runtime_error(path_.string() + ": byte " + std::to_string(element_ ? row_byte_ : byte_) +
                             ": " + row + what);
  }

  std::filesystem::path path_;
  std::string_view bytes_;
  TextReader in_;  // the header, and the body of a text file
  std::vector<Element> elements_{};
  bool ascii_ = true;
  std::endian order_ = std::endian::little;
  std::int64_t vertex_count_ = -1;

  std::size_t byte_ = 0;              // where the body of a binary file is read
  const Element* element_ = nullptr;  // being read
  std::int64_t row_ = 0;
  std::size_t row_byte_ = 0;
  int row_line_ = 0;  // of a text file; 0 before the first value of the row
  MeshFile mesh_{};
  std::vector<int> corners_{};
};

}  // namespace

MeshFile read_ply(const std::filesystem::path& path, std::string_view bytes) {
  return PlyReader(path, bytes).read();
}

}  // namespace aussois
