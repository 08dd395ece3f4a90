// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/passive_midpoint.hpp"

#include <algorithm>
#include <utility>

#include "geometry/settings.hpp"
#include "integrators/pose/conserving_forces.hpp"
#include "integrators/pose/landing.hpp"
#include "integrators/schemes/advance_step.hpp"
#include "integrators/schemes/shared_settings.hpp"

namespace aussois {
namespace {

constexpr double kMidpoint = 0.5;
constexpr int kRounds = 20;          // of linearisation and passivity together; 2 or 3 are usual
constexpr int kJumps = 8;            // rounds in which conserving forces learn what they miss
constexpr double kIterated = 1e-15;  // change of velocities by mean joints and conserving forces, relative
constexpr double kGivenUp = 1e-8;    // [m/s, rad/s]; more than that is no solution
constexpr double kExact = 1e-16;     // of the gyroscopic torque: its error is quadratic in that of the guess

// `free` at theta = 1/2 with its gyroscopic torque taken there. `v_guess`: rows of the problem.
FreeMotion with_gyroscopic(const Model& model, const Layout& dofs, double h, GyroscopicTerm term,
                           const VecX& v_guess, FreeMotion free) {
  std::vector<Triplet> entries;
  for (const BodyId b : model.bodies.ids()) {
    const int row = dofs.first[b];
    if (row < 0) continue;
    const Mat3& J = model.bodies[b].inertia;
    const Vec3 omega = free.v.segment<3>(row + 3);
    if (term == GyroscopicTerm::start) {  // (PMI-2)
      const Mat3 D = -skew(J * omega);
      free.gyroscopic.segment<3>(row + 3) = -h * D * omega;
      add_block(entries, row + 3, row + 3, h / 2 * D);
    } else {  // (PMI-3)
      const Vec3 middle = (omega + v_guess.segment<3>(row + 3)) / 2, momentum = J * middle;
      const Mat3 D = skew(middle) * J - skew(momentum);
      free.gyroscopic.segment<3>(row + 3) = -h * (middle.cross(momentum) + D * (omega - middle));
      add_block(entries, row + 3, row + 3, h / 2 * D);
    }
  }
  free.gyroscopic_D = square_matrix(dofs.rows, entries);
  sum_up(free);
  return free;
}

// What (PMI-3), linearised about the mean with `guess`, is off at `v`, relative to the spin.
double gyroscopic_error(const Layout& dofs, const VecX& before, const VecX& guess, const VecX& v, double h) {
  double worst = 0;
  for (const int row : dofs.first) {
    if (row < 0) continue;
    const double off = (v - guess).segment<3>(row + 3).norm() / 2;
    const double spin = (v + before).segment<3>(row + 3).norm() / 2;
    if (off > 0) worst = std::max(worst, h * off * off / std::max(spin, off));
  }
  return worst;
}

// Velocity of a row without its law.
RowVector plain_velocity(const ContactRow& row, const Layout& dofs, const VecX& v) {
  return relative_velocity(row, dofs, v) - row.w + row.moved;
}

// (PMI-6). `v`: at the start of the step.
void state_at_midpoint(const Layout& dofs, const VecX& v, ContactRow& row) {
  const RowVector before = plain_velocity(row, dofs, v);
  const double bias = std::max(row.w[0] - row.moved[0], before[0]);
  row.w.head(row.law.rows) = (row.moved + before).head(row.law.rows);
  row.w[0] = row.moved[0] + bias;
}

// Rows that would give energy are stated at the midpoint; how many more that are.
int make_passive(const Layout& dofs, double tolerance, ImpulseStep& step, std::vector<char>& stated) {
  int count = 0;
  const std::vector<RowVector> r = row_impulses(step);
  for (std::size_t i = 0; i < step.rows.size(); ++i) {
    ContactRow& row = step.rows[i];
    if (stated[i] || !has_normal(row.law) || r[i].isZero(0)) continue;
    const RowVector before = plain_velocity(row, dofs, step.free->v),
                    after = plain_velocity(row, dofs, step.solved.solution.v),
                    without = plain_velocity(row, dofs, step.free->v_free);
    const double noise = tolerance * r[i].norm() * (before.norm() + without.norm());
    if (r[i].dot(before + after) / 2 <= noise) continue;  // (PMI-5)
    state_at_midpoint(dofs, step.free->v, row);
    stated[i] = 1;
    ++count;
  }
  return count;
}

// Joints on the mean with the end that the last solve leads to (MJT-14), (MJT-15).
JointSystem mean_joint_system(const StepSetting& setting, const State& start, double h,
                              const ImpulseStep& step) {
  const VecX& v = step.solved.solution.v;
  const VecX mean = all_velocities(setting.dofs, (step.free->v + v) / 2, step.v_prescribed);
  const VecX path = path_velocity(setting.options.update, setting.model, start, mean, h);
  const State end = state_after(setting.model, start, path, mean, h);
  return joint_system_on_mean(setting.model, start, {end, mean}, setting.dofs, step.v_prescribed, h,
                              setting.normal, setting.options.joints);
}

// The displacement that ends landings closed (MJ-17), as part of the velocities of the path, unless the
// forces are given more on it than contacts took in the step (PMI-7).
VecX path_after_landing(const StepSetting& setting, const State& start, const FoundContacts& found,
                        const VecX& v_path, bool passive, ImpulseStep& step) {
  const FreeMotion& free = *step.free;
  if (setting.normal.law == NormalLaw::moreau || !v_path.allFinite()) return v_path;
  const VecX closed = landing_path(setting, start, found, v_path, step);
  const VecX& v = step.solved.solution.v;
  const double taken = VecX(free.M * (free.v_free - v)).dot(free.v + v) / 2;
  const double given = (free.v - free.v_free).dot(free.mass * (closed - v_path));
  return passive && given > taken ? v_path : closed;
}

StepOptions without_projection(StepOptions o) {
  o.joints.project = false;
  return o;
}

}  // namespace

void describe(SettingVisitor& visit, PassiveMidpointOptions& o) {
  visit.begin("PassiveMidpointOptions");
  visit.choice({.name = "gyroscopic",
                .what = "point of the step at which the gyroscopic torque is evaluated",
                .flag = "--gyroscopic",
                .label = "%",
                .in_every_label = true},
               o.gyroscopic, kGyroscopicTerms);
  visit.choice({.name = "forces",
                .what = "forces of laws, joint axes and coordinates: linearised about the start, or at the "
                        "middle so that elastic bodies keep their energy",
                .flag = "--forces",
                .label = "% forces"},
               o.forces, kMiddleForces);
  visit.choice(normal_law_setting(), o.law, kNormalLaws);
  visit.toggle({.name = "passive",
                .what = "allow contacts to add energy",
                .flag = "--not-passive=false",
                .label = "not passive"},
               o.passive);
  visit.toggle(
      {.name = "mean_joints",
       .what = "enforce joints at the mean of the poses at start and end of the step; needs --update cayley",
       .flag = "--mean-joints",
       .label = "mean joints"},
      o.mean_joints);
}

void validate(const PassiveMidpointOptions& options) {
  check_ranges(options);
}

PassiveMidpoint::PassiveMidpoint(const Model& model, const StepOptions& step,
                                 const PassiveMidpointOptions& own)
    : setting_(std::make_shared<const StepSetting>(
          step_setting(model, own.mean_joints ? without_projection(step) : step, own.law))),
      own_(own) {
  validate(own);
  refuse_unread(step, unread(), "passive_midpoint");
  refuse_unread_by(own.law, step);
  if (own.law == NormalLaw::gap_over_step) refuse_restitution(model);
  refuse_carrying(model, "passive_midpoint");
  require(!own.mean_joints || step.update == GroupUpdate::cayley,
          std::string("PassiveMidpointOptions::mean_joints needs StepOptions::update = cayley, not ") +
              to_string(step.update));
}

namespace {

// The rounds of one step: linearisation, passivity and joints on the mean, each stated where the last solve
// leads.
struct MidpointSolve {
  const StepSetting& setting;
  const PassiveMidpointOptions& own;
  const State& start;
  const FoundContacts& found;
  bool mean_joints;
  const FreeMotion plain =
      free_motion(setting.model, start, setting.dofs, found.h, kMidpoint);  // (MJ-4), (MJ-5)
  VecX guess = plain.v_free;
  ImpulseStep step = pose_step(setting, start, found, with_torque(), kMidpoint);
  std::vector<char> stated = std::vector<char>(step.rows.size(), 0);
  bool joints_stand = !mean_joints;
  bool forces_stand = own.forces == MiddleForce::linear;
  VecX missing{};  // MiddleForces::missing
  bool settled = false;
  bool landed = false;

  SharedMotion with_torque() const {
    return std::make_shared<const FreeMotion>(
        with_gyroscopic(setting.model, setting.dofs, found.h, own.gyroscopic, guess, plain));
  }
  // The same with the forces of the path that the guess gives. From some round on, what they miss stays,
  // since near rest rounding makes it jump.
  SharedMotion with_forces(int round) {
    FreeMotion out = plain;
    if (round < kJumps) missing.resize(0);
    MiddleForces forces =
        conserving_forces(setting, start, plain.mass,
                          {plain.v, (plain.v + guess) / 2, step.v_prescribed, std::move(missing)}, found.h);
    missing = std::move(forces.missing);
    out.laws = std::move(forces.laws);
    out.law_D.swap(forces.law_D);
    out.axes = std::move(forces.axes);
    return std::make_shared<const FreeMotion>(
        with_gyroscopic(setting.model, setting.dofs, found.h, own.gyroscopic, guess, std::move(out)));
  }

  // Changes of velocities from solve to solve that are no matter of the forces [m/s, rad/s].
  double noise_of_solves() const {
    return step.rows.empty() ? kGivenUp : kSolverNoise * setting.options.solver.tolerance;
  }

  // Settles on velocities and a path from them.
  VecX find_path() {
    settle();
    const VecX v = step.solved.solution.v, mean = (v + step.free->v) / 2;  // (PMI-4)
    VecX out = path_after_landing(setting, start, found, mean, own.passive, step);
    landed = out != mean;
    if (step.solved.solution.v != v) settle();  // a landing was stopped
    return out;
  }

  // Where a path ends, put on the joints: their rows are those of velocities.
  State end_of(const VecX& v_path) const {
    const VecX v = all_velocities(setting.dofs, v_path, step.v_prescribed);
    const VecX path = path_velocity(setting.options.update, setting.model, start, v, found.h);
    return projected_state(setting.model, state_after(setting.model, start, path, start.v, found.h)).state;
  }

  // Joints on the mean hand the jump of a landing on from step to step (PMI-8).
  VecX find_path_to(const State& end) {
    set_joints(
        joint_system_at(setting.model, start, end, setting.dofs, step.v_prescribed, found.h, setting.normal));
    mean_joints = false;
    joints_stand = true;
    return find_path();
  }

  void settle() {
    VecX last = VecX::Constant(setting.dofs.rows, kInf);
    double change = kInf;
    settled = false;
    for (int k = 0; k < kRounds; ++k) {
      solve_rows(setting, start, found, step);
      const VecX& v = step.solved.solution.v;
      if (!v.allFinite()) break;
      if (mean_joints || own.forces == MiddleForce::conserving) {
        const double before = std::exchange(change, (v - last).lpNorm<Eigen::Infinity>());
        const bool solved = change <= kIterated * v.lpNorm<Eigen::Infinity>();
        if (mean_joints)  // as far as rounding lets it
          joints_stand = solved || (change <= kGivenUp && change >= before / 2);
        if (own.forces == MiddleForce::conserving)  // or as far as the solver does
          forces_stand = solved || (change <= noise_of_solves() && change >= before);
        last = v;
      }
      const bool off = own.gyroscopic == GyroscopicTerm::midpoint &&
                       gyroscopic_error(setting.dofs, plain.v, guess, v, found.h) > kExact;
      const bool gives =
          own.passive && make_passive(setting.dofs, setting.options.solver.tolerance, step, stated) > 0;
      settled = !off && !gives && joints_stand && forces_stand;
      if (settled) break;
      if (off || !forces_stand) {
        guess = v;
        step.free = own.forces == MiddleForce::conserving ? with_forces(k) : with_torque();
      }
      if (!joints_stand) set_joints(mean_joint_system(setting, start, found.h, step));
    }
  }

  // What was stated at the midpoint stays so.
  void set_joints(JointSystem joints) {
    step.rows.resize(step.rows.size() - step.joints.rows.size());
    step.joints = std::move(joints);
    for (ContactRow row : step.joints.rows) {
      if (stated[step.rows.size()]) state_at_midpoint(setting.dofs, plain.v, row);
      step.rows.push_back(row);
    }
  }
};

}  // namespace

StepReport PassiveMidpoint::step(State& state, double h_limit) const {
  const StepSetting& setting = *setting_;
  const bool mean_joints = own_.mean_joints && !setting.model.joints.empty();
  const auto estimate = [&](const State& start, double h) {
    return estimate_without_contacts(
        setting, start, free_motion(setting.model, start, setting.dofs, h, kMidpoint), h, kMidpoint);
  };
  const auto attempt = [&](const State& start, const Estimate& ahead, double h) {
    FoundContacts found = find_ahead(setting, start, ahead, h);
    MidpointSolve now{setting, own_, start, found, mean_joints};
    VecX v_path = now.find_path();
    const bool projects = mean_joints && now.landed;
    if (projects) v_path = now.find_path_to(now.end_of(v_path));
    ImpulseStep& step = now.step;
    if (!now.settled && is_solved(step.solved.solution.report.status))
      step.solved.solution.report.status = SolveStatus::max_iterations;
    Trial trial{
        .move = {.v_path = std::move(v_path),
                 .v_end = step.solved.solution.v,
                 .goes_on = 2 * (1 - kMidpoint) * setting.options.advancement.min_h},
        .figures = {.contacts_made_passive = int(std::count(now.stated.begin(), now.stated.end(), 1))}};
    if (projects) trial.move.end = now.end_of(trial.move.v_path);
    trial.impulses = std::move(step);
    trial.found = std::move(found);
    return trial;
  };
  return advance_step(setting, state, h_limit, {estimate, attempt});
}

}  // namespace aussois
