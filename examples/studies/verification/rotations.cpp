// SPDX-License-Identifier: Apache-2.0
// Group D: rotations.
#include <algorithm>

#include "examples/studies/verification/running.hpp"

namespace aussois {
namespace {

/// 3e-10 from the separatrix: only a scheme that hardly changes energy and momentum flips at the right times.
CaseScene dzhanibekov() {
  CaseScene s = case_named("dzhanibekov").scene();
  twist(s.state, s.body).tail<3>() = Vec3(0, 2, 1e-4);
  return s;
}

VerificationCase first_flip() {
  return {.name = "D1.first_flip",
          .what = "Dzhanibekov's body, moreau_jean, theta 1/2, at 5, 2.5 and 1 ms",
          .rows = {{"time", "worst time of the first flip, per h^2", "s/s^2", 2,
                    "quarter of the period of Jacobi's functions, 6.18519931 s; order two"}},
          .measure = [] {
            const CaseScene s = dzhanibekov();
            Worst off;
            for (const double h : {5e-3, 2.5e-3, 1e-3}) {
              double flip = 0, before = 2;
              run_to(s, "moreau_jean", exact_options(h, NormalLaw::moreau), 7,
                     [&](const State& state, const StepReport&) {
                       const double w = twist(state, s.body)[4];
                       if (flip == 0 && w < 0) flip = state.t - h * w / (w - before);
                       before = w;
                     });
              off.add(std::abs(flip - 6.18519931) / (h * h));
            }
            return Figures{{"time", off}};
          }};
}

/// Largest differences from the shared series, of rates, attitude, energy and momentum.
struct Flipping {
  Worst rate{}, turn{}, energy{}, momentum{};  // [rad/s], [rad], relative, relative
};
Flipping flips(const std::string& name, double h) {
  const CaseScene s = dzhanibekov();
  SchemeOptions o = moreau_options(h);
  if (name == "passive_midpoint") o.step.update = GroupUpdate::cayley;
  const Scheme scheme = make_scheme(name, s.model, o);
  const double L = momentum(s.model, s.state).angular.norm();
  State state = s.state;
  Flipping out;
  for (const SeriesRow& row : shared_series("dzhanibekov.csv")) {
    run_accepted(scheme, state, row.at("t_s"));
    const Vec3 w(row.at("wx"), row.at("wy"), row.at("wz")), start(row.at("Lx"), row.at("Ly"), row.at("Lz"));
    const Quat q(row.at("qw"), row.at("qx"), row.at("qy"), row.at("qz"));
    out.rate.add((twist(state, s.body).tail<3>() - w).norm());
    out.turn.add(pose(state, s.body).R.angularDistance(q));
    out.energy.add(std::abs(energy(s.model, state).total() / row.at("energy") - 1));
    out.momentum.add((momentum(s.model, state).angular - start).norm() / L);
  }
  return out;
}

VerificationCase seven_flips(const std::string& scheme) {
  const bool exact = scheme == "event_driven", paoli = scheme == "schatzman_paoli",
             keeps = scheme == "passive_midpoint";
  VerificationCase out{
      .name = "D1.seven_flips",
      .setting = scheme,
      .what = "Dzhanibekov's body for 90 s at 2.5 ms (event_driven: 0.5 s; passive_midpoint by Cayley's map)",
      .rows = {{"rate", "worst rate", "rad/s",
                exact   ? 2e-5
                : paoli ? 4.5e-3
                        : 9e-4,
                paoli ? "shared series; guard: velocities half a step old"
                      : "shared series; guard at this step"},
               {"attitude", "worst attitude", "rad", exact ? 1e-5 : 5e-4,
                "shared series; guard at this step"},
               {"energy", "worst energy, relative", "-",
                keeps   ? 1e-12
                : exact ? 6e-9
                        : 6e-6,
                keeps ? "conserved; rounding" : "shared series; guard at this step"},
               {"momentum", "worst angular momentum, relative", "-",
                keeps   ? 1e-12
                : exact ? 3e-9
                : paoli ? 2.3e-3
                        : 1e-5,
                keeps ? "conserved; rounding" : "shared series; guard at this step"}},
      .measure =
          [=] {
            const Flipping run = flips(scheme, exact ? 0.5 : 2.5e-3);
            Figures figures{{"rate", run.rate},
                            {"attitude", run.turn},
                            {"energy", run.energy},
                            {"momentum", run.momentum}};
            if (!exact) figures["order"] = std::log2(flips(scheme, 5e-3).turn / run.turn);
            return figures;
          },
      .slow = true};
  if (!exact)
    out.rows.push_back({"order", "order of the attitude, 5 to 2.5 ms", "-",
                        scheme == "generalised_alpha" ? 1.4 : 1.85, "guard at these steps; D2.orders: two",
                        Sense::at_least});
  return out;
}

VerificationCase free_top() {
  return {
      .name = "D2.free_top",
      .what = case_named("free_top").what + "; moreau_jean, theta 1/2, h = 1 ms",
      .rows = {{"velocity", "velocity at the end", "rad/s", 1e-6, "closed form; order two: h^2"}},
      .measure = [] {
        const Case& c = case_named("free_top");
        const CaseScene s = c.scene();
        const State end = run_to(s, "moreau_jean", exact_options(1e-3, NormalLaw::moreau), c.t_end);
        return Figures{{"velocity", (c.observe(s, end).v - evaluate(c.exact(c.t_end), c.t_end).v).norm()}};
      }};
}

struct Off {
  double position = 0, energy = 0;  // [m], relative
  Worst force{};                    // at the tip, relative
};
/// After 2 s. The force is taken at the time that the report names for it (MJT-17), from 0.1 s on.
Off top_off(const std::string& scheme, double h, bool with_force) {
  constexpr double d = 1e-4;  // [s]
  const CaseScene s = case_named("heavy_top").scene();
  const ExactMotion exact = case_named("heavy_top").exact(2.01);
  const SeriesRow last = shared_series("heavy_top.csv").back();
  SchemeOptions o = moreau_options(h);
  o.generalised_alpha.spectral_radius = 0.8;  // without damping the force swings on
  Off out;
  const State end = run_to(s, scheme, o, 2, [&](const State&, const StepReport& r) {
    const double t = r.t_joints;
    if (!with_force || t < 0.1) return;
    const Vec3 a = (evaluate(exact, t + d).v - evaluate(exact, t - d).v) / (2 * d);
    const Vec3 force = 15 * (a + Vec3(0, 0, kGravity));
    out.force.add((r.joints[0].force - force).norm() / force.norm());
  });
  out.position = (pose(end, s.body).p - Vec3(last.at("x"), last.at("y"), last.at("z"))).norm();
  out.energy = std::abs(energy(s.model, end).total() / 5435.69679 - 1);
  return out;
}

VerificationCase end_of_the_series() {
  return {.name = "D3.end_of_the_series",
          .what = "the end of the shared series of the heavy top",
          .rows = {{"position", "position after 2 s, off the one agreed", "m", 1e-9, "agreed"}},
          .measure = [] {
            const SeriesRow last = shared_series("heavy_top.csv").back();
            const Vec3 at(last.at("x"), last.at("y"), last.at("z"));
            return Figures{{"position", (at - Vec3(-0.150416823, -0.724165592, -0.673022270)).norm()}};
          }};
}

VerificationCase heavy_top_exactly() {
  return {
      .name = "D3.heavy_top",
      .setting = "event_driven",
      .what = "heavy top of 150 rad/s on its tip for 2 s",
      .rows = {{"position", "position at the end", "m", 1e-7, "shared series; tolerances of the equation"},
               {"energy", "energy at the end, relative", "-", 1e-8, "conserved; tolerances of the equation"}},
      .measure = [] {
        const Off run = top_off("event_driven", 0.1, false);
        return Figures{{"position", run.position}, {"energy", run.energy}};
      }};
}

// Of the order of the motion. With 150 rad/s the velocities of schatzman_paoli, half a step old, turn the
// gyroscopic torque by 75 mrad at 1 ms: it is far off.
VerificationCase heavy_top(const std::string& scheme) {
  const bool paoli = scheme == "schatzman_paoli", alpha = scheme == "generalised_alpha";
  const std::string guard =
      paoli ? "guard: gyroscopic torque 38 mrad old" : "guard at this step; agreed: 1e-3 m at 1 ms";
  const std::string at_these_steps =
      std::string("guard at these steps; D3.orders: ") + (paoli ? "one" : "two");
  return {
      .name = "D3.heavy_top",
      .setting = scheme,
      .what = "heavy top of 150 rad/s on its tip for 2 s at 0.5 ms",
      .rows = {{"position", "position at the end", "m", paoli ? 0.34 : 6.6e-4, "shared series; " + guard},
               {"energy", "energy at the end, relative", "-", paoli ? 0.014 : 5e-6, "conserved; " + guard},
               {"force", "worst force at the tip, relative", "-",
                paoli   ? 0.57
                : alpha ? 1.1e-3
                        : 7e-4,
                "closed motion, (MJT-17); " + guard},
               {"order", "order of the position, 1 to 0.5 ms", "-", paoli ? 0.6 : 1.45, at_these_steps,
                Sense::at_least},
               {"order_of_force", "order of the force, 1 to 0.5 ms", "-",
                paoli   ? 0.4
                : alpha ? 1.9
                        : 1.5,
                at_these_steps, Sense::at_least}},
      .measure =
          [scheme] {
            const Off coarse = top_off(scheme, 1e-3, true), fine = top_off(scheme, 5e-4, true);
            return Figures{{"position", fine.position},
                           {"energy", fine.energy},
                           {"force", fine.force},
                           {"order", std::log2(coarse.position / fine.position)},
                           {"order_of_force", std::log2(coarse.force / fine.force)}};
          },
      .slow = true};
}

}  // namespace

std::vector<VerificationCase> rotation_verification() {
  std::vector<VerificationCase> out{first_flip()};
  for (const std::string& scheme : scheme_names()) out.push_back(seven_flips(scheme));
  out.push_back(free_top());
  out.push_back(end_of_the_series());
  out.push_back(heavy_top_exactly());
  for (const std::string& scheme : scheme_names())
    if (scheme != "event_driven") out.push_back(heavy_top(scheme));
  return out;
}

}  // namespace aussois
