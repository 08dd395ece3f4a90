// SPDX-License-Identifier: Apache-2.0
#include "io/part_mesh.hpp"

#include <sstream>
#include <stdexcept>
#include <utility>

#include "geometry/digest.hpp"
#include "io/build_info.hpp"
#include "io/checkpoint.hpp"
#include "io/kept_tables.hpp"
#include "io/mesh_file.hpp"
#include "io/shape_check.hpp"

namespace aussois {
namespace {

constexpr KeptKind kMesh{.format = "aussois-part-mesh", .version = "1"};

std::uint64_t key_of(const std::filesystem::path& path, double scale, const RepairOptions& options) {
  const auto& [relative_tolerance, largest_tolerance] = options;
  Digest key;
  key.add(bytes_of_file(path).bytes);
  key.add(fingerprint_of(path.extension().string()));  // by which the file is read
  for (const double x : {scale, relative_tolerance, largest_tolerance}) key.add(x);
  key.add(fingerprint_of(build_info() + kMesh.version));
  return key.value;
}

template <class Archive, class Report>
void visit_report(Archive& archive, Report& report) {
  auto& [vertices, edges, triangles, components, isolated_vertices, wire_edges, border_edges,
         non_manifold_edges, non_manifold_vertices, misoriented_edges, degenerate_triangles,
         duplicate_vertices, duplicate_triangles, self_intersections, min_height_ratio, box, volume, closed,
         oriented, manifold] = report;
  archive.one("/report/vertices", vertices);
  archive.one("/report/edges", edges);
  archive.one("/report/triangles", triangles);
  archive.one("/report/components", components);
  archive.one("/report/isolated_vertices", isolated_vertices);
  archive.one("/report/wire_edges", wire_edges);
  archive.one("/report/border_edges", border_edges);
  archive.one("/report/non_manifold_edges", non_manifold_edges);
  archive.one("/report/non_manifold_vertices", non_manifold_vertices);
  archive.one("/report/misoriented_edges", misoriented_edges);
  archive.one("/report/degenerate_triangles", degenerate_triangles);
  archive.one("/report/duplicate_vertices", duplicate_vertices);
  archive.one("/report/duplicate_triangles", duplicate_triangles);
  archive.one("/report/self_intersections", self_intersections);
  archive.one("/report/min_height_ratio", min_height_ratio);
  archive.one("/report/box/lo", box.lo);
  archive.one("/report/box/hi", box.hi);
  archive.one("/report/volume", volume);
  archive.one("/report/closed", closed);
  archive.one("/report/oriented", oriented);
  archive.one("/report/manifold", manifold);
}

}  // namespace

PartMesh read_kept_mesh(const std::filesystem::path& path, std::uint64_t key) {
  const Hdf5Silence silence;
  const auto [bytes, file] = open_kept(path, kMesh, key);
  PartMesh out;
  TableReader reader(file, bytes);
  visit_complex(reader, out.complex);
  visit_report(reader, out.report);
  out.notes = read_texts(file, "/notes");
  check_complex(file, out.complex);
  drop_pages(bytes);
  return out;
}

void write_kept_mesh(const std::filesystem::path& path, const PartMesh& mesh, std::uint64_t key) {
  write_kept(path, kMesh, key, [&](hid_t file) {
    TableWriter writer(file);
    visit_complex(writer, mesh.complex);
    visit_report(writer, mesh.report);
    write_texts(file, "/notes", mesh.notes);
  });
}

PartMesh repaired_part(const SimplicialComplex& complex, const RepairOptions& options) {
  RepairedMesh repaired = repair_mesh(complex, options);
  PartMesh out{.complex = std::move(repaired.complex), .report = repaired.report.after};
  std::istringstream lines(to_string(repaired.report));
  for (std::string line; std::getline(lines, line);) out.notes.push_back(line);
  if (!out.complex.solid && !out.complex.triangles.empty())
    out.notes.push_back("used as two-sided sheets, because it is not a solid: " + repaired.report.reason);
  return out;
}

PartMesh read_part_mesh(const std::filesystem::path& path, double scale, const RepairOptions& options) {
  MeshFile mesh = read_mesh(path, scale);
  weld_mesh_file(mesh);
  SimplicialComplex complex;
  try {
    complex = make_complex(std::move(mesh.vertices), std::move(mesh.triangles), mesh.wires);
  } catch (const std::invalid_argument& e) {
    throw std::runtime_error(path.string() + ": " + e.what());
  }
  PartMesh out = repaired_part(complex, options);
  if (const std::string notes = to_string(mesh.notes); !notes.empty())
    out.notes.insert(out.notes.begin(), notes);
  return out;
}

CachedPartMesh read_part_mesh_cached(const std::filesystem::path& path, double scale,
                                     const RepairOptions& options, const std::filesystem::path& folder) {
  CachedPartMesh out;
  const std::uint64_t key = folder.empty() ? 0 : key_of(path, scale, options);
  static_cast<CacheUse&>(out) = use_folder(
      folder, key, [&](const std::filesystem::path& file) { out.mesh = read_kept_mesh(file, key); },
      [&] { out.mesh = read_part_mesh(path, scale, options); },
      [&](const std::filesystem::path& file) { write_kept_mesh(file, out.mesh, key); });
  return out;
}

}  // namespace aussois
