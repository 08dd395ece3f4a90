// SPDX-License-Identifier: Apache-2.0
#include "io/shape_cache.hpp"

#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "geometry/digest.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"
#include "io/kept_tables.hpp"
#include "io/shape_check.hpp"

namespace aussois {
namespace {

constexpr KeptKind kShape{.format = "aussois-lmd-shape", .version = "7"};

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
LmdShape read_shape(const std::filesystem::path& path, std::uint64_t key, const SimplicialComplex* complex) {
  const Hdf5Silence silence;
  const auto [bytes, file] = open_kept(path, kShape, key);
  LmdShape shape;
  TableReader reader(file, bytes);
  visit_shape(reader, shape);
  check_shape(file, shape);
  if (complex && !same_mesh(before_straightening(shape), *complex))
    fail_hdf5(file, "/mesh", "is another one with the same key");
  drop_pages(bytes);
  return shape;
}

}  // namespace

std::uint64_t shape_key(const DilatedShape& shape, const LmdShapeOptions& options) {
  const auto& [planarity, deforming, levels, threads] = options;
  static_cast<void>(threads);  // changes nothing
  const SimplicialComplex& k = shape.complex;
  Digest key;
  key.add(std::as_bytes(std::span<const Vec3>(k.vertices)));
  key.add(std::as_bytes(std::span<const std::array<int, 3>>(k.triangles)));
  key.add(std::as_bytes(std::span<const std::array<int, 2>>(k.edges)));
  for (const double x : {double(k.solid), shape.radius, planarity, double(deforming), double(levels)})
    key.add(x);
  key.add(fingerprint_of(build_info() + kShape.version));
  return key.value;
}

void write_lmd_shape(const std::filesystem::path& path, const LmdShape& shape, std::uint64_t key) {
  write_kept(path, kShape, key, [&](hid_t file) {
    TableWriter writer(file);
    visit_shape(writer, shape);
  });
}

LmdShape read_lmd_shape(const std::filesystem::path& path, std::uint64_t key) {
  return read_shape(path, key, nullptr);
}

CachedShape prepare_cached(DilatedShape dilated, const LmdShapeOptions& options,
                           const std::filesystem::path& folder) {
  CachedShape out;
  const std::uint64_t key = folder.empty() ? 0 : shape_key(dilated, options);
  static_cast<CacheUse&>(out) = use_folder(
      folder, key,
      [&](const std::filesystem::path& file) {
        out.shape = std::make_shared<const LmdShape>(read_shape(file, key, &dilated.complex));
      },
      [&] { out.shape = std::make_shared<const LmdShape>(prepare(std::move(dilated), options)); },
      [&](const std::filesystem::path& file) { write_lmd_shape(file, *out.shape, key); });
  return out;
}

}  // namespace aussois
