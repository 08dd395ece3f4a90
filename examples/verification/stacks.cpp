// SPDX-License-Identifier: Apache-2.0
// Group G: stacks and scenes of other engines.
#include "examples/scenes/peer_scenes.hpp"
#include "examples/verification/running.hpp"

namespace aussois {
namespace {

constexpr double kGravity = 9.81;

/// The step of Moreau-Jean; throws NumericalFailure with its reason if it is not ok.
StepReport step(const MoreauJean& scheme, State& state) {
  StepReport report = scheme.step(state);
  if (!report.ok()) throw NumericalFailure(report.reason + " at t = " + std::to_string(state.t) + " s");
  return report;
}

// (n - k) m g below cube k of the tower of ten, and of the one with 800 kg on top.
VerificationCase tower(const std::string& name) {
  return {.name = "G1.weight_above_each_cube",
          .setting = name,
          .what = "tower of ten cubes, 20 steps of 10 ms",
          .rows = {{"force", "worst force below a cube, off the weight above, relative", "-", 1e-7,
                    "closed form (n - k) m g; ten tolerances of the solver"}},
          .measure = [name] {
            const PeerScene scene = peer_scene(name);
            const KernelScene k = kernel_scene(scene);
            const MoreauJean scheme(k.model, kernel_options(scene, 1e-2));
            State state = k.state;
            StepReport report;
            for (int i = 0; i < 20; ++i) report = step(scheme, state);
            std::vector<double> below(scene.bodies.size());
            for (const StepContact& c : report.contacts)
              below[std::size_t(std::max(c.point.a.body, c.point.b.body))] +=
                  std::abs(c.impulse.z()) / report.h;
            Worst force;
            double above = 0;
            for (std::size_t b = scene.bodies.size() - 1; b >= 1; --b) {
              above += scene.shapes[std::size_t(scene.bodies[b].shape)].mass * kGravity;
              force.add(std::abs(below[b] / above - 1));
            }
            return Figures{{"force", force}};
          }};
}

/// What the judge of the peers says of a run in steps of 10 ms; it ends when a body has fallen.
struct Judged {
  double error = 0, fall_time = kInf;  // [m], [s]
};
Judged judged(const Arch& arch, double t_end) {
  const PeerScene scene = arch_scene(arch);
  const KernelScene k = kernel_scene(scene);
  const MoreauJeanOptions o = kernel_options(scene, 1e-2);
  const MoreauJean scheme(k.model, o);
  State state = k.state;
  PeerJudge judge(scene);
  judge.see(sample(state));
  while (state.t < t_end - o.h / 2 && judge.fall_time() == kInf) {
    step(scheme, state);
    judge.see(sample(state));
  }
  return {judge.error(), judge.fall_time()};
}

// Least friction 0.30914, least thickness 0.10745, largest tilt 15.85 degrees (PEER-2).
VerificationCase arch_of_101() {
  return {
      .name = "G4.arch_of_101",
      .what =
          "arch of 101 stones on either side of its limits of friction, thickness and tilt, steps of 10 ms",
      .rows = {{"stands", "worst way of a stone inside the limits, 0.5 s", "m", 1e-8,
                "limit analysis (PEER-2): it stands; solver"},
               {"falls", "latest fall outside the limits", "s", 0.5, "limit analysis (PEER-2): it falls"}},
      .measure =
          [] {
            constexpr double kDegree = kPi / 180;
            Worst stands, falls;
            for (const Arch& arch :
                 {Arch{.stones = 101, .mu = 0.35}, Arch{.stones = 101, .tilt = 15 * kDegree},
                  Arch{.stones = 101, .thickness = 0.115}})
              stands.add(judged(arch, 0.5).error);
            for (const Arch& arch : {Arch{.stones = 101, .thickness = 0.1}, Arch{.stones = 101, .mu = 0.25},
                                     Arch{.stones = 101, .tilt = 18 * kDegree}})
              falls.add(judged(arch, 0.6).fall_time);
            return Figures{{"stands", stands}, {"falls", falls}};
          },
      .slow = true};
}

// The box, and the balls on it with 2/7 of its acceleration: speeds are exact, and positions those of the
// theta rule, (theta - 1/2) h T a ahead.
VerificationCase rolling(const std::string& name) {
  return {.name = "G5.rolling",
          .setting = name,
          .what = "box that is pushed under 25 balls for 0.5 s, theta 1/2 and 1, 10 and 1 ms",
          .rows = {{"acceleration", "acceleration of the box, off 0.7385 m/s^2", "m/s^2", 5e-5,
                    "closed form; its digits"},
                   {"speed", "worst speed", "m/s", 1e-11, "closed form; rounding of 500 steps"},
                   {"position", "worst position", "m", 1e-11, "theta rule; rounding of 500 steps"}},
          .measure =
              [name] {
                constexpr double t_end = 0.5;
                const PeerScene scene = peer_scene(name);
                const KernelScene k = kernel_scene(scene);
                const Vec3 along = scene.bodies[1].force.normalized();
                Worst speed, position;
                for (const double h : {1e-2, 1e-3})
                  for (const double theta : {0.5, 1.0}) {
                    MoreauJeanOptions o = kernel_options(scene, h);
                    o.theta = theta;
                    o.solver.tolerance = 1e-12;  // rounding is asked for
                    const MoreauJean scheme(k.model, o);
                    State state = k.state;
                    while (state.t < t_end - h / 2) step(scheme, state);
                    for (int b = 1; b < int(scene.bodies.size()); ++b) {
                      const double a = (b == 1 ? 1 : 2.0 / 7) * scene.acceleration;
                      const double way = a * t_end * (t_end / 2 + (theta - 0.5) * h);
                      speed.add(std::abs(twist(state, b).head<3>().dot(along) - a * t_end));
                      position.add((pose(state, b).p - pose(k.state, b).p - along * way).norm());
                    }
                  }
                return Figures{{"acceleration", std::abs(scene.acceleration - 0.7385)},
                               {"speed", speed},
                               {"position", position}};
              },
          .slow = true};
}

}  // namespace

std::vector<VerificationCase> stack_verification() {
  return {tower("tower"), tower("heavy_tower"), arch_of_101(), rolling("rolling"), rolling("rolling_xy")};
}

}  // namespace aussois
