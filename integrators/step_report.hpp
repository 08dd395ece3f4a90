// SPDX-License-Identifier: Apache-2.0
// The report of a step: every scheme returns one, and only the driver prints it.
#pragma once

#include <array>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/named.hpp"
#include "lmd/contact_point.hpp"
#include "mechanics/mechanism.hpp"
#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"
#include "reduction/loss.hpp"
#include "reduction/warm_start.hpp"

namespace aussois {

enum class StepStatus {
  ok,
  refused,     // no step of at least the minimal length could be accepted; the state is unchanged
  not_finite,  // a force, velocity or pose became non-finite; the state is unchanged
  not_solved,  // taken with the best impulses found: the solver, or the loop of an implicit step
               // (newton_change), failed even in the shortest attempt
};
const char* to_string(StepStatus status);

/// A contact that took part in the solve, as it stood at the start of the step, with its impulse and its
/// work. With FrictionAt::patches the tangential part of the impulse acts at the centre of its patch.
struct StepContact {
  ContactPoint point{};
  Vec3 impulse = Vec3::Zero();  // on A, world [N s]
  double drilling = 0;          // moment about the normal, on A [N m s]
  double work = 0;              // of impulse and drilling moment on the relative velocity, mean of start and
                                // end [J]
};

/// A gap function that took part in the solve.
struct StepGap {
  GapId id{};
  double gap = 0;               // at the start of the step [m]
  Vec3 impulse = Vec3::Zero();  // normal first [N s]
  double work = 0;              // as for a contact [J]
};

/// Work done at a joint on relative velocities, mean of start and end. That of springs, dampers and effort
/// motors is taken along the path of the step (MJT-16) [J].
struct JointWork {
  double locked = 0;     // of the locked motions: only the error of the discrete step
  double couplings = 0;  // with other joints, which get the opposite
  double stops = 0;
  double friction = 0;  // dry
  double motors = 0;    // of all kinds
  double springs = 0;   // and dampers
  double supports = 0;  // supplied by moved bodies through the joint
  double total() const { return locked + couplings + stops + friction + motors + springs + supports; }
};

/// What a joint did to body A, at the origin of the joint's frame on A, in the world; averaged over the step,
/// or as the scheme defines it (MJT-17).
struct StepJoint {
  Vec3 force = Vec3::Zero();   // of the locked motions and of couplings [N]
  Vec3 torque = Vec3::Zero();  // [N m]
  Vec3 effort = Vec3::Zero();  // along its axes: stops, dry friction, speed and position motors [N, N m]
  JointWork work{};
};

/// A stretch of the path of a step with constant velocities.
struct PathPiece {
  double t = 0, h = 0;  // when it begins and how long it lasts [s]
  PerBody<SE3> g{};     // poses at its start
  VecX v{};             // indexed as State::v
};

enum class EventKind {
  impact,            // a contact closed with a jump of the velocity
  rest,              // the end of infinitely many impacts
  release,           // a contact opened without an impact
  slip,              // from sticking to slipping
  stick,             // from slipping to sticking
  reversal,          // slip reversed its direction
  tangential_impact  // velocity jump at a closed contact that no finite force can keep closed (Painleve)
};
const char* to_string(EventKind kind);

/// An event between the ends of a step, from a scheme that stops at events.
struct StepEvent {
  EventKind kind = EventKind::impact;
  double t = 0;               // [s]
  BodyId body_a{}, body_b{};  // of a contact
  std::optional<int> slot{};  // of an axis or gap function, see axis_slot and gap_of; a contact has none
  double speed = 0;           // impacts: normal closing speed [m/s, rad/s], >= 0
};

/// What a step passed to the solver, and what came back.
struct StepProblem {
  FrictionProblem problem{};    // of the contacts kept (NSGS-1)
  VecX start{};                 // initial impulses of its rows [N s]
  FrictionSolution solution{};  // its report sums up the rounds of the step
};

/// Where the energy went in a step [J] (MJ-9).
struct EnergyLedger {
  double kinetic_change = 0;  // of the dynamic bodies and the coordinates
  double gravity_work = 0;    // along the path of the step: the loss of potential
  double law_work = 0;        // of force laws (for example the virtual coupling), joint springs and dampers,
                              // effort motors, forces of coordinates; also along the path
  double contact_work = 0;    // of contacts and gap functions; for e = 0 against bodies at rest positive only
                              // where a velocity turns in the step (LED-5) or an overlap is pushed out
  double gyroscopic_work = 0;  // of the gyroscopic term as discretised, and of masses that change with q
  double joint_work = 0;  // of joints, couplings, stops, dry friction, speed and position motors; together
                          // with the other laws of their axes, the sum of JointWork::total
  double numerical_work = 0;  // of the scheme itself: its damping (MJ-9), (GA-10)
  double residual() const {   // zero to rounding: the balance of (MJ-9)
    return kinetic_change - gravity_work - law_work - contact_work - gyroscopic_work - joint_work -
           numerical_work;
  }
};

/// Where the momentum of the dynamic bodies went in a step, about the world's origin with the arms of the
/// start (MJ-13). Forces between two of these bodies cancel; their moments cancel only as far as they were
/// posed with those arms. In event_driven all of it is taken along the motion, including the arms (EVD-11).
struct MomentumLedger {
  Momentum change{};     // from the state before to the state after; the parts include an impact at the start
  Momentum forces{};     // gravity and force laws
  Momentum contacts{};   // of contacts and gap functions
  Momentum joints{};     // of joints, couplings, stops, dry friction, motors, projection of velocities
  Momentum numerical{};  // of the scheme: its damping, and the difference made by using arms and attitudes of
                         // the start
  Momentum residual() const {  // zero to rounding: the balance of (MJ-13)
    return change - forces - contacts - joints - numerical;
  }
};

/// The parts of a step that are timed. The rest of it is ledgers, projection of joints, copies.
enum class Stage { broad_phase, search, reduction, kinematics, assembly, solve, certificate };
inline constexpr Named<Stage> kStages[] = {
    {Stage::broad_phase, "broad_phase"},  // which bodies are near
    {Stage::search, "search"},            // where they touch
    {Stage::reduction, "reduction"},      // which contacts were there before, and which matter
    {Stage::kinematics, "kinematics"},    // rows of contacts, gap functions and joints
    {Stage::assembly, "assembly"},        // masses, forces, the problem of the kept rows
    {Stage::solve, "solve"},
    {Stage::certificate, "certificate"}};

struct StageTime {
  double wall = 0, cpu = 0;  // [s]; CPU time of the process, 0 unless StepOptions::profile
};
struct StageTimes {
  std::array<StageTime, std::size(kStages)> of{};  // by Stage
  StageTime& operator[](Stage stage) { return of[std::size_t(stage)]; }
  const StageTime& operator[](Stage stage) const { return of[std::size_t(stage)]; }
};
void add(const StageTimes& part, StageTimes& sum);
/// Time since some fixed moment. The CPU time of the process costs a system call, and machines that limit it
/// count it in ticks of some ms: it is taken only if asked for.
StageTime time_now(bool cpu);
StageTime time_since(const StageTime& begin, bool cpu);
/// Wall time of some stages [s].
double seconds_of(const StageTimes& times, std::initializer_list<Stage> stages);

struct StepReport {
  StepStatus status = StepStatus::ok;
  std::string reason{};           // why refused: the pair, its gap and the bound
  double t = 0, h = 0;            // time reached and step taken [s]
  int contacts_found = 0;         // local minima within the threshold
  int contacts_coarse = 0;        // those of them that are of coarser levels (LOD-6)
  int contacts_kept = 0;          // those of them in the problem that was solved
  LossReport loss{};              // worst loss of the first selection (RED-7)
  MatchCounts matches{};          // of the contacts found with those of the last step (PER-3) to (PER-5)
  int contacts_made_passive = 0;  // law stated at the midpoint, since they would have given energy (PMI-6)
  int attempts = 1;               // times the step was tried (threshold enlarged or step halved)
  double threshold = 0;           // largest search distance for contacts, beyond the dilations [m]
  // Smallest gap of contacts found and gap functions, at the start of the step [m]; where levels answer it
  // may be a third too small (LOD-5)
  double min_gap = kInf;
  double min_base_distance = kInf;  // lower bound on the distance of the base complexes over the step [m]
  int certificate_rounds = 0;
  int passing_pairs = 0;  // near pairs that were skipped, since the model lets them pass (Model::passing)
  // Pairs of moved and fixed bodies that are not proven to stay apart in the step and cannot be stopped
  // (CA-20), sorted
  std::vector<BodyPair> driven_overlaps{};
  // Residuals of the last problem solved; iterations and failures of all problems; the worst status of those
  // that the step depends on: stages, landing (MJ-17), impacts (IMP-1), projection (PRJ-1). event_driven: the
  // worst of its impacts and settled contacts
  SolveReport solve{};
  PhysicalResidual physical{};
  EnergyLedger energy{};
  MomentumLedger momentum{};
  double impulse_gain = 0;    // work of contacts and gap functions on relative velocities, where positive [J]
  bool energy_rises = false;  // the gain exceeds rounding; restitution with friction can cause that (IMP-6)
  int impact_solves = 0;      // impact problems solved apart from the step (IMP-4), (IMP-5)
  int newton_iterations = 1;  // solves of the step, each with contacts and forces evaluated anew (MJ-12)
  double newton_change = 0;   // largest change of a velocity in the last of them [m/s, rad/s]
  double projection = 0;      // largest displacement by which contacts were projected [m, rad] (PRJ-3)
  double overlap_left = 0;    // what the projection left of the deepest overlap [m]
  VecX v_path{};  // all velocities, constant on the path of the step; empty in event_driven, whose path bends
  std::vector<PathPiece> pieces{};  // event_driven: chords of its path that its certificate covers (EVD-10)
  JointError joint_error{};         // largest of all joints at the end of the step
  std::vector<StepContact> contacts{};
  std::vector<StepGap> gaps{};           // of the active gap functions
  std::vector<double> law_work{};        // work of contacts and gap functions, summed for each of
                                         // contact_laws(model) [J]
  Table<JointId, StepJoint> joints{};    // of every joint of the model
  double t_joints = 0;                   // time that joint forces are means about, or belong to (MJT-17) [s]
  std::vector<StepEvent> events{};       // in order of time; only from schemes that stop at events
  std::optional<StepProblem> problem{};  // the last one solved, even in a step that failed; only if asked for
  StageTimes stages{};                   // of all attempts; none in event_driven
  StageTime total{};
  std::size_t kept_bytes = 0;  // that the scheme keeps of its pairs to be faster; none in event_driven
  bool ok() const { return status == StepStatus::ok && is_solved(solve.status); }
  /// True if the state is now that at `t`; otherwise it is unchanged.
  bool moved() const { return status == StepStatus::ok || status == StepStatus::not_solved; }
};

}  // namespace aussois
