// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/haptic/haptic_trial.hpp"

#include <cmath>
#include <deque>

#include "geometry/primitives.hpp"
#include "integrators/schemes/passive_midpoint.hpp"
#include "mechanics/model.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/state.hpp"
#include "ports/local_model.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 1e-3, kMass = 0.3;  // of the part [m], [kg]
constexpr double kSide = 0.02, kLength = 0.04;   // of cube and peg, with their dilation [m]
constexpr double kClearance = 1e-4;              // of the peg in its hole, on each side [m]
constexpr double kAway = 5e-3;                   // from the hand's home to the first touch [m]
constexpr double kFlownOff = 0.5;                // of the handle from its home [m]

struct Scene {
  Model model{};
  State state{};
  BodyId part{}, handle{};
  int hold = 0;  // of the port, in the state
  PortLimits limits{};
  Reaching reaching{};
};

void add_fixed(Scene& scene, const std::string& name, const SimplicialComplex& complex, const SE3& pose) {
  RigidBody body = fixed_body(name, add(scene.model, prepare(dilate(complex, kDilation))));
  scene.state.g.push_back(pose);
  add(scene.model, std::move(body));
}

// Walls around a square hole whose mouth is at z = 0, and its floor.
void add_slot(Scene& scene) {
  const double half = kSide / 2 + kClearance, thick = 0.01, deep = kLength;
  const SimplicialComplex wall = make_box(thick, 2 * kSide, deep - 2 * kDilation);
  for (const double side : {-1.0, 1.0}) {
    add_fixed(scene, "wall", wall, translation(side * (half + kDilation + thick / 2), 0, -deep / 2));
    add_fixed(
        scene, "wall", wall,
        translation(0, side * (half + kDilation + thick / 2), -deep / 2) * rotation(Vec3::UnitZ(), kPi / 2));
  }
  add_fixed(scene, "floor", make_plate(0.1, 0.1), translation(0, 0, -deep - kDilation));
}

void add_wedge(Scene& scene) {
  for (const double side : {-1.0, 1.0})
    add_fixed(scene, "slope", make_plate(0.2, 0.2), rotation(Vec3::UnitY(), side * kPi / 3));
}

Scene scene_of(const HapticTrial& trial) {
  Scene out;
  out.model.gravity = Vec3::Zero();  // what a hand holds still has no weight
  out.model.contact_law = {.mu = 0.3};
  const bool wall = trial.scene == HapticScene::wall;
  const double length = wall ? kSide : kLength, core = kSide - 2 * kDilation;
  const SimplicialComplex box = make_box(core, core, length - 2 * kDilation);
  double touches = length / 2;  // height of the part where it first touches
  RigidBody part{
      .name = "part",
      .mass = kMass,
      .inertia = kMass / 12 *
                 Vec3(kSide * kSide + length * length, kSide * kSide + length * length, 2 * kSide * kSide)
                     .asDiagonal()};
  part.shape = add(out.model, prepare(dilate(box, kDilation)));
  out.part = add(out.model, std::move(part));
  out.state.g.push_back({});
  if (wall) {
    add_fixed(out, "wall", make_plate(0.5, 0.5), translation(0, 0, -kDilation));
  } else if (trial.scene == HapticScene::slot) {
    add_slot(out);
    touches = -length / 2;  // inside, from the start
  } else {
    add_wedge(out);
    touches = length / 2 + kSide / 2 * std::tan(kPi / 3) + kDilation / std::cos(kPi / 3);
  }
  RigidBody handle = fixed_body("handle", {});
  handle.motion = DrivenMotion{};
  out.handle = add(out.model, std::move(handle));
  const SE3 home = translation(0, 0, touches + kAway);
  out.limits = {.force = trial.device.force_limit, .torque = trial.device.torque_limit};
  out.hold = add_port_law(out.model, out.part, out.handle, out.limits);
  const PerBody<SE3> places = out.state.g;
  out.state = rest_state(out.model);
  for (const BodyId b : places.ids()) out.state.g[b] = places[b];
  pose(out.state, out.part) = pose(out.state, out.handle) = home;
  set_port_hold(
      out.state, out.hold,
      {.gains = critical_gains(out.model.bodies[out.part], trial.stiffness, 1e-3 * trial.stiffness)});
  out.reaching = {.home = home,
                  .shallow = kAway + 1e-3,
                  .deep = kAway + 15e-3,
                  .back = trial.scene == HapticScene::slot ? 0.5 * kAway : 3e-3,
                  .aside = 2e-3,
                  .turn = 0.05};
  return out;
}

// The bodies' side of a trial: one step for every few samples.
class Bodies {
 public:
  Bodies(const HapticTrial& trial, HapticResult& result)
      : scene_(scene_of(trial)),
        h_(trial.every * trial.device.period),
        scheme_(scene_.model, {.h = h_, .update = GroupUpdate::cayley}),
        result_(result) {}

  const Reaching& reaching() const { return scene_.reaching; }

  /// Leads the handle to a sample; false if the step is refused.
  bool step(const SE3& to) {
    State& state = scene_.state;
    lead_body(scene_.model, state, scene_.handle, to, h_);
    for (const double end = state.t + h_; state.t < end - 1e-9 * h_;) {
      const StepReport report = scheme_.step(state, end - state.t);
      ++result_.steps;
      result_.unsolved += !report.ok();
      if (!report.moved()) return false;
      bool touching = false;
      for (const StepContact& c : report.contacts) touching = touching || !c.impulse.isZero(0);
      result_.events += touching != touching_;
      touching_ = touching;
    }
    return true;
  }
  double stored() const {
    const Energy now = energy(scene_.model, scene_.state);
    return now.kinetic + now.laws;
  }
  /// On the hand, as (PORT-5) sees it.
  DeviceForce told(const HandleMotion& motion) const {
    return local_force(point_of(scene_.part), port_hold(scene_.state, scene_.hold), scene_.limits, motion);
  }
  /// On the hand, as the last step left it.
  DeviceForce held() const {
    const PortPull pull = port_pull(point_of(scene_.part), point_of(scene_.handle),
                                    port_hold(scene_.state, scene_.hold), scene_.limits);
    return {-pull.force, -pull.torque};
  }

 private:
  TrajectoryPoint point_of(BodyId body) const {
    return {pose(scene_.state, body), twist(scene_.state, body)};
  }

  Scene scene_;
  double h_;
  PassiveMidpoint scheme_;
  HapticResult& result_;
  bool touching_ = false;
};

// The largest of what left beyond what was stored, over all windows of time.
struct Excess {
  double left = 0, lowest = kInf, worst = 0;
  void add_stored(double stored) { lowest = std::min(lowest, left + stored); }
  void now(double all) {
    left = all;
    if (lowest < kInf) worst = std::max(worst, left - lowest);
  }
};

}  // namespace

HapticResult haptic_trial(const HapticTrial& trial, const std::function<bool(std::int64_t)>& go_on) {
  validate(trial.reserve);
  HapticResult out;
  Bodies bodies(trial, out);
  const bool held = trial.way == HapticWay::held || trial.way == HapticWay::held_reserve,
             through = trial.way == HapticWay::reserve || trial.way == HapticWay::held_reserve;
  const SE3 home = bodies.reaching().home;
  SimulatedHand hand(trial.hand, trial.device, bodies.reaching(), trial.seed);
  Reserve reserve{.level = trial.reserve.lend};
  std::deque<DeviceForce> late(std::size_t(trial.late));
  DeviceForce force;
  DeviceMotion motion;
  SE3 seen = home, at_step = home;
  Excess measured, truth;
  double wishes = 0, forces = 0, left = 0;
  std::int64_t changed = 0;
  while (hand.pushes() <= trial.pushes && !out.flew_off && !out.refused && (!go_on || go_on(hand.pushes()))) {
    const SE3 sample = hand.live(force).pose;
    motion = motion_between(seen, sample);
    const SE3 last = std::exchange(seen, sample);
    const double work = work_left(hand.held(), motion, trial.reserve);
    reserve = after_sample(reserve, work);
    measured.now(left += work);
    truth.now(hand.given());
    const bool steps = ++out.samples % trial.every == 0;
    if (steps) {
      out.refused = !bodies.step(sample);
      at_step = sample;
      const double stored = bodies.stored();
      reserve = after_tick(reserve, stored, trial.reserve);
      measured.add_stored(stored), truth.add_stored(stored);
    }
    const double period = trial.device.period, since = double(out.samples % trial.every) * period;
    const Vec6 twist = steps ? twist_between(last, sample, period) : twist_between(at_step, sample, since);
    late.push_back(held ? bodies.held() : bodies.told({sample, twist, since}));
    const DeviceForce wish = late.front();
    late.pop_front();
    const Valve valve = let_through(wish, motion, reserve, trial.reserve);
    if (through) reserve = valve.reserve;
    force = through ? valve.force : wish;
    changed += (force.force - wish.force).norm() > 0.01 * wish.force.norm() + 1e-3 ||
               (force.torque - wish.torque).norm() > 0.01 * wish.torque.norm() + 1e-4;
    wishes += wish.force.squaredNorm(), forces += force.force.squaredNorm();
    out.peak = std::max(out.peak, hand.held().force.norm());
    out.flew_off = !((hand.handle().p - home.p).norm() < kFlownOff);
  }
  out.excess = measured.worst, out.true_excess = truth.worst, out.given = hand.given();
  out.beyond = reserve.negative;
  out.changed = double(changed) / double(std::max<std::int64_t>(1, out.samples));
  out.force_left = wishes > 0 ? std::sqrt(forces / wishes) : 1;
  return out;
}

}  // namespace aussois
