// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh_repair.hpp"

#include <algorithm>
#include <cstdio>

#include "geometry/repair_steps.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

// Flips open T-junctions and splits make triangles that flips improve. Two rounds settled every mesh seen;
// what is left after these is reported.
constexpr int kRounds = 4;

void append(RepairStep& sum, const RepairStep& step) {
  const bool worse = step.count > 0 && (sum.count == 0 || step.distance > sum.distance);
  if (worse) sum.place = step.place, sum.distance = step.distance;
  sum.count += step.count;
}

// Empty for a solid. Several fans of triangles at a vertex, as where two boxes touch in a corner, are none
// against it: every edge parts inside from outside.
std::string reason_against(const MeshReport& mesh, const OrientedComplex& oriented) {
  std::string text;
  const auto say = [&](int count, const char* one, const char* many = "") {
    if (count > 0) text += (text.empty() ? "" : ", ") + counted_noun(count, one, many);
  };
  if (mesh.triangles == 0) return "no triangles";
  say(mesh.border_edges, "border edge");
  say(mesh.wire_edges, "edge without a triangle", "edges without a triangle");
  say(mesh.non_manifold_edges, "edge with three or more triangles", "edges with three or more triangles");
  say(oriented.one_sided, "piece without an orientation", "pieces without an orientation");
  say(oriented.flat_shells, "shell without a volume", "shells without a volume");
  say(mesh.self_intersections, "self-intersecting pair of triangles", "self-intersecting pairs of triangles");
  if (text.empty() && !mesh.solid()) text = "no volume";
  return text;
}

void settle(RepairedMesh& out, OrientedComplex oriented, MeshReport mesh) {
  RepairReport& report = out.report;
  report.shells = oriented.shells;
  report.reason = reason_against(mesh, oriented);
  report.after = std::move(mesh);
  out.complex = std::move(oriented.complex);
  out.complex.solid = report.reason.empty();
}

}  // namespace

void describe(SettingVisitor& visit, RepairOptions& o) {
  visit.begin("RepairOptions");
  visit.number({"relative_tolerance", "tolerance relative to the box diagonal", "-", {0, 1e-2}},
               o.relative_tolerance);
  visit.number({"largest_tolerance", "upper bound of the tolerance", "m", range_from(0)},
               o.largest_tolerance);
}

void validate(const RepairOptions& options) {
  check_ranges(options);
}

void RepairStep::add(const Vec3& x, double moved) {
  if (count == 0 || moved > distance) place = x, distance = moved;
  ++count;
}

bool RepairReport::changed() const {
  for (const RepairStep* step :
       {&welded_same, &welded_near, &collapsed_triangles, &collapsed_wires, &duplicate_triangles,
        &flipped_slivers, &dropped_slivers, &split_edges, &turned_triangles, &turned_shells})
    if (step->count > 0) return true;
  return false;
}

RepairedMesh repair_mesh(const SimplicialComplex& complex, const RepairOptions& options) {
  validate(options);
  RepairedMesh out;
  RepairReport& report = out.report;
  report.before = report_mesh(complex);
  report.tolerance =
      std::min(options.relative_tolerance * report.before.box.diagonal(), options.largest_tolerance);

  OrientedComplex as_given = orient_surface(complex);
  if (as_given.turned_shells.count == 0 && reason_against(report.before, as_given).empty()) {
    out.vertex.resize(complex.vertices.size());
    for (std::size_t i = 0; i < out.vertex.size(); ++i) out.vertex[i] = int(i);
    settle(out, std::move(as_given), report.before);
    return out;
  }

  WeldedComplex same = weld_vertices(complex, 0);
  WeldedComplex near = weld_vertices(same.complex, report.tolerance);
  for (const int v : same.vertex) out.vertex.push_back(near.vertex[v]);
  report.welded_same = same.vertices;
  report.welded_near = near.vertices;
  for (const WeldedComplex* welded : {&same, &near}) {
    append(report.collapsed_triangles, welded->collapsed_triangles);
    append(report.collapsed_wires, welded->collapsed_wires);
  }
  DistinctComplex distinct = drop_duplicate_triangles(near.complex);
  report.duplicate_triangles = distinct.dropped;

  SimplicialComplex mended = std::move(distinct.complex);
  for (int round = 0; round < kRounds; ++round) {
    FlippedComplex flips = flip_slivers(mended, report.tolerance);
    SplitComplex splits = split_t_junctions(flips.complex, report.tolerance);
    append(report.flipped_slivers, flips.flipped);
    append(report.dropped_slivers, flips.dropped);
    append(report.split_edges, splits.inserted);
    report.slivers_left = flips.left;
    mended = std::move(splits.complex);
    if (splits.inserted.count == 0) break;
  }

  OrientedComplex oriented = orient_surface(mended);
  report.turned_triangles = oriented.turned_triangles;
  report.turned_shells = oriented.turned_shells;
  MeshReport mesh = report_mesh(oriented.complex);
  settle(out, std::move(oriented), std::move(mesh));
  return out;
}

std::string to_string(const RepairReport& report) {
  std::string text;
  char line[256];
  const auto say = [&](const RepairStep& step, const std::string& one, const std::string& many) {
    if (step.count == 0) return;
    const Vec3 mm = 1e3 * step.place;
    std::snprintf(line, sizeof line, ", %s (%.6g, %.6g, %.6g) mm",
                  step.distance > 0 ? "worst at" : "first at", mm.x(), mm.y(), mm.z());
    text += counted_noun(step.count, one, many) + line;
    if (step.distance > 0) {
      std::snprintf(line, sizeof line, " by %.3g um", 1e6 * step.distance);
      text += line;
    }
    text += '\n';
  };
  say(report.welded_same, "vertex at the place of another merged", "vertices at the place of another merged");
  std::snprintf(line, sizeof line, " nearer than %.3g um to another merged", 1e6 * report.tolerance);
  const std::string near = line;
  say(report.welded_near, "vertex" + near, "vertices" + near);
  say(report.collapsed_triangles, "triangle with welded corners dropped",
      "triangles with welded corners dropped");
  say(report.collapsed_wires, "wire with welded ends dropped", "wires with welded ends dropped");
  say(report.duplicate_triangles, "duplicate triangle dropped", "duplicate triangles dropped");
  say(report.flipped_slivers, "triangle without area flipped away", "triangles without area flipped away");
  say(report.dropped_slivers, "triangle without area at an open edge dropped",
      "triangles without area at an open edge dropped");
  say(report.split_edges, "vertex inserted into an open edge", "vertices inserted into open edges");
  say(report.turned_triangles, "triangle turned to agree with its neighbours",
      "triangles turned to agree with their neighbours");
  say(report.turned_shells, "shell turned inside out", "shells turned inside out");
  return text;
}

}  // namespace aussois
