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
#include "io/mesh_file.hpp"
#include "io/pose_file.hpp"

namespace aussois {
namespace {

std::string content_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error(path.string() + ": cannot be read");
  return text.str();
}

// Takes the repaired mesh as the part's complex; every repair becomes a note.
void settle(AssemblyPart& part, const SimplicialComplex& complex, const RepairOptions& options) {
  RepairedMesh repaired = repair_mesh(complex, options);
  part.complex = std::move(repaired.complex);
  part.repair = std::move(repaired.report);
  part.report = part.repair.after;
  std::istringstream lines(to_string(part.repair));
  for (std::string line; std::getline(lines, line);) part.notes.push_back(part.name + ": " + line);
  if (!part.complex.solid && !part.complex.triangles.empty())
    part.notes.push_back(part.name +
                         ": used as two-sided sheets, because it is not a solid: " + part.repair.reason);
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

AssemblyPart read_part(const std::filesystem::path& path, double scale, const RepairOptions& options) {
  MeshFile mesh = read_mesh(path, scale);
  weld_mesh_file(mesh);
  AssemblyPart part{.name = path.stem().string()};
  if (const std::string notes = to_string(mesh.notes); !notes.empty())
    part.notes.push_back(part.name + ": " + notes);
  SimplicialComplex complex;
  try {
    complex = make_complex(std::move(mesh.vertices), std::move(mesh.triangles), mesh.wires);
  } catch (const std::invalid_argument& e) {
    throw std::runtime_error(path.string() + ": " + e.what());
  }
  settle(part, complex, options);
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
                                  const std::filesystem::path& path, double scale) {
  AssemblyInput input{.name = moving.stem().string() + "_in_" + fixed.stem().string()};
  const PoseFile poses = read_poses(path, scale);
  input.poses = poses.pose;
  for (const int line : poses.line) input.place_of_pose.push_back(path.string() + ":" + std::to_string(line));
  input.fixed = read_part(fixed, scale);
  input.moving = read_part(moving, scale);
  if (input.moving.name == input.fixed.name) input.moving.name += "_moving";
  std::ostringstream text;
  for (const auto& file : {fixed, moving, path}) text << fingerprint_of(content_of(file)) << ' ';
  text << std::hexfloat << scale;
  input.fingerprint = text.str();
  return input;
}

AssemblyInput read_assembly_pair(const std::filesystem::path& data, const std::string& pair, double scale) {
  const PairFiles files = find_pair(data / "assembly" / "pairs.csv", pair);
  const auto mesh = [&](const std::string& name) { return data / "meshes" / (name + ".obj"); };
  AssemblyInput input =
      read_assembly_files(mesh(files.fixed), mesh(files.moving), data / "assembly" / files.trajectory, scale);
  input.name = pair;
  return input;
}

AssemblyInput builtin_assembly(const std::string& name) {
  require(name == "bolt_nut", "--builtin = " + name + " must be bolt_nut");
  const FastenerOptions options;
  AssemblyInput input{.name = name, .fixed = {.name = "bolt"}, .moving = {.name = "nut"}};
  settle(input.fixed, make_bolt(options), {});
  settle(input.moving, make_nut(options), {});
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
