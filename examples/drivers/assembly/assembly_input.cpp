// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/assembly_input.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "geometry/check.hpp"
#include "geometry/fastener.hpp"
#include "geometry/number_text.hpp"
#include "io/checkpoint.hpp"
#include "io/pose_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

AssemblyPart named_part(std::string name, PartMesh mesh) {
  AssemblyPart out{.name = std::move(name), .complex = std::move(mesh.complex), .report = mesh.report};
  for (const std::string& note : mesh.notes) out.notes.push_back(out.name + ": " + note);
  return out;
}

struct PairFiles {
  std::string fixed{}, moving{}, trajectory{};
};

PairFiles find_pair(const std::filesystem::path& table, const std::string& pair) {
  std::ifstream in(table);
  if (!in) throw std::runtime_error(table.string() + ": cannot be read");
  std::string line, known;
  for (int row = 1; std::getline(in, line); ++row) {
    if (line.ends_with('\r')) line.pop_back();
    std::istringstream fields(line);
    std::string name;
    PairFiles files;
    std::getline(fields, name, ',');
    std::getline(fields, files.fixed, ',');
    std::getline(fields, files.moving, ',');
    std::getline(fields, files.trajectory, ',');
    if (row == 1) continue;
    if (files.trajectory.empty())
      throw std::runtime_error(table.string() + ":" + std::to_string(row) +
                               ": four columns expected: name,fixed,moving,trajectory");
    if (name == pair) return files;
    known += " " + name;
  }
  throw std::invalid_argument("--pair = " + pair + " must be one of" + known);
}

}  // namespace

AssemblyPart read_part(const std::filesystem::path& path, double scale, const RepairOptions& options,
                       const std::filesystem::path& cache) {
  CachedPartMesh cached = read_part_mesh_cached(path, scale, options, cache);
  AssemblyPart part = named_part(path.stem().string(), std::move(cached.mesh));
  part.cache = std::move(cached);
  return part;
}

double straightened_by(const LmdShape& shape) {
  double farthest = 0;
  for (const auto& [v, from] : shape.straightened)
    farthest = std::max(farthest, (shape.complex.vertices[v] - from).norm());
  return farthest;
}

void note_straightened(AssemblyPart& part, const LmdShape& shape) {
  if (shape.straightened.empty()) return;
  char way[40];
  std::snprintf(way, sizeof way, "%.3g um", 1e6 * straightened_by(shape));
  part.notes.push_back(part.name + ": " +
                       counted_noun(std::int64_t(shape.straightened.size()), "vertex", "vertices") +
                       " put on straight chains, moved by up to " + way);
}

AssemblyInput read_assembly_files(const std::filesystem::path& fixed, const std::filesystem::path& moving,
                                  const std::filesystem::path& path, double scale,
                                  const std::filesystem::path& cache) {
  AssemblyInput input{.name = moving.stem().string() + "_in_" + fixed.stem().string()};
  const PoseFile poses = read_poses(path, scale);
  input.poses = poses.pose;
  for (const int line : poses.line) input.place_of_pose.push_back(path.string() + ":" + std::to_string(line));
  input.fixed = read_part(fixed, scale, {}, cache);
  input.moving = read_part(moving, scale, {}, cache);
  if (input.moving.name == input.fixed.name) input.moving.name += "_moving";
  std::ostringstream text;
  for (const auto& file : {fixed, moving, path}) text << fingerprint_of(read_file(file)) << ' ';
  text << std::hexfloat << scale;
  input.fingerprint = text.str();
  return input;
}

AssemblyInput read_assembly_pair(const std::filesystem::path& data, const std::string& pair, double scale,
                                 const std::filesystem::path& cache) {
  const PairFiles files = find_pair(data / "assembly" / "pairs.csv", pair);
  const auto mesh = [&](const std::string& name) { return data / "meshes" / (name + ".obj"); };
  AssemblyInput input = read_assembly_files(mesh(files.fixed), mesh(files.moving),
                                            data / "assembly" / files.trajectory, scale, cache);
  input.name = pair;
  return input;
}

AssemblyInput builtin_assembly(const std::string& name) {
  require(name == "bolt_nut", "--builtin = " + name + " must be bolt_nut");
  const FastenerOptions options;
  AssemblyInput input{.name = name,
                      .fixed = named_part("bolt", repaired_part(make_bolt(options))),
                      .moving = named_part("nut", repaired_part(make_nut(options)))};
  for (int i = 0; i <= 108; ++i) {  // every five degrees, from a twelfth of a turn above the head
    const double angle = kPi / 6 + i * kPi / 36;
    input.poses.push_back(rotation(Vec3::UnitZ(), angle) *
                          translation(0, 0, options.pitch * angle / (2 * kPi)));
  }
  input.fingerprint = name;
  return input;
}

PartMass part_mass(const AssemblyPart& part, double dilation, double density, double mass) {
  PartMass out;
  if (part.complex.solid)
    out = {mass_properties(part.complex, density), "solid"};
  else if (part.complex.triangles.empty())
    out = {wire_mass_properties(part.complex, dilation, density), "balls and capsules"};
  else
    out = {convex_hull_mass_properties(part.complex, density), "convex hull"};
  if (mass > 0) {
    out.properties.inertia *= mass / out.properties.mass;
    out.properties.mass = mass;
    out.source += ", given mass";
  }
  return out;
}

}  // namespace aussois
