// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/spinning_chain.hpp"

#include "examples/scenes/mechanisms.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/run.hpp"

namespace aussois {
namespace {

constexpr double kOmega = 3, kTurn = 2 * kPi / kOmega;

SchemeOptions on_mean_joints(double h) {
  SchemeOptions out = moreau_options(h);
  out.step.update = GroupUpdate::cayley;
  out.passive_midpoint.mean_joints = true;
  return out;
}

struct Ring {
  int rods = 6;
  JointKind kind = JointKind::spherical;
  std::string name() const { return std::to_string(rods) + " rods, " + to_string(kind); }
  double radius() const { return 0.5 / std::tan(kPi / rods); }  // of the circle of their middles [m]
  double force() const { return kOmega * kOmega * radius() / (2 * std::sin(kPi / rods)); }  // of a joint [N]
  CaseScene scene() const { return spinning_chain(rods, kOmega, kind); }
};
const Ring kChains[] = {{6, JointKind::spherical},
                        {6, JointKind::revolute},  // redundant: 30 rows for 27 motions
                        {4, JointKind::revolute}};

struct Balance {
  double energy = 0, angular = 0, linear = 0;  // at the end: relative, relative, [N s]
  double force = 0;                            // of a joint, at the end [N]
  Worst worst_energy{}, drift{};               // relative; of the joints [m]
  double moved = 0;                            // the first rod, from where it was [m]
};
Balance balance(const CaseScene& s, const std::string& scheme, const SchemeOptions& options, double turns) {
  const double before = energy(s.model, s.state).total();
  const Momentum start = momentum(s.model, s.state);
  Balance out;
  const State end =
      run_to(s, scheme, options, turns * kTurn, [&](const State& state, const StepReport& report) {
        out.force = report.joints[0].force.norm();
        out.worst_energy.add(std::abs(energy(s.model, state).total() / before - 1));
        out.drift.add(report.joint_error.translation);
      });
  const Momentum now = momentum(s.model, end);
  out.energy = std::abs(energy(s.model, end).total() / before - 1);
  out.angular = (now.angular - start.angular).norm() / start.angular.norm();
  out.linear = (now.linear - start.linear).norm();
  out.moved = (pose(end, 0).p - pose(s.state, 0).p).norm();
  return out;
}

// (MCH-10), the same for any joints: each step takes kappa (1 - kappa) (omega h)^4 / 16 of the energy, half
// of it of the angular momentum. Linear momentum to rounding.
VerificationCase slowing_down(const Ring& chain) {
  return {.name = "C10.slows_down",
          .setting = chain.name(),
          .what = "closed chain of 3 rad/s for five turns, moreau_jean, at 20 and 10 ms",
          .rows = {{"energy", "energy lost, off (MCH-10), relative to it", "-", 0.01,
                    "closed form; next order of h"},
                   {"angular", "angular momentum lost, off (MCH-10), relative to it", "-", 0.01,
                    "closed form; next order of h"},
                   {"linear", "linear momentum", "N s", 1e-12, "conserved; rounding"},
                   {"force", "force of a joint, relative", "-", 5e-4,
                    "closed form; (omega h)^2 of the coarser step over seven"}},
          .measure = [chain] {
            const double r = chain.radius(), kappa = r * r / (r * r + 1.0 / 12);
            Worst energy, angular, linear, force;
            for (const double h : {2e-2, 1e-2}) {
              const Balance now = balance(chain.scene(), "moreau_jean", moreau_options(h), 5);
              const double lost = kappa * (1 - kappa) * std::pow(kOmega * h, 4) / 16 * 5 * kTurn / h;
              energy.add(std::abs(now.energy / lost - 1));
              angular.add(std::abs(now.angular / (lost / 2) - 1));
              linear.add(now.linear);
              force.add(std::abs(now.force / chain.force() - 1));
            }
            return Figures{{"energy", energy}, {"angular", angular}, {"linear", linear}, {"force", force}};
          }};
}

// On the mean of both ends nothing is lost at all, at 60 ms a step of 10 degrees; the force is of order two.
VerificationCase mean_joints(const Ring& chain) {
  return {.name = "C10.mean_joints",
          .setting = chain.name(),
          .what = "closed chain of 3 rad/s on mean joints for two turns, passive_midpoint, at 60 and 10 ms",
          .rows = {{"energy", "energy, relative", "-", 1e-13, "conserved; rounding"},
                   {"angular", "angular momentum, relative", "-", 1e-13, "conserved; rounding"},
                   {"linear", "linear momentum", "N s", 1e-13, "conserved; rounding"},
                   {"force", "force of a joint, relative, over (omega h)^2", "-", 1, "theory: order two"}},
          .measure = [chain] {
            Worst energy, angular, linear, force;
            for (const double h : {6e-2, 1e-2}) {
              const Balance now = balance(chain.scene(), "passive_midpoint", on_mean_joints(h), 2);
              energy.add(now.energy), angular.add(now.angular), linear.add(now.linear);
              force.add(std::abs(now.force / chain.force() - 1) / (kOmega * kOmega * h * h));
            }
            return Figures{{"energy", energy}, {"angular", angular}, {"linear", linear}, {"force", force}};
          }};
}

// What is lost is rounding, of 20944 steps of 10 ms with balls and of 10472 of 20 ms with hinges.
VerificationCase hundred_turns(const Ring& chain) {
  const double h = chain.kind == JointKind::spherical ? 1e-2 : 2e-2;
  return {.name = "C10.hundred_turns",
          .setting = chain.name(),
          .what = "closed chain of 3 rad/s on mean joints for a hundred turns, at 10 ms (hinges: 20 ms)",
          .rows = {{"energy", "worst energy, relative", "-", 1e-12, "conserved (MJT-14); rounding"},
                   {"angular", "angular momentum, relative", "-", 1e-12, "conserved (MJT-14); rounding"},
                   {"drift", "worst error of a joint", "m", 1e-14, "joints hold to rounding"}},
          .measure =
              [=] {
                const Balance run = balance(chain.scene(), "passive_midpoint", on_mean_joints(h), 100);
                return Figures{{"energy", run.worst_energy}, {"angular", run.angular}, {"drift", run.drift}};
              },
          .slow = true};
}

// What ten turns lose is what the integrator's tolerance lets it.
VerificationCase ten_turns_exactly(const Ring& chain) {
  return {
      .name = "C10.ten_turns",
      .setting = chain.name(),
      .what = "closed chain of 3 rad/s for ten turns, event_driven",
      .rows = {{"energy", "energy, relative", "-", 2e-7, "conserved; tolerances of the equation"},
               {"angular", "angular momentum, relative", "-", 1e-7, "conserved; tolerances of the equation"}},
      .measure = [chain] {
        const Balance now = balance(chain.scene(), "event_driven", moreau_options(10 * kTurn), 10);
        return Figures{{"energy", now.energy}, {"angular", now.angular}};
      }};
}

VerificationCase force_exactly(const Ring& chain) {
  return {
      .name = "C10.force",
      .setting = chain.name(),
      .what = "closed chain of 3 rad/s, event_driven, steps of 1 ms: the mean of a force over a turn is zero",
      .rows = {{"force", "force of a joint, off 7.79423 N", "N", 1e-5, "closed form; its digits"}},
      .measure = [chain] {
        return Figures{
            {"force",
             std::abs(balance(chain.scene(), "event_driven", moreau_options(1e-3), 0.01).force - 7.79423)}};
      }};
}

// At the tightest tolerances of the event-driven reference: what CVODE loses.
VerificationCase hundred_turns_exactly() {
  return {
      .name = "C10.hundred_turns_of_the_equation",
      .what = "six rods on balls for a hundred turns, event_driven at its tightest tolerances",
      .rows = {{"energy", "energy, relative", "-", 2e-9, "conserved; tolerances of the equation"},
               {"angular", "angular momentum, relative", "-", 1e-9, "conserved; tolerances of the equation"},
               {"position", "position of a rod after whole turns", "m", 3e-7,
                "closed form; tolerances of the equation"}},
      .measure =
          [] {
            SchemeOptions o = exact_options(10);
            o.event_driven.ode = {.relative = 1e-13, .absolute = 1e-15};
            const Balance run = balance(kChains[0].scene(), "event_driven", o, 100);
            return Figures{{"energy", run.energy}, {"angular", run.angular}, {"position", run.moved}};
          },
      .slow = true};
}

/// Hung at one joint, in gravity, it unfolds and whirls.
CaseScene hung_chain() {
  CaseScene s = kChains[0].scene();
  s.model.gravity = Vec3(0, 0, -9.81);
  const SE3 at = pose(s.state, 0) * translation(0.5, 0, 0);
  add(s.model, joint_at(JointKind::spherical, "nail", 0, kWorld, s.state.g, at));
  s.state = consistent_state(s.model, s.state);
  return s;
}

// Energy of second order with the directions of a predicted middle, and to rounding on mean joints.
VerificationCase hung() {
  return {.name = "C10.hung",
          .what = "six rods on balls, hung at one joint, 1 s at 1 ms",
          .rows = {{"energy", "worst energy, moreau_jean", "J", 2e-4, "conserved; guard: order two"},
                   {"order", "order of it, 4 to 1 ms, off 2", "-", 0.4, "two; guard at these steps"},
                   {"on_mean_joints", "worst energy, passive_midpoint", "J", 2e-12, "conserved; rounding"},
                   {"drift", "worst error of a joint", "m", 1e-11, "joints hold to rounding"}},
          .measure = [] {
            const CaseScene s = hung_chain();
            Worst drift;
            const auto lost = [&](const char* scheme, const SchemeOptions& o) {
              const double before = energy(s.model, s.state).total();
              Worst worst;
              run_to(s, scheme, o, 1, [&](const State& now, const StepReport& report) {
                worst.add(std::abs(energy(s.model, now).total() - before));
                drift.add(report.joint_error.translation);
              });
              return double(worst);
            };
            const double coarse = lost("moreau_jean", moreau_options(4e-3)),
                         fine = lost("moreau_jean", moreau_options(1e-3)),
                         mean = lost("passive_midpoint", on_mean_joints(1e-3));
            return Figures{{"energy", fine},
                           {"order", std::abs(std::log(coarse / fine) / std::log(4) - 2)},
                           {"on_mean_joints", mean},
                           {"drift", drift}};
          }};
}

}  // namespace

std::vector<VerificationCase> spinning_chain_verification() {
  std::vector<VerificationCase> out;
  for (const auto& of : {slowing_down, mean_joints, hundred_turns, ten_turns_exactly})
    for (const Ring& chain : kChains) out.push_back(of(chain));
  for (const Ring& chain : {kChains[0], kChains[1]}) out.push_back(force_exactly(chain));
  out.push_back(hundred_turns_exactly());
  out.push_back(hung());
  return out;
}

}  // namespace aussois
