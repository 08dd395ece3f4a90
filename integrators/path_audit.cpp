// SPDX-License-Identifier: Apache-2.0
#include "integrators/path_audit.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "integrators/free_motion.hpp"
#include "lmd/certificate.hpp"

namespace aussois {
namespace {

constexpr double kRounding = 1e-14;  // of what coordinates and bodies measure

// The stretches of the step, whichever way its scheme told them.
std::vector<PathPiece> pieces_of(const State& start, const StepReport& report) {
  if (report.v_path.size() > 0) return {{.t = start.t, .h = report.h, .g = start.g, .v = report.v_path}};
  require(!report.pieces.empty(),
          "audit_path: the step has no path; AdvancementOptions::certify must be on in event_driven");
  return report.pieces;
}

// What a certificate says of a pair: (CA-6), and the bound of the report. That speaks of the pairs that came
// near; the others are proven to be farther apart than their dilations.
double certified_distance(const StepPair& pair, const StepReport& report, double max_overlap) {
  return std::max(required_distance(pair, {.max_overlap = max_overlap}),
                  std::min(report.min_base_distance, pair.dilation));
}

// Are all pairs as far apart as certified? What is farther than the cutoff changes neither minimum.
bool looked_at(const Model& model, const State& there, const std::vector<BodyBounds>& bounds,
               const StepReport& report, int threads, PathAudit& audit) {
  const auto shape = [&](int b) {
    const RigidBody& body = model.bodies[std::size_t(b)];
    return MovingShape{model.shapes[std::size_t(body.shape)].get(), body.g_bs, {.g = pose(there, b)}};
  };
  const auto extent = [&](int b) { return pose(there, b).p.norm() + bounds[std::size_t(b)].radius; };
  std::vector<double> dilation;
  for (const BodyBounds& body : bounds) dilation.push_back(body.box.radius);
  bool kept = true;
  for (const StepPair& pair : pairs_within(model, there, bounds, dilation, threads)) {
    const double certified = certified_distance(pair, report, audit.max_overlap);
    const double cutoff =
        std::min(2 * pair.dilation, std::max({certified, certified + audit.min_slack, audit.min_distance}));
    const double distance = base_distance(shape(pair.a), shape(pair.b), cutoff, threads);
    if (distance < cutoff) {
      audit.min_distance = std::min(audit.min_distance, distance);
      audit.min_slack = std::min(audit.min_slack, distance - certified);
    }
    kept = kept && distance >= certified - kRounding * (extent(pair.a) + extent(pair.b));
  }
  return kept;
}

}  // namespace

void audit_path(const Model& model, const State& start, const StepReport& report, int threads,
                PathAudit& audit) {
  const auto has_shape = [](const RigidBody& body) { return body.shape >= 0; };
  if (audit.samples == 0 || std::ranges::count_if(model.bodies, has_shape) < 2) return;
  const std::vector<BodyBounds> bounds = body_bounds(model);
  bool kept = true;
  for (const PathPiece& piece : pieces_of(start, report)) {
    const int places = std::max(1, int(std::ceil(audit.samples * piece.h / report.h)));
    State from = start;
    from.t = piece.t, from.g = piece.g;
    for (int i = 1; i <= places; ++i) {
      State there = from;
      there.g = moved_poses(model, from, piece.v, piece.h * i / places);
      kept = looked_at(model, there, bounds, report, threads, audit) && kept;
    }
  }
  ++audit.steps;
  audit.violations += !kept;
}

}  // namespace aussois
