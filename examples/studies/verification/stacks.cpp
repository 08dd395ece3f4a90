// SPDX-License-Identifier: Apache-2.0
// Group G: stacks and scenes of other engines.
#include <algorithm>

#include "examples/scenes/library.hpp"
#include "examples/scenes/peer_scenes.hpp"
#include "examples/studies/verification/running.hpp"

namespace aussois {
namespace {

constexpr double kDegree = kPi / 180;

std::string text(double number) {
  std::ostringstream out;
  out << number;
  return out.str();
}

/// A scene of the peers by Moreau-Jean, judged after every step; it ends when a body has fallen.
struct Run {
  double error = 0, worst = 0, fall_time = kInf;  // the judge's
  Worst sunk{};                                   // of the body `watched` [m]
  Worst gain{};                                   // of energy, in a step [J]
};
Run run(const PeerScene& scene, const SchemeOptions& o, double t_end, BodyId watched = 1) {
  const KernelScene k = kernel_scene(scene);
  const MoreauJean scheme(k.model, o.step, o.moreau_jean);
  State state = k.state;
  PeerJudge judge(scene);
  judge.see(sample(state));
  Run out;
  const double height = pose(state, watched).p.z();
  double before = energy(k.model, state).total();
  run_past(scheme, state, t_end - o.step.h / 2, [&](const StepReport&) {
    judge.see(sample(state));
    const double now = energy(k.model, state).total();
    out.gain.add(now - before);
    before = now;
    out.sunk.add(height - pose(state, watched).p.z());
    return judge.fall_time() == kInf;
  });
  out.error = judge.error(), out.worst = judge.worst(), out.fall_time = judge.fall_time();
  return out;
}
Run run(const std::string& name, double h, double t_end) {
  const PeerScene scene = peer_scene(name);
  return run(scene, kernel_options(scene, h), t_end);
}
Run run(const Arch& arch, double t_end) {
  const PeerScene scene = arch_scene(arch);
  return run(scene, kernel_options(scene, 1e-2), t_end, crown(scene));
}

/// The length that the peers are compared at [s].
double whole(const std::string& name) {
  return peer_scene(name).t_end;
}

// Boxes and prisms are eroded by what they are dilated with.
VerificationCase closed_at_the_start(const char* name, const std::string& scene, int contacts) {
  return {.name = name,
          .setting = scene,
          .what = "scene of the peers at its start",
          .rows = {{"contacts", "contacts", "-", double(contacts), "counted by hand", Sense::exactly},
                   {"gap", "worst gap", "m", 1e-14, "exactly closed; rounding at 20 m"}},
          .measure =
              [scene] {
                const PeerScene peers = peer_scene(scene);
                const KernelScene k = kernel_scene(peers);
                const ContactSet found = MoreauJean(k.model).contacts(k.state, 1e-6);
                Worst gap;
                for (const ContactPoint& c : found.points) gap.add(std::abs(c.gap));
                return Figures{{"contacts", double(found.points.size())}, {"gap", gap}};
              },
          .certified = true};
}

VerificationCase judged_at_the_start(const char* name, const std::string& scene) {
  return {.name = name,
          .setting = scene,
          .what = "scene of the peers at its start",
          .rows = {{"error", "error by the measure of the comparison", "-", 0, "nothing has happened yet",
                    Sense::exactly}},
          .measure =
              [scene] {
                const PeerScene peers = peer_scene(scene);
                PeerJudge judge(peers);
                judge.see(sample(kernel_scene(peers).state));
                return Figures{{"error", judge.error()}};
              },
          .certified = true};
}

constexpr int kSettings = 22;  // of all schemes, the reference apart

// What rests stays, in every scheme and setting: bodies that fall alike and stand on each other.
VerificationCase stays(const char* name, const std::string& scene, bool slow) {
  return {
      .name = name,
      .setting = scene,
      .what = "bodies on each other, eight steps by every scheme in every setting",
      .rows = {{"way", "worst shift of a body", "m", 1e-9, "it rests; the solver's tolerance"},
               {"energy", "worst energy, relative", "-", 1e-10, "conserved; the solver's tolerance"},
               {"attempts", "most attempts of a step", "-", 1, "no reason to halve a step", Sense::exactly},
               {"runs", "runs", "-", kSettings, "every setting", Sense::exactly}},
      .measure =
          [scene] {
            const LibraryScene& pile = library_scene(scene);
            const CaseScene s = pile.make();
            const double before = energy(s.model, s.state).total();
            Worst way, gain, attempts;
            int runs = 0;
            for (SchemeVariant variant : scheme_variants()) {
              variant.options.step.h = pile.h;
              const Scheme scheme = make_scheme(variant.name, s.model, variant.options);
              State state = s.state;
              for (int k = 0; k < 8; ++k) attempts.add(step(scheme, state, pile.h).attempts);
              for (const BodyId b : state.g.ids()) way.add((state.g[b].p - s.state.g[b].p).norm());
              gain.add(std::abs(energy(s.model, state).total() / before - 1));
              ++runs;
            }
            return Figures{{"way", way}, {"energy", gain}, {"attempts", attempts}, {"runs", double(runs)}};
          },
      .slow = slow,
      .certified = true};
}

// (n - k) m g below cube k of the tower of ten, and of the one with 800 kg on top.
VerificationCase tower(const std::string& name) {
  return {.name = "G1.weight_above_each_cube",
          .setting = name,
          .what = "tower of ten cubes, 20 steps of 10 ms",
          .rows = {{"force", "worst force below a cube, off the weight above, relative", "-", 1e-7,
                    "closed form (n - k) m g; ten tolerances of the solver"}},
          .measure =
              [name] {
                const PeerScene scene = peer_scene(name);
                const KernelScene k = kernel_scene(scene);
                const Scheme scheme = make_scheme("moreau_jean", k.model, kernel_options(scene, 1e-2));
                State state = k.state;
                StepReport report;
                for (int i = 0; i < 20; ++i) report = step(scheme, state);
                PerBody<double> below(scene.bodies.size());
                for (const StepContact& c : report.contacts)
                  below[std::max(c.point.a.body, c.point.b.body)] += std::abs(c.impulse.z()) / report.h;
                Worst force;
                double above = 0;
                for (int i = int(scene.bodies.size()) - 1; i >= 1; --i) {
                  const auto b = BodyId::at(i);
                  above += scene.shapes[scene.bodies[b].shape].mass * kGravity;
                  force.add(std::abs(below[b] / above - 1));
                }
                return Figures{{"force", force}};
              },
          .certified = true};
}

// The whole length of the comparison, and a fifth of it.
VerificationCase towers_stand(const std::string& name, bool in_full) {
  const double t_end = in_full ? whole(name) : 2;
  return {.name = in_full ? "G1.stands_in_full" : "G1.stands",
          .setting = name,
          .what = "tower of ten cubes, steps of 10 ms, " + text(t_end) + " s",
          .rows = {{"way", "worst shift of a cube", "m", in_full ? 1e-6 : 1e-7,
                    "it rests; the solver's tolerance"}},
          .measure =
              [=] {
                return Figures{{"way", run(name, 1e-2, t_end).error}};
              },
          .slow = in_full,
          .certified = true};
}

// 666 balls that fall on each other and roll apart.
VerificationCase pile(bool in_full) {
  return {.name = in_full ? "G2.pile_in_full" : "G2.pile",
          .what = in_full ? "666 balls, plastic, for " + text(whole("666")) + " s"
                          : "666 balls, plastic, for 0.1 s at 1 ms and 0.5 s at 10 ms",
          .rows = {{"fine", "deepest overlap at 1 ms", "m", 1e-5, "no overlap; 1e-4 of a radius"},
                   {"coarse", "deepest overlap at 10 ms", "m", 1e-3, "no overlap; a hundredth of a radius"},
                   {"gain", "largest gain of energy in a step, of 12.9 kJ", "J", 1e-6, "passive; rounding"}},
          .measure =
              [in_full] {
                const double t_end = whole("666");
                const Run fine = run("666", 1e-3, in_full ? t_end : 0.1),
                          coarse = run("666", 1e-2, in_full ? t_end : 0.5);
                return Figures{{"fine", fine.error},
                               {"coarse", coarse.error},
                               {"gain", std::max<double>(fine.gain, coarse.gain)}};
              },
          .slow = in_full,
          .certified = true};
}

// Balls that fall on each other at e = 1, impacts at both sides in one step of 10 ms: (IMP-2) of all
// contacts, those that open too, keeps the energy to the solver's tolerance.
VerificationCase elastic_pile() {
  return {
      .name = "G2.elastic_pile",
      .what = "666 balls, e = 1, for 1 s at 10 ms",
      .rows = {{"energy", "energy at the end, relative", "-", 1e-9,
                "conserved (IMP-2); the solver's tolerance"},
               {"hits", "contacts that push", "-", 101, "the balls collide", Sense::at_least},
               {"rises", "steps in which energy rises", "-", 0, "conserved (IMP-2)", Sense::exactly}},
      .measure =
          [] {
            const PeerScene scene = peer_scene("666_elastic");
            const KernelScene k = kernel_scene(scene);
            const Scheme scheme = make_scheme("moreau_jean", k.model, kernel_options(scene, 1e-2));
            State state = k.state;
            long hits = 0, rises = 0;
            run_past(scheme, state, 1, [&](const StepReport& report) {
              rises += report.energy_rises;
              for (const StepContact& c : report.contacts) hits += !c.impulse.isZero(0);
              return true;
            });
            return Figures{
                {"energy", std::abs(energy(k.model, state).total() / energy(k.model, k.state).total() - 1)},
                {"hits", double(hits)},
                {"rises", double(rises)}};
          },
      .certified = true};
}

// Bodies that fall together leave nothing but rounding between them: next to nothing to solve.
VerificationCase house_falls_as_one() {
  return {
      .name = "G3.falls_as_one",
      .what = "house of cards 0.5 m above the ground, three steps of 10 ms",
      .rows = {{"contacts", "contacts found, at least", "-", 501, "cards on each other", Sense::at_least},
               {"solve", "sweeps and Newton's iterations of a step", "-", 20,
                "guard: next to nothing to solve"},
               {"at_rounding", "steps solved to rounding", "-", 3, "the residual is one of rounding's size",
                Sense::exactly},
               {"way", "worst difference of the falls of two cards", "m", 1e-14,
                "they fall alike; rounding"}},
      .measure =
          [] {
            const PeerScene scene = peer_scene("kapla");
            KernelScene k = kernel_scene(scene);
            const State start = k.state;
            for (const BodyId b : k.state.g.ids())
              if (b > 0) k.state.g[b].p.z() += 0.5;
            const Scheme scheme = make_scheme("moreau_jean", k.model, kernel_options(scene, 1e-2));
            Least contacts;
            Worst solve, way;
            int at_rounding = 0;
            for (int i = 0; i < 3; ++i) {
              const StepReport report = step(scheme, k.state);
              contacts.add(report.contacts_found);
              solve.add(report.solve.iterations + report.solve.newton_iterations);
              at_rounding += report.solve.status == SolveStatus::at_rounding;
            }
            const auto fallen = [&](BodyId b) { return k.state.g[b].p.z() - start.g[b].p.z() - 0.5; };
            for (const BodyId b : k.state.g.ids())
              if (b > 1) way.add(std::abs(fallen(b) - fallen(1)));
            return Figures{
                {"contacts", contacts}, {"solve", solve}, {"at_rounding", double(at_rounding)}, {"way", way}};
          },
      .certified = true};
}

VerificationCase house_stands() {
  return {.name = "G3.stands",
          .what = "house of cards, steps of 10 ms, 5 s",
          .rows = {{"way", "worst shift of a card", "m", 1e-6, "it rests; the solver's tolerance"}},
          .measure =
              [] {
                return Figures{{"way", run("kapla", 1e-2, 5).error}};
              },
          .slow = true,
          .certified = true};
}

// On either side of the limits of friction, thickness and tilt (PEER-2): 0.30769, 0.10696 and 15.94 degrees
// of 25 stones, 0.30914, 0.10745 and 15.85 degrees of 101.
VerificationCase arch_limits(const char* name, int stones, const std::vector<Arch>& inside, double stands_for,
                             double way, const std::vector<Arch>& outside, double falls_within) {
  return {.name = name,
          .what = "arch of " + std::to_string(stones) +
                  " stones on either side of its limits of friction, thickness and tilt, steps of 10 ms",
          .rows = {{"stands", "worst shift of a stone inside the limits, " + text(stands_for) + " s", "m",
                    way, "limit analysis (PEER-2): it stands; the solver's tolerance"},
                   {"falls", "latest fall outside the limits", "s", falls_within,
                    "limit analysis (PEER-2): it falls"}},
          .measure =
              [=] {
                Worst stands, falls;
                for (const Arch& arch : inside) stands.add(run(arch, stands_for).error);
                for (const Arch& arch : outside) falls.add(run(arch, 1.2 * falls_within).fall_time);
                return Figures{{"stands", stands}, {"falls", falls}};
              },
          .slow = stones > 50,
          .certified = true};
}
VerificationCase arch_of_25() {
  return arch_limits("G4.arch_of_25", 25, {{.mu = 0.6}, {.mu = 0.35}, {.tilt = 15 * kDegree}}, 1, 1e-7,
                     {{.mu = 0.25}, {.thickness = 0.1}, {.tilt = 18 * kDegree}}, 1);
}
VerificationCase arch_of_101() {
  return arch_limits(
      "G4.arch_of_101", 101,
      {{.stones = 101, .mu = 0.35},
       {.stones = 101, .tilt = 15 * kDegree},
       {.stones = 101, .thickness = 0.115}},
      0.5, 1e-8,
      {{.stones = 101, .thickness = 0.1}, {.stones = 101, .mu = 0.25}, {.stones = 101, .tilt = 18 * kDegree}},
      0.5);
}

VerificationCase arch_for_a_minute(double mu) {
  return {.name = "G4.a_minute",
          .setting = "mu = " + text(mu),
          .what = "arch of 25 stones, steps of 10 ms, 60 s",
          .rows = {{"way", "worst shift of a stone", "m", 1e-9,
                    "limit analysis (PEER-2): it stands; a millionth of a millimetre"},
                   {"sunk", "descent of the crown", "m", 1e-9,
                    "limit analysis (PEER-2): it stands; a millionth of a millimetre"}},
          .measure =
              [mu] {
                const Run all = run(Arch{.mu = mu}, 60);
                return Figures{{"way", all.error}, {"sunk", all.sunk}};
              },
          .slow = true,
          .certified = true};
}

// Stones that are not where they belong fall into place within a second, and stay there.
VerificationCase scattered_arch(double scatter, Reducer reducer) {
  const Arch arch{.scatter = scatter};
  const double openings =
      26 * kPi / 25 * arch_spread(arch) * scatter;  // stones are pi / 25 m from each other
  return {.name = "G4.scattered_arch",
          .setting = text(scatter) + " m, reducer " + to_string(reducer),
          .what = "arch of 25 stones displaced at random, steps of 10 ms, 3 s",
          .rows = {{"contacts", "contacts found at rest", "contacts", 104,
                    "four a joint, as in the exact arch", Sense::at_least},
                   {"way", "worst shift of a stone", "m", openings, "sum of the openings of all joints"},
                   {"drift", "worst shift of a stone from 1 s to 3 s", "m", 1e-8,
                    "limit analysis (PEER-2): it stands; the solver's tolerance"},
                   {"solve", "sweeps and Newton's iterations of a step from 1 s on, mean", "-", 20,
                    "guard: next to nothing to solve"}},
          .measure =
              [arch, reducer] {
                const PeerScene scene = arch_scene(arch);
                const KernelScene k = kernel_scene(scene);
                SchemeOptions o = kernel_options(scene, 1e-2);
                o.step.reduction.reducer = reducer;
                const MoreauJean scheme(k.model, o.step, o.moreau_jean);
                State state = k.state, at_rest = state;
                const auto way = [](const State& from, const State& to) {
                  Worst out;
                  for (const BodyId b : from.g.ids()) out.add((to.g[b].p - from.g[b].p).norm());
                  return double(out);
                };
                Least contacts;
                double solve = 0;
                for (int i = 0; i < 300; ++i) {
                  const StepReport report = step(scheme, state);
                  if (i == 99) at_rest = state;
                  if (i < 100) continue;
                  contacts.add(report.contacts_found);
                  solve += double(report.solve.iterations + report.solve.newton_iterations) / 200;
                }
                return Figures{{"contacts", contacts},
                               {"way", way(k.state, state)},
                               {"drift", way(at_rest, state)},
                               {"solve", solve}};
              },
          .certified = true};
}

VerificationCase arch_of_101_stands() {
  return {
      .name = "G4.arch_of_101_stands",
      .what = "arch of 101 stones, steps of 10 ms, 5 s",
      .rows = {{"way", "worst shift of a stone", "m", 1e-6, "limit analysis (PEER-2): it stands; solver"}},
      .measure =
          [] {
            return Figures{{"way", run("arch_101", 1e-2, 5).error}};
          },
      .slow = true,
      .certified = true};
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
                    SchemeOptions o = kernel_options(scene, h);
                    o.moreau_jean.theta = theta;
                    o.step.solver.tolerance = 1e-12;  // rounding is asked for
                    const MoreauJean scheme(k.model, o.step, o.moreau_jean);
                    State state = k.state;
                    run_past(scheme, state, t_end - h / 2);
                    for (const BodyId b : scene.bodies.ids()) {
                      if (b == 0) continue;  // the ground
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
          .slow = true,
          .certified = true};
}

// What the peers are compared by.
VerificationCase rolling_speed(const std::string& name, bool in_full) {
  const double t_end = in_full ? whole(name) : 0.2;
  return {.name = in_full ? "G5.speed_in_full" : "G5.speed",
          .setting = name,
          .what = "box that is pushed under 25 balls, h = 1 ms, " + text(t_end) + " s",
          .rows = {{"speed", "rms error of the speed of the box, relative", "-", 1e-8,
                    "closed form; the solver's tolerance"}},
          .measure =
              [=] {
                return Figures{{"speed", run(name, 1e-3, t_end).error}};
              },
          .slow = in_full,
          .certified = true};
}

VerificationCase bouncing(double h, bool in_full) {
  const double t_end = in_full ? whole("bouncing") : 5;
  return {.name = in_full ? "G6.bouncing_in_full" : "G6.bouncing",
          .setting = "h = " + text(1e3 * h) + " ms",
          .what = "balls that bounce, e = 1, " + text(t_end) + " s",
          .rows = {{"energy", "worst energy, relative", "-", 1e-12, "conserved; rounding"}},
          .measure =
              [=] {
                return Figures{{"energy", run("bouncing", h, t_end).worst}};
              },
          .slow = in_full,
          .certified = true};
}

// The impacts of the scheme are up to a step away from the exact ones, which is all of the error.
VerificationCase bouncing_to_rest() {
  return {.name = "G6.to_rest",
          .what = "balls that bounce, e = 0.8, h = 1 ms, " + text(whole("bouncing_08")) + " s",
          .rows = {{"energy", "mean error of the energy, relative", "-", 2e-4,
                    "closed form; guard: impacts up to a step away"}},
          .measure =
              [] {
                return Figures{{"energy", run("bouncing_08", 1e-3, whole("bouncing_08")).error}};
              },
          .slow = true,
          .certified = true};
}

}  // namespace

std::vector<VerificationCase> stack_verification() {
  std::vector<VerificationCase> out{stays("A4.stays", "bead_column", false),
                                    stays("G1.stays", "tower", false),
                                    stays("G1.stays", "heavy_tower", false),
                                    stays("G3.stays", "kapla", true),
                                    stays("G4.stays", "arch", false),
                                    elastic_pile(),
                                    house_falls_as_one(),
                                    house_stands(),
                                    arch_of_25(),
                                    arch_for_a_minute(0.6),
                                    arch_for_a_minute(0.35),
                                    arch_of_101(),
                                    arch_of_101_stands(),
                                    closed_at_the_start("G4.start", "arch", 26 * 4),
                                    closed_at_the_start("G4.start", "arch_101", 102 * 4),
                                    closed_at_the_start("G5.start", "rolling", 4 + 25),
                                    judged_at_the_start("G2.start", "666"),
                                    judged_at_the_start("G2.start", "666_elastic"),
                                    judged_at_the_start("G6.start", "bouncing"),
                                    bouncing_to_rest()};
  for (const double scatter : {1e-6, 1e-5, 1e-4})
    for (const Reducer reducer : {Reducer::none, Reducer::wrench_cone, ReductionOptions().reducer})
      out.push_back(scattered_arch(scatter, reducer));
  for (const char* name : {"tower", "heavy_tower"}) {
    out.push_back(closed_at_the_start("G1.start", name, 40));
    out.push_back(tower(name));
  }
  for (const char* name : {"rolling", "rolling_xy"}) out.push_back(rolling(name));
  for (const double h : {1e-2, 3e-3}) out.push_back(bouncing(h, false));
  for (const double h : {1e-2, 1e-3}) out.push_back(bouncing(h, true));
  for (const bool in_full : {false, true}) {
    for (const char* name : {"tower", "heavy_tower"}) out.push_back(towers_stand(name, in_full));
    for (const char* name : {"rolling", "rolling_xy"}) out.push_back(rolling_speed(name, in_full));
    out.push_back(pile(in_full));
  }
  return out;
}

}  // namespace aussois
