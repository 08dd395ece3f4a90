// SPDX-License-Identifier: Apache-2.0
#include "io/replay_html.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "geometry/check.hpp"
#include "geometry/simplicial_complex.hpp"
#include "io/html_page.hpp"

namespace aussois {

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
  const auto fixed = [&](int side) {
    return header.bodies[std::size_t(contact.pair[std::size_t(side)])].fixed;
  };
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

/// Poses of the centred meshes, relative to `origin`.
void add_poses(PageArrays& arrays, const RunData& run, const std::vector<std::size_t>& rows,
               const Vec3& origin) {
  std::vector<float> pose;
  for (const std::size_t row : rows)
    for (std::size_t i = 0; i < run.header.bodies.size(); ++i) {
      const RunBody& body = run.header.bodies[i];
      SE3 g = run.steps[row].pose[i] * body.g_bs;
      if (!body.mesh.empty()) g.p = g * centre_of(run.header.meshes.at(body.mesh));
      append(pose, g.p - origin);
      for (const double q : {g.R.x(), g.R.y(), g.R.z(), g.R.w()}) pose.push_back(float(q));
    }
  arrays.add("pose", pose);
}

/// Of the bodies that deform, around the centres of their meshes as of add_meshes.
void add_vertices(PageArrays& arrays, const RunData& run, const std::vector<std::size_t>& rows) {
  std::vector<float> vertices;
  for (const std::size_t row : rows) {
    auto vertex = run.steps[row].vertices.begin();
    for (const RunBody& body : run.header.bodies) {
      const Vec3 centre =
          body.moving_vertices > 0 ? centre_of(run.header.meshes.at(body.mesh)) : Vec3::Zero();
      for (int i = 0; i < body.moving_vertices; ++i) append(vertices, *vertex++ - centre);
    }
  }
  arrays.add("vertices", vertices);
}

void add_contacts(PageArrays& arrays, const RunData& run, const std::vector<std::size_t>& rows,
                  const Vec3& origin) {
  std::vector<std::int32_t> offset{0};
  std::vector<float> point, normal, force, gap;
  for (const std::size_t row : rows) {
    for (const RunContact& contact : run.steps[row].contacts) {
      const ShownContact c = shown(run.header, run.steps[row], contact);
      append(point, c.point - origin);
      append(normal, c.normal);
      append(force, c.force);
      gap.push_back(float(contact.gap));
    }
    offset.push_back(std::int32_t(gap.size()));
  }
  arrays.add("contact.offset", offset);
  arrays.add("contact.point", point);
  arrays.add("contact.normal", normal);
  arrays.add("contact.force", force);
  arrays.add("contact.gap", gap);
}

/// Of every joint at every frame: three numbers along its axes, or the size of a vector.
void add_joints(PageArrays& arrays, const RunData& run, const std::vector<std::size_t>& rows) {
  std::vector<float> coordinate, force, torque, effort;
  for (const std::size_t row : rows)
    for (const RunJoint& joint : run.steps[row].joints) {
      append(coordinate, joint.coordinate);
      force.push_back(float(joint.force.norm()));
      torque.push_back(float(joint.torque.norm()));
      append(effort, joint.effort);
    }
  arrays.add("joint.coordinate", coordinate);
  arrays.add("joint.force", force);
  arrays.add("joint.torque", torque);
  arrays.add("joint.effort", effort);
}

double contact_force(const RunHeader& header, const RunStep& step) {
  Vec3 sum = Vec3::Zero();
  for (const RunContact& contact : step.contacts) sum += shown(header, step, contact).force;
  return sum.norm();
}

/// The numbers of a step that the page shows, each with what survives when a curve is thinned.
struct Quantity {
  const char* name;
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
double number_or_nan(double x) {
  return std::isfinite(x) ? x : std::numeric_limits<double>::quiet_NaN();
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

void add_quantities(PageArrays& arrays, const RunData& run, const std::vector<std::size_t>& rows,
                    int max_points) {
  const std::size_t steps = run.steps.size(), points = std::min(steps, std::size_t(max_points));
  for (const Quantity& quantity : quantities()) {
    std::vector<float> at_frames, curve;
    for (const std::size_t row : rows) at_frames.push_back(float(quantity.value(run.header, run.steps[row])));
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t begin = i * steps / points, end = (i + 1) * steps / points;
      double kept = quantity.value(run.header, run.steps[begin]);
      for (std::size_t row = begin + 1; row < end; ++row)
        kept = quantity.worse(kept, quantity.value(run.header, run.steps[row]));
      curve.push_back(float(kept));
    }
    arrays.add(std::string("frame.") + quantity.name, at_frames);
    arrays.add(std::string("curve.") + quantity.name, curve);
  }
}

Summary page_header(const RunData& run, const std::vector<std::size_t>& rows) {
  const RunHeader& header = run.header;
  std::vector<std::string> mesh_names, body_names;
  for (const auto& named : header.meshes) mesh_names.push_back(named.first);
  std::vector<std::int64_t> mesh, fixed, moving, steps;
  std::vector<double> dilation;
  for (const RunBody& body : header.bodies) {
    const auto found = std::find(mesh_names.begin(), mesh_names.end(), body.mesh);
    mesh.push_back(found == mesh_names.end() ? -1 : found - mesh_names.begin());
    body_names.push_back(body.name);
    fixed.push_back(body.fixed && body.moving_vertices == 0 ? 1 : 0);
    moving.push_back(body.moving_vertices);
    dilation.push_back(body.dilation);
  }
  for (const std::size_t row : rows) steps.push_back(run.steps[row].step);
  Summary page;
  page.set("title", header.title);
  page.set("command_line", header.command_line);
  page.set("build", header.build);
  page.set("recorded", run.steps.size());
  page.set("step", steps);
  page.set("mesh_name", mesh_names);
  page.set("body_name", body_names);
  page.set("body_mesh", mesh);
  page.set("body_fixed", fixed);
  page.set("body_moving_vertices", moving);
  page.set("body_dilation", dilation);
  std::vector<std::string> joint_names, joint_kinds;
  for (const RunJointName& joint : header.joints)
    joint_names.push_back(joint.name), joint_kinds.push_back(joint.kind);
  page.set("joint_name", joint_names);
  page.set("joint_kind", joint_kinds);
  return page;
}

/// Where the moving bodies (or, without any, all) begin: a near origin for float32.
Vec3 origin_of(const RunData& run) {
  Vec3 moving = Vec3::Zero(), all = Vec3::Zero();
  double moving_count = 0;
  for (std::size_t i = 0; i < run.header.bodies.size(); ++i) {
    all += run.steps[0].pose[i].p;
    if (run.header.bodies[i].fixed) continue;
    moving += run.steps[0].pose[i].p;
    ++moving_count;
  }
  if (moving_count > 0) return moving / moving_count;
  return run.header.bodies.empty() ? Vec3::Zero() : Vec3(all / double(run.header.bodies.size()));
}

}  // namespace

void write_replay_html(const std::filesystem::path& html, const RunData& run, const ReplayOptions& options) {
  require_field(options.max_frames >= 2, "ReplayOptions::max_frames", options.max_frames, "be at least 2");
  require_field(options.max_plot_points >= 2, "ReplayOptions::max_plot_points", options.max_plot_points,
                "be at least 2");
  require(!run.steps.empty(), "write_replay_html: the run has no steps");
  validate(run.header);
  for (const RunStep& step : run.steps) validate(run.header, step);

  const std::vector<std::size_t> rows = frame_rows(run.steps.size(), options.max_frames);
  const Vec3 origin = origin_of(run);
  PageArrays arrays;
  add_meshes(arrays, run.header);
  add_poses(arrays, run, rows, origin);
  add_vertices(arrays, run, rows);
  add_contacts(arrays, run, rows, origin);
  add_joints(arrays, run, rows);
  add_quantities(arrays, run, rows, options.max_plot_points);

  write_page(html, page_header(run, rows), arrays);
}

}  // namespace aussois
