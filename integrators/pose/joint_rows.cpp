// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/joint_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "geometry/check.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/tree.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr int kProjectionSteps = 10;
constexpr double kQuick = 1e-3;       // of the error before; what leaves more takes directions anew
constexpr double kProjected = 1e-13;  // [m, rad]; rounding of coordinates of some metres
constexpr double kClosed = 1e-10;     // [m, rad]; its square is nothing beside the compliance of (JNT-3)

bool is_bilateral(const Motor& motor) {
  return prescribes_motion(motor) && motor.limit == kInf;
}
bool is_limited(const Motor& motor) {
  return motor.limit < kInf;
}

// Of the target of a position motor [m/s, rad/s]; targets are smooth over 10 us.
double target_speed(const Motor& motor, double t) {
  constexpr double kTime = 1e-5;
  return (motor.target(t + kTime) - motor.target(t - kTime)) / (2 * kTime);
}

// A row of velocities of one or two joints: J . v, with v in the places of State::v.
struct VelocityRow {
  std::vector<std::pair<int, Vec6>> parts{};     // (first entry of State::v, J)
  std::vector<std::pair<int, double>> others{};  // (entry of State::v, J)
  double value = 0;                              // what is to be zero, or the coordinate
  double speed = 0;                              // what J . v is to be

  double times(const VecX& v) const {
    double sum = 0;
    for (const auto& [at, J] : parts) sum += J.dot(v.segment<6>(at));
    for (const auto& [at, J] : others) sum += J * v[at];
    return sum;
  }
};
void append(VelocityRow& out, const Joint& joint, const JointRow& row) {
  if (joint.body_a) out.parts.emplace_back(first_velocity(joint.body_a), row.J_a);
  if (joint.body_b) out.parts.emplace_back(first_velocity(joint.body_b), row.J_b);
  out.others.insert(out.others.end(), row.others.begin(), row.others.end());
}
VelocityRow velocity_row(const Joint& joint, const JointRow& row) {
  VelocityRow out{.value = row.value};
  append(out, joint, row);
  return out;
}
VelocityRow velocity_row(const Model& model, const JointColumn& column) {
  VelocityRow out = velocity_row(model.joints[column.joint], column.row);
  if (column.other) append(out, model.joints[column.other], column.of_other);
  return out;
}
JointColumn column_of(const Model& model, const Coupling& coupling, const JointPoses& at,
                      const std::vector<int>& turns) {
  const CouplingRow row = coupling_row(model, coupling, at, turns);
  JointColumn out{.kind = ColumnKind::coupling,
                  .joint = coupling.joint_1,
                  .row = row.row_1,
                  .other = coupling.joint_2,
                  .of_other = row.row_2};
  out.row.value = row.value;
  return out;
}
void append_column(std::vector<Triplet>& G, const Layout& dofs, const VelocityRow& row, int column) {
  for (const auto& [at, J] : row.parts)
    if (const int first = row_of(dofs, at); first >= 0)
      for (int i = 0; i < 6; ++i) G.emplace_back(first + i, column, J[i]);
  for (const auto& [at, J] : row.others)
    if (const int entry = row_of(dofs, at); entry >= 0) G.emplace_back(entry, column, J);
}

// The velocities that are given before a step begins.
struct Speeds {
  VecX before{};  // at the start; of moved bodies: on their path
  VecX moved{};   // of moved bodies only, zero elsewhere
};
Speeds speeds_of(const Layout& dofs, const State& state, const VecX& v_prescribed) {
  return {.before = all_velocities(dofs, free_velocities(dofs, state.v), v_prescribed),
          .moved = v_prescribed};
}

// The step that the equations and rows of joints are made for.
struct JointStep {
  const Model& model;
  const State& state;
  const Layout& dofs;
  Speeds v;
  double h, theta;
  const NormalRule& normal;
  double stabilisation;
  const State* end = nullptr;        // if velocities there count, instead of those on the path
  const ReachedEnd* mean = nullptr;  // if rows are those of the mean with an end that is known so far

  // b of a row that is to move by -`excess` while v_theta acts; what its velocity is off at the start, `lag`,
  // is forgotten (MJT-11).
  double position_bias(const VelocityRow& middle, double excess, double lag) const {
    return path_bias(middle, -excess / h + (1 - theta) * lag);
  }
  // b of a row whose J . v_theta is to be `wanted`.
  double path_bias(const VelocityRow& middle, double wanted) const {
    const double moved = middle.times(v.moved), free_before = middle.times(v.before) - moved;
    return (moved + (1 - theta) * free_before - wanted) / theta;
  }
  // Newton on the value at the end, which is to be what stabilisation leaves of that at the start (MJT-15).
  double mean_bias(const VelocityRow& middle, double off_before, double off_now) const {
    return path_bias(middle, middle.times(mean->v_path) - (off_now - (1 - stabilisation) * off_before) / h);
  }
  double locked_bias(const VelocityRow& start, const VelocityRow& middle, double at_end) const {
    if (mean) return mean_bias(middle, start.value, at_end);
    if (end) return middle.times(v.moved);  // (GA-5)
    return position_bias(middle, stabilisation * start.value, start.times(v.before));
  }
  double motor_bias(const Motor& motor, const VelocityRow& start, const VelocityRow& middle,
                    double at_end) const {
    const double t = state.t;
    if (motor.kind == MotorKind::speed) return middle.times(v.moved) - motor.target(t + h);
    if (mean) return mean_bias(middle, start.value - motor.target(t), at_end - motor.target(t + h));
    if (end) return middle.times(v.moved) - target_speed(motor, t + h);
    const double now = motor.target(t), next = motor.target(t + h);
    return position_bias(middle, stabilisation * (start.value - now) - (next - now),
                         start.times(v.before) - target_speed(motor, t));
  }
};

ContactRow axis_law(const Layout& dofs, const Joint& joint, const JointRow& row, double sign, Law law,
                    double w, int slot) {
  ContactRow out{.body_a = joint.body_a, .body_b = joint.body_b, .law = law, .slot = slot};
  out.J_a.row(0) = sign * row.J_a.transpose();
  out.J_b.row(0) = sign * row.J_b.transpose();
  for (const auto& [at, J] : row.others)
    if (const int entry = row_of(dofs, at); entry >= 0) out.others.emplace_back(0, entry, sign * J);
  out.w[0] = w;
  return out;
}

// A stop where `sign` (q - limit) >= 0 (MJT-12).
ContactRow stop(const JointStep& step, const Joint& joint, const JointAxis& axis, const JointRow& now,
                double sign, double limit, int slot) {
  const VelocityRow row = velocity_row(joint, now);
  const double gap = sign * (now.value - limit);
  const NormalBias bias =
      normal_bias(gap, sign * row.times(step.v.before), axis.restitution, step.h, step.normal);
  ContactRow out =
      axis_law(step.dofs, joint, now, sign, unilateral(), sign * row.times(step.v.moved) + bias.w, slot);
  out.gap = gap;
  out.restitution = axis.restitution;
  out.moved[0] = sign * row.times(step.v.moved);
  out.active = bias.active;
  return out;
}

// Equations in the order of the columns of G.
struct Equations {
  std::vector<JointColumn> columns{};
  std::vector<Triplet> G{};
  std::vector<double> b{}, off{};
  void add(const Layout& dofs, JointColumn column, const VelocityRow& row, double bias, double off_by) {
    columns.push_back(std::move(column));
    append_column(G, dofs, row, int(b.size()));
    b.push_back(bias);
    off.push_back(off_by);
  }
};

// Error of a position motor at the end, for schemes that set JointStep::end; otherwise 0.
double motor_error(const JointStep& step, const Motor& motor, JointId joint, int axis) {
  if (!step.end || motor.kind != MotorKind::position) return 0;
  return joint_coordinate(step.model, *step.end, joint, axis) - motor.target(step.state.t + step.h);
}

void add_axis(const JointStep& step, const JointPoses& middle, JointId j, int i, Equations& equations,
              std::vector<ContactRow>& rows) {
  const Joint& joint = step.model.joints[j];
  const JointAxis& axis = joint.axis[i];
  const bool driven = is_bilateral(axis.motor) || is_limited(axis.motor);
  if (axis.lower == -kInf && axis.upper == kInf && axis.friction == 0 && !driven) return;
  JointRow now = axis_row(step.model, step.state.g, j, i);
  now.value = joint_coordinate(step.model, step.state, j, i);
  const JointRow mid = axis_row(step.model, middle, j, i);
  const VelocityRow row_now = velocity_row(joint, now), row_mid = velocity_row(joint, mid);
  const auto slot = [&](AxisRow of) { return slot_of({.joint = j, .axis = i, .row = of}); };
  if (axis.lower > -kInf)
    rows.push_back(stop(step, joint, axis, now, 1, axis.lower, slot(AxisRow::lower_stop)));
  if (axis.upper < kInf)
    rows.push_back(stop(step, joint, axis, now, -1, axis.upper, slot(AxisRow::upper_stop)));
  if (axis.friction > 0)
    rows.push_back(axis_law(step.dofs, joint, mid, 1, dry_friction(axis.friction * step.h),
                            row_mid.times(step.v.moved), slot(AxisRow::friction)));
  if (!driven) return;
  const double at_end = step.mean ? joint_coordinate(step.model, step.mean->state, j, i) : 0;
  const double bias = step.motor_bias(axis.motor, row_now, row_mid, at_end);
  if (is_bilateral(axis.motor))
    equations.add(step.dofs, {ColumnKind::motor, j, i, mid}, row_mid, bias,
                  motor_error(step, axis.motor, j, i));
  else
    rows.push_back(axis_law(step.dofs, joint, mid, 1, dry_friction(axis.motor.limit * step.h), bias,
                            slot(AxisRow::motor)));
}

JointSystem system_of(const JointStep& step, PerBody<SE3> middle_poses) {
  const Model& model = step.model;
  const State& state = step.state;
  JointSystem out{.middle = std::move(middle_poses)};
  const State& last = step.end ? *step.end : step.mean ? step.mean->state : state;
  const JointPoses middle_at = step.mean ? JointPoses(state.g, last.g) : JointPoses(out.middle);
  Equations equations;
  const auto add_locked = [&](const VelocityRow& start, JointColumn column, double at_end) {
    const VelocityRow middle = velocity_row(model, column);
    const double bias = step.locked_bias(start, middle, at_end);
    equations.add(step.dofs, std::move(column), middle, bias, middle.value);
  };
  for (const JointId j : model.joints.ids()) {
    const Joint& joint = model.joints[j];
    const std::vector<JointRow> start = locked_rows(model, state.g, j),
                                middle = locked_rows(model, middle_at, j),
                                end = locked_rows(model, last.g, j);
    for (std::size_t k = 0; k < start.size(); ++k)
      add_locked(velocity_row(joint, start[k]), {ColumnKind::locked, j, 0, middle[k]}, end[k].value);
    for (int i = 0; i < axis_count(joint.kind); ++i) add_axis(step, middle_at, j, i, equations, out.rows);
  }
  for (const Coupling& coupling : model.couplings)
    add_locked(velocity_row(model, column_of(model, coupling, state.g, state.turns)),
               column_of(model, coupling, middle_at, last.turns),
               coupling_row(model, coupling, last.g, last.turns).value);
  out.columns = std::move(equations.columns);
  const auto columns = Eigen::Index(equations.b.size());
  out.equations.G = SparseMatrix(step.dofs.rows, columns);
  out.equations.G.setFromTriplets(equations.G.begin(), equations.G.end());
  out.equations.b = Eigen::Map<const VecX>(equations.b.data(), columns);
  out.off = Eigen::Map<const VecX>(equations.off.data(), columns);
  return out;
}

}  // namespace

bool within(const JointError& error, const JointOptions& options) {
  return !options.project || (error.translation <= options.tolerance && error.rotation <= options.tolerance);
}

std::string text_of(const JointError& error, const JointOptions& options) {
  std::ostringstream text;
  text << "joints are off by " << error.translation << " m and " << error.rotation
       << " rad after the projection, at most " << options.tolerance << " is allowed";
  return text.str();
}

namespace {

// Everything that must hold at a state: positions (locked rows, couplings, position motors), and velocities
// (also speed motors).
struct Constraints {
  std::vector<JointColumn> columns{};
  std::vector<VelocityRow> rows{};
};
Constraints constraints(const Model& model, const State& state, bool velocities) {
  Constraints out;
  const auto add = [&](JointColumn column) {
    out.rows.push_back(velocity_row(model, column));
    out.columns.push_back(std::move(column));
  };
  for (const JointId j : model.joints.ids()) {
    const Joint& joint = model.joints[j];
    for (const JointRow& row : locked_rows(model, state.g, j)) add({ColumnKind::locked, j, 0, row});
    for (int i = 0; i < axis_count(joint.kind); ++i) {
      const Motor& motor = joint.axis[i].motor;
      const bool of_position = motor.kind == MotorKind::position;
      if (!is_bilateral(motor) || !(velocities || of_position)) continue;
      add({ColumnKind::motor, j, i, axis_row(model, state.g, j, i)});
      VelocityRow& row = out.rows.back();
      row.value = of_position ? joint_coordinate(model, state, j, i) - motor.target(state.t) : 0;
      row.speed = of_position ? target_speed(motor, state.t) : motor.target(state.t);
    }
  }
  for (const Coupling& coupling : model.couplings) add(column_of(model, coupling, state.g, state.turns));
  return out;
}

// The smallest steps in the metric of the masses along which rows change by given amounts (MJT-13).
struct NearestMotion {
  FrictionProblem problem{};
  std::optional<MotionInverse> inverse{};  // nothing if something is not finite

  // By -`change`; of bodies that move freely, in the places of State::v.
  JointedMotion operator()(const VecX& change) {
    problem.b = change;
    return motion(problem, *inverse, VecX());
  }
};
// The masses of what joints hold: of bodies and, if there are trees, of coordinates.
SparseMatrix joined_mass(const Model& model, const State& state, const Layout& dofs) {
  if (carries_bodies(model)) return mass_matrix(model, state, dofs);
  std::vector<Triplet> M;
  add_body_masses(model, dofs, M);
  return square_matrix(dofs.coordinates, M);
}

NearestMotion nearest_motion(const Model& model, const State& state, const Layout& dofs,
                             const std::vector<VelocityRow>& rows) {
  std::vector<Triplet> G;
  for (std::size_t k = 0; k < rows.size(); ++k) append_column(G, dofs, rows[k], int(k));
  NearestMotion out;
  FrictionProblem& problem = out.problem;
  problem.M = joined_mass(model, state, dofs);
  const int count = int(problem.M.rows());
  problem.G = SparseMatrix(count, Eigen::Index(rows.size()));
  problem.G.setFromTriplets(G.begin(), G.end());
  problem.f = VecX::Zero(count);
  problem.H = SparseMatrix(count, 0);
  out.inverse = invert_motion(problem.M, problem.G);
  return out;
}

// `step`, of rows of the problem from the first on, in the places of State::v.
VecX spread(const State& state, const Layout& dofs, const VecX& step) {
  VecX rows = VecX::Zero(dofs.rows);
  rows.head(step.size()) = step;
  return all_velocities(dofs, rows, VecX::Zero(state.v.size()));
}

// Nearest to those of the state, poses at which all positions hold to `tolerance` [m, rad], or the best that
// Newton finds (MJT-13).
State closed(const Model& model, const State& state, double tolerance) {
  State out = state, tried = state;
  const Layout dofs = layout(model);
  NearestMotion nearest;
  double least = kInf;
  for (int k = 0; k < kProjectionSteps; ++k) {
    const std::vector<VelocityRow> rows = constraints(model, tried, false).rows;
    VecX error(Eigen::Index(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) error[Eigen::Index(i)] = rows[i].value;
    const double now = error.size() > 0 ? error.cwiseAbs().maxCoeff() : 0;
    if (!(now < least)) break;
    const bool slow = least == kInf || now > kQuick * least;
    least = now;
    out = tried;
    if (now <= tolerance) break;
    if (slow) nearest = nearest_motion(model, tried, dofs, rows);  // else the directions before do as well
    if (!nearest.inverse) break;
    tried = retract(model, tried, spread(state, dofs, nearest(error).v), 1);
  }
  return out;
}

// Whether joints lead from a body back to itself, the world and all that nothing pushes being one: some
// of their equations may then be redundant.
bool has_loops(const Model& model) {
  const std::size_t world = model.bodies.size();
  std::vector<std::size_t> leader(world + 1);
  std::iota(leader.begin(), leader.end(), std::size_t(0));
  const auto leader_of = [&](BodyId body) {
    std::size_t i = !body || !has_inertia(model.bodies[body]) ? world : std::size_t(body.index());
    while (leader[i] != i) i = leader[i] = leader[leader[i]];
    return i;
  };
  for (const Joint& joint : model.joints) {
    const std::size_t a = leader_of(joint.body_a), b = leader_of(joint.body_b);
    if (a == b) return true;
    leader[a] = b;
  }
  return false;
}

}  // namespace

JointSystem joint_system(const Model& model, const State& state, const Layout& dofs, const VecX& v_prescribed,
                         double h, double theta, const NormalRule& normal, const JointOptions& options) {
  if (model.joints.empty()) return {};
  const JointStep step{model, state, dofs,   speeds_of(dofs, state, v_prescribed),
                       h,     theta, normal, options.stabilisation};
  State middle = state;
  middle.t += h / 2;
  middle.g = moved_poses(model, state, step.v.before, h / 2);
  middle.q += h / 2 * step.v.before.tail(state.q.size());
  carry_poses(model, middle.q, middle.g);
  if (has_loops(model)) {  // (MJT-18)
    middle.turns = counted_turns(model, state, middle.g);
    middle = closed(model, middle, kClosed);
  }
  return system_of(step, std::move(middle.g));
}

JointSystem joint_system_at(const Model& model, const State& state, const State& end, const Layout& dofs,
                            const VecX& v_prescribed, double h, const NormalRule& normal) {
  if (model.joints.empty()) return {};
  const JointStep step{model, state, dofs, speeds_of(dofs, state, v_prescribed), h, 1, normal, 0, &end};
  return system_of(step, end.g);
}

JointSystem joint_system_on_mean(const Model& model, const State& state, const ReachedEnd& end,
                                 const Layout& dofs, const VecX& v_prescribed, double h,
                                 const NormalRule& normal, const JointOptions& options) {
  if (model.joints.empty()) return {};
  const JointStep step{model,   state, dofs,   speeds_of(dofs, state, v_prescribed),
                       h,       0.5,   normal, options.stabilisation,
                       nullptr, &end};
  return system_of(step, moved_poses(model, state, end.v_path, h / 2));
}

JointConstraints joint_constraints(const Model& model, const State& state, const Layout& dofs) {
  Constraints now = constraints(model, state, true);
  const auto count = Eigen::Index(now.rows.size());
  JointConstraints out{.columns = std::move(now.columns),
                       .G = SparseMatrix(dofs.rows, count),
                       .value = VecX(count),
                       .off = VecX(count)};
  std::vector<Triplet> G;
  for (std::size_t k = 0; k < now.rows.size(); ++k) {
    append_column(G, dofs, now.rows[k], int(k));
    out.value[Eigen::Index(k)] = now.rows[k].value;
    out.off[Eigen::Index(k)] = now.rows[k].times(state.v) - now.rows[k].speed;
  }
  out.G.setFromTriplets(G.begin(), G.end());
  return out;
}

ProjectedState with_consistent_velocity(const Model& model, const State& state) {
  Constraints now = constraints(model, state, true);
  if (now.rows.empty()) return {.state = state};
  const Layout dofs = layout(model);
  VecX off(Eigen::Index(now.rows.size()));
  for (std::size_t k = 0; k < now.rows.size(); ++k)
    off[Eigen::Index(k)] = now.rows[k].times(state.v) - now.rows[k].speed;
  NearestMotion nearest = nearest_motion(model, state, dofs, now.rows);
  ProjectedState out{.state = state};
  if (!nearest.inverse) return out;
  JointedMotion step = nearest(off);
  out.state.v += spread(state, dofs, step.v);
  out.columns = std::move(now.columns);
  out.lambda = std::move(step.lambda);
  return out;
}

ProjectedState projected_state(const Model& model, const State& state) {
  if (model.joints.empty()) return {.state = state};
  return with_consistent_velocity(model, closed(model, state, kProjected));
}

}  // namespace aussois
