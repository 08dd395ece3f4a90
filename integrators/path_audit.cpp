// SPDX-License-Identifier: Apache-2.0
#include "integrators/path_audit.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "integrators/advancement.hpp"
#include "integrators/free_motion.hpp"

namespace aussois {
namespace {

constexpr double kRounding = 1e-12;  // of the cutoff

// Of the bodies that have shapes.
struct Dilations {
  int count = 0;
  double least = kInf, most = 0;  // [m]
};
Dilations dilations(const Model& model) {
  Dilations out;
  for (const RigidBody& body : model.bodies) {
    if (body.shape < 0) continue;
    const double radius = model.shapes[std::size_t(body.shape)]->radius;
    ++out.count;
    out.least = std::min(out.least, radius), out.most = std::max(out.most, radius);
  }
  return out;
}

// The stretches of the step, whichever way its scheme told them.
std::vector<PathPiece> pieces_of(const State& start, const StepReport& report) {
  if (report.v_path.size() > 0) return {{.t = start.t, .h = report.h, .g = start.g, .v = report.v_path}};
  require(!report.pieces.empty(),
          "audit_path: the step has no path; AdvancementOptions::certify must be on in event_driven");
  return report.pieces;
}

}  // namespace

void audit_path(const Model& model, const State& start, const StepReport& report, int threads,
                PathAudit& audit) {
  const auto [count, least, most] = dilations(model);
  if (audit.samples == 0 || count < 2 || most == 0) return;
  const double cutoff = 4 * most;
  const double claimed =
      std::min(report.min_base_distance, 2 * least);  // what it does not speak of is farther
  bool kept = true;
  for (const PathPiece& piece : pieces_of(start, report)) {
    const int places = std::max(1, int(std::ceil(audit.samples * piece.h / report.h)));
    State from = start;
    from.t = piece.t, from.g = piece.g;
    for (int i = 1; i <= places; ++i) {
      State there = from;
      there.g = moved_poses(model, from, piece.v, piece.h * i / places);
      const double distance = min_base_distance(model, there, cutoff, threads);
      if (distance < cutoff) audit.min_distance = std::min(audit.min_distance, distance);
      audit.min_slack = std::min(audit.min_slack, distance - claimed);
      kept = kept && distance > 0 && distance >= claimed - kRounding * cutoff;
    }
  }
  ++audit.steps;
  audit.violations += !kept;
}

}  // namespace aussois
