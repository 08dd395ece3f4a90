// SPDX-License-Identifier: Apache-2.0
// One step of the event-driven scheme, from event to event: its state, and what its parts share. Events are
// handled in event_settling.cpp, the differential equation between events in event_motion.cpp, the proof of
// the path in event_path.cpp, and the loop over events in event_driven.cpp.
#pragma once

#include "integrators/events/event_driven.hpp"
#include "integrators/events/ode.hpp"
#include "integrators/events/touching.hpp"
#include "integrators/pose/reduced_solve.hpp"
#include "integrators/tell/joint_work.hpp"

namespace aussois {

// A row of a path counts as reached when it is nearer than this: sums of steps are rounded [s]
inline constexpr double kSameTime = 1e-12;

/// For each of `old`, the index of the touch in `now` that continues it: the one with the same features, or
/// the nearest contact of the same bodies that continues no other; -1: none.
std::vector<int> matched(const std::vector<Touch>& old, const std::vector<Touch>& now);
std::vector<Touch> touches_of(const std::vector<ClosedTouch>& closed);

/// A touch that opened at the start of the piece. `offset` is how much it overlapped, plus the accuracy to
/// which its gap is known if it opened without speed.
struct LeavingTouch {
  Touch touch{};
  double offset = 0;  // [m]
};

/// Where the parts of the differential equation begin in its vector (EVD-2).
struct EventLayout {
  int bodies = 0, q = 0, v = 0, work = 0, impulse = 0, touch_work = 0, momentum = 0, joints = 0, size = 0;
  std::vector<int> first_impulse{};  // of every closed touch
};
enum EventWork { by_laws, by_contacts, by_joints, by_mass, kWorks };
enum EventMomentum { of_forces, of_contacts, of_joints, kMomenta };
inline constexpr int kMomentum = 6;    // entries of each: linear, angular
inline constexpr int kJointSums = 16;  // of every joint: force, torque, effort, parts of the work
using JointSums = Eigen::Matrix<double, kJointSums, 1>;

EventLayout layout_of(const StepSetting& setting, const std::vector<ClosedTouch>& closed);

/// Adds to its joint what a stop or dry friction does with `p` at the velocity `on`; `v` is the velocity at
/// which the touch was made.
void add_touch(const Touch& touch, double p, const VecX& v, const VecX& on,
               Table<JointId, StepJoint>& joints);

/// One step: from event to event.
class EventRun {
 public:
  EventRun(const StepSetting& setting, const EventDrivenOptions& options, const State& start, double h)
      : setting_(setting),
        o_(options),
        model_(setting.model),
        state_(start),
        t_begin_(start.t),
        t_end_(start.t + h) {
    state_.r = row_count(model_) > 0 ? VecX(VecX::Zero(row_count(model_))) : VecX();
    joints_.resize(model_.joints.size());
  }

  StepReport step(State& out);

 private:
  bool settle(bool first);
  bool collisions(std::vector<Touch>& touches);
  bool jump_without_collision(const std::vector<Touch>& touches);
  bool decide(const std::vector<Touch>& touches);
  void foretell_rest(const Accelerations& now);
  void compare(const std::vector<ClosedTouch>& before);
  OdeOptions ode_of_piece() const;
  bool follow(const OdeProblem& problem, double stop, OdeOptions& ode, State& last, bool& refusal);
  bool integrate_piece();
  bool run(const State& start);
  void tell_contacts(const State& start);
  double safe_until(const State& from, double stop) const;
  bool leapt(const State& from, const State& to);
  bool certified(const State& from, const State& to, const std::function<State(double)>& at);

  VecX packed() const;
  State unpacked(double t, const VecX& y) const;
  std::vector<ClosedTouch> closed_at(const std::vector<Touch>& touches, std::vector<int>& match) const;
  bool rate(double t, const VecX& y, VecX& out) const;
  bool roots(double t, const VecX& y, VecX& out) const;
  void take(const VecX& y);
  double next_row() const;
  void move_prescribed();
  void add_event(EventKind kind, const Touch& touch, double t, double speed = 0);
  void add_impulse(const Touch& touch, const VecX& r, double work);
  void add_jump(const std::vector<Touch>& near, const Collision& hit, const VecX& before);
  WorkVelocities worked_on(const State& state, const VecX& v) const;
  void project();
  bool of_a_joint(const Touch& touch) const { return is_of_axis(model_, touch.slot); }
  void count_solve(const SolveReport& solve) {
    add_part(solve, report_.solve);
    report_.solve.residual = std::max(report_.solve.residual, solve.residual);
    report_.solve.worst_island = std::max(report_.solve.worst_island, solve.worst_island);
    report_.solve.coulomb_residual = std::max(report_.solve.coulomb_residual, solve.coulomb_residual);
  }
  bool refused(const std::string& reason) {
    report_.status = StepStatus::refused;
    report_.reason = reason;
    return false;
  }

  const StepSetting& setting_;
  const EventDrivenOptions& o_;
  const Model& model_;
  State state_;  // where the run is
  double t_begin_, t_end_;
  StepReport report_{};
  Table<JointId, StepJoint> joints_{};  // their impulses and work so far
  double work_[kWorks] = {};
  MomentumLedger momentum_{};  // its parts so far
  bool proven_apart_ = false;  // at the start (CA-21)
  int stops_ = 0;
  long ode_steps_ = 0;

  // Of the piece that begins at state_
  std::vector<ClosedTouch> closed_{};
  std::vector<LeavingTouch> leaving_{};
  std::vector<VecX> force_{};  // at its start
  VecX a_{};                   // likewise, indexed as State::v
  double tolerance_ = 0;       // smaller accelerations count as zero [m/s^2]
  EventLayout layout_{};
  State turned_{};  // state from which turns are counted
};

}  // namespace aussois
