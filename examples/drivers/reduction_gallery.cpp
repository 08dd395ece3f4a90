// SPDX-License-Identifier: Apache-2.0
// Which contacts does each reducer keep? Draws parts that stand on a plane under a slightly tilted load.
//
// Theory   doc/theory/reduction.md (RED-1) to (RED-14), doc/reduction_gallery.md
// Run      reduction_gallery -o out
// Expect   out/reduction_cylinder.svg and the same for torus, gear and peg, or only that of --mesh;
//          hull_margin keeps the margin that it promises
#include <cstdio>

#include "examples/common/driver.hpp"
#include "examples/common/run_watch.hpp"
#include "examples/common/scheme_flags.hpp"
#include "examples/studies/reduction/patch_of_four.hpp"
#include "examples/studies/reduction/selection_picture.hpp"
#include "geometry/mass_properties.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/atomic_file.hpp"
#include "io/mesh_file.hpp"
#include "io/summary.hpp"
#include "reduction/planar_patch.hpp"
#include "reduction/reduce.hpp"

using namespace aussois;

namespace {

constexpr double kDilation = 1e-3, kDensity = 1000, kMu = 0.6;

struct Arguments {
  double tilt = 12, towards = 25;  // of gravity [deg]
  std::filesystem::path mesh{};
  double scale = 1e-3;  // [m per unit of the file]
  std::string up = "z";
  SchemeFlags scheme{};
  WatchFlags watch{};
  CommonOptions common{};
};

struct Part {
  std::string name{};
  SimplicialComplex complex{};
};
std::vector<Part> parts() {
  return {{"cylinder", make_cylinder(0.05, 0.06, 64)},
          {"torus", make_torus(0.04, 0.012, 48, 24)},
          {"gear", make_extrusion(gear_profile(18, 0.04, 0.05), 0.015)},
          {"peg", make_cylinder(0.02508, 0.0676, 24)}};
}

/// The part of --mesh, turned so that it stands on the plane.
Part part_of(const Arguments& a) {
  MeshFile file = read_mesh(a.mesh, a.scale);
  const Quat turn = Quat::FromTwoVectors(Vec3::Unit(a.up[0] - 'x'), Vec3::UnitZ());
  for (Vec3& x : file.vertices) x = turn * x;
  return {a.mesh.stem().string(), make_complex(std::move(file.vertices), std::move(file.triangles))};
}

/// Contacts of a part that rests on a plate, and what each carried in the last step.
struct Resting {
  ContactSet contacts{};
  std::vector<Vec3> impulse{};
  std::vector<double> mu{};
  RunAudit audit{};
};
Resting resting(const Part& part, const Arguments& a) {
  Model model;
  const double tilt = a.tilt * kPi / 180, towards = a.towards * kPi / 180;
  model.gravity =
      9.81 * Vec3(std::sin(tilt) * std::cos(towards), std::sin(tilt) * std::sin(towards), -std::cos(tilt));
  model.contact_law = {.mu = kMu};
  const auto plate = add(model, prepare(dilate(make_plate(0.4, 0.4), kDilation)));
  const ShapeId shape = add(model, prepare(dilate(part.complex, kDilation)));
  add(model, fixed_body("plate", plate));
  const BodyId body = add(model, solid_body(part.name, shape, mass_properties(part.complex, kDensity)));
  State state = rest_state(model);
  double lowest = kInf;
  for (const Vec3& x : part.complex.vertices) lowest = std::min(lowest, x.z());
  pose(state, body).p.z() = 2 * kDilation - lowest - model.bodies[body].g_bs.p.z();
  SchemeOptions options = scheme_options(a.scheme);
  options.step.threads = a.common.threads;
  RunWatch watch(a.watch, "reduction_" + part.name, a.common.threads);
  watch.set_options(options.step);
  const Scheme scheme = watch.watched(model, make_scheme(a.scheme.scheme, model, options));
  const StepReport last = run_until(scheme, state, 10 * options.step.h);
  if (!last.ok()) throw NumericalFailure(part.name + ": " + last.reason);
  Resting out{.contacts = MoreauJean(model, {}).contacts(state, 1e-5), .audit = watch.audit()};
  const WarmStart warm = warm_start(state.memory, out.contacts);
  out.impulse = warm.impulse;
  out.mu.assign(out.contacts.points.size(), kMu);
  return out;
}

std::vector<Vec2> at(const std::vector<Vec2>& points, const std::vector<int>& members) {
  std::vector<Vec2> out;
  for (const int i : members) out.push_back(points[i]);
  return out;
}

struct Rule {
  std::string title{};
  ReductionOptions options{};
};
std::vector<Rule> rules() {
  return {{"all contacts", {.reducer = Reducer::none}},
          {"extreme_points", {.reducer = Reducer::extreme_points}},
          {"as published", {.reducer = Reducer::extreme_points, .paper_exact = true}},
          {"patch of four (engines)", {.reducer = Reducer::selector, .selector = patch_of_four_selector()}},
          {"hull_exact", {.reducer = Reducer::hull_exact}},
          {"hull_area_loss, 4", {.reducer = Reducer::hull_area_loss}},
          {"hull_margin (default)", {.reducer = Reducer::hull_margin}},
          {"direction_set, 6", {.reducer = Reducer::direction_set, .directions = 6}},
          {"wrench_cone, 0.1", {.reducer = Reducer::wrench_cone}},
          {"load_carrier", {.reducer = Reducer::load_carrier}}};
}

/// One part with all rules: its panels, what the summary holds of them.
struct Gallery {
  std::vector<SelectionPanel> panels{};
  std::vector<double> kept{}, margin{};
  bool promised = true;  // hull_margin keeps 0.9, or as many corners as it may
  RunAudit audit{};      // of the steps before
};
Gallery gallery_of(const Part& part, const Arguments& a) {
  const Resting rest = resting(part, a);
  std::vector<Vec2> points;
  std::vector<double> load;
  for (std::size_t i = 0; i < rest.contacts.points.size(); ++i) {
    const ContactPoint& c = rest.contacts.points[i];
    points.push_back(mid_point(c).head<2>());
    load.push_back(std::abs(rest.impulse[i].dot(c.normal)));
  }
  const PlanarPatch patch = planar_patch(points);
  Gallery out{.audit = rest.audit};
  for (const Rule& rule : rules()) {
    const Selection selection =
        reduce({.contacts = rest.contacts, .impulse = rest.impulse, .mu = rest.mu}, rule.options);
    const LossReport& loss = selection.loss;
    char note[96];
    std::snprintf(note, sizeof note, "%zu, m %.2f, A %.2f, t %.2f", selection.kept.size(), loss.margin,
                  loss.area, loss.torsion);
    const bool whole = rule.options.reducer == Reducer::none;
    out.panels.push_back(
        {.title = rule.title,
         .note = whole ? std::to_string(points.size()) + ", orange: what they carry"
                 : selection.kept.size() == points.size() ? "nothing left out"
                                                          : note,
         .all = points,
         .weight = whole ? load : std::vector<double>{},
         .kept = whole ? std::vector<int>{} : selection.kept,
         .hull_all = at(points, patch.hull),
         .hull_kept = whole ? std::vector<Vec2>{} : at(points, hull_of(patch, selection.kept))});
    out.kept.push_back(double(selection.kept.size()));
    out.margin.push_back(loss.margin);
    if (rule.options.reducer == Reducer::hull_margin)
      out.promised = loss.margin >= 0.9 - 1e-9 || selection.kept.size() >= 8;
    if (!a.common.quiet) std::printf("%-9s %-24s %s\n", part.name.c_str(), rule.title.c_str(), note);
  }
  return out;
}

ExitCode draw(const Arguments& a) {
  make_folders(a.common);
  Summary summary;
  bool promised = true;
  RunAudit audit;
  for (const Part& part : a.mesh.empty() ? parts() : std::vector<Part>{part_of(a)}) {
    const Gallery gallery = gallery_of(part, a);
    write_whole_file(a.common.out / ("reduction_" + part.name + ".svg"), selection_svg(gallery.panels));
    summary.set(part.name + "_kept", gallery.kept);
    summary.set(part.name + "_margin", gallery.margin);
    add(gallery.audit, audit);
    // Of a part of one's own no eight corners may keep that much: six of twelve keep 0.87, and so do eight.
    promised = promised && (gallery.promised || !a.mesh.empty());
  }
  summary.set("promised", promised);
  set_audit(audit, summary);
  set_profile(a.watch, summary);
  print_profile(a.watch);
  if (!a.common.summary.empty()) write_summary(a.common.summary, summary);
  return print_findings(audit) && promised ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("reduction_gallery", "Draws the contacts of parts on a plane before and after each reducer.");
  cli.group("scene");
  cli.option("--tilt", a.tilt, "tilt of gravity, which moves the load off the middle", "deg", {0, 30});
  cli.option("--towards", a.towards, "direction in which the load moves, about the vertical", "deg",
             {-360, 360});
  cli.group("your own part");
  cli.input("--mesh", a.mesh,
            "closed surface (OBJ, STL, PLY or OFF) that stands on a face; empty: four built-in parts");
  cli.option("--scale", a.scale, "length of one unit of the mesh file", "m", kMeshScale);
  cli.choice("--up", a.up, "axis of the mesh file that points up", {"x", "y", "z"});
  a.scheme.options.step.reduction.reducer = Reducer::none;  // the pictures show what each would leave out
  std::erase(a.scheme.schemes, "event_driven");
  a.scheme.not_offered = "not event_driven, which has no reducer";
  cli.group("stepping");
  cli.option("--h", a.scheme.options.step.h, "largest step", "s", setting_of<StepOptions>("h").range);
  add_options(cli, a.scheme);
  add_options(cli, a.watch, "parts");
  cli.common(a.common);
  cli.example("reduction_gallery -o out", "four parts, ten pictures each");
  cli.example("reduction_gallery --tilt 0", "the load in the middle");
  cli.example("reduction_gallery --mesh gear.obj --scale 0.05 --up y",
              "your own gear, with its axis along y");
  return run_driver(cli, argc, argv, [&] {
    refuse_unread_flags(cli, a.scheme);
    check(cli, a.watch.dump, a.scheme.scheme);
    return draw(a);
  });
}
