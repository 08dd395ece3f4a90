// SPDX-License-Identifier: Apache-2.0
#include "integrators/run.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

#include <Eigen/Cholesky>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "geometry/settings.hpp"
#include "integrators/pose/joint_rows.hpp"
#include "integrators/prove/certify_step.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

void check_joints(const Model& model, const State& state, double tolerance) {
  const std::string bound = "be at most " + number_text(tolerance) + "; see consistent_state()";
  for (const JointId j : model.joints.ids()) {
    const std::string who = "start: joint " + to_string(j) + " (" + model.joints[j].name + "): ";
    const JointError error = joint_error(model, state, j);
    require_field(error.translation <= tolerance, (who + "translation error [m]").c_str(), error.translation,
                  bound.c_str());
    require_field(error.rotation <= tolerance, (who + "rotation error [rad]").c_str(), error.rotation,
                  bound.c_str());
  }
  for (std::size_t i = 0; i < model.couplings.size(); ++i)
    require_field(
        std::abs(coupling_row(model, model.couplings[i], state.g, state.turns).value) <= tolerance,
        ("start: coupling " + std::to_string(i) + " (" + model.couplings[i].name + "): error").c_str(),
        coupling_row(model, model.couplings[i], state.g, state.turns).value, bound.c_str());
}

void check_size(const std::string& who, const MatX& A, Eigen::Index rows, Eigen::Index columns) {
  const auto text = [](Eigen::Index m, Eigen::Index n) {
    return std::to_string(m) + " x " + std::to_string(n);
  };
  require_field(A.rows() == rows && A.cols() == columns, ("start: " + who).c_str(), text(A.rows(), A.cols()),
                ("be " + text(rows, columns)).c_str());
}

void check_coordinates(const Model& model, const State& state) {
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    const std::string who = "coordinates " + to_string(i) + " (" + block.name + "): ";
    if (!block.mass) continue;  // it has points or a tree
    const VecX q = coordinates(model, state, i);
    const MatX M = block.mass(q);
    check_size(who + "mass", M, block.size, block.size);
    const double asymmetry = (M - M.transpose()).cwiseAbs().maxCoeff();
    require_field(asymmetry <= 1e-9 * M.cwiseAbs().maxCoeff(),
                  ("start: " + who + "largest |mass - transpose|").c_str(), asymmetry,
                  "be at most 1e-9 of the largest entry");
    require(Eigen::LLT<MatX>(M).info() == Eigen::Success, "start: " + who + "mass must be positive definite");
    if (!block.force) continue;
    const CoordinateForce force = block.force(state.t, q, speeds(model, state, i));
    check_size(who + "force.f", force.f, block.size, 1);
    if (force.K.size() > 0) check_size(who + "force.K", force.K, block.size, block.size);
    if (force.C.size() > 0) check_size(who + "force.C", force.C, block.size, block.size);
  }
}

void check_gaps(const Model& model, const State& state) {
  for (const GapId i : model.gaps.ids()) {
    const GapFunction& gap = model.gaps[i];
    const std::string who = "gap function " + to_string(i) + " (" + gap.name + "): ";
    const GapRows rows = gap.evaluate(model, state, state.t);
    require_field(rows.J.rows() >= 1 && rows.J.rows() <= 3, ("start: " + who + "rows of J").c_str(),
                  rows.J.rows(), "lie in [1, 3]");
    check_size(who + "J", rows.J, rows.J.rows(), gap_columns(model, gap));
    if (rows.rate.size() > 0) check_size(who + "rate", rows.rate, rows.J.rows(), 1);
  }
}

}  // namespace

void validate_start(const Model& model, const State& state, const AdvancementOptions& options,
                    const JointOptions& joints) {
  validate(model);
  validate(model, state);
  validate(options);
  check_ranges(joints);
  check_coordinates(model, state);
  check_gaps(model, state);
  check_joints(model, state, joints.tolerance);
  if (!options.certify) return;
  const std::string wrong =
      wrong_start(model, state, body_bounds(model), pieces_of_shapes(model), options, 1);
  require(wrong.empty(), "start: " + wrong);
}

State consistent_state(const Model& model, const State& state) {
  return projected_state(model, state).state;
}

VecX consistent_velocity(const Model& model, const State& state) {
  return with_consistent_velocity(model, state).state.v;
}

void describe(SettingVisitor& visit, SettleOptions& o) {
  visit.begin("SettleOptions");
  visit.number({"first_h", "first step", "s", positive_range()}, o.first_h);
  visit.number({.name = "growth",
                .what = "growth factor of each step",
                .range = {.lowest = 1, .open_below = true, .open_above = true}},
               o.growth);
  visit.number({"turn", "largest turn of a body in a step", "rad", positive_range()}, o.turn);
  visit.number({"displacement", "displacement in a step at rest", "m, rad", positive_range()},
               o.displacement);
  visit.count({"max_steps", "maximum number of steps", "", range_from(1)}, o.max_steps);
}

LargestSpeeds largest_speeds(const State& state) {
  LargestSpeeds out{.all = state.v.size() > 0 ? state.v.lpNorm<Eigen::Infinity>() : 0};
  for (const BodyId b : state.g.ids()) out.turning = std::max(out.turning, angular_part(state.v, b).norm());
  return out;
}

namespace {

// Whether a held axis of a point moves, which may give any work.
bool leads_points(const Model& model, const State& state) {
  for (const BlockId i : model.coordinates.ids()) {
    const VecX v = speeds(model, state, i);
    const std::vector<PointMass>& points = model.coordinates[i].points;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec3 all = v.segment<3>(3 * Eigen::Index(k));
      if (without_held(points[k], all) != all) return true;
    }
  }
  return false;
}

// Whether the work of laws is that of passive ones alone, on bodies and points that nothing moves.
bool laws_are_passive(const Model& model, const State& state) {
  const auto are_passive = [](const Coordinates& block) { return !block.mass; };  // points, trees
  return std::ranges::all_of(model.forces, &ForceLaw::passive) &&
         std::ranges::all_of(model.coordinates, are_passive) && !has_axis_forces(model) &&
         std::ranges::none_of(model.bodies, is_moved) && !leads_points(model, state);
}

double stored(const Model& model, const State& state, const Energy& now) {
  return now.kinetic + now.gravity +
         (laws_are_passive(model, state) ? now.laws : spring_energy(model, state));
}

// What came from outside in a step: all work of laws, joints and contacts but that of those which can only
// take, and of springs, whose energy is stored. Forces of coordinates hold what their masses make of it.
double given(const Model& model, const State& state, const StepReport& report) {
  const EnergyLedger& e = report.energy;
  double out = (laws_are_passive(model, state) ? 0 : e.law_work) + e.joint_work + e.contact_work;
  if (!model.coordinates.empty()) out += e.gyroscopic_work;
  for (const StepJoint& joint : report.joints) {
    const JointWork& w = joint.work;
    out -= w.locked + w.couplings + w.stops + w.friction + w.springs;
  }
  return std::accumulate(report.law_work.begin(), report.law_work.end(), out, std::minus<>());
}

}  // namespace

EnergyGain energy_gain(const Model& model, const State& start) {
  const Energy now = energy(model, start);
  return {.stored = stored(model, start, now), .kinetic = now.kinetic};
}

void add_step(const Model& model, const State& state, const StepReport& report, EnergyGain& gain) {
  const Energy now = energy(model, state);
  const double before = std::exchange(gain.stored, stored(model, state, now));
  gain.above = std::max(0.0, gain.above + gain.stored - before - given(model, state, report));
  gain.largest = std::max(gain.largest, gain.above);
  double mass =
      std::accumulate(model.bodies.begin(), model.bodies.end(), 0.0,
                      [](double sum, const RigidBody& b) { return has_inertia(b) ? sum + b.mass : sum; });
  for (const Coordinates& block : model.coordinates)
    for (const PointMass& point : block.points) mass += point.mass;
  gain.kinetic = std::max({gain.kinetic, now.kinetic, mass * (report.h * model.gravity).squaredNorm() / 2});
}

}  // namespace aussois
