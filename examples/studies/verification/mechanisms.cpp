// SPDX-License-Identifier: Apache-2.0
// Group C: mechanisms and loops. C2 is in slider_crank.cpp, C4 and C5 in dimer.cpp, C8 in bricard.cpp, C10 in
// spinning_chain.cpp.
#include "examples/scenes/mechanisms.hpp"

#include <algorithm>

#include "examples/studies/verification/bricard.hpp"
#include "examples/studies/verification/dimer.hpp"
#include "examples/studies/verification/running.hpp"
#include "examples/studies/verification/slider_crank.hpp"
#include "examples/studies/verification/spinning_chain.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

// The impact itself, without gravity: upright, about to change the edge. Housner's ratio is exact.
VerificationCase housner(NormalLaw law) {
  return {.name = "C1.housners_ratio",
          .setting = to_string(law),
          .what = "block of 0.1 x 0.4 m that changes its edge at 1.2 rad/s, one step of 0.1 ms",
          .rows = {{"rate", "rate after the impact", "rad/s", 1e-9,
                    "closed form: 1 - 3/2 sin^2 alpha of it; agreed"}},
          .measure = [law] {
            const double ratio = 1 - 1.5 / 17;  // sin^2 alpha = 0.05^2 / (0.05^2 + 0.2^2) = 1/17
            CaseScene s = case_named("rocking_block").scene();
            s.model.gravity = Vec3::Zero();
            const double height = 0.2, width = 0.05,
                         omega = -1.2;  // about the edge at +x; its foot at -x comes down
            pose(s.state, s.body) = translation(0, 0, 1e-2 + height - 1e-14);
            twist(s.state, s.body) << Vec3(0, omega, 0).cross(Vec3(-width, 0, height)), Vec3(0, omega, 0);
            const State end = run_to(s, "moreau_jean", exact_options(1e-4, law), 1e-4);
            return Figures{{"rate", std::abs(twist(end, s.body)[4] - ratio * omega)}};
          }};
}

// A block with sin^2 alpha = 0.8 > 2/3: Housner's ratio is negative, so it rests at its first impact. Without
// gravity, upright, half width 0.2 m, half height 0.1 m.
VerificationCase flat_block(const std::string& scheme) {
  return {.name = "C1.flat_block",
          .setting = scheme,
          .what = "block of 0.4 x 0.2 m that changes its edge at 1.2 rad/s, two steps of 0.1 ms",
          .rows = {{"twist", "velocity and rate after the impact", "m/s, rad/s", 1e-9, "closed form: rest"}},
          .measure = [scheme] {
            constexpr double b = 0.2, a = 0.1, omega = -1.2, kDilation = 1e-2;
            CaseScene s;
            s.model.gravity = Vec3::Zero();
            s.model.contact_law = {.mu = 4, .restitution = 0};
            const SimplicialComplex box = make_box(2 * b, 0.1, 2 * a);
            add(s.model, fixed_body("plate", add(s.model, prepare(dilate(make_plate(2, 2), kDilation)))));
            const ShapeId shape = add(s.model, prepare(dilate(box, 0)));
            s.body = add(s.model, solid_body("block", shape, mass_properties(box, 1000)));
            s.state = rest_state(s.model);
            pose(s.state, s.body).p.z() = kDilation + a - 1e-14;
            twist(s.state, s.body) << Vec3(0, omega, 0).cross(Vec3(-b, 0, a)), Vec3(0, omega, 0);
            return Figures{{"twist", twist(run_to(s, scheme, moreau_options(1e-4), 2e-4), s.body).norm()}};
          }};
}

VerificationCase fourteen_impacts_exactly() {
  return {
      .name = "C1.fourteen_impacts",
      .setting = "event_driven",
      .what = "block of 0.1 x 0.4 m released at half of alpha",
      .rows = {{"impacts", "impacts off those of the shared series", "-", 0, "shared series", Sense::exactly},
               {"time", "worst time of an impact", "s", 1e-7, "shared series; tolerances of the equation"}},
      .measure = [] {
        const std::vector<SeriesRow> events = shared_series("rocking_block_events.csv");
        std::vector<double> found;
        run_to(case_named("rocking_block").scene(), "event_driven",
               exact_options(0.1, NormalLaw::combined, 1e-12), events.back().at("t_s") + 0.05,
               [&](const State&, const StepReport& report) {
                 for (const StepEvent& e : report.events)
                   if (e.kind == EventKind::impact && (found.empty() || e.t > found.back() + 1e-4))
                     found.push_back(e.t);
               });
        Worst time;
        for (std::size_t k = 0; k < std::min(found.size(), events.size()); ++k)
          time.add(std::abs(found[k] - events[k].at("t_s")));
        return Figures{{"impacts", double(found.size()) - double(events.size())}, {"time", time}};
      }};
}

/// Worst time of the impacts of Moreau-Jean [s], infinite if one is missing.
double worst_rocking_time(double h, const std::vector<SeriesRow>& events) {
  const Case& c = case_named("rocking_block");
  const CaseScene s = c.scene();
  double tilt = 0;
  Worst worst;
  std::size_t k = 0;
  run_to(s, "moreau_jean", moreau_options(h), events.back().at("t_s") + 0.05,
         [&](const State& now, const StepReport&) {
           const double next = c.observe(s, now).q[0];
           if (tilt * next < 0 && k < events.size()) worst.add(std::abs(now.t - events[k++].at("t_s")));
           if (next != 0) tilt = next;
         });
  return k == events.size() ? double(worst) : kInf;
}

// Moreau-Jean comes to them too early, with each a little more, of order one.
VerificationCase fourteen_impacts_in_steps() {
  return {
      .name = "C1.fourteen_impacts",
      .setting = "moreau_jean",
      .what = "block of 0.1 x 0.4 m released at half of alpha, in steps of 1 and 0.2 ms",
      .rows = {{"time", "worst time of an impact at 0.2 ms", "s", 0.036,
                "shared series; guard: order one, amplified"},
               {"order", "order of the worst time, off 1", "-", 0.25, "one; guard at two steps"}},
      .measure =
          [] {
            const std::vector<SeriesRow> events = shared_series("rocking_block_events.csv");
            const double coarse = worst_rocking_time(1e-3, events), fine = worst_rocking_time(2e-4, events);
            return Figures{{"time", fine}, {"order", std::abs(std::log(coarse / fine) / std::log(5) - 1)}};
          },
      .slow = true};
}

/// Where the woodpecker's beak hits [s], and its coordinates at the times asked for, which end before t_end.
struct Pecking {
  std::vector<double> beak{};
  std::vector<Vec3> q{};
  double stuck = 0;  // the sleeve hangs on the pole by friction alone [s]
};
Pecking peck(double h, double t_end, const std::vector<double>& times = {}) {
  const CaseScene s = woodpecker();
  const Scheme scheme = make_scheme("moreau_jean", s.model,
                                    {.step = {.h = h, .solver = {.tolerance = 1e-12}},
                                     .moreau_jean = {.theta = 0.5, .law = NormalLaw::moreau}});
  State state = s.state;
  Pecking out;
  bool touched = false;
  const auto look = [&](const StepReport& report) {
    const bool pushes = std::ranges::any_of(
        report.gaps, [](const StepGap& gap) { return gap.id == 0 && gap.impulse.x() > 0; });
    if (pushes && !touched) out.beak.push_back(state.t - report.h / 2);
    touched = pushes;
    if (std::abs(state.v[0]) < 1e-8 && std::abs(state.v[1]) < 1e-8) out.stuck += report.h;
    return true;
  };
  for (const double until : times) {
    run_accepted(scheme, state, until, look);
    out.q.push_back(state.q);
  }
  run_accepted(scheme, state, t_end, look);
  return out;
}

// First order, and the reference grants 2e-4 of its own.
VerificationCase pecking() {
  return {
      .name = "C3.woodpecker_over_a_period",
      .what = "woodpecker, moreau_jean, h = 10 us, 0.15 s",
      .rows = {{"rows", "rows of the shared series compared here", "-", 150, "shared series", Sense::exactly},
               {"position", "worst coordinate", "m, rad", 4e-4,
                "shared series, good to 2e-4; as much again"}},
      .measure = [] {
        const std::vector<SeriesRow> rows = shared_series("woodpecker.csv");
        std::vector<double> times;
        for (const SeriesRow& row : rows)
          if (row.at("t_s") < 0.1501) times.push_back(row.at("t_s"));
        const Pecking bird = peck(1e-5, 0.15, times);
        Worst off;
        for (std::size_t k = 0; k < bird.q.size(); ++k)
          off.add((bird.q[k] - Vec3(rows[k].at("y_m"), rows[k].at("phiM_rad"), rows[k].at("phiS_rad")))
                      .lpNorm<Eigen::Infinity>());
        return Figures{{"rows", double(bird.q.size())}, {"position", off}};
      }};
}

VerificationCase four_pecks() {
  return {.name = "C3.woodpecker_pecks",
          .what = "woodpecker, moreau_jean, h = 20 us, 0.6 s",
          .rows = {{"pecks", "impacts of the beak", "-", 4, "agreed", Sense::exactly},
                   {"first", "time of the first, off 81.0135 ms", "s", 2e-5, "agreed; a step"},
                   {"period", "worst time between two, off 145.9 ms", "s", 2e-4,
                    "agreed, good to 1e-4; ten steps"},
                   {"stuck", "time in which the sleeve hangs by friction alone", "s", 0.03,
                    "it sticks between pecks", Sense::at_least}},
          .measure = [] {
            const Pecking bird = peck(2e-5, 0.6);
            Worst period;
            for (std::size_t k = 1; k < bird.beak.size(); ++k)
              period.add(std::abs(bird.beak[k] - bird.beak[k - 1] - 0.1459));
            return Figures{{"pecks", double(bird.beak.size())},
                           {"first", bird.beak.empty() ? kInf : std::abs(bird.beak[0] - 0.0810135)},
                           {"period", period},
                           {"stuck", peck(2e-5, 0.15).stuck}};
          }};
}

VerificationCase double_pendulum_exactly() {
  return {.name = "C6.double_pendulum",
          .setting = "event_driven",
          .what = "double pendulum at its wall, 5 s",
          .rows = {{"pieces", "pieces of the reference", "-", 4, "three impacts", Sense::exactly},
                   {"third", "third impact of the reference, off 4.2760415 s", "s", 5e-8, "agreed"},
                   {"impacts", "impacts", "-", 3, "agreed", Sense::exactly},
                   {"time", "worst time of an impact", "s", 1e-8, "equation of order eight; tolerances"},
                   {"angles", "angles at the end", "rad", 1e-8, "equation of order eight; tolerances"}},
          .measure = [] {
            const CaseScene s = double_pendulum();
            const ExactMotion exact = double_pendulum_motion(5);
            std::vector<double> times;
            const State end = run_to(s, "event_driven", exact_options(0.25, NormalLaw::combined, 1e-12), 5,
                                     [&](const State&, const StepReport& report) {
                                       for (const StepEvent& e : report.events) times.push_back(e.t);
                                     });
            Worst time;
            for (std::size_t k = 0; k < std::min(times.size(), exact.pieces.size() - 1); ++k)
              time.add(std::abs(times[k] - exact.pieces[k + 1].begin));
            return Figures{
                {"pieces", double(exact.pieces.size())},
                {"third", exact.pieces.size() < 4 ? kInf : std::abs(exact.pieces[3].begin - 4.2760415)},
                {"impacts", double(times.size())},
                {"time", time},
                {"angles", (end.q - evaluate(exact, 5).q).norm()}};
          }};
}

VerificationCase double_pendulum_in_steps(double h) {
  return {.name = "C6.double_pendulum",
          .setting = h > 5e-4 ? "moreau_jean, 1 ms" : "moreau_jean, 0.2 ms",
          .what = "double pendulum at its wall, 5 s",
          .rows = {{"impacts", "impacts", "-", 3, "agreed", Sense::exactly},
                   {"time", "worst time of an impact", "s", 5 * h, "equation of order eight; five steps"},
                   {"energy", "energy at the end, off event_driven's", "J", 30 * h, "guard: order one"}},
          .measure = [h] {
            const CaseScene s = double_pendulum();
            const ExactMotion exact = double_pendulum_motion(5);
            const State right = run_to(s, "event_driven", exact_options(0.25, NormalLaw::combined, 1e-12), 5);
            std::size_t impacts = 0;
            Worst time;
            double before = 0;
            const State end =
                run_to(s, "moreau_jean", moreau_options(h), 5, [&](const State& now, const StepReport&) {
                  const double rate = std::cos(now.q[0]) * now.v[0] + std::cos(now.q[1]) * now.v[1];
                  const double gap = std::sin(now.q[0]) + std::sin(now.q[1]) + 0.2;
                  if (before < 0 && rate > 0 && gap < 0.05 && ++impacts < exact.pieces.size())
                    time.add(std::abs(now.t - exact.pieces[impacts].begin));
                  before = rate;
                });
            return Figures{
                {"impacts", double(impacts)},
                {"time", time},
                {"energy", std::abs(energy(s.model, end).total() - energy(s.model, right).total())}};
          }};
}

/// At most, over a run of C7 against the equation of its one angle (MCH-7): th'' = (G / I) g sin th from the
/// vertical, th' = 1 rad/s.
struct FourBarErrors {
  Worst angle{}, energy{}, drift{};  // [rad], of that at the start, of the joints [m]
};
FourBarErrors four_bar_errors(int windows, const std::string& scheme, double h, double t_end) {
  const double I = (windows + 1) / 3.0 + windows, G = (windows + 1) / 2.0 + windows, pull = kGravity * G / I;
  const auto exact =
      ode_solution([pull](double, const VecX& y) -> VecX { return Vec2(y[1], pull * std::sin(y[0])); },
                   Vec2(0, 1), t_end, 1e-3);
  const CaseScene s = four_bars(windows);
  const double before = energy(s.model, s.state).total();
  FourBarErrors out;
  run_to(s, scheme, moreau_options(h), t_end, [&](const State& now, const StepReport& report) {
    out.angle.add(std::abs(joint_coordinate(s.model, now, 0) - exact(now.t)[0]));
    out.energy.add(std::abs(energy(s.model, now).total() / before - 1));
    out.drift.add(report.joint_error.translation);
  });
  return out;
}

// Two windows, five rods, 35 equations for the 29 motions that are not free; 2 s, one turn: the bars lie in
// one line twice.
VerificationCase two_windows(const std::string& scheme) {
  const bool alpha = scheme == "generalised_alpha";  // fourteen times the error of the energy
  VerificationCase out{
      .name = "C7.two_windows",
      .setting = scheme,
      .what = "two windows of four bars through their singular positions, 2 s at 1 ms",
      .rows = {{"angle", "worst angle", "rad", 2e-5, "equation of the angle; guard: order two"},
               {"energy", "worst energy, relative", "-", alpha ? 3e-5 : 2e-6, "conserved; guard: order two"},
               {"drift", "worst error of a joint", "m", 1e-12, "joints hold to rounding"}},
      .measure = [scheme] {
        const FourBarErrors coarse = four_bar_errors(2, scheme, 4e-3, 2),
                            fine = four_bar_errors(2, scheme, 1e-3, 2);
        return Figures{{"angle", fine.angle},
                       {"energy", fine.energy},
                       {"drift", fine.drift},
                       {"order", std::abs(std::log(coarse.angle / fine.angle) / std::log(4) - 2)}};
      }};
  if (!alpha)
    out.rows.push_back(
        {"order", "order of the angle, 4 to 1 ms, off 2", "-", 0.2, "two; guard at these steps"});
  return out;
}

// 81 rods, 605 equations for the 485 motions that are not free; four of the ten turns of the whole 20 s,
// which take two and a half times as long.
VerificationCase forty_windows() {
  return {.name = "C7.forty_windows",
          .what = "forty windows of four bars, moreau_jean, h = 0.7 ms, 8 s",
          .rows = {{"angle", "worst angle", "rad", 1e-3, "equation of the angle"},
                   {"energy", "worst energy, relative", "-", 1e-6, "conserved; guard: order two"},
                   {"drift", "worst error of a joint", "m", 1e-11, "joints hold to rounding"}},
          .measure =
              [] {
                const FourBarErrors run = four_bar_errors(40, "moreau_jean", 7e-4, 8);
                return Figures{{"angle", run.angle}, {"energy", run.energy}, {"drift", run.drift}};
              },
          .slow = true};
}

constexpr double kSqueezed = 0.03;  // end of C9 [s]
// The test set for initial value problems of the university of Bari, to 14 digits.
constexpr double kAngles[7] = {15.81077119629904,   -15.75637105984298, 0.04082224013073101,
                               -0.5347301163226948, 0.5244099658805304, 0.5347301163226948,
                               1.048080741042263};

double off_squeezer(const std::string& scheme, const SchemeOptions& o) {
  const CaseScene s = squeezer();
  const State end = run_to(s, scheme, o, kSqueezed);
  Worst worst;
  for (int i = 0; i < 7; ++i)
    worst.add(std::abs(joint_coordinate(s.model, end, JointId::at(i)) + kSqueezerStart[i] - kAngles[i]));
  return worst;
}

// The accelerations that the test set gives for the start: all bodies, joints, the spring and the motor.
VerificationCase squeezer_at_its_start() {
  return {
      .name = "C9.squeezer_at_its_start",
      .what = "squeezer, moreau_jean, one step of 1 us",
      .rows = {{"joints", "error of the joints at the start", "m", 1e-15, "closed form; rounding"},
               {"acceleration", "worst acceleration", "rad/s^2", 2e-3, "published to 14 digits; order h"}},
      .measure = [] {
        constexpr double h = 1e-6, kPublished[7] = {14222.4439199541, -10666.8329399656};
        const CaseScene s = squeezer();
        const State end = run_to(s, "moreau_jean", moreau_options(h), h);
        Worst off;
        for (int i = 0; i < 7; ++i)
          off.add(std::abs(joint_speed(s.model, end, JointId::at(i)) / h - kPublished[i]));
        return Figures{{"joints", joint_error(s.model, s.state).translation}, {"acceleration", off}};
      }};
}

// Over two and a half turns of the crank in 30 ms.
VerificationCase squeezer_at_its_end(const std::string& scheme) {
  return {
      .name = "C9.squeezer",
      .setting = scheme,
      .what = "squeezer, 30 ms at 10 us",
      .rows = {{"angle", "worst angle at the end", "rad", 1e-4, "published to 14 digits; guard: order two"},
               {"order", "order of it, 20 to 10 us, off 2", "-", 0.2, "two; guard at these steps"}},
      .measure = [scheme] {
        const double fine = off_squeezer(scheme, moreau_options(1e-5)),
                     coarse = off_squeezer(scheme, moreau_options(2e-5));
        return Figures{{"angle", fine}, {"order", std::abs(std::log2(coarse / fine) - 2)}};
      }};
}

// The rotation by Cayley's map lags by a twelfth of the cube of its angle: twice the error.
VerificationCase squeezer_by_cayley() {
  return {
      .name = "C9.squeezer_by_cayley",
      .what = "squeezer, 30 ms, passive_midpoint with Cayley's map",
      .rows = {{"angle", "worst angle at 8 us", "rad", 1e-4, "published to 14 digits; guard: order two"},
               {"coarse", "worst angle at 10 us", "rad", 1e-4, "Cayley's lag doubles it", Sense::at_least}},
      .measure = [] {
        const auto off = [](double h) {
          SchemeOptions o = moreau_options(h);
          o.step.update = GroupUpdate::cayley;
          return off_squeezer("passive_midpoint", o);
        };
        return Figures{{"angle", off(8e-6)}, {"coarse", off(1e-5)}};
      }};
}

VerificationCase squeezer_exactly() {
  return {.name = "C9.squeezer",
          .setting = "event_driven",
          .what = "squeezer, 30 ms",
          .rows = {{"angle", "worst angle at the end", "rad", 1e-7,
                    "published to 14 digits; tolerances of the equation"}},
          .measure = [] {
            return Figures{{"angle", off_squeezer("event_driven", moreau_options(1e-2))}};
          }};
}

// Of the spring, the bodies and the motor together: what the motor did is its torque times the angle.
VerificationCase squeezer_energy() {
  return {.name = "C9.squeezer_energy",
          .what = "squeezer, 30 ms, moreau_jean, h = 10 us",
          .rows = {{"energy", "worst energy less the motor's work", "J", 1e-5, "conserved; guard: order two"},
                   {"order", "order of it, 30 to 10 us", "-", 1.8, "theory: two", Sense::at_least}},
          .measure = [] {
            const CaseScene s = squeezer();
            const auto lost = [&](double h) {
              const double before = energy(s.model, s.state).total();
              Worst worst;
              run_to(s, "moreau_jean", moreau_options(h), kSqueezed,
                     [&](const State& now, const StepReport&) {
                       const double given = 0.033 * joint_coordinate(s.model, now, 0);
                       worst.add(std::abs(energy(s.model, now).total() - before - given));
                     });
              return double(worst);
            };
            const double coarse = lost(3e-5), fine = lost(1e-5);
            return Figures{{"energy", fine}, {"order", std::log(coarse / fine) / std::log(3)}};
          }};
}

}  // namespace

std::vector<VerificationCase> mechanism_verification() {
  std::vector<VerificationCase> out{housner(NormalLaw::moreau), housner(NormalLaw::combined),
                                    housner(NormalLaw::gap_over_step)};
  for (const std::string& scheme : scheme_names()) out.push_back(flat_block(scheme));
  out.push_back(fourteen_impacts_exactly());
  out.push_back(fourteen_impacts_in_steps());
  for (VerificationCase& c : slider_crank_verification()) out.push_back(std::move(c));
  for (VerificationCase& c : dimer_verification()) out.push_back(std::move(c));
  for (VerificationCase& c :
       std::vector<VerificationCase>{pecking(), four_pecks(), double_pendulum_exactly(),
                                     double_pendulum_in_steps(1e-3), double_pendulum_in_steps(2e-4)})
    out.push_back(std::move(c));
  for (const char* scheme : {"moreau_jean", "d1_minus_linear", "passive_midpoint", "generalised_alpha"})
    out.push_back(two_windows(scheme));
  out.push_back(forty_windows());
  for (VerificationCase& c : bricard_verification()) out.push_back(std::move(c));
  out.push_back(squeezer_at_its_start());
  for (const char* scheme : {"moreau_jean", "generalised_alpha", "d1_minus_linear"})
    out.push_back(squeezer_at_its_end(scheme));
  for (VerificationCase& c :
       std::vector<VerificationCase>{squeezer_exactly(), squeezer_by_cayley(), squeezer_energy()})
    out.push_back(std::move(c));
  for (VerificationCase& c : spinning_chain_verification()) out.push_back(std::move(c));
  return out;
}

}  // namespace aussois
