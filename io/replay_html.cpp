// SPDX-License-Identifier: Apache-2.0
#include "io/replay_html.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "geometry/settings.hpp"
#include "geometry/simplicial_complex.hpp"
#include "io/html_page.hpp"

namespace aussois {

void describe(SettingVisitor& visit, ReplayOptions& o) {
  visit.begin("ReplayOptions");
  visit.count({"max_frames", "poses and contacts shown", "", range_from(2)}, o.max_frames);
  visit.count({"max_plot_points", "points of a curve", "", range_from(2)}, o.max_plot_points);
}

namespace {

void append(std::vector<float>& values, const Vec3& x) {
  for (const double coordinate : x) values.push_back(float(coordinate));
}

Vec3 centre_of(const RunMesh& mesh) {
  Box box;
  for (const Vec3& vertex : mesh.vertices) {
    box.lo = box.lo.cwiseMin(vertex);
    box.hi = box.hi.cwiseMax(vertex);
  }
  return mesh.vertices.empty() ? Vec3::Zero() : Vec3(0.5 * (box.lo + box.hi));
}

/// Rows shown: the first, the last, and evenly between them.
std::vector<std::size_t> frame_rows(std::size_t rows, int max_frames) {
  const std::size_t count = std::min(rows, std::size_t(max_frames));
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < count; ++i) shown.push_back(count == 1 ? 0 : i * (rows - 1) / (count - 1));
  return shown;
}

/// A contact as seen by the body that moves: where it touches, the normal towards it, the force on it.
struct ShownContact {
  Vec3 point, normal, force;
};
ShownContact shown(const RunHeader& header, const RunStep& step, const RunContact& contact) {
  const auto fixed = [&](int side) { return header.bodies[contact.pair[side]].fixed; };
  const Vec3 force = step.h > 0 ? Vec3(contact.impulse / step.h) : Vec3::Zero();
  if (fixed(0) && !fixed(1)) return {contact.point_b, -contact.normal, -force};
  return {contact.point, contact.normal, force};
}

/// Meshes around their own centre, so that float32 keeps eight digits of the shape and not of its place.
void add_meshes(PageArrays& arrays, const RunHeader& header) {
  int index = 0;
  for (const auto& [name, mesh] : header.meshes) {
    const Vec3 centre = centre_of(mesh);
    std::vector<float> vertices;
    std::vector<std::int32_t> faces, wires;
    for (const Vec3& vertex : mesh.vertices) append(vertices, vertex - centre);
    for (const auto& face : mesh.faces) faces.insert(faces.end(), face.begin(), face.end());
    for (const auto& wire : mesh.wires) wires.insert(wires.end(), wire.begin(), wire.end());
    const std::string prefix = "mesh" + std::to_string(index++) + ".";
    arrays.add(prefix + "vertices", vertices);
    arrays.add(prefix + "faces", faces);
    arrays.add(prefix + "wires", wires);
  }
}

double number_or_nan(double x) {
  return std::isfinite(x) ? x : std::numeric_limits<double>::quiet_NaN();
}

/// What the page draws: poses of the centred meshes, vertices of bodies that deform around the centres of
/// their meshes, contacts and joints; places relative to `origin`.
struct Frames {
  std::vector<std::int64_t> step{};
  std::vector<float> pose{}, vertices{}, field{}, point{}, normal{}, force{}, gap{};
  std::vector<std::int32_t> offset{0};
  // Of every joint: three numbers along its axes, or the size of a vector
  std::vector<float> coordinate{}, joint_force{}, joint_torque{}, effort{};
};

/// `centres` are those of the bodies' meshes.
void add_bodies(const RunHeader& header, const RunStep& step, const std::vector<Vec3>& centres,
                const Vec3& origin, Frames& out) {
  auto vertex = step.vertices.begin();
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    const RunBody& body = header.bodies[i];
    SE3 g = step.pose[i] * body.g_bs;
    if (!body.mesh.empty()) g.p = g * centres[i];
    append(out.pose, g.p - origin);
    for (const double q : {g.R.x(), g.R.y(), g.R.z(), g.R.w()}) out.pose.push_back(float(q));
    for (int k = 0; k < body.moving_vertices; ++k) append(out.vertices, *vertex++ - centres[i]);
  }
}

void add_frame(const RunHeader& header, const RunStep& step, const std::vector<Vec3>& centres,
               const Vec3& origin, Frames& out) {
  out.step.push_back(step.step);
  add_bodies(header, step, centres, origin, out);
  for (const double value : step.field) out.field.push_back(float(number_or_nan(value)));
  for (const RunContact& contact : step.contacts) {
    const ShownContact c = shown(header, step, contact);
    append(out.point, c.point - origin);
    append(out.normal, c.normal);
    append(out.force, c.force);
    out.gap.push_back(float(contact.gap));
  }
  out.offset.push_back(std::int32_t(out.gap.size()));
  for (const RunJoint& joint : step.joints) {
    append(out.coordinate, joint.coordinate);
    out.joint_force.push_back(float(joint.force.norm()));
    out.joint_torque.push_back(float(joint.torque.norm()));
    append(out.effort, joint.effort);
  }
}

void add_arrays(const Frames& frames, PageArrays& arrays) {
  arrays.add("pose", frames.pose);
  arrays.add("vertices", frames.vertices);
  arrays.add("field", frames.field);
  arrays.add("contact.offset", frames.offset);
  arrays.add("contact.point", frames.point);
  arrays.add("contact.normal", frames.normal);
  arrays.add("contact.force", frames.force);
  arrays.add("contact.gap", frames.gap);
  arrays.add("joint.coordinate", frames.coordinate);
  arrays.add("joint.force", frames.joint_force);
  arrays.add("joint.torque", frames.joint_torque);
  arrays.add("joint.effort", frames.effort);
}

double contact_force(const RunHeader& header, const RunStep& step) {
  Vec3 sum = Vec3::Zero();
  for (const RunContact& contact : step.contacts) sum += shown(header, step, contact).force;
  return sum.norm();
}

/// The numbers of a step that the page shows, each with what survives when a curve is thinned.
struct Quantity {
  std::string name;
  std::function<double(const RunHeader&, const RunStep&)> value;
  double (*worse)(double, double);
};
double last(double, double next) {
  return next;
}
double smaller(double a, double b) {
  return std::fmin(a, b);
}
double larger(double a, double b) {
  return std::fmax(a, b);
}
const std::vector<Quantity>& quantities() {
  using H = RunHeader;
  using S = RunStep;
  static const std::vector<Quantity> list = {
      {"time", [](const H&, const S& s) { return s.time; }, last},
      {"h", [](const H&, const S& s) { return s.h; }, smaller},
      {"kinetic", [](const H&, const S& s) { return s.kinetic; }, last},
      {"total", [](const H&, const S& s) { return s.kinetic + s.gravity + s.laws; }, last},
      {"min_gap", [](const H&, const S& s) { return number_or_nan(s.min_gap); }, smaller},
      {"residual", [](const H&, const S& s) { return s.residual; }, larger},
      {"iterations", [](const H&, const S& s) { return double(s.iterations); }, larger},
      {"contacts", [](const H&, const S& s) { return double(s.contacts.size()); }, larger},
      {"coupling", [](const H&, const S& s) { return s.coupling_force.norm(); }, larger},
      {"contact_force", contact_force, larger},
  };
  return list;
}

double farther_from_zero(double a, double b) {
  return std::abs(b) > std::abs(a) || std::isnan(a) ? b : a;
}

/// Those of every page, and the gauges of the run.
std::vector<Quantity> quantities_of(const RunHeader& header) {
  std::vector<Quantity> out = quantities();
  for (Eigen::Index i = 0; i < Eigen::Index(header.gauges.size()); ++i)
    out.push_back({"gauge" + std::to_string(i),
                   [i](const RunHeader&, const RunStep& s) { return number_or_nan(s.gauges[i]); },
                   farther_from_zero});
  return out;
}

/// A quantity at the frames, and its curve: each point keeps the worst of its bucket of steps.
struct Curve {
  std::vector<float> at_frames{}, points{};
  double kept = 0;
};

/// The bucket of a row: point i stands for the rows from i * steps / points on.
bool begins_bucket(std::size_t row, std::size_t point, std::size_t steps, std::size_t points) {
  return point < points && row == point * steps / points;
}

Summary page_header(const RunHeader& header, std::size_t recorded,
                    const std::vector<std::int64_t>& shown_steps) {
  std::vector<std::string> mesh_names, body_names, fields, field_units;
  for (const auto& named : header.meshes) mesh_names.push_back(named.first);
  std::vector<std::int64_t> mesh, fixed, moving;
  std::vector<double> dilation;
  for (const RunBody& body : header.bodies) {
    const auto found = std::find(mesh_names.begin(), mesh_names.end(), body.mesh);
    mesh.push_back(found == mesh_names.end() ? -1 : found - mesh_names.begin());
    body_names.push_back(body.name);
    fixed.push_back(body.fixed && body.moving_vertices == 0 ? 1 : 0);
    moving.push_back(body.moving_vertices);
    dilation.push_back(body.dilation);
    fields.push_back(body.field);
    field_units.push_back(body.field_unit);
  }
  Summary page;
  page.set("title", header.title);
  page.set("command_line", header.command_line);
  page.set("build", header.build);
  page.set("recorded", recorded);
  page.set("step", shown_steps);
  page.set("mesh_name", mesh_names);
  page.set("body_name", body_names);
  page.set("body_mesh", mesh);
  page.set("body_fixed", fixed);
  page.set("body_moving_vertices", moving);
  page.set("body_dilation", dilation);
  page.set("body_field", fields);
  page.set("body_field_unit", field_units);
  std::vector<std::string> joint_names, joint_kinds;
  for (const RunJointName& joint : header.joints)
    joint_names.push_back(joint.name), joint_kinds.push_back(joint.kind);
  page.set("joint_name", joint_names);
  page.set("joint_kind", joint_kinds);
  page.set("gauge_name", header.gauges);
  return page;
}

/// Where the moving bodies (or, without any, all) begin: a near origin for float32.
Vec3 origin_of(const RunHeader& header, const RunStep& start) {
  Vec3 moving = Vec3::Zero(), all = Vec3::Zero();
  double moving_count = 0;
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    all += start.pose[i].p;
    if (header.bodies[i].fixed) continue;
    moving += start.pose[i].p;
    ++moving_count;
  }
  if (moving_count > 0) return moving / moving_count;
  return header.bodies.empty() ? Vec3::Zero() : Vec3(all / double(header.bodies.size()));
}

/// One pass over the steps, `step_of(row)` for each in order.
void write_page_of(const std::filesystem::path& html, const RunHeader& header, std::size_t steps,
                   const std::function<const RunStep&(std::size_t)>& step_of, const ReplayOptions& options) {
  check_ranges(options);
  require(steps > 0, "write_replay_html: the run has no steps");
  validate(header);
  const std::vector<std::size_t> rows = frame_rows(steps, options.max_frames);
  const std::size_t points = std::min(steps, std::size_t(options.max_plot_points));
  std::vector<Vec3> centres;
  for (const RunBody& body : header.bodies)
    centres.push_back(body.mesh.empty() ? Vec3::Zero() : centre_of(header.meshes.at(body.mesh)));
  Vec3 origin = Vec3::Zero();
  Frames frames;
  const std::vector<Quantity> shown_quantities = quantities_of(header);
  std::vector<Curve> curves(shown_quantities.size());
  std::size_t point = 0;
  for (std::size_t row = 0; row < steps; ++row) {
    const RunStep& step = step_of(row);
    validate(header, step);
    if (row == 0) origin = origin_of(header, step);
    const bool is_frame = frames.step.size() < rows.size() && row == rows[frames.step.size()];
    const bool begins = begins_bucket(row, point, steps, points);
    for (std::size_t i = 0; i < curves.size(); ++i) {
      const Quantity& quantity = shown_quantities[i];
      Curve& curve = curves[i];
      const double value = quantity.value(header, step);
      if (is_frame) curve.at_frames.push_back(float(value));
      if (begins && row > 0) curve.points.push_back(float(curve.kept));
      curve.kept = begins ? value : quantity.worse(curve.kept, value);
    }
    if (is_frame) add_frame(header, step, centres, origin, frames);
    point += begins;
  }
  PageArrays arrays;
  add_meshes(arrays, header);
  add_arrays(frames, arrays);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    curves[i].points.push_back(float(curves[i].kept));
    arrays.add("frame." + shown_quantities[i].name, curves[i].at_frames);
    arrays.add("curve." + shown_quantities[i].name, curves[i].points);
  }
  write_page(html, page_header(header, steps, frames.step), arrays);
}

}  // namespace

void write_replay_html(const std::filesystem::path& html, const RunData& run, const ReplayOptions& options) {
  write_page_of(
      html, run.header, run.steps.size(), [&](std::size_t row) -> const RunStep& { return run.steps[row]; },
      options);
}

void write_replay_html(const std::filesystem::path& html, RunReader& run, const ReplayOptions& options) {
  write_page_of(
      html, run.header(), run.steps(), [&](std::size_t row) -> const RunStep& { return run.step(row); },
      options);
}

}  // namespace aussois
