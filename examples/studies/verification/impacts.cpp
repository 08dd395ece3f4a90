// SPDX-License-Identifier: Apache-2.0
// Group A: impacts without friction. Bullets are in bullets.cpp.
#include <algorithm>

#include "examples/scenes/mechanisms.hpp"
#include "examples/studies/verification/bullets.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

// A1, e = 1. The step of an impact at the midpoint turns the velocity and leaves the height.
VerificationCase ball_at_the_midpoint() {
  return {.name = "A1.elastic_ball_at_the_midpoint",
          .what = "ball from 1 m, e = 1, moreau_jean, theta 1/2, h = 10 ms, 20 s",
          .rows = {{"energy", "largest change of energy, relative", "-", 1e-12,
                    "identity; rounding of 2000 steps"}},
          .measure = [] {
            const CaseScene s = case_named("ball_e1").scene();
            const double before = energy(s.model, s.state).total();
            Worst change;
            run_to(s, "moreau_jean", exact_options(1e-2, NormalLaw::moreau), 20,
                   [&](const State& state, const StepReport&) {
                     change.add(std::abs(energy(s.model, state).total() / before - 1));
                   });
            return Figures{{"energy", change}};
          }};
}

// Implicit Euler loses m (g h)^2 / 2 in each step of a flight.
VerificationCase ball_of_euler() {
  return {.name = "A1.elastic_ball_of_euler",
          .what = "ball in flight, moreau_jean, theta 1, 40 steps of 10 ms",
          .rows = {{"loss", "energy lost, off m (g h)^2 / 2 a step", "J", 1e-12, "closed form; rounding"}},
          .measure = [] {
            const CaseScene s = case_named("ball_e1").scene();
            SchemeOptions o = exact_options(1e-2, NormalLaw::moreau);
            o.moreau_jean.theta = 1;
            const State state = run_to(s, "moreau_jean", o, 0.4);  // before the first impact
            const double lost = energy(s.model, s.state).total() - energy(s.model, state).total();
            return Figures{{"loss", std::abs(lost - 40 * std::pow(kGravity * o.step.h, 2) / 2)}};
          }};
}

// After the accumulation point the ball rests: what is left are the steps of Newton's law on the last g h.
VerificationCase ball_at_rest(NormalLaw law) {
  constexpr double h = 1e-3;
  return {.name = "A1.ball_after_its_last_bounce",
          .setting = to_string(law),
          .what = "ball from 1 m, e = 1/2, moreau_jean, theta 1/2, h = 1 ms, after 3 s",
          .rows = {{"speed", "speed at rest", "m/s", 1e-12, "agreed: Zeno's end; rounding"},
                   {"height", "height at rest", "m", std::sqrt(2 * kGravity) * h,
                    "agreed: impact speed times h"}},
          .measure = [law] {
            const CaseScene s = case_named("ball_e05").scene();
            const State state = run_to(s, "moreau_jean", exact_options(h, law), 3);
            return Figures{{"speed", std::abs(twist(state, s.body)[2])},
                           {"height", std::abs(pose(state, s.body).p.z())}};
          }};
}

/// Speeds before the impacts of a run, slower ones than `graze` left out, and the ends of their steps.
struct Hits {
  std::vector<double> speed{}, t{};
};
Hits hits_of(const CaseScene& s, double h, double t_end, double graze) {
  Hits out;
  double before = 0;
  run_to(s, "moreau_jean", exact_options(h, NormalLaw::combined), t_end,
         [&](const State& state, const StepReport&) {
           const double v = twist(state, s.body)[2];
           if (before < -graze && v > 0) out.speed.push_back(before), out.t.push_back(state.t);
           before = v;
         });
  return out;
}

/// How far each is from `speed` [m/s], and its time from the middle of its period, in periods.
Figures off_orbit(const Hits& hits, double speed, double begin, double period) {
  Worst off_speed, off_time;
  for (std::size_t k = 0; k < hits.t.size(); ++k) {
    off_speed.add(std::abs(hits.speed[k] - speed));
    off_time.add(std::abs((hits.t[k] - begin) / period - double(k) - 0.5));
  }
  return {{"impacts", double(hits.t.size())}, {"speed", off_speed}, {"time", off_time}};
}

// A3. The orbit at W = 2.6 is stable: errors shrink by 0.8 in each period. Those at 2.8 and 4.6 multiply them
// by 3 and 35, so a hundred periods there are beyond 16 digits.
VerificationCase stable_orbit() {
  const ExactMotion orbit = case_named("forced_26").exact(case_named("forced_26").t_end);
  const double period = orbit.pieces[2].begin - orbit.pieces[1].begin;
  const double speed = orbit.pieces[0].at(orbit.pieces[1].begin).v[0];  // before the impact
  return {.name = "A3.stable_orbit",
          .what = "forced oscillator, W = 2.6, e = 0.8, moreau_jean, h = T/1000, 100 periods",
          .rows = {{"impacts", "impacts", "-", 100, "closed form: one a period", Sense::exactly},
                   {"speed", "worst speed before an impact", "m/s", 1e-2 * std::abs(speed),
                    "closed form; a hundredth of it at this step"},
                   {"time", "worst time of an impact", "T", 3e-3, "closed form; three steps"}},
          .measure = [=] {
            const CaseScene s = case_named("forced_26").scene();
            return off_orbit(hits_of(s, period / 1000, 100 * period, 0), speed, 0, period);
          }};
}

/// At W = 4.6, e = 0.7 the orbit with one impact in two periods of the force is stable. With t from an impact
/// z = c cos t + d sin t + B cos(W t + phase).
struct Orbit {
  static constexpr double W = 4.6, e = 0.7, B = 1 / (1 - W * W);
  double T, phase, c, d;
  explicit Orbit(double period)
      : T(period),
        phase(std::atan(-std::tan(T / 2) * (1 - e) / (W * (1 + e)))),
        c(-B * std::cos(phase)),
        d(c * std::tan(T / 2)) {}
  double z(double t) const { return c * std::cos(t) + d * std::sin(t) + B * std::cos(W * t + phase); }
  double v(double t) const { return -c * std::sin(t) + d * std::cos(t) - B * W * std::sin(W * t + phase); }
};

/// The scene of the case, put on the orbit of two periods halfway between impacts.
CaseScene on_two_periods(const Orbit& one, const Orbit& two) {
  CaseScene s = case_named("forced_46").scene();  // on the orbit `one`, its clock started at T / 2
  const double turn = two.phase + Orbit::W * two.T / 2 - one.phase - Orbit::W * one.T / 2;
  s.state.t = (turn < 0 ? turn + 2 * kPi : turn) / Orbit::W;  // the force is where ours wants it
  pose(s.state, s.body).p.z() += two.z(two.T / 2) - one.z(one.T / 2);
  twist(s.state, s.body)[2] = two.v(two.T / 2);
  return s;
}

VerificationCase orbit_of_two_periods_exactly() {
  return {
      .name = "A3.orbit_of_two_periods",
      .setting = "event_driven",
      .what = "forced oscillator, W = 4.6, e = 0.7, on its orbit of two periods, 100 impacts",
      .rows = {{"law", "the orbit's own v+ + e v-, and the scene's start", "m/s", 1e-13,
                "closed form; rounding"},
               {"listed", "speed of its impact, off 0.276161", "m/s", 1e-6, "agreed"},
               {"height", "height at the end", "m", 1e-9, "closed form; ten tolerances of the equation"},
               {"speed", "velocity at the end", "m/s", 1e-9, "closed form; ten tolerances of the equation"}},
      .measure = [] {
        const Orbit one(2 * kPi / Orbit::W), two(4 * kPi / Orbit::W);
        const CaseScene ours = on_two_periods(one, two), listed = case_named("forced_46").scene();
        const State end = run_to(ours, "event_driven", exact_options(two.T, NormalLaw::combined, 1e-12),
                                 ours.state.t + 100 * two.T);
        return Figures{{"law", std::max(std::abs(two.v(0) + Orbit::e * two.v(two.T)),
                                        std::abs(twist(listed.state, listed.body)[2] - one.v(one.T / 2)))},
                       {"listed", std::abs(two.v(two.T) + 0.276161)},
                       {"height", std::abs(pose(end, ours.body).p.z() - pose(ours.state, ours.body).p.z())},
                       {"speed", std::abs(twist(end, ours.body)[2] - two.v(two.T / 2))}};
      }};
}

VerificationCase orbit_of_two_periods_in_steps() {
  return {.name = "A3.orbit_of_two_periods",
          .setting = "moreau_jean",
          .what = "forced oscillator, W = 4.6, e = 0.7, on its orbit of two periods, h = T/1000",
          .rows = {{"impacts", "impacts above 0.15 m/s; others graze", "-", 100,
                    "closed form: one in two periods", Sense::exactly},
                   {"speed", "worst speed before an impact", "m/s", 0.06 * 0.276,
                    "closed form; guard: 6 % at this step"},
                   {"time", "worst time of an impact", "T", 4e-3, "closed form; four steps"}},
          .measure = [] {
            const Orbit one(2 * kPi / Orbit::W), two(4 * kPi / Orbit::W);
            const CaseScene s = on_two_periods(one, two);
            return off_orbit(hits_of(s, two.T / 1000, s.state.t + 100 * two.T, 0.15), two.v(two.T), s.state.t,
                             two.T);
          }};
}

/// Balls of these masses in a row, `gap` between neighbours; the first comes with 1 m/s, e = 1.
CaseScene cradle(const std::vector<double>& masses, double gap = -1e-15) {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.model.contact_law = {.mu = 0, .restitution = 1};
  const auto ball = add(s.model, prepare(dilate(make_point(), 0.05)));
  for (const double m : masses)
    add(s.model, RigidBody{.name = "ball", .shape = ball, .mass = m, .inertia = 1e-3 * m * Mat3::Identity()});
  s.state = rest_state(s.model);
  for (const BodyId b : s.state.g.ids()) pose(s.state, b).p.x() = b.index() * (0.1 + gap);
  twist(s.state, 0)[0] = 1;
  return s;
}

/// The largest difference of the balls' speeds from `right` after `steps` of 1 ms.
double off_speeds(const CaseScene& s, const SchemeOptions& o, int steps, const std::vector<double>& right) {
  const State end = run_to(s, "moreau_jean", o, steps * o.step.h);
  Worst out;
  for (int i = 0; i < int(right.size()); ++i) out.add(std::abs(twist(end, BodyId::at(i))[0] - right[i]));
  return out;
}

SchemeOptions blow(ImpactOrder order) {
  SchemeOptions o = exact_options(1e-3, NormalLaw::moreau);
  o.moreau_jean.impact.order = order;
  return o;
}

// All contacts at once: W r = 2 u of the first contact, solved by hand for n equal balls (MCH-9): the last
// of r = 2 (n - k) / n is what all others leave with. Pair by pair the last one takes all.
VerificationCase equal_balls() {
  return {
      .name = "A4.equal_balls",
      .what = "2, 3, 5 and 10 balls that touch, e = 1, one step of 1 ms",
      .rows = {{"at_once", "worst speed, struck at once", "m/s", 1e-12,
                "closed form (MCH-9): 2/n - 1, 2/n, ...; agreed"},
               {"in_turn", "worst speed, pair by pair", "m/s", 1e-12, "closed form: 0, ..., 0, 1; agreed"}},
      .measure = [] {
        Worst at_once, in_turn;
        for (const int n : {2, 3, 5, 10}) {
          std::vector<double> shared(std::size_t(n), 2.0 / n), passed(std::size_t(n), 0);
          shared.front() -= 1, passed.back() = 1;
          const CaseScene s = cradle(std::vector<double>(std::size_t(n), 1));
          at_once.add(off_speeds(s, blow(ImpactOrder::simultaneous), 1, shared));
          in_turn.add(off_speeds(s, blow(ImpactOrder::sequential), 1, passed));
        }
        return Figures{{"at_once", at_once}, {"in_turn", in_turn}};
      }};
}

// Newton's law on all contacts at once; the sequential rule would give (0, 0, 1).
VerificationCase three_balls(NormalLaw law) {
  return {.name = "A4.three_balls",
          .setting = to_string(law),
          .what = "three balls that touch, e = 1, one step of 1 ms",
          .rows = {{"speed", "worst speed, off -1/3, 2/3, 2/3", "m/s", 1e-12, "closed form; agreed"}},
          .measure = [law] {
            return Figures{{"speed", off_speeds(cradle({1, 1, 1}), exact_options(1e-3, law), 1,
                                                {-1.0 / 3, 2.0 / 3, 2.0 / 3})}};
          }};
}

// A micrometre apart, in steps a thousand times longer than it takes to close. Moreau's law asks what closes
// by itself, so the blow is passed on; the combined law asks all that come within the step, so it is shared,
// up to the speed that closes the gap in a step.
VerificationCase near_balls(NormalLaw law) {
  constexpr double kGap = 1e-6, kStep = 1e-3;
  const bool shares = law == NormalLaw::combined;
  return {
      .name = "A4.balls_that_nearly_touch",
      .setting = to_string(law),
      .what = "three balls a micrometre apart, e = 1, ten steps of 1 ms",
      .rows = {{"speed", shares ? "worst speed, off -1/3, 2/3, 2/3" : "worst speed, off 0, 0, 1", "m/s",
                shares ? kGap / kStep : 1e-12,
                shares ? "closed form, to gap over step" : "closed form; agreed"}},
      .measure = [=] {
        const std::vector<double> right =
            shares ? std::vector{-1.0 / 3, 2.0 / 3, 2.0 / 3} : std::vector{0.0, 0.0, 1.0};
        return Figures{{"speed", off_speeds(cradle({1, 1, 1}, kGap), exact_options(kStep, law), 10, right)}};
      }};
}

// Unequal ones: at once all but the first leave as one body of their common mass (3 kg on 2 + 1 kg); pair by
// pair each hands over 2 m / (m + m').
VerificationCase unequal_balls() {
  return {
      .name = "A4.unequal_balls",
      .what = "balls of 3, 2 and 1 kg that touch, e = 1, one step of 1 ms",
      .rows = {{"at_once", "worst speed, struck at once, off 0, 1, 1", "m/s", 1e-12, "closed form; agreed"},
               {"in_turn", "worst speed, pair by pair, off 1/5, 2/5, 8/5", "m/s", 1e-12,
                "closed form; agreed"}},
      .measure = [] {
        const CaseScene s = cradle({3, 2, 1});
        return Figures{{"at_once", off_speeds(s, blow(ImpactOrder::simultaneous), 1, {0, 1, 1})},
                       {"in_turn", off_speeds(s, blow(ImpactOrder::sequential), 1, {0.2, 0.4, 1.6})}};
      }};
}

/// One step from a cold start: how far the contact below sphere k is from the weight above it, relative.
struct Weighed {
  Worst error{};
  StepReport report{};
};
Weighed weigh(int beads, const SolverOptions& solver) {
  const CaseScene s = bead_column(beads);
  SchemeOptions options{.step = {.h = 1e-3, .advancement = {.certify = false}},
                        .moreau_jean = {.theta = 0.5}};
  options.step.solver = solver;
  State state = s.state;
  Weighed out;
  out.report = step(make_scheme("moreau_jean", s.model, options), state);
  PerBody<double> push(std::size_t(beads) + 1);
  for (const StepContact& c : out.report.contacts)
    push[std::max(c.point.a.body, c.point.b.body)] += std::abs(c.impulse.z()) / options.step.h;
  for (int k = 1; k <= beads; ++k)
    out.error.add(std::abs(push[BodyId::at(k)] / ((beads - k + 1) * kGravity) - 1));
  return out;
}

// The hard case of sweeps: each carries a weight one sphere further. The default gives it to Newton.
VerificationCase column() {
  return {.name = "A4.column",
          .what = "1000 beads of 1 kg on top of each other at rest, one step from a cold start",
          .rows = {{"contacts", "contacts", "-", 1000, "one below each bead", Sense::exactly},
                   {"weight", "worst force, off the weight above, relative", "-", 1e-6,
                    "closed form (n - k) m g; agreed"},
                   {"newton", "Newton's iterations, if not found by sweeps", "-", 99,
                    "guard: n^2 sweeps without"}},
          .measure = [] {
            const Weighed all = weigh(1000, {.tolerance = 1e-12});
            const bool swept = all.report.solve.found_by == Method::nsgs;
            return Figures{{"contacts", double(all.report.contacts.size())},
                           {"weight", all.error},
                           {"newton", swept ? kInf : double(all.report.solve.newton_iterations)}};
          }};
}

// What sweeps alone would need: about n^2 of them.
VerificationCase column_by_sweeps() {
  return {
      .name = "A4.column_by_sweeps",
      .what = "columns of 10 and 40 beads by sweeps alone, to 1e-10",
      .rows = {{"weight", "worst force, off the weight above, relative", "-", 1e-4,
                "closed form; n^2 tolerances"},
               {"exponent", "exponent of the sweeps in the beads, off 2", "-", 0.3,
                "theory: n^2; two sizes"}},
      .measure = [] {
        Worst weight;
        const auto sweeps = [&](int beads) {
          const Weighed one =
              weigh(beads, {.method = Method::nsgs, .tolerance = 1e-10, .max_iterations = 200000});
          weight.add(one.error);
          return double(one.report.solve.iterations);
        };
        const double ten = sweeps(10), forty = sweeps(40);
        return Figures{{"weight", weight}, {"exponent", std::abs(std::log(forty / ten) / std::log(4) - 2)}};
      }};
}

}  // namespace

std::vector<VerificationCase> impact_verification() {
  std::vector<VerificationCase> out{ball_at_the_midpoint(),
                                    ball_of_euler(),
                                    ball_at_rest(NormalLaw::moreau),
                                    ball_at_rest(NormalLaw::combined),
                                    stable_orbit(),
                                    orbit_of_two_periods_exactly(),
                                    orbit_of_two_periods_in_steps(),
                                    equal_balls(),
                                    three_balls(NormalLaw::moreau),
                                    three_balls(NormalLaw::combined),
                                    near_balls(NormalLaw::moreau),
                                    near_balls(NormalLaw::combined),
                                    unequal_balls(),
                                    column(),
                                    column_by_sweeps()};
  for (VerificationCase& c : bullet_verification()) out.push_back(std::move(c));
  return out;
}

}  // namespace aussois
