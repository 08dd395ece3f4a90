// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/slider_crank.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "examples/scenes/mechanisms.hpp"
#include "examples/studies/convergence/study.hpp"
#include "examples/studies/verification/running.hpp"

namespace aussois {
namespace {

/// Centre of the slider and half its length times its tilt, from a row of the shared series.
Vec3 slider_at(const SeriesRow& row) {
  const double th1 = row.at("th1_rad"), th2 = row.at("th2_rad");
  return {kCrankLength * std::cos(th1) + kConnectingRodLength * std::cos(th2),
          kCrankLength * std::sin(th1) + kConnectingRodLength * std::sin(th2),
          kSliderLength / 2 * row.at("th3_rad")};
}

// Both corners of the upper side at once: 2.6925028 ms, 0.8416123 m/s (verification by another integrator).
VerificationCase first_impacts() {
  return {
      .name = "C2.exact_motion",
      .what = "the exact motion of the slider-crank without friction, 8 ms",
      .rows = {{"pieces", "pieces, three impacts", "-", 4, "agreed", Sense::exactly},
               {"first", "time of the first impact, off 2.6925028 ms", "s", 5e-11, "agreed, to its digits"},
               {"speed", "speed before it, off 0.8416123 m/s", "m/s", 5e-8, "agreed, to its digits"},
               {"gap", "worst gap at an impact", "m", 1e-14, "it touches; rounding"},
               {"restitution", "worst velocity after an impact, off -0.4 of that before", "m/s", 1e-12,
                "Newton's law; rounding"}},
      .measure = [] {
        const ExactMotion exact = slider_crank_motion(8e-3);
        Worst gap, restitution;
        for (std::size_t k = 1; k < exact.pieces.size(); ++k) {
          const double hit = exact.pieces[k].begin;
          gap.add(std::abs(exact.pieces[k].at(hit).q[1] - 1e-3));
          restitution.add(std::abs(exact.pieces[k].at(hit).v[1] + 0.4 * exact.pieces[k - 1].at(hit).v[1]));
        }
        const double t = exact.pieces.size() < 2 ? kInf : exact.pieces[1].begin;
        return Figures{{"pieces", double(exact.pieces.size())},
                       {"first", std::abs(t - 2.6925028e-3)},
                       {"speed", std::abs(exact.pieces[0].at(t).v[1] - 0.8416123)},
                       {"gap", gap},
                       {"restitution", restitution}};
      }};
}

// Another code, at a fixed step of 5 ns: through the end of infinitely many impacts, and while the wall
// guides. Two corners hit in each of its events.
VerificationCase fine_steps() {
  return {
      .name = "C2.exact_motion_and_fine_steps",
      .what = "the exact motion of the slider-crank without friction, 20 ms",
      .rows = {{"slider", "worst place of the slider", "m", 2e-8, "shared series, good to 4e-7 rad of 0.3 m"},
               {"time", "worst time of an impact", "s", 4e-7, "shared series"}},
      .measure = [] {
        const ExactMotion exact = slider_crank_motion(0.02);
        Worst slider, time;
        for (const SeriesRow& row : shared_series("slider_crank_mu0.csv"))
          slider.add((evaluate(exact, row.at("t_s")).q - slider_at(row)).norm());
        const std::vector<SeriesRow> events = shared_series("slider_crank_mu0_events.csv");
        for (std::size_t k = 0; k < events.size(); k += 2)
          time.add(k / 2 + 1 < exact.pieces.size()
                       ? std::abs(exact.pieces[k / 2 + 1].begin - events[k].at("t_s"))
                       : kInf);
        return Figures{{"slider", slider}, {"time", time}};
      }};
}

struct Rule {
  bool of_bodies = true;
  ImpactLaw law = ImpactLaw::newton;
  double late = 0;  // of the impacts, at most [s]
};

/// With friction, h = 10 us, until 8 ms: times of the impacts, middles of their steps, and the slider.
Figures with_friction_off(const Rule& rule) {
  const CaseScene s = (rule.of_bodies ? slider_crank_of_bodies : slider_crank_of_angles)(0.01);
  const auto observe = rule.of_bodies ? slider_of_bodies : slider_of_angles;
  SchemeOptions o = moreau_options(1e-5);
  o.moreau_jean.impact.law = rule.law;
  const Scheme scheme = make_scheme("moreau_jean", s.model, o);
  const std::vector<SeriesRow> events = shared_series("slider_crank_mu001_events.csv");
  State state = s.state;
  Worst slider, time;
  std::size_t impacts = 0;
  double rising = 0;
  for (const SeriesRow& row : shared_series("slider_crank_mu001.csv")) {
    if (row.at("t_s") > 8e-3) break;
    run_accepted(scheme, state, row.at("t_s"), [&](const StepReport& report) {
      const double now = observe(s, state).v[1];
      if (rising > 0.05 && now < 0 && ++impacts <= 3)
        time.add(std::abs(state.t - report.h / 2 - events.at(2 * impacts - 2).at("t_s")));
      rising = now;
      return true;
    });
    slider.add((observe(s, state).q - slider_at(row)).norm());
  }
  return {{"impacts", double(impacts)}, {"time", time}, {"slider", slider}};
}

// Newton's law within the step refers to the normal velocity in the directions of its start. In angles those
// turn by 0.03 m/s in a step, in bodies they do not: an impact apart from the step is what angles want.
VerificationCase with_friction(const Rule& rule) {
  const std::string text =
      std::string(rule.of_bodies ? "bodies, " : "angles, ") + name_of(rule.law, kImpactLaws);
  return {
      .name = "C2.with_friction",
      .setting = text,
      .what = "slider-crank with friction for 8 ms, moreau_jean, h = 10 us",
      .rows = {{"impacts", "impacts", "-", 3, "shared series", Sense::exactly},
               {"time", "worst time of an impact", "s", rule.late,
                rule.law == ImpactLaw::poisson ? "shared series; a step" : "shared series; guard (MCH-4)"},
               {"slider", "worst place of the slider", "m", 2e-5, "shared series; guard: order one"}},
      .measure = [rule] { return with_friction_off(rule); }};
}

// Errors of first order, three impacts of up to 1.2 m/s.
VerificationCase every_scheme() {
  return {.name = "C2.every_scheme",
          .what = "slider-crank of bodies and of angles in every scheme and setting, h = 20 us",
          .rows = {{"runs", "runs", "-", 36, "every setting of every scheme that applies", Sense::exactly},
                   {"position", "worst position", "m", 3e-4, "exact motion; guard: order one"},
                   {"velocity", "worst velocity, distance of graphs", "m/s", 0.1,
                    "exact motion; guard: order one"}},
          .measure = [] {
            int runs = 0;
            Worst position, velocity;
            for (const char* name : {"slider_crank", "slider_crank_angles"}) {
              const Case& c = case_named(name);
              const ExactMotion exact = c.exact(c.t_end);
              for (const SchemeVariant& variant : scheme_variants()) {
                if (!applies(c, scheme_traits(variant.name, variant.options))) continue;
                SchemeOptions o = variant.options;
                o.step.h = 2e-5, o.step.solver.tolerance = 1e-12, o.step.advancement.certify = false;
                const Errors errors = errors_of(run_case(c, variant.name, o, 1), exact);
                position.add(errors[q_max]), velocity.add(errors[v_graph]);
                ++runs;
              }
            }
            return Figures{{"runs", double(runs)}, {"position", position}, {"velocity", velocity}};
          }};
}

// Struck one after the other, the corners tilt the slider: what follows is another motion, not a worse one.
VerificationCase corners_in_turn() {
  return {.name = "C2.corners_in_turn",
          .what = "first impact of the slider without friction, moreau_jean, h = 10 us",
          .rows = {{"at_once", "largest rate of its tilt, corners struck at once", "m/s", 1e-9,
                    "symmetry; rounding"},
                   {"in_turn", "largest rate of its tilt, corners struck in turn", "m/s", 0.05,
                    "another law: the last corner wins", Sense::at_least}},
          .measure = [] {
            const auto tilting = [](ImpactOrder order) {
              const CaseScene s = slider_crank_of_bodies(0);
              SchemeOptions o = moreau_options(1e-5);
              o.moreau_jean.impact.order = order;
              const Scheme scheme = make_scheme("moreau_jean", s.model, o);
              State state = s.state;
              Worst out;  // the corners that were struck last are soon struck again
              run_past(scheme, state, 2.75e-3, [&](const StepReport&) {
                out.add(std::abs(slider_of_bodies(s, state).v[2]));
                return true;
              });
              return double(out);
            };
            return Figures{{"at_once", tilting(ImpactOrder::simultaneous)},
                           {"in_turn", tilting(ImpactOrder::sequential)}};
          }};
}

/// Kinetic and potential energy of crank and rod [J], from the centre of the slider and its velocity; the
/// crank's angle is the one near `crank`.
double slider_crank_energy(const Vec2& at, const Vec2& rate, double crank) {
  constexpr double l1 = kCrankLength, l2 = kConnectingRodLength, m1 = 0.038, m2 = 0.038, m3 = 0.076,
                   J1 = 7.4e-5, J2 = 5.9e-4;
  const double r = at.norm(), aside = std::acos((l1 * l1 + r * r - l2 * l2) / (2 * l1 * r)),
               to_slider = std::atan2(at.y(), at.x());
  const auto distance = [&](double angle) { return std::abs(std::remainder(angle - crank, 2 * kPi)); };
  const double th1 =
      distance(to_slider + aside) < distance(to_slider - aside) ? to_slider + aside : to_slider - aside;
  const Vec2 head = l1 * Vec2(std::cos(th1), std::sin(th1)), rod = at - head;
  Mat2 turns;  // columns: what the crank's and the rod's rotation move the slider by
  turns << -head.y(), -rod.y(), head.x(), rod.x();
  const Vec2 w = turns.inverse() * rate, head_rate = w[0] * turns.col(0);
  const double kinetic = (J1 + m1 * l1 * l1 / 4) * w[0] * w[0] + J2 * w[1] * w[1] +
                         m2 * (head_rate + w[1] / 2 * turns.col(1)).squaredNorm() + m3 * rate.squaredNorm();
  return kinetic / 2 + kGravity * (m1 / 2 * head.y() + m2 * (head + rod / 2).y() + m3 * at.y());
}

// Half a dozen turns of the crank: where the slider is, the impacts faster than 2 cm/s and what they left of
// the energy. With 10 us a step the solver cannot be asked for less than 1e-10.
Figures rattle() {
  constexpr double t_end = 0.2, kFast = 0.02;
  const ExactMotion exact = slider_crank_motion(t_end);
  int hits = 0, counted = 0;
  for (std::size_t k = 1; k < exact.pieces.size(); ++k) {
    const double t = exact.pieces[k].begin, before = exact.pieces[k - 1].at(t).v[1],
                 after = exact.pieces[k].at(t).v[1];
    hits += t < t_end && std::abs(before) > kFast && before * after < 0;
  }
  const CaseScene s = slider_crank_of_bodies(0);
  double before = 0;
  const State end = run_to(s, "moreau_jean", exact_options(1e-5, NormalLaw::moreau, 1e-10), t_end,
                           [&](const State& now, const StepReport&) {
                             const double next = slider_of_bodies(s, now).v[1];
                             counted += std::abs(before) > kFast && before * next < 0;
                             before = next;
                           });
  const MotionSample right = evaluate(exact, t_end);
  const Vec3 crank = pose(end, 0).R * Vec3::UnitX();
  const double left =
      slider_crank_energy(right.q.head<2>(), right.v.head<2>(), std::atan2(crank.z(), crank.x()));
  return {{"hits", double(hits)},
          {"counted", std::abs(double(counted - hits))},
          {"slider", (slider_of_bodies(s, end).q - right.q).norm()},
          {"energy", std::abs(energy(s.model, end).total() - left)}};
}
VerificationCase rattling_slider() {
  return {
      .name = "C2.rattling_slider",
      .what = "slider-crank with clearance, no friction, 0.2 s, moreau_jean, h = 10 us",
      .rows = {{"hits", "impacts above 2 cm/s of the exact motion", "-", 43, "closed motion", Sense::exactly},
               {"counted", "impacts above 2 cm/s, off those", "-", 3, "hops of about 2 cm/s"},
               {"slider", "slider at the end", "m", 2e-5, "closed motion; guard: order one"},
               {"energy", "energy at the end", "J", 1e-4,
                "closed motion; guard, of 0.343 J that impacts take"}},
      .measure = rattle,
      .slow = true};
}

}  // namespace

std::vector<VerificationCase> slider_crank_verification() {
  return {first_impacts(),
          fine_steps(),
          with_friction({true, ImpactLaw::poisson, 1e-5}),
          with_friction({false, ImpactLaw::poisson, 1e-5}),
          with_friction({true, ImpactLaw::newton, 3.5e-5}),
          with_friction({false, ImpactLaw::newton, 2.6e-4}),
          every_scheme(),
          corners_in_turn(),
          rattling_slider()};
}

}  // namespace aussois
