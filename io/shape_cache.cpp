// SPDX-License-Identifier: Apache-2.0
#include "io/shape_cache.hpp"

#include <cstdio>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/digest.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"
#include "io/hdf5_file.hpp"
#include "io/mapped_file.hpp"
#include "io/sealed_file.hpp"
#include "io/shape_check.hpp"
#include "io/shape_tables.hpp"

namespace aussois {
namespace {

constexpr const char* kShapeFormat = "aussois-lmd-shape";
constexpr const char* kShapeVersion = "6";  // raise it when a table, or what prepare() puts into one, changes

std::string hex(std::uint64_t value) {
  char text[24];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

// What is in a file of its own: a vertex index beside a place has a gap in memory.
struct Moved {
  std::vector<int> vertex{};
  std::vector<Vec3> from{};
};

Moved columns_of(const SharedArray<MovedVertex>& straightened) {
  Moved out;
  for (const auto& [vertex, from] : straightened) {
    out.vertex.push_back(vertex);
    out.from.push_back(from);
  }
  return out;
}

template <class T>
using PlainRow = Hdf5Row<typename Plain<T>::type>;

class Writer {
 public:
  explicit Writer(hid_t file) : file_(file) {}
  template <class T>
  void table(const std::string& name, std::span<const T> values) {
    static_assert(sizeof(T) == sizeof(typename Plain<T>::type));
    write_piece(file_, name, PlainRow<T>::type(), PlainRow<T>::shape(), values.data(), values.size());
  }
  template <class T>
  void table(const std::string& name, const SharedArray<T>& values) {
    table(name, std::span<const T>(values));
  }
  void table(const std::string& name, const SharedArray<MovedVertex>& values) {
    const Moved columns = columns_of(values);
    table(name + "/vertex", std::span<const int>(columns.vertex));
    table(name + "/from", std::span<const Vec3>(columns.from));
  }
  template <class T>
  void one(const char* name, const T& value) {
    table(name, std::span<const T>(&value, 1));
  }
  void one(const char* name, bool value) { one(name, int(value)); }

 private:
  hid_t file_;
};

// Tables are spans of the file's bytes.
class Reader {
 public:
  Reader(hid_t file, const FileBytes& bytes) : file_(file), bytes_(bytes) {}
  template <class T>
  void table(const std::string& name, SharedArray<T>& values) {
    const Hdf5Piece piece = piece_of(file_, name, PlainRow<T>::type(), PlainRow<T>::shape());
    if (piece.offset % alignof(T) != 0 || piece.rows > hsize_t{1} << 31)
      fail_hdf5(file_, name, "does not begin where its numbers may lie, or has more than 2^31 rows");
    if (piece.offset + piece.rows * sizeof(T) > bytes_.bytes.size()) fail_hdf5(file_, name, "is cut off");
    const auto* const first = reinterpret_cast<const T*>(bytes_.bytes.data() + piece.offset);
    values = piece.rows > 0 ? SharedArray<T>({first, piece.rows}, bytes_.owner) : SharedArray<T>();
  }
  void table(const std::string& name, SharedArray<MovedVertex>& values) {
    SharedArray<int> vertex;
    SharedArray<Vec3> from;
    table(name + "/vertex", vertex);
    table(name + "/from", from);
    if (vertex.size() != from.size()) fail_hdf5(file_, name, "has columns of different lengths");
    std::vector<MovedVertex> moved;
    for (std::size_t i = 0; i < vertex.size(); ++i) moved.push_back({vertex[i], from[i]});
    values = std::move(moved);
  }
  template <class T>
  void one(const std::string& name, T& value) {
    SharedArray<T> values;
    table(name, values);
    if (values.size() != 1)
      fail_hdf5(file_, name, "has " + std::to_string(values.size()) + " rows instead of 1");
    value = values[0];
  }
  void one(const std::string& name, bool& value) {
    int number = 0;
    one(name, number);
    if (number != 0 && number != 1) fail_hdf5(file_, name, "is neither 0 nor 1");
    value = number != 0;
  }

 private:
  hid_t file_;
  const FileBytes& bytes_;
};

// ---- a cache of files

void write_hdf5(const std::filesystem::path& path, const LmdShape& shape, std::uint64_t key) {
  const Hdf5Id file = create_hdf5(path, alignof(ConeNode));
  write_text(file, "/", "format", kShapeFormat);
  write_text(file, "/", "version", kShapeVersion);
  write_text(file, "/", "key", hex(key));
  write_text(file, "/", "build", build_info());
  Writer writer(file);
  visit_shape(writer, shape);
  flush_hdf5(file);
}

// The file and its bytes, opened one after the other: it may be replaced in between, but not for ever.
std::pair<FileBytes, Hdf5Id> open_sealed(const std::filesystem::path& path) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) break;
    FileBytes bytes = bytes_of_file(path);
    if (!is_sealed(bytes.bytes)) break;
    Hdf5Id file = open_hdf5(path, Hdf5Access::read);
    if (is_file(descriptor_of(file), bytes)) return {std::move(bytes), std::move(file)};
  }
  throw std::runtime_error(path.string() + ": missing, truncated or damaged: its checksum does not fit");
}

bool same_mesh(const SimplicialComplex& a, const SimplicialComplex& b) {
  return a.solid == b.solid && a.triangles == b.triangles && a.edges == b.edges &&
         a.vertices.size() == b.vertices.size() &&
         std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vec3)) == 0;
}

SimplicialComplex before_straightening(const LmdShape& shape) {
  SimplicialComplex complex = shape.complex;
  if (shape.straightened.empty()) return complex;
  std::vector<Vec3> vertices = complex.vertices.to_vector();
  for (const MovedVertex& moved : shape.straightened) vertices[moved.vertex] = moved.from;
  complex.vertices = std::move(vertices);
  return complex;
}

// `complex`: what the file must hold. Null: whatever it holds.
LmdShape read_hdf5(const std::filesystem::path& path, std::uint64_t key, const SimplicialComplex* complex) {
  const Hdf5Silence silence;
  const auto [bytes, file] = open_sealed(path);
  check_format(file, kShapeFormat, kShapeVersion);
  if (const std::string found = read_text(file, "/", "key"); found != hex(key))
    fail_hdf5(file, "/@key", "is " + found + ", this mesh with these options has " + hex(key));
  LmdShape shape;
  Reader reader(file, bytes);
  visit_shape(reader, shape);
  check_shape(file, shape);
  if (complex && !same_mesh(before_straightening(shape), *complex))
    fail_hdf5(file, "/mesh", "is another one with the same key");
  drop_pages(bytes);
  return shape;
}

}  // namespace

std::uint64_t shape_key(const DilatedShape& shape, const LmdShapeOptions& options) {
  const auto& [planarity, deforming, threads] = options;
  static_cast<void>(threads);  // changes nothing
  const SimplicialComplex& k = shape.complex;
  Digest key;
  key.add(std::as_bytes(std::span<const Vec3>(k.vertices)));
  key.add(std::as_bytes(std::span<const std::array<int, 3>>(k.triangles)));
  key.add(std::as_bytes(std::span<const std::array<int, 2>>(k.edges)));
  for (const double x : {double(k.solid), shape.radius, planarity, double(deforming)}) key.add(x);
  key.add(fingerprint_of(build_info() + kShapeVersion));
  return key.value;
}

void write_lmd_shape(const std::filesystem::path& path, const LmdShape& shape, std::uint64_t key) {
  const Hdf5Silence silence;
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    write_hdf5(temporary, shape, key);
    seal(temporary);
    forbid_writing(temporary);
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
