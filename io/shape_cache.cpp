// SPDX-License-Identifier: Apache-2.0
#include "io/shape_cache.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "geometry/digest.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"
#include "io/hdf5_file.hpp"

namespace aussois {
namespace {

constexpr const char* kShapeFormat = "aussois-lmd-shape";
constexpr const char* kShapeVersion = "5";  // raise it when a table, or what prepare() puts into one, changes

std::string hex(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

// ---- how an element of a table lies in a row: plain numbers without gaps

template <class T>
struct Row {
  using type = T;
  static const T& of(const T& x) { return x; }
  static const T& back(const T& row) { return row; }
};

template <>
struct Row<float> {
  using type = double;
  static type of(float x) { return double(x); }
  static float back(type row) { return float(row); }
};

template <>
struct Row<VertexLeaf> {
  using type = std::array<int, 5>;
  static type of(const VertexLeaf& leaf) {
    const auto& [vertex, first_ray, ray_count, cyclic, is_wide] = leaf;
    return {vertex, first_ray, int(ray_count), int(cyclic), int(is_wide)};
  }
  static VertexLeaf back(const type& row) {
    return {.vertex = row[0],
            .first_ray = row[1],
            .ray_count = std::uint32_t(row[2]) & 0x7ffffffU,
            .cyclic = row[3] != 0,
            .is_wide = row[4] != 0};
  }
};

template <>
struct Row<EdgeLeaf> {
  using type = std::array<int, 7>;
  static type of(const EdgeLeaf& leaf) {
    const auto& [first, last, conormals, path, path_length, is_wide] = leaf;
    return {first, last, conormals[0], conormals[1], path, int(path_length), int(is_wide)};
  }
  static EdgeLeaf back(const type& row) {
    return {.first = row[0],
            .last = row[1],
            .conormals = {row[2], row[3]},
            .path = row[4],
            .path_length = std::uint32_t(row[5]) & 0x7fffffffU,
            .is_wide = row[6] != 0};
  }
};

template <>
struct Row<MovedVertex> {
  using type = std::array<double, 4>;
  static type of(const MovedVertex& moved) {
    const auto& [vertex, from] = moved;
    return {double(vertex), from.x(), from.y(), from.z()};
  }
  static MovedVertex back(const type& row) { return {int(row[0]), {row[1], row[2], row[3]}}; }
};

template <>
struct Row<RegionPlane> {
  using type = std::array<double, 4>;
  static type of(const RegionPlane& plane) {
    const auto& [normal, offset] = plane;
    return {normal.x(), normal.y(), normal.z(), offset};
  }
  static RegionPlane back(const type& row) { return {Vec3(row[0], row[1], row[2]), row[3]}; }
};

template <>
struct Row<BaseSimplex> {
  using type = std::array<int, 4>;
  static type of(const BaseSimplex& simplex) {
    const auto& [dim, vertex] = simplex;
    return {dim, vertex[0], vertex[1], vertex[2]};
  }
  static BaseSimplex back(const type& row) { return {row[0], {row[1], row[2], row[3]}}; }
};

template <>
struct Row<ConeNode> {  // its 32-bit words, floats and integers, in the order of the struct
  using type = std::array<std::uint32_t, 80>;
  static type of(const ConeNode& node) {
    static_assert(offsetof(ConeNode, h) + sizeof node.h == sizeof(type));
    static_assert(sizeof node == 320, "a field was added: raise kShapeVersion");
    type row;
    std::memcpy(row.data(), &node, sizeof row);
    return row;
  }
  static ConeNode back(const type& row) {
    ConeNode node{};
    std::memcpy(&node, row.data(), sizeof row);
    return node;
  }
};

template <class T>
std::vector<typename Row<T>::type> rows_of(const std::vector<T>& table) {
  std::vector<typename Row<T>::type> rows;
  rows.reserve(table.size());
  for (const T& element : table) rows.push_back(Row<T>::of(element));
  return rows;
}

// ---- the list of all tables

/// What make_complex needs to give the same complex again.
struct Mesh {
  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> triangles{};
  std::vector<std::array<int, 2>> wires{};
  int solid = 0;
};

Mesh mesh_of(const SimplicialComplex& complex) {
  Mesh mesh{.vertices = complex.vertices, .triangles = complex.triangles, .solid = complex.solid};
  for (std::size_t e = 0; e < complex.edges.size(); ++e)
    if (complex.edge_triangles[int(e)].empty()) mesh.wires.push_back(complex.edges[e]);
  return mesh;
}

bool same_bits(const Mesh& a, const Mesh& b) {
  return a.solid == b.solid && a.triangles == b.triangles && a.wires == b.wires &&
         a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

template <class Archive, class M>
void visit_mesh(Archive& archive, M& mesh) {
  archive.table("/mesh/vertices", mesh.vertices);
  archive.table("/mesh/triangles", mesh.triangles);
  archive.table("/mesh/wires", mesh.wires);
  archive.one("/mesh/solid", mesh.solid);
}

/// Every field by name: one that is added to LmdShape does not compile until it stands here (raise
/// kShapeVersion then).
template <class Archive, class Shape>
void visit_shape(Archive& archive, Shape& shape) {
  auto& [complex, radius, centre, bounding_radius, tolerance, straightened, regions, triangle_region,
         triangle_sign, rays, paths, vertices, edges, misfits, faces, rest, vertex_tree, wide_vertex_tree,
         edge_tree, wide_edge_tree, face_tree, rest_tree, narrow_vertices, narrow_edges, flat_triangles,
         unproven, unproven_tree] = shape;
  static_cast<void>(complex);  // follows from the mesh
  archive.one("/radius", radius);
  archive.one("/centre", centre);
  archive.one("/bounding_radius", bounding_radius);
  archive.one("/tolerance", tolerance);
  archive.table("/straightened", straightened);
  archive.table("/regions", regions);
  archive.table("/triangle_region", triangle_region);
  archive.table("/triangle_sign", triangle_sign);
  archive.table("/rays", rays);
  archive.table("/paths", paths);
  archive.table("/vertices", vertices);
  archive.table("/edges", edges);
  archive.table("/misfits", misfits);
  archive.table("/faces", faces);
  archive.table("/rest", rest);
  archive.table("/tree/vertex", vertex_tree.nodes);
  archive.table("/tree/wide_vertex", wide_vertex_tree.nodes);
  archive.table("/tree/edge", edge_tree.nodes);
  archive.table("/tree/wide_edge", wide_edge_tree.nodes);
  archive.table("/tree/face", face_tree.nodes);
  archive.table("/tree/rest", rest_tree.nodes);
  archive.table("/tree/unproven", unproven_tree.nodes);
  archive.one("/narrow_vertices", narrow_vertices);
  archive.one("/narrow_edges", narrow_edges);
  archive.one("/flat_triangles", flat_triangles);
  archive.table("/unproven", unproven);
}

class Key {
 public:
  template <class T>
  void table(const char*, const std::vector<T>& values) {
    const auto rows = rows_of(values);
    digest_.add(std::as_bytes(std::span(rows)));
  }
  template <class T>
  void one(const char* name, const T& value) {
    table(name, std::vector<T>{value});
  }
  std::uint64_t value() const { return digest_.value; }

 private:
  Digest digest_{};
};

class Writer {
 public:
  explicit Writer(hid_t file) : file_(file) {}
  template <class T>
  void table(const char* name, const std::vector<T>& values) {
    write_rows(file_, name, rows_of(values));
  }
  template <class T>
  void one(const char* name, const T& value) {
    table(name, std::vector<T>{value});
  }

 private:
  hid_t file_;
};

class Reader {
 public:
  explicit Reader(hid_t file) : file_(file) {}
  template <class T>
  void table(const char* name, std::vector<T>& values) {
    using R = typename Row<T>::type;
    const Hdf5Column column = Hdf5Column::open(file_, name, Hdf5Row<R>::type(), Hdf5Row<R>::shape());
    std::vector<R> rows(column.rows());
    column.read(rows.data(), 0, column.rows());
    values.clear();
    values.reserve(rows.size());
    for (const R& row : rows) values.push_back(Row<T>::back(row));
  }
  template <class T>
  void one(const char* name, T& value) {
    std::vector<T> values;
    table(name, values);
    if (values.size() != 1)
      fail_hdf5(file_, name, "has " + std::to_string(values.size()) + " rows instead of 1");
    value = values[0];
  }

 private:
  hid_t file_;
};

// ---- is it a shape that a search can walk through?

class Check {
 public:
  Check(hid_t file, const LmdShape& shape) : file_(file), s_(shape) {}

  void all() const {
    tables();
    leaves();
    const std::size_t narrow_v = std::size_t(s_.narrow_vertices), narrow_e = std::size_t(s_.narrow_edges);
    tree("/tree/vertex", s_.vertex_tree, narrow_v);
    tree("/tree/wide_vertex", s_.wide_vertex_tree, s_.vertices.size() - narrow_v);
    tree("/tree/edge", s_.edge_tree, narrow_e);
    tree("/tree/wide_edge", s_.wide_edge_tree, s_.edges.size() - narrow_e);
    tree("/tree/face", s_.face_tree, s_.faces.size());
    tree("/tree/rest", s_.rest_tree, s_.rest.size());
    tree("/tree/unproven", s_.unproven_tree, s_.unproven.size());
  }

 private:
  void expect(bool holds, const char* name, const char* what) const {
    if (!holds) fail_hdf5(file_, name, what);
  }
  static bool within(int i, std::size_t count) { return i >= 0 && std::size_t(i) < count; }
  static bool length(double x) { return std::isfinite(x) && x >= 0; }

  void tables() const {
    const std::size_t triangles = s_.complex.triangles.size();
    expect(length(s_.radius), "/radius", "is not a length");
    expect(length(s_.bounding_radius) && s_.centre.allFinite(), "/bounding_radius",
           "is not a ball with its centre");
    expect(length(s_.tolerance), "/tolerance", "is not a length");
    expect(s_.narrow_vertices >= 0 && std::size_t(s_.narrow_vertices) <= s_.vertices.size(),
           "/narrow_vertices", "is not a valid number of vertices");
    expect(s_.narrow_edges >= 0 && std::size_t(s_.narrow_edges) <= s_.edges.size(), "/narrow_edges",
           "is not a valid number of edges");
    expect(s_.flat_triangles >= 0 && std::size_t(s_.flat_triangles) + s_.faces.size() == triangles,
           "/flat_triangles", "and the faces do not add up to all triangles");
    expect(s_.triangle_region.size() == triangles && s_.triangle_sign.size() == triangles, "/triangle_region",
           "does not have one row per triangle");
    for (const RegionPlane& p : s_.regions)
      expect(p.normal.allFinite() && std::isfinite(p.offset), "/regions", "has a plane that is not finite");
    for (const int r : s_.triangle_region)
      expect(within(r, s_.regions.size()), "/triangle_region", "has an index outside the regions");
    for (const int sign : s_.triangle_sign) expect(std::abs(sign) == 1, "/triangle_sign", "is not 1 or -1");
    for (const Vec3& ray : s_.rays) expect(ray.allFinite(), "/rays", "has a ray that is not finite");
    for (const int e : s_.paths)
      expect(within(e, s_.complex.edges.size()), "/paths", "has an index outside the edges of the mesh");
    for (const int t : s_.faces) expect(within(t, triangles), "/faces", "has an index outside the triangles");
    for (const int i : s_.unproven)
      expect(within(i, std::size_t(base_count(s_))), "/unproven", "has an index outside the base simplices");
  }

  void leaves() const {
    const std::size_t points = s_.complex.vertices.size(), mesh_edges = s_.complex.edges.size();
    for (const VertexLeaf& v : s_.vertices) {
      expect(within(v.vertex, points), "/vertices", "has an index outside the vertices of the mesh");
      expect(v.first_ray >= 0 && std::size_t(v.first_ray) + v.ray_count <= s_.rays.size(), "/vertices",
             "has an index outside the rays");
    }
    for (const EdgeLeaf& e : s_.edges) {
      expect(within(e.first, points) && within(e.last, points), "/edges",
             "has an index outside the vertices of the mesh");
      for (const int region : e.conormals)
        expect(std::abs(std::int64_t(region)) <= std::int64_t(s_.regions.size()), "/edges",
               "has an index outside the regions");
      expect(e.path_length == 1
                 ? within(e.path, mesh_edges)
                 : e.path_length > 1 && e.path >= 0 && std::size_t(e.path) + e.path_length <= s_.paths.size(),
             "/edges", "has a path that does not exist");
    }
    expect(s_.misfits.empty() || s_.misfits.size() == s_.edges.size(), "/misfits",
           "does not have one row per edge");
    for (const float misfit : s_.misfits)
      expect(misfit >= 0 && misfit <= 2, "/misfits", "is not a sum of two sines");
    for (const BaseSimplex& simplex : s_.rest) {
      expect(simplex.dim >= 0 && simplex.dim <= 2, "/rest", "has a dimension outside 0, 1, 2");
      for (int k = 0; k <= simplex.dim; ++k)
        expect(within(simplex.vertex[k], points), "/rest", "has an index outside the vertices of the mesh");
    }
  }

  // Children come after their parent, so the descent ends; every simplex lies in one bucket.
  void tree(const char* name, const ConeTree& tree, std::size_t simplices) const {
    std::vector<char> node_seen(tree.nodes.size()), simplex_seen(simplices);
    std::size_t nodes = tree.nodes.empty() ? 0 : 1, found = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
      const ConeNode& node = tree.nodes[i];
      expect(finite(node), name, "has a number that is not finite");
      for (int lane = 0; lane < 4; ++lane) {
        if (node.r[lane] < 0) continue;
        const std::size_t first = node.child[lane], count = node.count[lane];
        if (count == 0) {
          expect(first > i && first < tree.nodes.size() && !node_seen[first], name, "is not a tree");
          node_seen[first] = 1;
          ++nodes;
          continue;
        }
        expect(count <= kBucket && first + count <= simplices, name, "has an index outside its simplices");
        for (std::size_t k = first; k < first + count; ++k) {
          expect(!simplex_seen[k], name, "holds a simplex twice");
          simplex_seen[k] = 1;
        }
        found += count;
      }
    }
    expect(nodes == tree.nodes.size() && found == simplices, name, "does not reach every node and simplex");
  }
  static bool finite(const ConeNode& node) {
    const auto row = Row<ConeNode>::of(node);
    constexpr std::size_t kFirst = offsetof(ConeNode, child) / 4, kLast = offsetof(ConeNode, u) / 4;
    for (std::size_t i = 0; i < row.size(); ++i)  // all words but the counts
      if ((i < kFirst || i >= kLast) && !std::isfinite(std::bit_cast<float>(row[i]))) return false;
    return true;
  }

  hid_t file_;
  const LmdShape& s_;
};

// ---- the last eight bytes of a file are the checksum of the others: HDF5, which overlooks them, sees whole
// files only

std::uint64_t digest_of(const std::string& bytes, std::size_t count) {
  Digest digest;
  digest.add(std::as_bytes(std::span(bytes.data(), count)));
  return digest.value;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void seal(const std::filesystem::path& path) {
  const std::string bytes = bytes_of(path);
  const std::uint64_t digest = digest_of(bytes, bytes.size());
  std::ofstream file(path, std::ios::binary | std::ios::app);
  file.write(reinterpret_cast<const char*>(&digest), sizeof digest);
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": cannot be written (is the disk full?)");
}

bool is_sealed(const std::filesystem::path& path) {
  const std::string bytes = bytes_of(path);
  std::uint64_t digest = 0;
  if (bytes.size() < sizeof digest) return false;
  const std::size_t count = bytes.size() - sizeof digest;
  std::memcpy(&digest, bytes.data() + count, sizeof digest);
  return digest == digest_of(bytes, count);
}

// ---- a cache of files

void write_hdf5(const std::filesystem::path& path, const LmdShape& shape, std::uint64_t key) {
  const Mesh mesh = mesh_of(shape.complex);
  const Hdf5Id file = create_hdf5(path);
  write_text(file, "/", "format", kShapeFormat);
  write_text(file, "/", "version", kShapeVersion);
  write_text(file, "/", "key", hex(key));
  write_text(file, "/", "build", build_info());
  Writer writer(file);
  visit_mesh(writer, mesh);
  visit_shape(writer, shape);
  flush_hdf5(file);
}

SimplicialComplex complex_of(hid_t file, Mesh mesh) {
  try {
    SimplicialComplex complex = make_complex(std::move(mesh.vertices), std::move(mesh.triangles), mesh.wires);
    complex.solid = mesh.solid != 0;
    return complex;
  } catch (const std::invalid_argument& e) {
    fail_hdf5(file, "/mesh", e.what());
  }
}

Mesh before_straightening(hid_t file, Mesh mesh, const std::vector<MovedVertex>& straightened) {
  for (const MovedVertex& moved : straightened) {
    if (moved.vertex < 0 || std::size_t(moved.vertex) >= mesh.vertices.size())
      fail_hdf5(file, "/straightened", "has an index outside the vertices of the mesh");
    mesh.vertices[moved.vertex] = moved.from;
  }
  return mesh;
}

// `complex`: what the file must hold; building it again would be half of the time. Null: whatever it holds.
LmdShape read_hdf5(const std::filesystem::path& path, std::uint64_t key, const SimplicialComplex* complex) {
  const Hdf5Silence silence;
  if (!is_sealed(path))
    throw std::runtime_error(path.string() + ": missing, truncated or damaged: its checksum does not fit");
  const Hdf5Id file = open_hdf5(path, Hdf5Access::read);
  check_format(file, kShapeFormat, kShapeVersion);
  if (const std::string found = read_text(file, "/", "key"); found != hex(key))
    fail_hdf5(file, "/@key", "is " + found + ", this mesh with these options has " + hex(key));
  Mesh mesh;
  LmdShape shape;
  Reader reader(file);
  visit_mesh(reader, mesh);
  visit_shape(reader, shape);
  if (complex) {
    if (!same_bits(before_straightening(file, mesh, shape.straightened), mesh_of(*complex)))
      fail_hdf5(file, "/mesh", "is another one with the same key");
    shape.complex = *complex;
    shape.complex.vertices = std::move(mesh.vertices);
  } else {
    shape.complex = complex_of(file, std::move(mesh));
  }
  Check(file, shape).all();
  return shape;
}

}  // namespace

std::uint64_t shape_key(const DilatedShape& shape, const LmdShapeOptions& options) {
  const auto& [planarity, deforming, threads] = options;
  static_cast<void>(threads);  // changes nothing
  const Mesh mesh = mesh_of(shape.complex);
  Key key;
  visit_mesh(key, mesh);
  key.one("radius", shape.radius);
  key.one("planarity", planarity);
  key.one("deforming", int(deforming));
  key.one("program", fingerprint_of(build_info() + kShapeVersion));
  return key.value();
}

void write_lmd_shape(const std::filesystem::path& path, const LmdShape& shape, std::uint64_t key) {
  const Hdf5Silence silence;
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    write_hdf5(temporary, shape, key);
    seal(temporary);
  });
}

LmdShape read_lmd_shape(const std::filesystem::path& path, std::uint64_t key) {
  return read_hdf5(path, key, nullptr);
}

CachedShape prepare_cached(DilatedShape dilated, const LmdShapeOptions& options,
                           const std::filesystem::path& folder) {
  CachedShape out;
  if (folder.empty()) {
    out.shape = std::make_shared<const LmdShape>(prepare(std::move(dilated), options));
    return out;
  }
  const std::uint64_t key = shape_key(dilated, options);
  out.file = folder / (hex(key) + ".h5");
  std::error_code ignored;
  if (std::filesystem::exists(out.file, ignored)) {
    try {
      out.shape = std::make_shared<const LmdShape>(read_hdf5(out.file, key, &dilated.complex));
      out.loaded = out.kept = true;
      return out;
    } catch (const std::runtime_error& e) {
      out.warning = std::string(e.what()) + "; prepared again";
    }
  }
  out.shape = std::make_shared<const LmdShape>(prepare(std::move(dilated), options));
  try {
    std::filesystem::create_directories(folder);
    write_lmd_shape(out.file, *out.shape, key);
    out.kept = true;
  } catch (const std::runtime_error& e) {
    if (!out.warning.empty()) out.warning += "; ";
    out.warning += std::string(e.what()) + "; not kept";
  }
  return out;
}

std::string to_string(const CachedShape& shape) {
  if (shape.loaded) return "loaded from " + shape.file.string();
  return shape.kept ? "prepared, kept in " + shape.file.string() : "prepared";
}

}  // namespace aussois
