// SPDX-License-Identifier: Apache-2.0
// What happened in a step; returned by every scheme, printed by nobody but the driver.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lmd/contact_point.hpp"
#include "mechanics/mechanism.hpp"
#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"
#include "reduction/loss.hpp"
#include "reduction/warm_start.hpp"

namespace aussois {

enum class StepStatus {
  ok,
  refused,     // no step above the minimal one could be accepted; the state is unchanged
  not_finite,  // a force, velocity or pose stopped being a number; the state is unchanged
  not_solved,  // taken, but with the best impulses that were found: the solver, or the loop of an implicit
               // step (newton_change), failed in the shortest attempt too
};
const char* to_string(StepStatus status);

/// A contact that took part in the solve, as it stood at the start of the step, and what it did. With
/// FrictionAt::patches the tangential part of the impulse acts at the centre of its patch.
struct StepContact {
  ContactPoint point{};
  Vec3 impulse = Vec3::Zero();  // on A, world [N s]
  double drilling = 0;          // moment about the normal, on A [N m s]
  double work = 0;              // of both on the relative velocity, mean of start and end [J]
};

/// A gap function that took part in the solve.
struct StepGap {
  int index = -1;
  double gap = 0;               // at the start of the step [m]
  Vec3 impulse = Vec3::Zero();  // normal first [N s]
  double work = 0;              // as that of a contact [J]
};

/// Work of what acts at a joint on relative velocities, mean of start and end; springs, dampers and effort
/// motors along the path of the step (MJT-16) [J].
struct JointWork {
  double locked = 0;     // of the locked motions: what the discrete step leaves of nothing
  double couplings = 0;  // to other joints, that have the opposite
  double stops = 0;
  double friction = 0;  // dry
  double motors = 0;    // of all kinds
  double springs = 0;   // and dampers
  double supports = 0;  // what moved bodies give through the joint
  double total() const { return locked + couplings + stops + friction + motors + springs + supports; }
};

/// What a joint did, on A at the origin of its frame there, in the world; averaged over the step, or as the
/// scheme has it (MJT-17).
struct StepJoint {
  Vec3 force = Vec3::Zero();   // of the locked motions and of couplings [N]
  Vec3 torque = Vec3::Zero();  // [N m]
  Vec3 effort = Vec3::Zero();  // along its axes: stops, dry friction, speed and position motors [N, N m]
  JointWork work{};
};

/// A stretch of the path of a step with constant velocities.
struct PathPiece {
  double t = 0, h = 0;   // where it begins and how long it is [s]
  std::vector<SE3> g{};  // poses at its start
  VecX v{};              // in the places of State::v
};

enum class EventKind {
  impact,            // closed with a jump of the velocity
  rest,              // the end of infinitely many impacts
  release,           // opened without one
  slip,              // from sticking to slipping
  stick,             // from slipping to sticking
  reversal,          // from slipping to slipping back
  tangential_impact  // a jump of a closed contact that no finite force can keep closed (Painleve)
};
const char* to_string(EventKind kind);

/// What happened between the ends of a step, in a scheme that stops there.
struct StepEvent {
  EventKind kind = EventKind::impact;
  double t = 0;                  // [s]
  int body_a = -1, body_b = -1;  // of a contact
  int slot = -1;                 // of an axis or gap function: first entry of State::r
  double speed = 0;              // impacts: the normal speed that it closed with [m/s, rad/s], >= 0
};

/// What a step gave to the solver and what came back.
struct StepProblem {
  FrictionProblem problem{};    // of the contacts kept (NSGS-1)
  VecX start{};                 // impulses it was started with, of its rows [N s]
  FrictionSolution solution{};  // its report sums up the rounds of the step
};

/// Where the energy went in a step [J] (MJ-9).
struct EnergyLedger {
  double kinetic_change = 0;  // of the dynamic bodies and the coordinates
  double gravity_work = 0;    // along the path of the step: what the potential lost
  double law_work = 0;        // of force laws (the virtual coupling for example), joint springs and dampers,
                              // effort motors, forces of coordinates; along the path too
  double contact_work =
      0;  // of the impulses of contacts and gap functions; never positive for e = 0 against bodies at rest
  double gyroscopic_work = 0;  // of the gyroscopic term as discretised, and of masses that change with q
  double joint_work = 0;  // of joints, couplings, stops, dry friction, speed and position motors; with the
                          // other laws of their axes the sum of JointWork::total
  double numerical_work = 0;  // of the scheme itself: its damping (MJ-9), (GA-10)
  double residual() const {   // zero to rounding: the balance of (MJ-9)
    return kinetic_change - gravity_work - law_work - contact_work - gyroscopic_work - joint_work -
           numerical_work;
  }
};

/// Where the momentum of the dynamic bodies went in a step, about the world's origin with the arms of the
/// start (MJ-13): what acts between two of them cancels, its moments as far as it was posed with those arms.
/// In event_driven all of it along the motion, arms too (EVD-11).
struct MomentumLedger {
  Momentum change{};     // from the state before to the state after; parts hold an impact at the start too
  Momentum forces{};     // gravity and force laws
  Momentum contacts{};   // and gap functions
  Momentum joints{};     // couplings, stops, dry friction, motors; projection of velocities
  Momentum numerical{};  // of the scheme: its damping, and what arms and attitudes of the start leave to it
  Momentum residual() const {  // zero to rounding: the balance of (MJ-13)
    return change - forces - contacts - joints - numerical;
  }
};

struct StepReport {
  StepStatus status = StepStatus::ok;
  std::string reason{};           // why refused: the pair, its gap and the bound
  double t = 0, h = 0;            // time reached and step taken [s]
  int contacts_found = 0;         // local minima within the threshold
  int contacts_kept = 0;          // of them in the problem that was solved
  LossReport loss{};              // the worst of what the first selection lost (RED-7)
  MatchCounts matches{};          // of those found, with one of the last step (PER-3) to (PER-5)
  int contacts_made_passive = 0;  // whose law was stated at the midpoint, or they had given energy (PMI-6)
  int attempts = 1;               // times the step was tried (threshold enlarged or step halved)
  double threshold = 0;   // largest distance within which contacts were looked for, beyond the dilations [m]
  double min_gap = kInf;  // smallest of contacts found and gap functions, at the start of the step [m]
  double min_base_distance = kInf;  // lower bound of the distance of the base complexes over the step [m]
  int certificate_rounds = 0;
  int passing_pairs = 0;  // that came near and were not looked at: the model lets them pass (Model::passing)
  // Moved and fixed bodies that are not proven to keep apart in the step and cannot be stopped (CA-20),
  // sorted
  std::vector<std::pair<int, int>> driven_overlaps{};
  SolveReport solve{};  // residuals of the last problem solved; iterations and failures of all, and the worst
                        // status of those that the step stands on: stages, landing (MJ-17), impacts (IMP-1),
                        // projection (PRJ-1). event_driven: the worst of its impacts and settled contacts
  PhysicalResidual physical{};
  EnergyLedger energy{};
  MomentumLedger momentum{};
  double impulse_gain = 0;  // work of contacts and gap functions on relative velocities, if they gave any [J]
  bool energy_rises = false;  // more than rounding: restitution with friction can do that (IMP-6)
  int impact_solves = 0;      // problems of impacts apart from the step (IMP-4), (IMP-5)
  int newton_iterations = 1;  // solves of the step, contacts and forces evaluated anew for each (MJ-12)
  double newton_change = 0;   // of a velocity by the last of them, at most [m/s, rad/s]
  double projection = 0;      // what contacts were projected by, at most [m, rad] (PRJ-3)
  double overlap_left = 0;    // of the deepest one that projection found [m]
  VecX v_path{};  // all velocities, constant on the path of the step; empty in event_driven, whose path bends
  std::vector<PathPiece> pieces{};  // event_driven's: chords of it, that its certificate speaks of (EVD-10)
  JointError joint_error{};         // of all joints at the end of the step, at most
  std::vector<StepContact> contacts{};
  std::vector<StepGap> gaps{};           // of the active gap functions
  std::vector<double> law_work{};        // of both, added up for each of contact_laws(model) [J]
  std::vector<StepJoint> joints{};       // of every joint of the model
  double t_joints = 0;                   // that their forces are means about, or belong to (MJT-17) [s]
  std::vector<StepEvent> events{};       // in order of time; only of schemes that stop at events
  std::optional<StepProblem> problem{};  // the last one solved, also in a step that ended badly; if asked for
  double seconds_contact = 0, seconds_solve = 0, seconds_certificate = 0,
         seconds_total = 0;  // that passed [s]
  bool ok() const { return status == StepStatus::ok && is_solved(solve.status); }
  /// The state is that at `t`; otherwise it is unchanged.
  bool moved() const { return status == StepStatus::ok || status == StepStatus::not_solved; }
};

}  // namespace aussois
