// SPDX-License-Identifier: Apache-2.0
// Group H: balances. What schemes keep, and of which order they lose the rest, by poses and velocities alone
// and by the numerical entries of the ledgers, against theory (doc/theory/ledgers.md); passivity; bits.
#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <utility>

#include "examples/common/random.hpp"
#include "examples/scenes/block_on_plate.hpp"
#include "examples/scenes/joint_variants.hpp"
#include "examples/scenes/outside_judge.hpp"
#include "examples/scenes/springs.hpp"
#include "examples/scenes/tumbling.hpp"
#include "examples/studies/convergence/study.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/run.hpp"

namespace aussois {
namespace {

// ---- what a run keeps

constexpr double kZero = kInf;  // an order: nothing but rounding

// (LED-2): orders in h of what a run loses or gains.
struct Promise {
  double order = 1;  // of all that is not said otherwise
  double top_momentum = 1, top_energy = 1;
  double pair_momentum = 1, pair_energy = 1;  // of two bodies on a joint
  double spring_energy = 1;                   // linear
  double damping = kZero;                     // numerical_work and numerical.linear on springs
};

Promise promise(const SchemeVariant& v) {
  const SchemeOptions& o = v.options;
  const double p = scheme_traits(v.name, o).smooth;
  Promise out{p, p, p, p, p, p, p};
  const bool midpoint = (v.name == "moreau_jean" && o.moreau_jean.theta == 0.5) ||
                        (v.name == "moreau_jean_projected" && o.moreau_jean_projected.theta == 0.5);
  const bool passive = v.name == "passive_midpoint";
  if (passive ||
      (midpoint && o.moreau_jean.newton.max_iterations > 1)) {  // the torque of the mean spin (PMI-3)
    out.top_energy = kZero;
    if (o.step.update == GroupUpdate::cayley) out.top_momentum = kZero;
  }
  if (passive && o.passive_midpoint.mean_joints) out.pair_momentum = out.pair_energy = kZero;
  if (passive || midpoint) out.spring_energy = out.damping = kZero;
  if (v.name == "generalised_alpha" && o.generalised_alpha.spectral_radius == 1) out.damping = kZero;
  return out;
}

/// Largest of a run of a second, in parts of what there is at its start.
struct Lost {
  Worst linear{}, angular{}, energy{};
  double numerical_linear = 0, numerical_angular = 0, numerical_work = 0;  // added up, without signs
};

/// A scene that nothing acts on from outside; `potential` of a state [J].
struct Isolated {
  CaseScene scene{};
  std::function<double(const State&)> potential = [](const State&) { return 0.0; };
};

Lost lost(const Isolated& isolated, const SchemeVariant& variant, double h) {
  const CaseScene& s = isolated.scene;  // clang 14 captures no structured bindings
  const auto& potential = isolated.potential;
  SchemeOptions options = variant.options;
  options.step.h = h;
  options.step.solver.tolerance = 1e-14;
  const Judged first = judged_from_outside(s.model, s.state);
  const double E = first.kinetic + potential(s.state), p = first.linear.norm(), L = first.angular.norm();
  Lost out;
  run_to(s, variant.name, options, 1, [&](const State& state, const StepReport& report) {
    const Judged now = judged_from_outside(s.model, state);
    out.linear.add((now.linear - first.linear).norm() / p);
    out.angular.add((now.angular - first.angular).norm() / L);
    out.energy.add(std::abs(now.kinetic + potential(state) - E) / E);
    out.numerical_linear += report.momentum.numerical.linear.norm() / p;
    out.numerical_angular += report.momentum.numerical.angular.norm() / L;
    out.numerical_work += std::abs(report.energy.numerical_work) / E;
  });
  return out;
}

/// What theory says of a figure of a run.
struct Claim {
  const char *figure, *what;
  double (*of)(const Lost&);
  double order;  // kZero: rounding
};
constexpr auto kLinear = [](const Lost& l) -> double { return l.linear; };
constexpr auto kAngular = [](const Lost& l) -> double { return l.angular; };
constexpr auto kEnergy = [](const Lost& l) -> double { return l.energy; };
constexpr auto kNumericalLinear = [](const Lost& l) { return l.numerical_linear; };
constexpr auto kNumericalAngular = [](const Lost& l) { return l.numerical_angular; };
constexpr auto kNumericalWork = [](const Lost& l) { return l.numerical_work; };

/// The order between the last two of three steps, or the largest of all three where nothing but rounding is
/// promised. An order of what is rounding, or far from its limit, is none.
double judged(const Claim& claim, const std::array<Lost, 3>& runs) {
  const double coarsest = claim.of(runs[0]), coarse = claim.of(runs[1]), fine = claim.of(runs[2]);
  if (claim.order == kZero) return std::max({coarsest, coarse, fine});
  return fine > 1e-11 && coarsest < 0.5 ? std::log2(coarse / fine) : std::nan("");
}

VerificationCase keeps(const char* name, const std::string& scene_name, const Isolated& scene,
                       const SchemeVariant& variant, const std::vector<Claim>& claims) {
  VerificationCase out{.name = name,
                       .setting = label(variant.name, variant.options),
                       .what = scene_name + " for 1 s in steps of 10, 5 and 2.5 ms",
                       .measure =
                           [=] {
                             std::array<Lost, 3> runs;
                             for (int i = 0; i < 3; ++i) runs[i] = lost(scene, variant, 1e-2 / (1 << i));
                             Figures figures;
                             for (const Claim& claim : claims) figures[claim.figure] = judged(claim, runs);
                             return figures;
                           },
                       .certified = true};
  for (const Claim& claim : claims)
    if (claim.order == kZero)
      out.rows.push_back({claim.figure, std::string(claim.what) + ", relative", "-", 1e-12,
                          "theory (LED-2): kept; rounding"});
    else
      out.rows.push_back({claim.figure, std::string("order of ") + claim.what, "-", claim.order - 0.1,
                          "theory (LED-2), less 0.1", Sense::at_least});
  return out;
}

Isolated free_top() {
  Isolated out;
  auto& [model, state, body] = out.scene;
  model.gravity.setZero();
  body = add(model, RigidBody{.name = "top", .mass = 2, .inertia = Vec3(0.1, 0.2, 0.3).asDiagonal()});
  state = rest_state(model);
  pose(state, body).p = Vec3(0.3, -0.2, 0.5);
  twist(state, body) << 1, 2, -1, 0.3, 4, 0.2;
  return out;
}

Isolated pair_on(JointKind kind) {
  const Tumbling tumbling(kind);
  return {.scene = {.model = tumbling.model, .state = tumbling.state}};
}

Isolated on_springs() {
  const Vec3 stiffness(8, 12, 16);
  Isolated out;
  auto& [model, state, body] = out.scene;
  model.gravity.setZero();
  body = add(model, RigidBody{.name = "mass", .mass = 2, .inertia = Mat3::Identity()});
  add(model, spring(body, stiffness));
  state = rest_state(model);
  pose(state, body).p = Vec3(0.3, -0.2, 0.5);
  twist(state, body).head<3>() << 1, 2, -1;
  out.potential = [=](const State& now) { return stiffness.dot(now.g[0].p.cwiseAbs2()) / 2; };
  return out;
}

VerificationCase top_keeps(const SchemeVariant& v) {
  const Promise theory = promise(v);
  return keeps("H2.free_top", "free top", free_top(), v,
               {{"linear", "linear momentum", kLinear, kZero},
                {"angular", "angular momentum", kAngular, theory.top_momentum},
                {"energy", "energy", kEnergy, theory.top_energy},
                {"numerical_linear", "numerical linear momentum", kNumericalLinear, kZero},
                {"numerical_angular", "numerical angular momentum", kNumericalAngular, theory.top_momentum}});
}

VerificationCase pair_keeps(const SchemeVariant& v, const char* name, JointKind kind) {
  const Promise theory = promise(v);
  return keeps(name, std::string("two bodies that tumble on a joint, ") + to_string(kind), pair_on(kind), v,
               {{"linear", "linear momentum", kLinear, kZero},
                {"angular", "angular momentum", kAngular, theory.pair_momentum},
                {"energy", "energy", kEnergy, theory.pair_energy},
                {"numerical_angular", "numerical angular momentum: the arms of the start (MJ-13)",
                 kNumericalAngular, 1}});
}

VerificationCase springs_keep(const SchemeVariant& v) {
  const Promise theory = promise(v);
  const bool filters = v.name == "generalised_alpha";  // its accelerations are no forces (GA-2)
  return keeps("H1.linear_springs", "mass on linear springs", on_springs(), v,
               {{"energy", "energy", kEnergy, theory.spring_energy},
                {"numerical_work", "numerical work", kNumericalWork, theory.damping},
                {"numerical_linear", "numerical linear momentum", kNumericalLinear,
                 filters ? theory.damping : kZero}});
}

VerificationCase the_reference_keeps() {
  return {
      .name = "H2.by_the_reference",
      .setting = "event_driven",
      .what = "free top and two bodies on a ball or a slider for 1 s in steps of 10 ms",
      .rows = {{"linear", "linear momentum, relative", "-", 1e-12, "conserved; rounding"},
               {"angular", "angular momentum, relative", "-", 1e-7, "conserved; tolerances of the equation"},
               {"energy", "energy, relative", "-", 1e-7, "conserved; tolerances of the equation"}},
      .measure =
          [] {
            Worst linear, angular, energy;
            for (const Isolated& scene :
                 {free_top(), pair_on(JointKind::spherical), pair_on(JointKind::prismatic)}) {
              const Lost l = lost(scene, {"event_driven", {}}, 1e-2);
              linear.add(l.linear), angular.add(l.angular), energy.add(l.energy);
            }
            return Figures{{"linear", linear}, {"angular", angular}, {"energy", energy}};
          },
      .certified = true};
}

// ---- works

VerificationCase free_fall() {
  return {
      .name = "H1.free_fall",
      .what = "body of 2 kg that falls, moreau_jean, theta 1/2, 0.7 and 1, ten steps of 10 ms",
      .rows = {{"weight", "worst work of the weight, off m g dz", "J", 1e-14, "closed form; rounding"},
               {"damping", "worst numerical work, off -(theta - 1/2) m (g h)^2", "J", 1e-14,
                "closed form (MJ-13); rounding"},
               {"push", "worst impulse of the weight, off m g h", "N s", 1e-15, "closed form; rounding"},
               {"ledger", "worst change of energy that no work explains", "J", 1e-13, "identity; rounding"}},
      .measure =
          [] {
            const double m = 2, g = kGravity, h = 0.01;
            Worst weight, damping, push, ledger;
            for (const double theta : {0.5, 0.7, 1.0}) {
              Model model;
              add(model, RigidBody{.name = "body", .mass = m, .inertia = Mat3::Identity()});
              State state = rest_state(model);
              const MoreauJean scheme(model, {.h = h}, {.theta = theta});
              for (int k = 0; k < 10; ++k) {
                const double z = pose(state, 0).p.z();
                const StepReport report = step(scheme, state);
                weight.add(std::abs(report.energy.gravity_work - m * g * (z - pose(state, 0).p.z())));
                damping.add(std::abs(report.energy.numerical_work + (theta - 0.5) * m * g * g * h * h));
                push.add(std::abs(report.momentum.forces.linear.z() + m * g * h));
                ledger.add(std::abs(report.energy.residual()));
              }
            }
            return Figures{{"weight", weight}, {"damping", damping}, {"push", push}, {"ledger", ledger}};
          },
      .certified = true};
}

/// Two masses on springs, one of them on a sprung slider.
CaseScene masses_on_springs() {
  CaseScene s;
  for (const double mass : {1.0, 3.0})
    add(s.model, RigidBody{.name = "ball", .mass = mass, .inertia = mass * Mat3::Identity()});
  add(s.model, spring(0, Vec3(200, 300, 400)));
  add(s.model, spring(1, Vec3(500, 100, 50)));
  s.state = rest_state(s.model);
  pose(s.state, 0).p = Vec3(0.1, -0.2, 0.3);
  pose(s.state, 1).p = Vec3(-0.3, 0.1, 0.2);
  twist(s.state, 1) << 1, 2, -1, 0.3, 4, 0.2;
  add(s.model, joint_at(JointKind::prismatic, "slider", 0, kWorld, s.state.g, pose(s.state, 0)));
  s.model.joints[0].axis[0] = {.stiffness = 700, .rest = 0.05};
  s.state.v = consistent_velocity(s.model, s.state);
  return s;
}

// At theta = 1/2 the work of weight and linear springs is what their potentials lost, step by step.
VerificationCase linear_forces(const SchemeVariant& v) {
  return {.name = "H1.linear_forces",
          .setting = label(v.name, v.options),
          .what = "two masses on springs, a sprung slider and weight, 200 steps of 5 ms",
          .rows = {{"works", "worst work of a step, off what its potential lost, relative", "-", 1e-12,
                    "identity at the midpoint; rounding"},
                   {"energy", "worst energy, relative", "-", 1e-12, "conserved at the midpoint; rounding"}},
          .measure =
              [v] {
                const CaseScene s = masses_on_springs();
                const Energy first = energy(s.model, s.state);
                const double E = first.kinetic + first.laws;
                SchemeOptions o = v.options;
                o.step.h = 5e-3;
                o.step.solver.tolerance = 1e-14;
                Worst works, whole;
                Energy before = first;
                run_to(s, v.name, o, 1, [&](const State& state, const StepReport& report) {
                  const Energy now = energy(s.model, state);
                  const EnergyLedger& e = report.energy;
                  works.add(std::abs(e.law_work - before.laws + now.laws) / E);
                  works.add(std::abs(e.gravity_work - before.gravity + now.gravity) / E);
                  works.add(std::abs(now.kinetic - before.kinetic - e.kinetic_change) / E);
                  works.add(std::abs(now.total() - before.total()) / E);
                  works.add(std::abs(e.residual()) / E);
                  whole.add(std::abs(now.total() - first.total()) / E);
                  before = now;
                });
                return Figures{{"works", works}, {"energy", whole}};
              },
          .certified = true};
}

/// Those at the midpoint; centres on arcs are moved otherwise.
std::vector<SchemeVariant> midpoint_variants() {
  std::vector<SchemeVariant> out = scheme_variants();
  std::erase_if(out, [](const SchemeVariant& v) {
    const bool midpoint = v.name == "passive_midpoint" ||
                          (v.name.starts_with("moreau_jean") && v.options.moreau_jean.theta == 0.5);
    return !midpoint || v.options.step.update == GroupUpdate::screw;
  });
  return out;
}

// A rod whose end, at x + a and y + a with unit masses, strikes a floor on which friction sticks.
CaseScene rod_on_floor() {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  add(s.model, Coordinates{.name = "rod",
                           .size = 3,
                           .mass = [](const VecX&) -> MatX { return MatX::Identity(3, 3); },
                           .force = {},
                           .potential = {}});
  MatX J(2, 3);
  J << 0, 1, 1, 1, 0, 1;
  add(s.model, GapFunction{.name = "floor",
                           .block = 0,
                           .evaluate =
                               [J](const Model& m, const State& state, double) {
                                 return GapRows{
                                     .gap = J.row(0).dot(coordinates(m, state, 0)), .J = J, .rate = {}};
                               },
                           .law = {.mu = 10, .restitution = 0.9}});
  s.state = rest_state(s.model);
  s.state.v << -0.5, -1, 0;
  return s;
}

// u_N = y' + a', u_T = x' + a' with unit masses: W = (2 1; 1 2). From u = (-1, -1/2) with e = 0.9 and
// friction that sticks, Newton's impulses are (1.1, -0.3), their work (1.1 (-0.1) + 0.3 / 2) / 2 = 0.02:
// Kane's paradox. Poisson's: compression (0.5, 0), expansion (0.45, -0.225); work (-0.95 * 0.325 + 0.225 / 2)
// / 2.
VerificationCase kanes_paradox() {
  return {
      .name = "H1.kanes_paradox",
      .what = "rod that strikes the floor with friction that sticks, e = 0.9, moreau_jean",
      .rows = {{"newton", "work and gain by Newton's law, off 0.02 J", "J", 1e-7,
                "closed form; the solver's tolerance"},
               {"told", "steps by Newton's law that report a gain", "-", 1, "the energy rises",
                Sense::exactly},
               {"poisson", "work by Poisson's law, off -0.098125 J", "J", 1e-12, "closed form; rounding"},
               {"impulse", "impulses by Poisson's law, off 0.95 and -0.225 N s", "N s", 1e-12,
                "closed form; rounding"},
               {"alarm", "steps by Poisson's law that report a gain", "-", 0, "energy is lost",
                Sense::exactly},
               {"ledger", "worst change of energy that no work explains", "J", 1e-12, "identity; rounding"}},
      .measure =
          [] {
            const CaseScene s = rod_on_floor();
            Worst ledger;
            const auto strike = [&](ImpactLaw law) {
              State state = s.state;
              StepReport report =
                  step(make_scheme(
                           "moreau_jean", s.model,
                           {.moreau_jean = {.theta = 1, .law = NormalLaw::moreau, .impact = {.law = law}}}),
                       state);
              ledger.add(std::abs(report.energy.residual()));
              ledger.add(std::abs(report.energy.kinetic_change - (state.v.squaredNorm() - 1.25) / 2));
              return report;
            };
            const StepReport newton = strike(ImpactLaw::newton), poisson = strike(ImpactLaw::poisson);
            const Vec2 impulse =
                poisson.gaps.empty() ? Vec2::Constant(kInf) : Vec2(poisson.gaps[0].impulse.head<2>());
            return Figures{
                {"newton",
                 std::max(std::abs(newton.energy.contact_work - 0.02), std::abs(newton.impulse_gain - 0.02))},
                {"told", double(newton.energy_rises)},
                {"poisson", std::abs(poisson.energy.contact_work - (-0.95 * 0.325 + 0.225 / 2) / 2)},
                {"impulse", (impulse - Vec2(0.95, -0.225)).cwiseAbs().maxCoeff()},
                {"alarm", double(poisson.energy_rises)},
                {"ledger", ledger}};
          },
      .certified = true};
}

// The explicit trapezoidal rule drives a top up: the energy as poses and velocities have it.
VerificationCase gain_of_a_run() {
  return {
      .name = "H1.gain_of_a_run",
      .setting = "d1_minus_linear",
      .what = "free top, 1000 steps of 0.1 s, none of which rises by itself",
      .rows = {{"gain", "energy gained, relative", "-", 0.01, "an explicit scheme", Sense::at_least},
               {"off", "gain that the run reports, off the true one, relative", "-", 0.05,
                "theory (LED-4): it swings a little as it climbs"},
               {"told", "runs that report it", "-", 1, "theory (LED-4): above a thousandth", Sense::exactly},
               {"alarms", "steps that report it", "-", 0, "each gains too little", Sense::exactly}},
      .measure =
          [] {
            CaseScene s;
            s.model.gravity.setZero();
            add(s.model, RigidBody{.name = "top", .mass = 1, .inertia = Vec3(1, 2, 3).asDiagonal()});
            s.state = rest_state(s.model);
            twist(s.state, 0).tail<3>() << 0.3, 2, 0.4;
            EnergyGain told = energy_gain(s.model, s.state);
            int alarms = 0;
            const State end = run_to(s, "d1_minus_linear", {.step = {.h = 0.1}}, 100,
                                     [&](const State& state, const StepReport& r) {
                                       add_step(s.model, state, r, told);
                                       alarms += r.energy_rises;
                                     });
            const double first = judged_from_outside(s.model, s.state).kinetic,
                         gained = judged_from_outside(s.model, end).kinetic - first;
            return Figures{{"gain", gained / first},
                           {"off", std::abs(told.largest / gained - 1)},
                           {"told", double(energy_rises(told))},
                           {"alarms", double(alarms)}};
          },
      .certified = true};
}

// ---- passivity

/// A force held over the step, as a port gives it: no stiffness, no damping. A step may ask more than once.
ForceLaw port(BodyId body, std::function<Vec6(const State&)> wrench) {
  return {.name = "port",
          .add_to = [body, wrench = std::move(wrench)](const Model&, const State& state, double,
                                                       GeneralisedForce& force) {
            body_part(force.f, body) += wrench(state);
          }};
}

// What the ports and gravity gave must cover what the body has gained, in each step and in all.
struct PortLedger {
  double stored = 0, given = 0;  // [J]
  double worst = -kInf;          // of a step, of the energies in it [-]
  Worst ledger{};                // likewise, what no work explains
  int made_passive = 0;
};
PortLedger by_ports(const Model& model, State state, bool passive, int steps) {
  const Scheme scheme = make_scheme(
      "passive_midpoint", model,
      {.step = {.h = 1e-3, .solver = {.tolerance = 1e-12}}, .passive_midpoint = {.passive = passive}});
  PortLedger out;
  for (int k = 0; k < steps; ++k) {
    const double before = energy(model, state).kinetic;
    const StepReport report = step(scheme, state);
    const double given = report.energy.law_work + report.energy.gravity_work;
    const double size = before + std::abs(given) + std::abs(report.energy.contact_work) + 1e-9;
    out.stored += report.energy.kinetic_change;
    out.given += given;
    out.worst = std::max(out.worst, (report.energy.kinetic_change - given) / size);
    out.made_passive += report.contacts_made_passive;
    out.ledger.add(std::abs(report.energy.residual() / size));
  }
  return out;
}

// A block on a plate under white noise of ten times its weight, pulled down to stay near.
Scene noisy_block() {
  Scene s = block_on_plate(0.4, 0.3, 0);
  s.model.forces.push_back(port(s.block, [](const State& state) -> Vec6 {
    Random random(std::uint64_t(std::llround(1e6 * state.t)));
    const Vec3 force = random.vector(100) - Vec3(0, 0, 20), torque = random.vector(0.5);
    Vec6 wrench;
    wrench << force, torque;
    return wrench;
  }));
  return s;
}

// A block that is pulled off its plate and pressed on again at every other step of 1 ms.
Scene block_on_and_off() {
  Scene s = block_on_plate(0.5, 0, 0);
  s.model.forces.push_back(port(s.block, [](const State& state) -> Vec6 {
    const double sign = std::llround(1e3 * state.t) % 2 == 0 ? 1 : -1;
    Vec6 wrench = Vec6::Zero();
    wrench[0] = 5 * sign, wrench[2] = 40 * sign;
    return wrench;
  }));
  return s;
}

// Every step of a longer run; without (PMI-6) the same runs gain: the law at the middle is not for nothing.
VerificationCase contacts_at_a_thousand_hertz(const std::string& setting, Scene (*scene)()) {
  return {
      .name = "H3.contacts_at_1_kHz",
      .setting = setting,
      .what = "block on a plate under a force held over each step, passive_midpoint, 1500 steps of 1 ms",
      .rows = {{"gain", "worst gain of a step over what was given, relative", "-", 1e-12,
                "passive (PMI-6); rounding"},
               {"kept", "what was given, less what is stored", "J", 0, "passive (PMI-6)", Sense::at_least},
               {"made_passive", "contacts whose law was stated at the midpoint", "-", 1, "it is needed",
                Sense::at_least},
               {"without", "worst gain of a step with `passive` off, relative", "-", 1e-2,
                "it is needed: explicit forms gain", Sense::at_least},
               {"ledger", "worst change of energy that no work explains, relative", "-", 1e-12,
                "identity; rounding"}},
      .measure =
          [scene] {
            const Scene s = scene();
            const PortLedger with = by_ports(s.model, s.state, true, 1500),
                             without = by_ports(s.model, s.state, false, 1500);
            return Figures{{"gain", with.worst},
                           {"kept", with.given - with.stored},
                           {"made_passive", double(with.made_passive)},
                           {"without", without.worst},
                           {"ledger", std::max<double>(with.ledger, without.ledger)}};
          },
      .certified = true};
}

// A tool held by a hand (100 N/m, 1 N s/m, swinging) against a wall of 1e5 N/m that answers late. The wall
// may well be active; the tool is not.
VerificationCase late_wall(int delay) {
  return {.name = "H3.late_wall",
          .setting = std::to_string(delay) + " steps late",
          .what = "tool held by a hand against a wall of 1e5 N/m that answers late, 4000 steps of 1 ms",
          .rows = {{"gain", "worst gain of a step over what was given, relative", "-", 1e-12,
                    "passive; rounding"},
                   {"kept", "what was given, less what is stored, of 4000 steps' rounding", "-", 1,
                    "no contact takes any"}},
          .measure =
              [delay] {
                Model model{.gravity = Vec3::Zero()};
                add(model, RigidBody{.name = "body", .mass = 0.3, .inertia = 1e-3 * Mat3::Identity()});
                const auto seen = std::make_shared<std::deque<std::pair<double, double>>>();  // (t, x)
                model.forces.push_back(port(0, [seen, delay](const State& state) -> Vec6 {
                  const double x = state.g[0].p.x(), v = state.v[0];
                  if (seen->empty() || seen->back().first < state.t) seen->emplace_back(state.t, x);
                  if (int(seen->size()) > delay + 1) seen->pop_front();
                  const double late = seen->front().second, wall = late < 0 ? -1e5 * late : 0;
                  const double hand = 100 * (-0.02 * std::sin(5 * state.t) - x) - v;
                  return Vec6::Unit(0) * (wall + hand);
                }));
                State state = rest_state(model);
                pose(state, 0).p.x() = 1e-3;
                const PortLedger ledger = by_ports(model, state, true, 4000);
                return Figures{{"gain", ledger.worst},
                               {"kept", std::abs(ledger.given - ledger.stored) /
                                            (4000e-12 * std::abs(ledger.stored) + 1e-9)}};
              },
          .certified = true};
}

// ---- bits

// What the reference knows between steps stands in the state.
VerificationCase fresh_scheme_in_each_step(const std::string& scene) {
  return {.name = "H4.fresh_scheme_in_each_step",
          .setting = scene,
          .what = "event_driven, one scheme for all of four long steps and a fresh one for each",
          .rows = {{"other_bits", "states with other bits", "-", 0,
                    "the scheme keeps everything in the state", Sense::exactly}},
          .measure = [scene] {
            const Case& c = case_named(scene);
            const CaseScene s = c.scene();
            const SchemeOptions o = exact_options(c.t_end / 7.3);
            const Scheme kept = make_scheme("event_driven", s.model, o);
            State one = s.state, other = s.state;
            int differ = 0;
            for (int k = 0; k < 4; ++k) {
              step(kept, one);
              step(make_scheme("event_driven", s.model, o), other);
              differ += hash(one) != hash(other);
            }
            return Figures{{"other_bits", double(differ)}};
          }};
}

// The certificate refuses nothing here: it looks at the path that was found.
VerificationCase certificate_of_the_reference(const std::string& scene) {
  return {.name = "H4.certificate_of_the_reference",
          .setting = scene,
          .what = "event_driven in seven steps and a bit, with its certificate and without",
          .rows = {{"other_bits", "ends with other bits", "-", 0, "it changes nothing", Sense::exactly}},
          .measure = [scene] {
            const Case& c = case_named(scene);
            const auto end = [&](bool certify) {
              SchemeOptions o = exact_options(c.t_end / 7.3);
              o.step.advancement.certify = certify;
              State last = run_to(c.scene(), "event_driven", o, c.t_end);
              last.apart = 0;  // all that it says
              return hash(last);
            };
            return Figures{{"other_bits", double(end(true) != end(false))}};
          }};
}

// Where no body has a shape there is nothing to certify.
VerificationCase certificate_without_shapes() {
  return {.name = "H4.certificate_without_shapes",
          .what = "exact motions of bodies without shapes, moreau_jean, with its certificate and without",
          .rows = {{"scenes", "scenes", "-", 6, "counted by hand", Sense::exactly},
                   {"other_bits", "runs that end otherwise, to the bit", "-", 0, "nothing to certify",
                    Sense::exactly}},
          .measure = [] {
            int scenes = 0, differ = 0;
            for (const Case& c : cases()) {
              if (!c.scene().model.shapes.empty()) continue;
              ++scenes;
              SchemeOptions o{.step = {.h = c.h}};
              const ComputedMotion with = run_case(c, "moreau_jean", o, 1);
              o.step.advancement.certify = false;
              const ComputedMotion without = run_case(c, "moreau_jean", o, 1);
              differ += with.t != without.t || with.node.back().v != without.node.back().v ||
                        with.node.back().q != without.node.back().q;
            }
            return Figures{{"scenes", double(scenes)}, {"other_bits", double(differ)}};
          }};
}

}  // namespace

std::vector<VerificationCase> balance_verification() {
  std::vector<SchemeVariant> variants = variants_with_joints();
  std::erase_if(variants, [](const SchemeVariant& v) { return v.name == "event_driven"; });
  std::vector<VerificationCase> out;
  for (const SchemeVariant& v : variants) {
    out.push_back(springs_keep(v));
    out.push_back(top_keeps(v));
    out.push_back(pair_keeps(v, "H2.pair_on_a_ball", JointKind::spherical));
    out.push_back(pair_keeps(v, "H2.pair_on_a_slider", JointKind::prismatic));
  }
  for (const SchemeVariant& v : midpoint_variants()) out.push_back(linear_forces(v));
  out.push_back(free_fall());
  out.push_back(kanes_paradox());
  out.push_back(gain_of_a_run());
  out.push_back(the_reference_keeps());
  out.push_back(contacts_at_a_thousand_hertz("white noise", noisy_block));
  out.push_back(contacts_at_a_thousand_hertz("on and off", block_on_and_off));
  for (const int delay : {0, 1, 3}) out.push_back(late_wall(delay));
  for (const char* scene : {"ball_e05", "stick_slip", "heavy_top"})
    out.push_back(fresh_scheme_in_each_step(scene));
  for (const char* scene : {"ball_e05", "rocking_block", "stick_slip"})
    out.push_back(certificate_of_the_reference(scene));
  out.push_back(certificate_without_shapes());
  return out;
}

}  // namespace aussois
