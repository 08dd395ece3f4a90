// SPDX-License-Identifier: Apache-2.0
#include "io/gauges.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/check.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

double displacement(const Frame& f) {
  double out = 0;
  for (const BodyId b : f.state.g.ids()) out = std::max(out, (f.state.g[b].p - f.start.g[b].p).norm());
  return out;
}

// In the order in which messages name them.
const std::vector<Gauge>& known_gauges() {
  using F = const Frame&;
  constexpr GaugeTotal kNothing = GaugeTotal::nothing;
  const auto clock = [](const char* column, double (*value)(F)) {
    return Gauge{.column = column, .value = value, .clock = true};
  };
  static const std::vector<Gauge> all = {
      {"step", "", kNothing, [](F f) { return double(f.step); }},
      {"t", "", kNothing, [](F f) { return f.report.t; }},
      {"h", "", kNothing, [](F f) { return f.report.h; }},
      {"attempts", "", kNothing, [](F f) { return double(f.report.attempts); }},
      {"contacts_found", "", kNothing, [](F f) { return double(f.report.contacts_found); }},
      {"", "max_contacts", GaugeTotal::most, [](F f) { return double(f.report.contacts_found); }, true},
      {"contacts", "", kNothing, [](F f) { return double(f.report.contacts_kept); }},
      {"iterations", "", kNothing, [](F f) { return double(f.report.solve.iterations); }},
      {"newton", "", kNothing, [](F f) { return double(f.report.solve.newton_iterations); }},
      {"residual", "", kNothing, [](F f) { return f.report.solve.residual; }},
      {"worst_island", "worst_island", GaugeTotal::most, [](F f) { return f.report.solve.worst_island; }},
      {"", "solver_failures", GaugeTotal::sum, [](F f) { return double(!is_solved(f.report.solve.status)); },
       true},
      {"min_gap", "min_gap", GaugeTotal::least, [](F f) { return f.report.min_gap; }},
      {"min_base_distance", "min_base_distance", GaugeTotal::least,
       [](F f) { return f.report.min_base_distance; }},
      {"energy", "", kNothing, [](F f) { return energy(f.model, f.state).total(); }},
      {"kinetic", "", kNothing, [](F f) { return energy(f.model, f.state).kinetic; }},
      {"gravity", "", kNothing, [](F f) { return energy(f.model, f.state).gravity; }},
      {"laws", "", kNothing, [](F f) { return energy(f.model, f.state).laws; }},
      {"", "energy_rise", GaugeTotal::most,
       [](F f) { return energy(f.model, f.state).total() - energy(f.model, f.before).total(); }},
      {"energy_residual", "", kNothing, [](F f) { return f.report.energy.residual(); }},
      {"", "energy_residual", GaugeTotal::most, [](F f) { return std::abs(f.report.energy.residual()); }},
      {"impulse_gain", "", kNothing, [](F f) { return f.report.impulse_gain; }},
      {"", "impulse_gain", GaugeTotal::sum,
       [](F f) { return f.report.energy_rises ? f.report.impulse_gain : 0.0; }},
      {"", "energy_rises", GaugeTotal::sum, [](F f) { return double(f.report.energy_rises); }, true},
      {"joint_drift", "joint_drift", GaugeTotal::most, [](F f) { return f.report.joint_error.translation; }},
      {"joint_drift_angle", "joint_drift_angle", GaugeTotal::most,
       [](F f) { return f.report.joint_error.rotation; }},
      {"displacement", "max_displacement", GaugeTotal::most, displacement},
      clock("ms_contact",
            [](F f) {
              return 1e3 * seconds_of(f.report.stages, {Stage::broad_phase, Stage::search, Stage::reduction});
            }),
      clock("ms_solve",
            [](F f) {
              return 1e3 * seconds_of(f.report.stages, {Stage::kinematics, Stage::assembly, Stage::solve});
            }),
      clock("ms_certificate", [](F f) { return 1e3 * seconds_of(f.report.stages, {Stage::certificate}); }),
      clock("ms_total", [](F f) { return 1e3 * f.report.total.wall; }),
  };
  return all;
}

// A total without a column may have the name of a column: "total:energy_residual" differs from it.
std::string name_of(const Gauge& gauge) {
  return gauge.column.empty() ? "total:" + gauge.total : gauge.column;
}

std::string name_of(const ContactLaw& law) {
  char text[80];
  std::snprintf(text, sizeof text, "mu %g e %g R_e %g", law.mu, law.restitution, law.contensou_radius);
  return text;
}

}  // namespace

double total_of_nothing(GaugeTotal keep) {
  return keep == GaugeTotal::least ? kInf : 0;
}

double next_total(GaugeTotal keep, double total, double value) {
  switch (keep) {
    case GaugeTotal::nothing:
      break;
    case GaugeTotal::least:
      return std::min(total, value);
    case GaugeTotal::most:
      return std::max(total, value);
    case GaugeTotal::sum:
      return total + value;
  }
  return total;
}

Gauge gauge(const std::string& name) {
  std::string known;
  for (const Gauge& g : known_gauges()) {
    if (name == name_of(g)) return g;
    known += (known.empty() ? "" : ", ") + name_of(g);
  }
  throw std::invalid_argument("gauge = " + name + " must be one of " + known);
}

std::vector<Gauge> gauges(const std::vector<std::string>& names) {
  std::vector<Gauge> out;
  for (const std::string& name : names) out.push_back(gauge(name));
  return out;
}

std::vector<Gauge> model_gauges(const Model& model) {
  std::vector<Gauge> out;
  const auto add = [&](std::string column, std::function<double(const Frame&)> value) {
    out.push_back({.column = std::move(column), .value = std::move(value)});
  };
  const std::vector<ContactLaw> laws = contact_laws(model);
  for (std::size_t i = 0; i < laws.size(); ++i)
    add("work:" + name_of(laws[i]), [i](const Frame& f) { return f.report.law_work[i]; });
  for (const JointId j : model.joints.ids())
    add("work:joint:" + model.joints[j].name,
        [j](const Frame& f) { return f.report.joints[j].work.total(); });
  Eigen::Index at = 0;
  for (const Coordinates& block : model.coordinates)
    for (int i = 0; i < block.size; ++i, ++at)
      if (block.points.empty())
        add("q:" + block.name + ":" + std::to_string(i), [at](const Frame& f) { return f.state.q[at]; });
  for (const JointId j : model.joints.ids())
    for (int axis = 0; axis < axis_count(model.joints[j].kind); ++axis)
      add("joint:" + model.joints[j].name + ":" + std::to_string(axis),
          [j, axis](const Frame& f) { return joint_coordinate(f.model, f.state, j, axis); });
  return out;
}

}  // namespace aussois
