// SPDX-License-Identifier: Apache-2.0
#include "integrators/path_audit.hpp"

#include <algorithm>
#include <utility>

#include "geometry/check.hpp"
#include "integrators/advancement.hpp"
#include "integrators/free_motion.hpp"

namespace aussois {
namespace {

constexpr double kRounding = 1e-12;  // of the cutoff

// Smallest and largest dilation of the bodies that have shapes.
std::pair<double, double> dilations(const Model& model) {
  double least = kInf, most = 0;
  for (const RigidBody& body : model.bodies) {
    if (body.shape < 0) continue;
    const double radius = model.shapes[std::size_t(body.shape)]->radius;
    least = std::min(least, radius), most = std::max(most, radius);
  }
  return {least, most};
}

}  // namespace

void audit_path(const Model& model, const State& start, const StepReport& report, int threads,
                PathAudit& audit) {
  if (audit.samples == 0) return;
  require(report.v_path.size() > 0, "audit_path: the step has no path of constant velocities");
  const auto [least, most] = dilations(model);
  const double cutoff = 4 * most;
  const double claimed =
      std::min(report.min_base_distance, 2 * least);  // what it does not speak of is farther
  bool kept = true;
  for (int i = 1; i <= audit.samples; ++i) {
    State there = start;
    there.g = moved_poses(model, start, report.v_path, report.h * i / audit.samples);
    const double distance = min_base_distance(model, there, cutoff, threads);
    if (distance < cutoff) audit.min_distance = std::min(audit.min_distance, distance);
    audit.min_slack = std::min(audit.min_slack, distance - claimed);
    kept = kept && distance > 0 && distance >= claimed - kRounding * cutoff;
  }
  ++audit.steps;
  audit.violations += !kept;
}

}  // namespace aussois
