// SPDX-License-Identifier: Apache-2.0
#include "integrators/prove/path_audit.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "integrators/prove/certify_step.hpp"
#include "lmd/certificate.hpp"
#include "lmd/coverage.hpp"

namespace aussois {
namespace {

// The pieces of the step's path, in whichever form its scheme reported them.
std::vector<PathPiece> pieces_of(const State& start, const StepReport& report) {
  if (report.v_path.size() > 0) return {{.t = start.t, .h = report.h, .g = start.g, .v = report.v_path}};
  require(!report.pieces.empty(),
          "audit_path: the step has no path; AdvancementOptions::certify must be on in event_driven");
  return report.pieces;
}

// A step that is looked at.
struct Audited {
  const Model& model;
  const StepReport& report;
  PerBody<BodyBounds> bounds{};
  Table<ShapeId, Pieces> pieces{};
  int threads = 1;
};

// The distance certified for a pair: by (CA-6), and by the bound of the report. That bound covers the pairs
// that came near and can be stopped; their other pairs are proven to be farther apart than their dilations.
double certified_distance(const Audited& step, const StepPair& pair, double max_overlap) {
  const auto moves = [&](BodyId body) { return contacts_can_move(step.model.bodies[body]); };
  const double required = required_distance(pair, {.max_overlap = max_overlap});
  if (!moves(pair.a) && !moves(pair.b)) return required;
  return std::max(required, std::min(step.report.min_base_distance, pair.dilation));
}

// Pairs reported to overlap are not certified.
bool is_told(const StepPair& pair, const StepReport& report) {
  return std::ranges::binary_search(report.driven_overlaps, bodies_of(pair));
}

// Where it is; keep the shape.
MovingShape still(const PosedShape& posed) {
  return {.shape = posed.shape, .motion = {.g = posed.g_ws}, .body = posed.body};
}

PerBody<double> dilations(const Audited& step) {
  PerBody<double> out;
  for (const BodyBounds& body : step.bounds) out.push_back(body.box.radius);
  return out;
}

// Up to where the nearest simplices are minima. Of a shape that meets itself, those at the border of its
// material neighbours may be nearest, a little farther than its dilations (DEF-4).
constexpr double kOwnNeighbours = 1.2;  // of the sum of the dilations; a cable's border is at 1.4 or more
double told_by_minima(const StepPair& pair, double dilations) {
  return (pair.a == pair.b ? std::min(dilations, kOwnNeighbours) : dilations) * pair.dilation;
}

// Pairs whose dilated shapes come nearer than the sum of their dilations.
std::vector<StepPair> pairs_at(const Audited& step, const State& there) {
  std::vector<StepPair> out = pairs_within(step.model, there, step.bounds, dilations(step), step.threads);
  const VecX rest = VecX::Zero(there.v.size());
  const std::vector<StepPair> driven =
      driven_pairs(step_path({step.model, there, rest, 0}, step.bounds), step.bounds, step.threads);
  out.insert(out.end(), driven.begin(), driven.end());
  return out;
}

// All pairs but those reported to overlap.
std::vector<StepPair> untold_pairs(const Audited& step, const State& there) {
  std::vector<StepPair> out = pairs_at(step, there);
  std::erase_if(out, [&](const StepPair& pair) { return is_told(pair, step.report); });
  return out;
}

struct Seen {
  bool kept = true, nested = false;
};

// Are all pairs as far apart as certified, and none inside the other? What is farther than the cutoff changes
// neither minimum.
Seen look_at(const Audited& step, const State& there, PathAudit& audit) {
  const std::vector<StepPair> pairs = untold_pairs(step, there);
  Seen out;
  for (const StepPair& pair : pairs) {
    const double certified = certified_distance(step, pair, audit.max_overlap);
    const double cutoff =
        std::min(2 * pair.dilation, std::max({certified, certified + audit.min_slack, audit.min_distance}));
    const PosedShape a = posed_shape(step.model, there, pair.a), b = posed_shape(step.model, there, pair.b);
    const double distance = base_distance(still(a), still(b), cutoff, step.threads);
    if (distance < cutoff) {
      audit.min_distance = std::min(audit.min_distance, distance);
      audit.min_slack = std::min(audit.min_slack, distance - certified);
    }
    out.kept = out.kept && distance >= certified - rounding_of_distance(a, b);
  }
  out.nested = !nested_pair(step.model, there, pairs, step.pieces).empty();
  return out;
}

// Is the smallest gap of every pair its distance less the dilations (LMD-14)?
bool is_covered(const Audited& step, const State& there) {
  return std::ranges::all_of(untold_pairs(step, there), [&](const StepPair& pair) {
    const PosedShape a = posed_shape(step.model, there, pair.a), b = posed_shape(step.model, there, pair.b);
    const double cutoff = told_by_minima(pair, 2),
                 distance = base_distance(still(a), still(b), cutoff, step.threads);
    return distance >= cutoff || is_covered(a, b, distance, step.threads);
  });
}

// Is the smallest gap that the step found where it started the least distance of the pairs less their
// dilations (LMD-14)? Only pairs nearer than the smallest search distance tell. Gap functions and
// event_driven, which lists touches along its way, have smallest gaps of their own.
bool found_the_nearest(const Audited& step, const State& start, double floor) {
  if (!step.model.gaps.empty() || step.report.v_path.size() == 0) return true;
  double lowest = kInf, highest = kInf;
  for (const StepPair& pair : pairs_within(step.model, start, step.bounds, dilations(step), step.threads)) {
    const PosedShape a = posed_shape(step.model, start, pair.a), b = posed_shape(step.model, start, pair.b);
    const double tolerance = coverage_tolerance(a, b), cutoff = told_by_minima(pair, 1 + floor) - tolerance,
                 distance = base_distance(still(a), still(b), cutoff, step.threads);
    if (bases_all_but_touch(*a.shape, *b.shape, distance)) return true;
    if (distance >= cutoff) continue;
    lowest = std::min(lowest, distance - pair.dilation - tolerance);
    highest = std::min(highest, distance - pair.dilation + tolerance);
  }
  return highest == kInf || (lowest <= step.report.min_gap && step.report.min_gap <= highest);
}

// A pair that is certified where the path ends cannot pass through each other on a way to the state that is
// shorter than their distance.
bool leads_to(const Audited& step, const State& path_end, const State& end, double max_overlap) {
  const auto moved = [&](BodyId b) {
    double stretch = 0;
    if (deforms(step.model.bodies[b])) {
      const std::vector<Vec3> from = deformed_vertices(step.model, path_end, b),
                              to = deformed_vertices(step.model, end, b);
      for (std::size_t i = 0; i < to.size(); ++i) stretch = std::max(stretch, (to[i] - from[i]).norm());
    }
    return stretch + (pose(end, b).p - pose(path_end, b).p).norm() +
           step.bounds[b].radius * angle_between(pose(end, b).R, pose(path_end, b).R);
  };
  PerBody<double> reach;
  for (const BodyId b : step.bounds.ids()) reach.push_back(moved(b));
  return std::ranges::none_of(
      pairs_within(step.model, path_end, step.bounds, reach, step.threads), [&](const StepPair& pair) {
        return reach[pair.a] + reach[pair.b] >= certified_distance(step, pair, max_overlap);
      });
}

}  // namespace

void audit_path(const Model& model, const State& start, const State& end, const StepReport& report,
                int threads, PathAudit& audit) {
  const auto has_shape = [](const RigidBody& body) { return bool(body.shape); };
  const bool meets_itself =
      std::ranges::any_of(model.shapes, [](const auto& shape) { return bool(shape->self); });
  if (audit.samples == 0 || (std::ranges::count_if(model.bodies, has_shape) < 2 && !meets_itself)) return;
  const Audited step{model, report, body_bounds(model), pieces_of_shapes(model), threads};
  Seen seen;
  const auto look = [&](const State& there) {
    const Seen here = look_at(step, there, audit);
    seen = {seen.kept && here.kept, seen.nested || here.nested};
  };
  State there = start;
  for (const PathPiece& piece : pieces_of(start, report)) {
    const int places = std::max(1, int(std::ceil(audit.samples * piece.h / report.h)));
    State from = start;
    from.t = piece.t, from.g = piece.g;
    for (int i = 1; i <= places; ++i) {
      there = from;
      there.g = moved_poses(model, from, piece.v, piece.h * i / places);
      there.q = from.q + piece.h * i / places * piece.v.tail(from.q.size());
      look(there);
    }
  }
  look(end);
  const bool covered = seen.nested || (found_the_nearest(step, start, audit.floor) && is_covered(step, end));
  ++audit.steps;
  audit.nested += seen.nested;
  audit.uncovered += !covered;
  audit.violations += !seen.kept || seen.nested || !covered || !leads_to(step, there, end, audit.max_overlap);
}

std::vector<BodyPair> skipped_pairs(const Model& model) {
  std::vector<BodyPair> out;
  for (const auto& [a, b] : model.passing)
    if (model.bodies[a].shape && model.bodies[b].shape) out.push_back({a, b});
  return out;
}

double min_base_distance(const Model& model, const State& state, double cutoff, int threads) {
  double distance = cutoff;
  for (const StepPair& pair : pairs_within(model, state, body_bounds(model),
                                           PerBody<double>(model.bodies.size(), cutoff / 2), threads)) {
    const PosedShape a = posed_shape(model, state, pair.a), b = posed_shape(model, state, pair.b);
    distance = base_distance(still(a), still(b), distance, threads);
  }
  return distance;
}

}  // namespace aussois
