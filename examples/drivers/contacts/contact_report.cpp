// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/contacts/contact_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>

#include <nlohmann/json.hpp>

#include "examples/common/quantile.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"

namespace aussois {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kDegree = kPi / 180;

std::string text(const char* format, ...) {
  char line[256];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return line;
}

std::string feature_text(const Feature& f) {
  if (f.dim == 0) return text("V %d", f.simplex);
  return f.dim == 1 ? text("E %d chain %d", f.simplex, f.region)
                    : text("F %d region %d", f.simplex, f.region);
}

double without_noise(double x) {  // no "-0.0000" in the table
  return std::abs(x) < 5e-5 ? 0 : x;
}

Json vector(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}
Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}
Json pose_json(const SE3& g) {
  return {g.p.x(), g.p.y(), g.p.z(), g.R.w(), g.R.x(), g.R.y(), g.R.z()};
}

Json part_json(const AssemblyPart& part, const LmdShape& shape) {
  return {
      {"name", part.name},           {"vertices", part.report.vertices}, {"triangles", part.report.triangles},
      {"solid", part.complex.solid}, {"dilation", shape.radius},         {"radius", shape.bounding_radius},
      {"notes", part.notes}};
}

Json feature_json(const Feature& f) {
  Json bary = Json::array();
  for (int i = 0; i <= f.dim; ++i) bary.push_back(f.bary[i]);
  return {{"dim", f.dim}, {"simplex", f.simplex}, {"region", f.region}, {"barycentric", bary}};
}

Json contact_json(const ContactReport& report, const ContactQuery& query, const ContactPoint& c) {
  const ContactKinematics k =
      contact_kinematics(c, {report.a, query.pose, 0}, query.pose, {report.b, {}, 1}, {});
  return {{"type", type_of(c)},
          {"gap", c.gap},
          {"point_a", vector(c.x_a)},
          {"point_b", vector(c.x_b)},
          {"normal", vector(c.normal)},
          {"angle_margin", c.angle_margin},
          {"sin_psi", k.sin_psi},
          {"kinematics", to_string(k.status)},
          {"feature_a", feature_json(c.a)},
          {"feature_b", feature_json(c.b)}};
}

// The columns for a pose of a path, with the unit of the table and its factor.
struct Column {
  const char *name, *unit;
  double factor;
  double (*value)(const ContactQuery&);
};
constexpr Column kColumns[] = {
    {"contacts", "", 1, [](const ContactQuery& q) { return double(q.contact_count); }},
    {"min_gap", "um", 1e6, [](const ContactQuery& q) { return q.min_gap; }},
    {"ms", "", 1, [](const ContactQuery& q) { return q.ms; }},
    {"node_pairs", "", 1, [](const ContactQuery& q) { return double(q.count.node_pairs); }},
    {"leaf_pairs", "", 1, [](const ContactQuery& q) { return double(q.count.leaf_pairs); }},
};

Quantiles column_quantiles(const ContactReport& report, const Column& column) {
  std::vector<double> values;
  for (const ContactQuery& query : report.queries)
    if (const double value = column.value(query); std::isfinite(value)) values.push_back(value);
  return quantiles_of(std::move(values));
}

RunStep frame_of_page(const ContactQuery& query, std::int64_t index) {
  RunStep step;
  step.step = index;
  step.time = double(index);
  step.pose = {SE3{}, query.pose};
  step.velocity = VecX::Zero(12);
  for (ContactPoint c : query.contacts.points) {  // A moves and is body 1 of the page
    c.a.body = 1;
    c.b.body = 0;
    step.contacts.push_back(run_contact(c));
  }
  step.contacts_found = int(step.contacts.size());
  step.min_gap = query.min_gap;
  return step;
}

}  // namespace

std::string type_of(const ContactPoint& contact) {
  constexpr char kLetters[] = "VEF";
  return {kLetters[contact.a.dim], '-', kLetters[contact.b.dim]};
}

std::string contact_table(const ContactReport& report, const ContactQuery& query, int rows) {
  const std::vector<ContactPoint>& points = query.contacts.points;
  std::string out = text("%5s  %-4s %10s  %-29s  %-23s %8s  %-18s %s\n", "", "type", "gap [um]",
                         "point on A [mm]", "normal from B to A", "margin",
                         ("on " + report.pair->a.name).c_str(), ("on " + report.pair->b.name).c_str());
  const std::size_t shown = std::min(points.size(), std::size_t(rows));
  for (std::size_t i = 0; i < shown; ++i) {
    const ContactPoint& c = points[i];
    out += text("%5zu  %-4s %10.3f  %9.4f %9.4f %9.4f  %7.4f %7.4f %7.4f %7.3f\xC2\xB0  %-18s %s\n", i,
                type_of(c).c_str(), 1e6 * c.gap, without_noise(1e3 * c.x_a.x()),
                without_noise(1e3 * c.x_a.y()), without_noise(1e3 * c.x_a.z()), without_noise(c.normal.x()),
                without_noise(c.normal.y()), without_noise(c.normal.z()), c.angle_margin / kDegree,
                feature_text(c.a).c_str(), feature_text(c.b).c_str());
  }
  if (shown < points.size()) out += text("       and %zu more\n", points.size() - shown);
  return out;
}

Quantiles quantiles_of(std::vector<double> values) {
  if (values.empty()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, nan};
  }
  return {std::ranges::min(values), quantile(values, 0.5), quantile(values, 0.95), std::ranges::max(values)};
}

std::string statistics_table(const ContactReport& report) {
  std::string out = text("%-14s %12s %12s %12s %12s\n", "per pose", "min", "median", "p95", "max");
  for (const Column& column : kColumns) {
    const Quantiles q = column_quantiles(report, column);
    const std::string name = column.name + (*column.unit ? std::string(" [") + column.unit + "]" : "");
    out += text("%-14s %12.5g %12.5g %12.5g %12.5g\n", name.c_str(), column.factor * q.smallest,
                column.factor * q.median, column.factor * q.p95, column.factor * q.largest);
  }
  return out;
}

void write_contact_json(const std::filesystem::path& path, const ContactReport& report) {
  const LmdOptions& o = report.options;
  Json json = {
      {"pair", report.pair->name},
      {"command_line", report.command_line},
      {"build", build_info()},
      {"a", part_json(report.pair->a, *report.a)},
      {"b", part_json(report.pair->b, *report.b)},
      {"options",
       {{"threshold", o.threshold}, {"alpha", o.alpha}, {"alpha_ee", o.alpha_ee}, {"threads", o.threads}}}};
  Json poses = Json::array();
  for (const ContactQuery& query : report.queries) {
    Json row = {{"pose", pose_json(query.pose)}};
    row["bases_touch"] = query.bases_touch ? Json(*query.bases_touch) : Json(nullptr);
    row["covered"] = query.covered ? Json(*query.covered) : Json(nullptr);
    row["nested"] = query.bases_touch ? Json(query.nesting.has_value()) : Json(nullptr);
    for (const Column& column : kColumns) row[column.name] = number(column.value(query));
    poses.push_back(std::move(row));
  }
  if (report.queries.size() == 1) {
    const ContactQuery& query = report.queries[0];
    json.update(poses[0]);
    json["contacts"] = Json::array();
    for (const ContactPoint& c : query.contacts.points)
      json["contacts"].push_back(contact_json(report, query, c));
  } else {
    for (const Column& column : kColumns) {
      const Quantiles q = column_quantiles(report, column);
      json["summary"][column.name] = {{"min", number(q.smallest)},
                                      {"median", number(q.median)},
                                      {"p95", number(q.p95)},
                                      {"max", number(q.largest)}};
    }
    json["poses"] = std::move(poses);
  }
  write_whole_file(path, json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n');
}

void write_contact_page(const std::filesystem::path& html, const ContactReport& report) {
  Model model;
  add(model, fixed_body(report.pair->b.name, add(model, *report.b)));
  add(model, fixed_body(report.pair->a.name, add(model, *report.a)));
  RunData run{.header = run_header(model)};
  run.header.bodies[1].fixed = false;  // the page shows A as the part that moves
  run.header.title = "query_contacts " + report.pair->name;
  run.header.command_line = report.command_line;
  run.header.build = build_info();
  for (std::size_t i = 0; i < report.queries.size(); ++i)
    run.steps.push_back(frame_of_page(report.queries[i], std::int64_t(i)));
  write_replay_html(html, run);
}

}  // namespace aussois
