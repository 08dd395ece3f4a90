// SPDX-License-Identifier: Apache-2.0
#include "integrators/joint_rows.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "nsgs/joint_elimination.hpp"

namespace aussois {
namespace {

constexpr int kProjectionSteps = 10;
constexpr double kProjected = 1e-13;  // [m, rad]; rounding of coordinates of some metres

bool is_bilateral(const Motor& motor) {
  return (motor.kind == MotorKind::speed || motor.kind == MotorKind::position) && motor.limit == kInf;
}

// A row of velocities of one or two joints: J . v, with v in the places of State::v.
struct VelocityRow {
  std::vector<std::pair<int, Vec6>> parts{};  // (first entry of State::v, J)
  double value = 0;

  double times(const VecX& v) const {
    double sum = 0;
    for (const auto& [at, J] : parts) sum += J.dot(v.segment<6>(at));
    return sum;
  }
};
void append(VelocityRow& out, const Joint& joint, const JointRow& row) {
  if (joint.body_a >= 0) out.parts.emplace_back(6 * joint.body_a, row.J_a);
  if (joint.body_b >= 0) out.parts.emplace_back(6 * joint.body_b, row.J_b);
}
VelocityRow velocity_row(const Joint& joint, const JointRow& row) {
  VelocityRow out{.value = row.value};
  append(out, joint, row);
  return out;
}
VelocityRow velocity_row(const Model& model, const Coupling& coupling, const CouplingRow& row) {
  VelocityRow out{.value = row.value};
  append(out, model.joints[std::size_t(coupling.joint_1)], row.row_1);
  append(out, model.joints[std::size_t(coupling.joint_2)], row.row_2);
  return out;
}

// Everything that must be zero: locked rows joint by joint, then couplings.
std::vector<VelocityRow> constraints(const Model& model, const std::vector<SE3>& g,
                                     const std::vector<int>& turns) {
  std::vector<VelocityRow> out;
  for (const Joint& joint : model.joints)
    for (const JointRow& row : locked_rows(joint, g)) out.push_back(velocity_row(joint, row));
  for (const Coupling& coupling : model.couplings)
    out.push_back(velocity_row(model, coupling, coupling_row(model, coupling, g, turns)));
  return out;
}

void append_column(std::vector<Triplet>& G, const DofMap& dofs, const VelocityRow& row, int column) {
  for (const auto& [at, J] : row.parts)
    if (const int first = row_of(dofs, at); first >= 0)
      for (int i = 0; i < 6; ++i) G.emplace_back(first + i, column, J[i]);
}

// What a step knows about velocities before it begins.
struct Speeds {
  VecX before{};  // at the start; of moved bodies: on their path
  VecX moved{};   // of moved bodies only, zero elsewhere
};
Speeds speeds_of(const DofMap& dofs, const State& state, const VecX& v_prescribed) {
  return {.before = all_velocities(dofs, free_velocities(dofs, state.v), v_prescribed),
          .moved = v_prescribed};
}

// b of a row that is to move by -`excess` while v_theta acts; what its velocity is off at the start, `lag`,
// is forgotten (MJT-11).
double position_bias(const VelocityRow& middle, const Speeds& v, double excess, double lag, double h,
                     double theta) {
  const VecX& all = v.before;
  const double moved = middle.times(v.moved), free_before = middle.times(all) - moved;
  const double wanted = -excess / h + (1 - theta) * lag;
  return (moved + (1 - theta) * free_before - wanted) / theta;
}

// b of a row that is to have the speed `wanted` at the end of the step.
double speed_bias(const VelocityRow& row, const Speeds& v, double wanted) {
  return row.times(v.moved) - wanted;
}

double motor_bias(const Motor& motor, const VelocityRow& start, const VelocityRow& middle, const Speeds& v,
                  double t, double h, double theta, double stabilisation) {
  if (motor.kind == MotorKind::speed) return speed_bias(middle, v, motor.target(t + h));
  const double now = motor.target(t), next = motor.target(t + h);
  const double speed = (motor.target(t + h / 2) - motor.target(t - h / 2)) / h;
  return position_bias(middle, v, stabilisation * (start.value - now) - (next - now),
                       start.times(v.before) - speed, h, theta);
}

ContactRow axis_law(const Joint& joint, const JointRow& row, double sign, Law law, double w, int slot) {
  ContactRow out{.body_a = joint.body_a, .body_b = joint.body_b, .law = law, .slot = slot};
  out.J_a.row(0) = sign * row.J_a.transpose();
  out.J_b.row(0) = sign * row.J_b.transpose();
  out.w[0] = w;
  return out;
}

}  // namespace

void validate(const JointOptions& options) {
  require_field(options.stabilisation >= 0 && options.stabilisation <= 1, "JointOptions::stabilisation",
                options.stabilisation, "lie in [0, 1]");
}

JointSystem joint_system(const Model& model, const State& state, const DofMap& dofs, const VecX& v_prescribed,
                         double h, double theta, const NormalLawOptions& normal,
                         const JointOptions& options) {
  JointSystem out;
  if (model.joints.empty()) return out;
  const Speeds v = speeds_of(dofs, state, v_prescribed);
  out.middle = moved_poses(model, state, v.before, h / 2);
  std::vector<Triplet> G;
  std::vector<double> b;
  const auto equation = [&](const VelocityRow& row, double bias) {
    append_column(G, dofs, row, int(b.size()));
    b.push_back(bias);
  };
  const auto holds = [&](const VelocityRow& start, const VelocityRow& middle) {
    equation(middle,
             position_bias(middle, v, options.stabilisation * start.value, start.times(v.before), h, theta));
  };
  for (int j = 0; j < int(model.joints.size()); ++j) {
    const Joint& joint = model.joints[std::size_t(j)];
    out.first.push_back(int(b.size()));
    const std::vector<JointRow> start = locked_rows(joint, state.g), middle = locked_rows(joint, out.middle);
    for (std::size_t k = 0; k < start.size(); ++k)
      holds(velocity_row(joint, start[k]), velocity_row(joint, middle[k]));
    for (int i = 0; i < axis_count(joint.kind); ++i) {
      const JointAxis& axis = joint.axis[std::size_t(i)];
      const int slot = kRowsOfAJoint * j + kRowsOfAnAxis * i;
      const bool stops = axis.lower > -kInf || axis.upper < kInf;
      const bool driven = axis.motor.kind == MotorKind::speed || axis.motor.kind == MotorKind::position;
      if (!stops && !driven && axis.friction == 0) continue;
      JointRow now = axis_row(joint, state.g, i);
      now.value = joint_coordinate(model, state, j, i);
      const JointRow mid = axis_row(joint, out.middle, i);
      const VelocityRow row_now = velocity_row(joint, now), row_mid = velocity_row(joint, mid);
      const auto stop = [&](double sign, double limit, int at) {
        const NormalBias bias = normal_bias(sign * (now.value - limit), sign * row_now.times(v.before),
                                            axis.restitution, h, normal);
        out.rows.push_back(
            axis_law(joint, now, sign, unilateral(), sign * row_now.times(v.moved) + bias.w, slot + at));
        out.rows.back().active = bias.active;
      };
      if (axis.lower > -kInf) stop(1, axis.lower, 0);
      if (axis.upper < kInf) stop(-1, axis.upper, 1);
      if (axis.friction > 0)
        out.rows.push_back(
            axis_law(joint, mid, 1, dry_friction(axis.friction * h), row_mid.times(v.moved), slot + 2));
      if (!driven) continue;
      const double bias =
          motor_bias(axis.motor, row_now, row_mid, v, state.t, h, theta, options.stabilisation);
      if (is_bilateral(axis.motor))
        equation(row_mid, bias);
      else
        out.rows.push_back(axis_law(joint, mid, 1, dry_friction(axis.motor.limit * h), bias, slot + 3));
    }
  }
  out.first.push_back(int(b.size()));
  for (const Coupling& coupling : model.couplings)
    holds(velocity_row(model, coupling, coupling_row(model, coupling, state.g, state.turns)),
          velocity_row(model, coupling, coupling_row(model, coupling, out.middle, state.turns)));
  out.equations.G = SparseMatrix(dofs.rows, Eigen::Index(b.size()));
  out.equations.G.setFromTriplets(G.begin(), G.end());
  out.equations.b = Eigen::Map<const VecX>(b.data(), Eigen::Index(b.size()));
  return out;
}

std::vector<StepJoint> step_joints(const Model& model, const JointSystem& system, const VecX& lambda,
                                   const VecX& r, double h) {
  std::vector<StepJoint> out(model.joints.size());
  // A row of impulse p at a joint: its wrench on A, moved to the joint's frame (MJT-12)
  const auto push = [&](int j, const Vec6& J_a, double p) {
    const Joint& joint = model.joints[std::size_t(j)];
    const SE3 body = joint.body_a < 0 ? SE3{} : system.middle[std::size_t(joint.body_a)];
    const Vec3 force = p / h * J_a.head<3>(), arm = frame_on_a(joint, system.middle).p - body.p;
    StepJoint& sum = out[std::size_t(j)];
    sum.force += force;
    sum.torque += body.R * Vec3(p / h * J_a.tail<3>()) - arm.cross(force);
  };
  for (int j = 0; j < int(model.joints.size()); ++j) {
    const Joint& joint = model.joints[std::size_t(j)];
    int column = system.first[std::size_t(j)];
    for (const JointRow& row : locked_rows(joint, system.middle)) push(j, row.J_a, lambda[column++]);
    for (int i = 0; i < axis_count(joint.kind); ++i) {
      const auto acts = r.segment<kRowsOfAnAxis>(kRowsOfAJoint * j + kRowsOfAnAxis * i);
      double& effort = out[std::size_t(j)].effort[i];
      effort = (acts[0] - acts[1] + acts[2] + acts[3]) / h;
      if (is_bilateral(joint.axis[std::size_t(i)].motor)) effort += lambda[column++] / h;
    }
  }
  int column = system.first.back();
  for (const Coupling& coupling : model.couplings) {
    const double p = lambda[column++];
    push(coupling.joint_1,
         axis_row(model.joints[std::size_t(coupling.joint_1)], system.middle, coupling.axis_1).J_a, p);
    push(coupling.joint_2,
         axis_row(model.joints[std::size_t(coupling.joint_2)], system.middle, coupling.axis_2).J_a,
         -coupling.ratio * p);
  }
  return out;
}

namespace {

// The smallest step in the metric of the masses along which the constraints change by -`change` (MJT-13);
// nothing if something is not finite.
std::optional<VecX> nearest(const Model& model, const DofMap& dofs, const std::vector<VelocityRow>& rows,
                            const VecX& change) {
  std::vector<Triplet> M, G;
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (const int at = dofs.first[b]; at >= 0) {
      add_block(M, at, at, model.bodies[b].mass * Mat3::Identity());
      add_block(M, at + 3, at + 3, model.bodies[b].inertia);
    }
  for (std::size_t k = 0; k < rows.size(); ++k) append_column(G, dofs, rows[k], int(k));
  FrictionProblem problem;
  problem.M = SparseMatrix(dofs.coordinates, dofs.coordinates);
  problem.M.setFromTriplets(M.begin(), M.end());
  problem.G = SparseMatrix(dofs.coordinates, Eigen::Index(rows.size()));
  problem.G.setFromTriplets(G.begin(), G.end());
  problem.f = VecX::Zero(dofs.coordinates);
  problem.b = change;
  problem.H = SparseMatrix(dofs.coordinates, 0);
  const std::optional<MotionInverse> inverse = invert_motion(problem.M, problem.G);
  if (!inverse) return std::nullopt;
  return free_velocity(problem, *inverse);
}

// `step`, rows of the dynamic bodies, in the places of State::v.
VecX spread(const Model& model, const State& state, const DofMap& dofs, const VecX& step) {
  VecX all = VecX::Zero(state.v.size());
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    if (const int at = dofs.first[b]; at >= 0) all.segment<6>(6 * Eigen::Index(b)) = step.segment<6>(at);
  return all;
}

}  // namespace

VecX consistent_velocity(const Model& model, const State& state) {
  const std::vector<VelocityRow> rows = constraints(model, state.g, state.turns);
  const DofMap dofs = dof_map(model);
  VecX off(Eigen::Index(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) off[Eigen::Index(k)] = rows[k].times(state.v);
  const std::optional<VecX> step = nearest(model, dofs, rows, off);
  return step ? VecX(state.v + spread(model, state, dofs, *step)) : state.v;
}

State consistent(const Model& model, const State& state) {
  State out = state;
  if (model.joints.empty()) return out;
  const DofMap dofs = dof_map(model);
  std::vector<SE3> best = out.g;
  double least = kInf;
  for (int k = 0; k < kProjectionSteps; ++k) {
    const std::vector<VelocityRow> rows = constraints(model, out.g, out.turns);
    VecX error(Eigen::Index(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) error[Eigen::Index(i)] = rows[i].value;
    const double now = error.size() > 0 ? error.cwiseAbs().maxCoeff() : 0;
    if (!(now < least)) break;
    least = now;
    best = out.g;
    if (now <= kProjected) break;
    const std::optional<VecX> step = nearest(model, dofs, rows, error);
    if (!step) break;
    const VecX all = spread(model, state, dofs, *step);
    for (std::size_t b = 0; b < model.bodies.size(); ++b) {
      if (dofs.first[b] < 0) continue;
      const auto at = 6 * Eigen::Index(b);
      out.g[b].p += all.segment<3>(at);
      out.g[b].R = (out.g[b].R * exp_so3(all.segment<3>(at + 3))).normalized();
    }
  }
  out.g = best;
  out.turns = counted_turns(model, state, out.g);
  out.v = consistent_velocity(model, out);
  return out;
}

}  // namespace aussois
