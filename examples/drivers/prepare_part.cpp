// SPDX-License-Identifier: Apache-2.0
// Shows how contact determination sees a part: the regions, chains and classes of its mesh. Also erodes the
// part by its dilation, so that the dilated part has the size of the drawing.
//
// Theory   doc/theory/erosion.md (ERO-1) to (ERO-9), doc/theory/lmd.md (LMD-4), (LMD-5), (LMD-7)
// Run      prepare_part --builtin l --erode --dilation 1e-3
//          prepare_part --builtin gear --dilation 5e-4 --erode
// Expect   faces and concave edges restored to rounding errors, convex edges of 90 degrees rounded by 0.414
//          dilations
#include <algorithm>
#include <cstdio>
#include <optional>

#include "examples/common/setting_flags.hpp"
#include "examples/drivers/assembly/assembly_input.hpp"
#include "examples/drivers/part/part_picture.hpp"
#include "geometry/check.hpp"
#include "geometry/fastener.hpp"
#include "geometry/mesh_features.hpp"
#include "geometry/primitives.hpp"
#include "io/build_info.hpp"
#include "io/mesh_file.hpp"
#include "io/summary.hpp"
#include "lmd/lmd_options.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path mesh{};
  std::string builtin = "box", fallback = "refuse";
  double scale = 1e-3, alpha = LmdOptions{}.alpha * 180 / kPi;
  ErosionOptions erosion{.depth = 2e-4};
  LmdShapeOptions shape{};
  SaidSettings said{};  // of both
  bool erode = false;
  CommonOptions common{};
  std::string command_line{};
};

AssemblyPart part_of(const Arguments& a) {
  if (!a.mesh.empty()) return read_part(a.mesh, a.scale);
  const std::vector<Vec2> l = {{0, 0}, {0.03, 0}, {0.03, 0.01}, {0.01, 0.01}, {0.01, 0.03}, {0, 0.03}};
  AssemblyPart part{.name = a.builtin};
  if (a.builtin == "box") part.complex = make_box(0.04, 0.03, 0.02);
  if (a.builtin == "l") part.complex = make_extrusion(l, 0.01);
  if (a.builtin == "gear") part.complex = make_extrusion(gear_profile(20, 0.02, 0.024), 0.01);
  if (a.builtin == "peg") part.complex = make_cylinder(0.004, 0.05, 64);
  if (a.builtin == "ball") part.complex = make_sphere(0.01, 3);
  if (a.builtin == "bolt") part.complex = make_bolt();
  if (a.builtin == "nut") part.complex = make_nut();
  part.report = report_mesh(part.complex);
  return part;
}

constexpr std::size_t kMostTriangles = 5000;  // of parts for which another depth is looked for when theirs is
                                              // refused: some ten erosions of up to a few seconds

std::string micrometres(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g um", 1e6 * x);
  return text;
}

/// Every number goes to the JSON, and what a person asks first also to the page and the terminal.
class Report {
 public:
  template <class Value>
  void add(const std::string& key, const Value& value) {
    summary.set(key, value);
  }
  void show(const std::string& name, const std::string& text) { facts.emplace_back(name, text); }
  Summary summary{};
  std::vector<std::pair<std::string, std::string>> facts{};
};

void report_mesh_and_classes(Report& report, const AssemblyPart& part, const LmdShape& shape,
                             const Idealisation& ideal, const Arguments& a) {
  const MeshReport& mesh = part.report;
  report.add("part", part.name);
  report.add("triangles", mesh.triangles);
  report.add("vertices", mesh.vertices);
  report.add("components", mesh.components);
  report.add("solid", part.complex.solid);
  report.add("border_edges", mesh.border_edges);
  report.add("non_manifold_edges", mesh.non_manifold_edges);
  report.add("misoriented_edges", mesh.misoriented_edges);
  report.add("degenerate_triangles", mesh.degenerate_triangles);
  report.add("duplicate_triangles", mesh.duplicate_triangles);
  report.add("self_intersections", mesh.self_intersections);
  report.add("size", mesh.box.diagonal());
  report.add("dilation", a.erosion.depth);
  report.add("search_bytes", search_bytes(shape));
  report.show("triangles", std::to_string(mesh.triangles));
  report.show("solid", part.complex.solid ? "yes" : "no, two-sided sheets");

  const ClassCounts counts = count_classes(shape, ideal);
  report.add("regions", ideal.region_normal.size());
  report.add("chains", ideal.chains.size());
  report.show("planar regions", std::to_string(ideal.region_normal.size()));
  report.show("straight chains", std::to_string(ideal.chains.size()));
  const double farthest = straightened_by(shape);
  report.add("straightened_vertices", shape.straightened.size());
  report.add("straightened_by", farthest);
  if (!shape.straightened.empty())
    report.show("vertices put on straight chains",
                std::to_string(shape.straightened.size()) + ", moved by up to " + micrometres(farthest));
  const std::pair<const char*, int> classes[] = {{"v_corner", counts.v_corner}, {"v_wide", counts.v_wide},
                                                 {"e_crease", counts.e_crease}, {"e_wide", counts.e_wide},
                                                 {"face", counts.face},         {"silent", counts.silent}};
  for (const auto& [name, count] : classes) {
    report.add(name, count);
    report.show(name, std::to_string(count));
  }
  const MeshFeatures features = find_mesh_features(part.complex);
  const VertexRuleCells& cells = features.cells;
  const auto active_edges = std::count_if(features.edge_class.begin(), features.edge_class.end(), is_active);
  report.add("active_edges", active_edges);
  report.add("active_vertices_both", cells.both);
  report.add("active_vertices_neither", cells.neither);
  report.add("active_vertices_only_moravanszky_terdiman", cells.only_moravanszky_terdiman);
  report.add("active_vertices_only_tangent_cone", cells.only_tangent_cone);
  report.show("edges that contacts can lie on", std::to_string(active_edges));
  const double bend = 180 / kPi * median_bend(part.complex, ideal);
  report.add("median_bend_degrees", bend);
  char text[40];
  std::snprintf(text, sizeof text, "%.3g deg", bend);
  report.show("median bend at an edge", text);
  if (bend > 0 && bend < a.alpha / 3)
    std::fprintf(
        stderr,
        "warning: half of the chains bend by less than %.3g degrees, a third of alpha: round surfaces "
        "are finer than the contacts need\n",
        a.alpha / 3);
}

void report_erosion(Report& report, const ErosionResult& eroded) {
  const ErosionMeasures& m = eroded.measures;
  report.add("erosion", to_string(eroded.status));
  report.add("erosion_reason", eroded.reason);
  report.show("erosion", to_string(eroded.status));
  if (!eroded.ok()) return;
  report.add("eroded_triangles", eroded.complex.triangles.size());
  const std::pair<const char*, double> lengths[] = {
      {"shallow", m.shallow},     {"face_error", m.face_error},       {"edge_error", m.edge_error},
      {"rounding", m.rounding},   {"edge_rounding", m.edge_rounding}, {"rounding_bound", m.rounding_bound},
      {"hausdorff", m.hausdorff}, {"thickness", m.thickness},         {"deviation", m.deviation}};
  for (const auto& [name, length] : lengths) {
    report.add(name, length);
    report.show(name, micrometres(length));
  }
  report.add("volume_lost", m.volume_lost);
  report.add("convex_chains", m.convex_chains);
  report.add("concave_chains", m.concave_chains);
  report.add("split_vertices", m.split_vertices);
  report.add("merged_vertices", m.merged_vertices);
  report.add("deviating_vertices", m.deviating_vertices);
  report.add("samples", m.samples);
  report.add("face_samples", m.face_samples);
  report.show("split, merged, deviating vertices", std::to_string(m.split_vertices) + ", " +
                                                       std::to_string(m.merged_vertices) + ", " +
                                                       std::to_string(m.deviating_vertices));
}

/// Says why, and what can be done.
void report_refusal(Report& report, const SimplicialComplex& part, const ErosionResult& eroded,
                    const ErosionOptions& options, bool as_it_is) {
  std::string text = (as_it_is ? "warning: not eroded: " : "refused: ") + eroded.reason;
  if (as_it_is) text += "; the dilation adds to its size";
  if (eroded.status != ErosionStatus::not_solid && part.triangles.size() <= kMostTriangles) {
    const std::optional<double> depth = erodible_depth(part, options);
    text += depth ? "; it erodes by up to " + micrometres(*depth) + ", found by bisection"
                  : "; it does not erode by a thousandth of that either";
    if (depth) report.add("erodible_depth", *depth);
    if (depth) report.show("erodes by up to", micrometres(*depth));
  }
  std::fprintf(stderr, "%s\n", text.c_str());
}

ExitCode prepare_part(const Arguments& a) {
  // 1. The part as it is.
  const AssemblyPart part = part_of(a);
  for (const std::string& note : part.notes) std::fprintf(stderr, "warning: %s\n", note.c_str());
  require(!part.complex.triangles.empty(), "the part has no triangles");
  const LmdShape shape = prepare({.complex = part.complex, .radius = a.erosion.depth}, a.shape);
  const Idealisation ideal = idealise(part.complex, shape.tolerance);
  Report report;
  report_mesh_and_classes(report, part, shape, ideal, a);

  // 2. The part made smaller by the dilation to come.
  make_folders(a.common);
  ErosionResult eroded;
  if (a.erode) {
    eroded = erode(part.complex, a.erosion);
    report_erosion(report, eroded);
    if (eroded.ok())
      write_obj(a.common.out / "eroded.obj",
                {.vertices = eroded.complex.vertices.to_vector(),
                 .triangles = eroded.complex.triangles.to_vector()},
                a.scale);
    else
      report_refusal(report, part.complex, eroded, a.erosion, a.fallback == "none");
  }

  // 3. The picture and the numbers.
  PartPicture picture = part_picture(shape, ideal, eroded.complex, eroded.triangle_region);
  picture.title = "prepare_part " + part.name;
  picture.command_line = a.command_line;
  picture.build = build_info();
  picture.facts = report.facts;
  write_part_html(a.common.out / "part.html", picture);
  if (!a.common.summary.empty()) write_summary(a.common.summary, report.summary);

  if (!a.common.quiet) std::fputs(to_string(part.report).c_str(), stdout);
  if (!a.common.quiet)
    for (const auto& [name, text] : report.facts) std::printf("%-36s %s\n", name.c_str(), text.c_str());
  if (!a.erode) {
    std::printf("prepare_part: %s, %s\n",
                counted_noun(std::int64_t(ideal.region_normal.size()), "region").c_str(),
                counted_noun(std::int64_t(ideal.chains.size()), "chain").c_str());
    return ExitCode::ok;
  }
  if (!eroded.ok()) {
    std::printf("prepare_part: not eroded (%s)\n", to_string(eroded.status));
    return a.fallback == "none" ? ExitCode::ok : ExitCode::not_accepted;
  }
  std::printf("prepare_part: eroded by %s; dilation restores faces to %.1e of the size and rounds by %s\n",
              micrometres(a.erosion.depth).c_str(), eroded.measures.face_error / part.report.box.diagonal(),
              micrometres(eroded.measures.rounding).c_str());
  return ExitCode::ok;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  Cli cli(
      "prepare_part",
      "Prepares a part for the search for contacts and shows its regions, chains and classes; with --erode, "
      "shrinks it by its dilation first.");
  cli.group("part");
  cli.input("--mesh", a.mesh, "mesh of the part (OBJ, STL, PLY or OFF); empty: --builtin");
  cli.choice("--builtin", a.builtin, "built-in part, used if no --mesh is given",
             {"box", "l", "gear", "peg", "ball", "bolt", "nut"});
  cli.option("--scale", a.scale, "length of one unit of the mesh file", "m", kMeshScale);
  add_flags(cli, a.shape, a.said);
  cli.option("--alpha", a.alpha,
             "enlargement of normal cones; only used to warn about meshes that are too fine", "deg",
             in_degrees(setting_of<LmdOptions>("alpha")).range);
  cli.group("erosion");
  const std::vector<OfferedSetting> erosion = offered(a.erosion, a.said);
  add_flags(cli, erosion, a.said, {"--dilation"});
  cli.flag("--erode", a.erode, "first make the part smaller by the dilation");
  cli.choice("--fallback", a.fallback,
             "if the part cannot be eroded: refuse exits with code 1, none keeps the part as it is",
             {"refuse", "none"});
  add_flags(cli, erosion, a.said, {"--deviation", "--no-split", "--max-rounding", "--samples"});
  cli.group("output");
  cli.option("--json", a.common.summary, "the same as --summary");
  cli.common(a.common, Cli::Restart::no, Cli::Threads::no);
  cli.example("prepare_part --builtin gear --erode --dilation 2e-4", "open out/part.html; out/eroded.obj");
  cli.example("prepare_part --mesh bracket.obj --scale 1e-3 --dilation 1e-4 --erode --json part.json",
              "your own part, in millimetres");
  return run_driver(cli, argc, argv, [&] {
    take(a.said, a.erosion);
    take(a.said, a.shape);
    return prepare_part(a);
  });
}
