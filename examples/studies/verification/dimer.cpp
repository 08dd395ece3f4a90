// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/dimer.hpp"

#include <algorithm>

#include "examples/scenes/toys.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "lmd/simplex_distance.hpp"

namespace aussois {
namespace {

SchemeOptions dimer_options(double h) {
  return {.step = {.h = h, .solver = {.tolerance = 1e-12}},
          .moreau_jean = {.theta = 0.5, .law = NormalLaw::moreau}};
}

/// Largest difference of the two end points from those of a shared series, up to t_end [s].
double off_series(const CaseScene& s, const std::string& scheme, double h, const std::string& name,
                  double t_end) {
  const Scheme run = make_scheme(scheme, s.model, dimer_options(h));
  const double half = Dimer{}.half;
  State state = s.state;
  Worst out;
  for (const SeriesRow& row : shared_series(name)) {
    if (row.at("t_s") > t_end) break;
    require_accepted(run_until(run, state, row.at("t_s")));
    const Vec3 q = dimer_pose(s, state);
    for (const double side : {-half, half})
      out.add(
          std::hypot(q[0] + side * std::cos(q[2]) - row.at("x_m") - side * std::cos(row.at("theta_rad")),
                     q[1] + side * std::sin(q[2]) - row.at("y_m") - side * std::sin(row.at("theta_rad"))));
  }
  return out;
}

VerificationCase drop() {
  const std::string guard = "shared series, right to 2e-5; guard: order one";
  return {.name = "C4.drop",
          .what = "dimer that falls on its ends from 20 mm, e = 0.6, mu = 0.1, six impacts: its ends",
          .rows = {{"exactly", "worst place for 0.2 s, event_driven", "m", 1e-6, "shared series; guard"},
                   {"coarse", "worst place for 0.1 s, moreau_jean, h = 0.1 ms", "m", 1e-4, guard},
                   {"fine", "worst place for 0.1 s, moreau_jean, h = 10 us", "m", 1e-5, guard}},
          .measure =
              [] {
                const CaseScene s = dimer_drop();
                const auto off = [&](const char* scheme, double h, double t_end) {
                  return off_series(s, scheme, h, "dimer_drop.csv", t_end);
                };
                return Figures{{"exactly", off("event_driven", 1e-3, 0.2)},
                               {"coarse", off("moreau_jean", 1e-4, 0.1)},
                               {"fine", off("moreau_jean", 1e-5, 0.1)}};
              },
          .certified = true};
}

VerificationCase vibrated() {
  return {.name = "C4.vibrated",
          .what = "dimer on a plate that vibrates at 25 Hz by 0.9 g: its ends",
          .rows = {{"exactly", "worst place for 0.09 s, event_driven; it rattles to rest from 0.07 s on", "m",
                    1e-5, "shared series, right to 2e-5"},
                   {"coarse", "worst place for 0.4 s, moreau_jean, h = 0.1 ms", "m", 1e-4,
                    "shared series; guard: order one"},
                   {"fine", "worst place for 0.4 s, moreau_jean, h = 20 us", "m", 2e-5,
                    "shared series, right to 2e-5; order one"}},
          .measure =
              [] {
                const CaseScene s = dimer_on_vibrating_plate(0.9 * kGravity, 0.41);
                const auto off = [&](const char* scheme, double h, double t_end) {
                  return off_series(s, scheme, h, "dimer_vibrated.csv", t_end);
                };
                return Figures{{"exactly", off("event_driven", 1e-3, 0.09)},
                               {"coarse", off("moreau_jean", 1e-4, 0.4)},
                               {"fine", off("moreau_jean", 2e-5, 0.4)}};
              },
          .certified = true};
}

// By energy and geometry alone: it falls without turning until the lower end touches; then both contacts
// couple.
VerificationCase touches() {
  return {.name = "C4.touches",
          .setting = "event_driven",
          .what = "dimer that falls on its ends, one step of 70 ms",
          .rows = {{"events", "events", "-", 2, "each end once", Sense::exactly},
                   {"time", "time of the first", "s", 1e-9, "closed form: a free fall; tolerances"},
                   {"first", "time of the first, off 54.53325 ms", "s", 1e-6, "agreed"},
                   {"second", "time of the second, off 65.1325 ms", "s", 1e-6, "shared series"}},
          .measure =
              [] {
                const CaseScene s = dimer_drop();
                const Dimer d;
                const double t = std::sqrt(2 * (0.02 - d.half * std::sin(0.3) - d.radius) / kGravity);
                State state = s.state;
                const std::vector<StepEvent> events =
                    step(make_scheme("event_driven", s.model, dimer_options(0.07)), state).events;
                const auto off = [&](std::size_t k, double right) {
                  return k < events.size() ? std::abs(events[k].t - right) : kInf;
                };
                return Figures{{"events", double(events.size())},
                               {"time", off(0, t)},
                               {"first", off(0, 0.05453325)},
                               {"second", off(1, 0.0651325)}};
              },
          .certified = true};
}

// Below 1 g the plate never throws it: it comes to rest and does not drift. Sign and place of where it stops.
VerificationCase at_rest() {
  return {.name = "C4.at_rest",
          .what = "dimer on a plate that vibrates by 0.9 g, moreau_jean, h = 0.1 ms, 0.6 s",
          .rows = {{"place", "place at 0.2 s, off 0.214 mm to the right", "m", 2e-5,
                    "shared series, right to 2e-5"},
                   {"drift", "mean speed from 0.2 s on", "m/s", 1e-6, "theory: below 1 g it stays"}},
          .measure =
              [] {
                const CaseScene s = dimer_on_vibrating_plate(0.9 * kGravity, 0.61);
                double at = 0;
                const State end = run_to(s, "moreau_jean", dimer_options(1e-4), 0.6,
                                         [&](const State& state, const StepReport&) {
                                           if (state.t < 0.2 + 1e-9) at = dimer_pose(s, state)[0];
                                         });
                return Figures{{"place", std::abs(at - 2.14e-4)},
                               {"drift", std::abs(dimer_pose(s, end)[0] - at) / 0.4}};
              },
          .certified = true};
}

/// The minima of the distance with the rod moved by (x, 0, z).
ContactSet contacts_at(const MoreauJean& scheme, const CaseScene& s, double x, double z) {
  State state = s.state;
  pose(state, s.body).p += Vec3(x, 0, z);
  return scheme.contacts(state, 0.05);
}

// Two sides and the bar: three minima wherever the rod's end is above the bar. Each gap is C1 along the path:
// its difference is the normal velocity.
VerificationCase contacts_between_the_balls() {
  return {
      .name = "C5.contacts_between_the_balls",
      .what = "rod between the balls of a dimer, 12 mm above the bar, moved by 24 mm to either side",
      .rows = {{"fewest", "contacts, at least", "-", 3, "geometry: two sides and the bar", Sense::exactly},
               {"most", "contacts, at most", "-", 3, "geometry: two sides and the bar", Sense::exactly},
               {"slope", "worst slope of a gap, off its normal, by differences over 2 um", "-", 1e-6,
                "theory: C1; differences over 2 um"}},
      .measure = [] {
        constexpr double d = 1e-6;
        const CaseScene s = dimer_and_rod(0, 1e-3, 0);
        const MoreauJean scheme(s.model, {.h = 1e-3}, {.theta = 1});
        Least fewest;
        Worst most, slope;
        for (int k = -240; k <= 240; ++k) {
          const double x = 1e-4 * k;
          const ContactSet before = contacts_at(scheme, s, x - d, 0.012),
                           now = contacts_at(scheme, s, x, 0.012),
                           after = contacts_at(scheme, s, x + d, 0.012);
          for (const ContactSet* set : {&before, &now, &after})
            fewest.add(double(set->points.size())), most.add(double(set->points.size()));
          if (before.points.size() != now.points.size() || after.points.size() != now.points.size())
            continue;  // seen by the counts
          for (std::size_t i = 0; i < now.points.size(); ++i) {
            const ContactPoint& c = now.points[i];
            const double along = c.normal.x() * (c.a.body == s.body ? 1 : -1);
            slope.add(std::abs((after.points[i].gap - before.points[i].gap) / (2 * d) - along));
          }
        }
        return Figures{{"fewest", fewest}, {"most", most}, {"slope", slope}};
      }};
}

// How deep the rod is in balls and bar, from points and segments alone [m].
double depth(const CaseScene& s, const State& state) {
  const SE3& g = pose(state, s.body);
  const Vec3 rod[] = {g * Vec3(-kPushedRodLength / 2, 0, 0), g * Vec3(kPushedRodLength / 2, 0, 0)};
  const Vec3 bar[] = {Vec3(-kBallPlace, 0, 0), Vec3(kBallPlace, 0, 0)};
  double gap = closest_points(rod, bar).distance - kPushedRodRadius - kBarRadius;
  for (const Vec3& ball : bar) {
    const Vec3 along = rod[1] - rod[0];
    const double part = std::clamp((ball - rod[0]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    gap = std::min(gap, (ball - rod[0] - part * along).norm() - kPushedRodRadius - kBallRadius);
  }
  return -gap;
}

// Pushed in beside the flank of a ball: over it, down to the bar. Any saved state leads to the same bits.
VerificationCase pushed_rod(const std::string& name) {
  constexpr double h = 1e-3, kSpeed = 0.1;
  return {
      .name = "C5.pushed_rod",
      .setting = name,
      .what = "rod pushed at 0.1 m/s beside the flank of a ball, 250 steps of 1 ms",
      .rows = {{"depth", "deepest in balls and bar, by points and segments", "m", h * kSpeed,
                "theory: the distance of a step"},
               {"ball", "impulse of the balls", "N s", 1e-6, "it comes down on a flank", Sense::at_least},
               {"bar", "impulse of the bar", "N s", 1e-6, "it comes down to the bar", Sense::at_least},
               {"other_bits", "states that a fresh scheme misses, from seven of them", "-", 0,
                "a scheme keeps everything in the state", Sense::exactly}},
      .measure =
          [name] {
            const CaseScene s = dimer_and_rod(0.018, 0.012, kSpeed);
            const Scheme scheme = make_scheme(name, s.model, dimer_options(h));
            std::vector<State> saved = {s.state};
            double ball = 0, bar = 0;
            Worst deepest;
            for (int k = 0; k < 250; ++k) {
              State next = saved.back();
              for (const StepContact& c : step(scheme, next).contacts)
                (std::min(c.point.a.body, c.point.b.body) == 0 ? ball : bar) += c.impulse.norm();
              deepest.add(depth(s, next));
              saved.push_back(std::move(next));
            }
            int other = 0;
            for (const std::size_t from : {0U, 1U, 50U, 100U, 125U, 150U, 249U}) {
              const Scheme fresh = make_scheme(name, s.model, dimer_options(h));
              State state = saved[from];
              for (std::size_t k = from; k + 1 < saved.size() && k < from + 60; ++k) {
                step(fresh, state);
                other += hash(state) != hash(saved[k + 1]);
              }
            }
            return Figures{{"depth", deepest}, {"ball", ball}, {"bar", bar}, {"other_bits", double(other)}};
          },
      .certified = true};
}

}  // namespace

std::vector<VerificationCase> dimer_verification() {
  std::vector<VerificationCase> out{drop(), vibrated(), touches(), at_rest(), contacts_between_the_balls()};
  for (const std::string& scheme : scheme_names()) out.push_back(pushed_rod(scheme));
  return out;
}

}  // namespace aussois
