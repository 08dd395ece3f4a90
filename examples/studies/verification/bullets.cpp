// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/bullets.hpp"

#include <algorithm>

#include "examples/scenes/toys.hpp"
#include "examples/studies/verification/running.hpp"

namespace aussois {
namespace {

constexpr double kStep = 1e-3;  // 0.8 m
constexpr double kShare = kBulletMass / (kBulletMass + kPaperMass), kMomentum = kBulletMass * kBulletSpeed;

// Dilated shapes may overlap by 4 %: an impact may be so late [s]; later where overlap is taken back.
constexpr double kSlack = 0.04 * (kBulletRadius + kPaperHalfThickness) / kBulletSpeed + 1e-12;

struct Gun {
  SchemeVariant scheme{};
  int starts = 100;  // of the bullet, spread over a step
  std::string setting{};
};

constexpr double kTolerance = 1e-13, kSameSpeed = 10 * kTolerance * kBulletSpeed;

// 800 m/s cross the overlap that the certificate allows in 0.25 us: the default smallest step of 0.1 us will
// do, if a step that ends in an overlap leaves room for the next (CA-17).
SchemeOptions fast(SchemeOptions o) {
  o.step.h = kStep;
  o.step.solver.tolerance = kTolerance;
  return o;
}

std::vector<Gun> guns() {
  std::vector<Gun> out;
  for (const SchemeVariant& v : scheme_variants())
    out.push_back({{v.name, fast(v.options)}, 100, label(v.name, v.options)});
  for (const int starts : {10, 100})  // some tenths of a second for each start
    out.push_back(
        {{"event_driven", fast({})}, starts, "event_driven, " + std::to_string(starts) + " starts"});
  return out;
}

bool is_reference(const Gun& gun) {
  return gun.scheme.name == "event_driven";
}

/// Restitutions that the gun knows.
std::vector<double> restitutions(const Gun& gun) {
  return scheme_traits(gun.scheme.name, gun.scheme.options).restitution ? std::vector{0.0, 1.0}
                                                                        : std::vector{0.0};
}

/// A case of this gun.
VerificationCase with_gun(const Gun& gun, std::string name, std::string what, std::vector<Asked> rows,
                          std::function<Figures()> measure) {
  return {.name = std::move(name),
          .setting = gun.setting,
          .what = std::move(what),
          .rows = std::move(rows),
          .measure = std::move(measure),
          .slow = is_reference(gun) && gun.starts == 100,
          .certified = true};
}

/// What a run to the end of an impact and two steps more did.
struct Shot {
  State end{};
  double begin = kInf, over = 0;  // of the steps in which impulses acted [s]
  int attempts = 0;               // of one step, at most
};
Shot shoot(const CaseScene& s, const SchemeVariant& v) {
  const Scheme scheme = make_scheme(v.name, s.model, v.options);
  Shot out{.end = s.state};
  for (int after = 0, steps = 0; after < 3; ++steps) {
    if (steps == 300) throw NumericalFailure("no end of the impact in 300 steps");
    const State before = out.end;
    out.attempts = std::max(out.attempts, step(scheme, out.end).attempts);
    if ((out.end.v - before.v).norm() > 1e-6 * kBulletSpeed)
      out.begin = std::min(out.begin, before.t), out.over = out.end.t;
    const bool closing = twist(out.end, s.body)[2] - twist(out.end, 0)[2] < -1e-6 * kBulletSpeed;
    if (!closing) ++after;
  }
  return out;
}

/// How far the speeds along z are from what momentum and restitution say [m/s].
double off_speeds(const CaseScene& s, const State& end, double e) {
  return std::max(std::abs(twist(end, 0)[2] + (1 + e) * kShare * kBulletSpeed),
                  std::abs(twist(end, s.body)[2] + (kShare - e * (1 - kShare)) * kBulletSpeed));
}

/// Change of the momentum along z, relative.
double off_momentum(const CaseScene& s, const State& end) {
  return std::abs((kBulletMass * twist(end, s.body)[2] + kPaperMass * twist(end, 0)[2]) / kMomentum + 1);
}

/// Height of the bullet's centre above the paper's.
double above(const CaseScene& s, const State& state) {
  return pose(state, s.body).p.z() - pose(state, 0).p.z();
}

// The bullet hands on what momentum says, at the time when it is there, and stays in front of the paper.
VerificationCase paper(const Gun& gun) {
  const double late = (gun.scheme.name == "moreau_jean_projected" ? 4 : 1) * kSlack;
  return with_gun(
      gun, "A5.paper", "bullet of 800 m/s on paper, e = 0 and 1, starts spread over a step of 0.8 m",
      {{"in_front", "least distance of the centres after it", "m", 0.95 * kBulletRadius,
        "no tunnelling; overlap of 4 %", Sense::at_least},
       {"momentum", "change of momentum, relative", "-", 1e-12, "conservation; agreed"},
       {"late", "delay of the first impulse after the impact", "s", late,
        "4 % of the radii at 800 m/s; the projection takes it back"},
       {"early", "lead of the last impulse before the impact", "s", 1e-12, "closed form; rounding"},
       {"lasts", "duration of the impulses", "s", 2 * kStep, "an impact is over in two steps"},
       {"attempts", "attempts of one step", "-", 50, "guard: halvings down to 0.1 us are 14"},
       {"speed", "worst speed after it", "m/s", kSameSpeed, "closed form; tolerance, ten times"}},
      [gun] {
        Least in_front;
        Worst momentum, begins, ends, lasts, attempts, speed;
        for (const double e : restitutions(gun))
          for (int k = 0; k < gun.starts; ++k) {
            const double gap = 0.3 + double(k) / gun.starts * kBulletSpeed * kStep, t = gap / kBulletSpeed;
            const CaseScene s = bullet_and_paper(e, gap);
            const Shot shot = shoot(s, gun.scheme);
            in_front.add(above(s, shot.end));
            momentum.add(off_momentum(s, shot.end));
            begins.add(shot.begin - t), ends.add(t - shot.over), lasts.add(shot.over - shot.begin);
            attempts.add(shot.attempts);
            speed.add(off_speeds(s, shot.end, e));
          }
        return Figures{{"in_front", in_front}, {"momentum", momentum}, {"late", begins}, {"early", ends},
                       {"lasts", lasts},       {"attempts", attempts}, {"speed", speed}};
      });
}

/// Two bullets on ways that miss each other by `miss`, up to 3 ms: the change of velocities, and the most
/// rounds of certificates in a step.
struct Crossing {
  double change = 0;  // [m/s]
  long rounds = 0;
};
Crossing cross(const Gun& gun, double miss, double phase) {
  CaseScene s = crossing_bullets(miss, 0.3 + phase * 2 * kBulletSpeed * kStep);
  if (restitutions(gun).back() == 0) s.model.contact_law.restitution = 0;  // a plastic law refuses any other
  const Scheme scheme = make_scheme(gun.scheme.name, s.model, gun.scheme.options);
  State state = s.state;
  Crossing out;
  run_past(scheme, state, 3e-3, [&](const StepReport& report) {
    out.rounds = std::max(out.rounds, long(report.certificate_rounds));
    return true;
  });
  out.change = (state.v - s.state.v).norm();
  return out;
}

VerificationCase near_miss(const Gun& gun) {
  return with_gun(
      gun, "A5.near_miss", "two bullets pass each other at 1600 m/s and 1 um, starts spread over a step",
      {{"velocity", "change of velocities", "m/s", 1e-12 * kBulletSpeed, "closed form: no hit; rounding"},
       {"rounds", "rounds of certificates in a step", "-", is_reference(gun) ? 99999.0 : 59.0,
        "guard: grazing does not stall"}},
      [gun] {
        Worst velocity, rounds;
        for (int k = 0; k < gun.starts; ++k) {
          const Crossing crossing = cross(gun, 1e-6, double(k) / gun.starts);
          velocity.add(crossing.change), rounds.add(double(crossing.rounds));
        }
        return Figures{{"velocity", velocity}, {"rounds", rounds}};
      });
}

// Not a miss: 5 % of the radii overlap, more than the certificate forgives.
VerificationCase hit(const Gun& gun) {
  return with_gun(gun, "A5.hit", "two bullets whose ways overlap by 5 % of their radii, ten starts",
                  {{"velocity", "least change of velocities", "m/s", 1e-3, "the certificate forgives 4 %",
                    Sense::at_least}},
                  [gun] {
                    Least velocity;
                    for (int k = 0; k < 10; ++k)
                      velocity.add(cross(gun, -0.05 * 2 * kBulletRadius, k / 10.0).change);
                    return Figures{{"velocity", velocity}};
                  });
}

// Head-on at the edge of an upright sheet of a tenth of a millimetre: (TOY-1) again.
VerificationCase edge(const Gun& gun) {
  return with_gun(
      gun, "A5.edge", "bullet head-on at the edge of the sheet, e = 0 and 1, starts spread over a step",
      {{"speed", "worst speed after it", "m/s", kSameSpeed, "closed form (TOY-1); tolerance, ten times"},
       {"momentum", "change of momentum, relative", "-", 1e-12, "conservation; agreed"},
       {"spin", "speed of rotation of the sheet", "rad/s", 1e-6, "symmetry"}},
      [gun] {
        Worst speed, momentum, spin;
        for (const double e : restitutions(gun))
          for (int k = 0; k < gun.starts; ++k) {
            const CaseScene s = bullet_on_edge(e, 0.3 + double(k) / gun.starts * kBulletSpeed * kStep, 0);
            const State end = shoot(s, gun.scheme).end;
            speed.add(off_speeds(s, end, e));
            momentum.add(off_momentum(s, end));
            spin.add(twist(end, 0).tail<3>().norm());
          }
        return Figures{{"speed", speed}, {"momentum", momentum}, {"spin", spin}};
      });
}

// A micrometre beside, the normal leans by 2e-4 and the bullet goes off sideways by 0.035 (1 + e) m/s. In a
// step of 0.1 m each solve of Newton's loop would multiply the lean by some 20, and end with a bullet that
// went round the edge (MJ-16).
VerificationCase beside_the_edge(const Gun& gun) {
  return with_gun(
      gun, "A5.beside_the_edge", "bullet 1 um beside the edge of the sheet, in Newton's loop, 100 starts",
      {{"speed", "worst speed of the bullet along its way", "m/s", 0.02, "closed form (TOY-1)"},
       {"aside", "worst speed sideways, off 0.035 (1 + e) m/s", "m/s", 0.1,
        "theory (MJ-16): 170 without it"}},
      [gun] {
        Worst speed, aside;
        for (const double e : restitutions(gun))
          for (int k = 0; k < 100; ++k) {
            const CaseScene s = bullet_on_edge(e, 0.3 + k / 100.0 * kBulletSpeed * kStep, 1e-6);
            const Scheme scheme = make_scheme(gun.scheme.name, s.model, gun.scheme.options);
            State state = s.state;
            run_past(scheme, state, 3e-3);
            speed.add(std::abs(twist(state, s.body)[2] + (kShare - e * (1 - kShare)) * kBulletSpeed));
            aside.add(std::abs(twist(state, s.body)[0] - 0.035 * (1 + e)));
          }
        return Figures{{"speed", speed}, {"aside", aside}};
      });
}

/// The step in which the needle meets the sheet, and its speed upwards one step later; times of `meets`.
struct Strike {
  double begin = 0, end = 0, rise = 0;  // [-], [-], [m/s]
};
Strike strike(const Gun& gun, double angle) {
  SchemeOptions o = gun.scheme.options;
  if (!is_reference(gun)) o.step.advancement.min_h = 1e-12;
  const CaseScene s = needle_and_sheet(0, angle);
  const double half = 0.05 - 5e-4, spin = twist(s.state, s.body)[4];
  const double meets_at = std::asin((pose(s.state, s.body).p.z() - 5e-4 - kPaperHalfThickness) / half);
  const double t = (meets_at - angle) / spin;
  const Scheme scheme = make_scheme(gun.scheme.name, s.model, o);
  State state = s.state, before = state;
  for (int k = 0; k < 300 && std::abs(twist(state, s.body)[4] - spin) < 1e-6 * spin; ++k) {
    before = state;
    step(scheme, state);
  }
  Strike out{before.t / t, state.t / t, 0};
  step(scheme, state);
  out.rise = twist(state, s.body)[2];
  return out;
}

// 10 rad per step: where the tip ends says nothing about what it swept. It meets the sheet in the step in
// which geometry says so. Its 4 % of overlap are crossed in 0.04 us. Where gaps may close over the step the
// first impulse only brakes it. Stopped at its tip it goes up by up to 144 m/s, by how far out the tip is
// when the step begins.
VerificationCase needle(const Gun& gun) {
  const double lag = gun.scheme.options.step.update == GroupUpdate::cayley ? 0.12 : 1e-12;
  return with_gun(
      gun, "A5.needle", "needle whose tips come at 500 m/s, ten rad a step, starts spread over 1.72 rad",
      {{"late", "delay of the start of the step that hits, relative", "-", lag,
        "geometry; Cayley's 2 atan(x/2) lags behind x by 0.12"},
       {"early", "lead of the end of the step that hits, relative", "-", 1e-12, "geometry; rounding"},
       {"least_rise", "least speed upwards", "m/s", 20, "stopped at its tip", Sense::at_least},
       {"rise", "largest speed upwards", "m/s", 145, "closed form: 144 with the tip straight out"}},
      [gun] {
        Worst late, early, rise;
        Least least_rise;
        for (int k = 0; k < gun.starts; ++k) {
          const Strike one = strike(gun, -0.81 + double(k) / gun.starts * 1.72);
          late.add(one.begin - 1), early.add(1 - one.end);
          rise.add(one.rise), least_rise.add(one.rise);
        }
        return Figures{{"late", late}, {"early", early}, {"least_rise", least_rise}, {"rise", rise}};
      });
}

// The overlap that is granted is crossed in 0.25 us. Where the smallest step is longer, starts that come to
// it in the wrong place are refused, by name, and the bullet stays in front of the paper.
VerificationCase refused() {
  return {
      .name = "A5.refused",
      .what = "bullet on paper with steps of 1 us at least, passive_midpoint with Moreau's law, 100 starts",
      .rows = {{"refused", "refused starts", "-", 11, "the overlap is crossed in a quarter of the step",
                Sense::at_least},
               {"otherwise", "refused starts with another status or reason, or a changed state", "-", 0,
                "a refused step names the pair and changes nothing", Sense::exactly},
               {"in_front", "least distance of the centres", "m", 0.95 * kBulletRadius, "no tunnelling",
                Sense::at_least}},
      .measure =
          [] {
            int count = 0, otherwise = 0;
            Least in_front;
            for (int k = 0; k < 100; ++k) {
              const CaseScene s = bullet_and_paper(0, 0.3 + k / 100.0 * kBulletSpeed * kStep);
              const Scheme scheme = make_scheme("passive_midpoint", s.model,
                                                {.step = {.h = kStep, .advancement = {.min_h = 1e-6}},
                                                 .passive_midpoint = {.law = NormalLaw::moreau}});
              State state = s.state;
              std::uint64_t before = hash(state);
              const StepReport last = run(scheme, state, 6e-3, [&](const StepReport& report) {
                if (report.ok()) before = hash(state);
                return report.ok() && state.t < 3e-3;
              });
              count += !last.ok();
              otherwise += !last.ok() && (last.status != StepStatus::refused || hash(state) != before ||
                                          !last.reason.starts_with("no step of at least 1e-06 s was "
                                                                   "accepted: bodies 0 and 1"));
              in_front.add(above(s, state));
            }
            return Figures{
                {"refused", double(count)}, {"otherwise", double(otherwise)}, {"in_front", in_front}};
          },
      .certified = true};
}

}  // namespace

std::vector<VerificationCase> bullet_verification() {
  std::vector<VerificationCase> out;
  for (const auto& of : {paper, near_miss, hit, edge, needle})
    for (const Gun& gun : guns())
      if (of != hit || !is_reference(gun) || gun.starts == 10) out.push_back(of(gun));
  for (const Gun& gun : guns())
    if (!is_reference(gun) && gun.scheme.options.moreau_jean.newton.max_iterations != 1)
      out.push_back(beside_the_edge(gun));
  out.push_back(refused());
  return out;
}

}  // namespace aussois
