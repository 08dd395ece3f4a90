// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>

#include "examples/scenes/toys.hpp"
#include "examples/studies/verification/rolling_bodies.hpp"
#include "examples/studies/verification/running.hpp"

namespace aussois {
namespace {

// (TOY-11), (TOY-12) in the body: gamma up, omega; rho from the centre of mass to the point that touches.
VecX rolling(const Rattleback& r, const VecX& y) {
  const Vec3 gamma = y.head<3>(), omega = y.tail<3>(), gamma_rate = gamma.cross(omega);
  const Vec3 A2 = r.semi_axes.cwiseProduct(r.semi_axes), rho = lowest_point(r, gamma);
  const double length = r.semi_axes.cwiseProduct(gamma).norm();
  const Vec3 rho_rate = -A2.cwiseProduct(gamma_rate) / length +
                        A2.cwiseProduct(gamma) * gamma.dot(A2.cwiseProduct(gamma_rate)) / std::pow(length, 3);
  const Mat3 S = skew(rho);
  const Vec3 moment = -omega.cross(r.inertia * omega) +
                      r.mass * rho.cross(rho_rate.cross(omega) + omega.cross(rho.cross(omega))) +
                      r.mass * kGravity * rho.cross(gamma);
  VecX rate(6);
  rate << gamma_rate, (r.inertia - r.mass * S * S).inverse() * moment;
  return rate;
}
double energy_of(const Rattleback& r, const VecX& y) {
  const Vec3 gamma = y.head<3>(), omega = y.tail<3>(), rho = lowest_point(r, gamma);
  return 0.5 * r.mass * rho.cross(omega).squaredNorm() + 0.5 * omega.dot(r.inertia * omega) -
         r.mass * kGravity * rho.dot(gamma);
}
double vertical_spin(const VecX& y) {
  return y.head<3>().dot(y.tail<3>());
}

VecX observed(const CaseScene& s, const State& state) {
  VecX y(6);
  y << pose(state, s.body).R.conjugate() * Vec3::UnitZ(), twist(state, s.body).tail<3>();
  return y;
}

std::function<VecX(double)> reference(double spin, double t_end, double stride = 2.5e-4) {
  const CaseScene s = rattleback(spin);
  return ode_solution([](double, const VecX& y) { return rolling(Rattleback{}, y); }, observed(s, s.state),
                      t_end, stride);
}

/// The first time at which the vertical spin changes its sign, to a millisecond; infinity: not until t_end.
double reversal(const std::function<VecX(double)>& y, double t_end) {
  const double begin = vertical_spin(y(0));
  for (double t = 0; t < t_end; t += 1e-3)
    if (vertical_spin(y(t)) * begin < 0) return t;
  return kInf;
}

struct Followed {
  Worst spin{};            // error of the vertical spin, if it is compared [rad/s]
  double reversal = kInf;  // [s]
  double energy = 0;       // error at the end, relative to the kinetic energy of the start [-]
};
Followed follow(const std::string& name, double spin, double h, double t_end,
                const std::function<VecX(double)>& exact, const MoreauJeanOptions& own) {
  const CaseScene s = rattleback(spin);
  const SchemeOptions o{.step = {.h = h, .solver = {.tolerance = 1e-12}}, .moreau_jean = own};
  Followed out;
  const State end = run_to(s, name, o, t_end, [&](const State& state, const StepReport&) {
    const double now = vertical_spin(observed(s, state));
    if (now * spin < 0) out.reversal = std::min(out.reversal, state.t);
    if (exact && state.t < t_end) out.spin.add(std::abs(now - vertical_spin(exact(state.t))));
  });
  const Energy before = energy(s.model, s.state);
  out.energy = std::abs(energy(s.model, end).total() - before.total()) / before.kinetic;
  return out;
}

// Contacts at the middle of the step, and the law of the mean velocity, which is the one there: no slip works
// nothing and is of order two (MJ-10).
const MoreauJeanOptions kMean = rolling_options().moreau_jean;
constexpr MoreauJeanOptions kLast{.contacts = ContactsAt::midpoint};

std::string spin_text(double spin) {
  return spin < 0 ? "backwards, 5 rad/s" : "forwards, 5 rad/s";
}

// The equations themselves. Started against its skew inertia the body soon turns round, with it late. Without
// loss both senses of rotation turn.
VerificationCase equations(double spin, double t_end, double turns_at) {
  return {.name = "B7.equations_of_rolling",
          .setting = spin_text(spin),
          .what = "the equations that the rattleback is compared with, strides of 0.25 ms",
          .rows = {{"energy", "worst energy, relative", "-", 1e-12, "agreed"},
                   {"stride", "worst difference from half the stride", "rad/s", 1e-8, "order eight"},
                   {"reversal",
                    spin < 0 ? "time of the reversal, off 2.77 s" : "time of the reversal, off 11.46 s", "s",
                    0.01, "guard: the figure of toys.md, to its digits"},
                   {"turned", "spin at the end, against that of the start", "rad/s", 1e-300,
                    "it has turned round", Sense::at_least}},
          .measure = [=] {
            const Rattleback r;
            const auto y = reference(spin, t_end), finer = reference(spin, t_end, 1.25e-4);
            const double before = energy_of(r, y(0));
            Worst energy, stride;
            for (double t = 0; t < t_end; t += 0.05) {
              energy.add(std::abs(energy_of(r, y(t)) / before - 1));
              stride.add((y(t) - finer(t)).norm());
            }
            return Figures{{"energy", energy},
                           {"stride", stride},
                           {"reversal", std::abs(reversal(y, t_end) - turns_at)},
                           {"turned", -vertical_spin(y(t_end)) * (spin < 0 ? -1 : 1)}};
          }};
}

VerificationCase from_event_to_event(double spin, double t_end) {
  return {.name = "B7.from_event_to_event",
          .setting = spin_text(spin),
          .what = "rattleback through its reversal, event_driven, h = 5 ms",
          .rows = {{"spin", "worst vertical spin", "rad/s", 1e-4, "equations of rolling; guard"},
                   {"reversal", "time of the reversal", "s", 6e-3,
                    "equations of rolling; a step and a millisecond"}},
          .measure = [=] {
            const auto exact = reference(spin, t_end);
            const Followed run = follow("event_driven", spin, 5e-3, t_end, exact, kLast);
            return Figures{{"spin", run.spin}, {"reversal", std::abs(run.reversal - reversal(exact, t_end))}};
          }};
}

VerificationCase mean_velocity() {
  return {.name = "B7.mean_velocity",
          .what = "rattleback for 1 s, moreau_jean, law of the mean velocity, h = 1 ms",
          .rows = {{"spin", "worst vertical spin", "rad/s", 4e-3, "equations of rolling; guard: order two"},
                   {"energy", "energy at the end, relative to the kinetic", "-", 3e-4,
                    "conserved; guard: order two"},
                   {"order", "order of the spin, 1 to 0.2 ms, off 2", "-", 0.1, "theory (MJ-10): two"},
                   {"promised", "order that the scheme states", "-", 2, "theory (MJ-10)", Sense::exactly}},
          .measure = [] {
            const auto exact = reference(5, 1);
            const Followed coarse = follow("moreau_jean", 5, 1e-3, 1, exact, kMean),
                           fine = follow("moreau_jean", 5, 2e-4, 1, exact, kMean);
            return Figures{{"spin", coarse.spin},
                           {"energy", coarse.energy},
                           {"order", std::abs(std::log(coarse.spin / fine.spin) / std::log(5) - 2)},
                           {"promised", scheme_traits("moreau_jean", rolling_options()).rolling}};
          }};
}

VerificationCase reversal_of_steps(double spin, double h, double t_end, double within) {
  return {.name = "B7.reversal_with_the_mean_velocity",
          .setting = spin_text(spin) + (h > 5e-4 ? ", 1 ms" : ", 0.2 ms"),
          .what = "rattleback, moreau_jean, law of the mean velocity",
          .rows = {{"reversal", "time of the reversal", "s", within,
                    "equations of rolling; guard: order two, amplified"}},
          .measure = [=] {
            const double right = reversal(reference(spin, t_end), t_end);
            return Figures{
                {"reversal", std::abs(follow("moreau_jean", spin, h, t_end, {}, kMean).reversal - right)}};
          }};
}

// Where the law is that of the velocity at the end, with the arms of another time, no slip works by O(h) per
// second. A small oscillation grows until it takes all of the spin: errors grow with it.
VerificationCase last_velocity(const std::string& scheme) {
  return {
      .name = "B7.last_velocity",
      .setting = scheme,
      .what = "rattleback for 1 s with the law of the last velocity, h = 0.1 ms",
      .rows = {{"spin", "worst vertical spin", "rad/s", 0.07,
                "equations of rolling; guard: order one, amplified"},
               {"ratio", "the same over that at 0.2 ms", "-", 0.7, "guard: order one halves it"},
               {"order", "order, 0.2 to 0.1 ms, off the one that the scheme states", "-", 0.3,
                "SchemeTraits::rolling; guard at these steps"}},
      .measure = [scheme] {
        const auto exact = reference(5, 1);
        const Followed coarse = follow(scheme, 5, 2e-4, 1, exact, kLast),
                       fine = follow(scheme, 5, 1e-4, 1, exact, kLast);
        const double promised =
            scheme_traits(scheme, {.moreau_jean = {.theta = 0.5, .contacts = ContactsAt::midpoint}}).rolling;
        return Figures{{"spin", fine.spin},
                       {"ratio", fine.spin / coarse.spin},
                       {"order", std::abs(std::log2(coarse.spin / fine.spin) - promised)}};
      }};
}

VerificationCase too_soon() {
  return {.name = "B7.too_soon",
          .what = "rattleback of -5 rad/s, moreau_jean, law of the last velocity, at 0.2, 0.1 and 0.05 ms",
          .rows = {{"late", "largest delay of the reversal", "s", 0, "its work turns it too soon"},
                   {"ratio", "largest ratio of the leads, from step to step", "-", 0.8,
                    "guard: order one halves it in the end"},
                   {"soon", "lead of the reversal at 0.05 ms", "s", 0.45, "guard: order one, amplified"}},
          .measure = [] {
            const double exact = reversal(reference(-5, 3), 3);
            double before = kInf;
            Worst late, ratio;
            for (const double h : {2e-4, 1e-4, 5e-5}) {
              const double soon = exact - follow("moreau_jean", -5, h, 3, {}, kLast).reversal;
              late.add(-soon);
              ratio.add(soon / before);
              before = soon;
            }
            return Figures{{"late", late}, {"ratio", ratio}, {"soon", before}};
          }};
}

}  // namespace

std::vector<VerificationCase> rattleback_verification() {
  std::vector<VerificationCase> out{equations(-5, 5, 2.77),
                                    equations(5, 20, 11.46),
                                    from_event_to_event(-5, 5),
                                    from_event_to_event(5, 13),
                                    mean_velocity(),
                                    reversal_of_steps(-5, 1e-3, 3.5, 0.06),
                                    reversal_of_steps(-5, 2e-4, 3.5, 2e-3),
                                    reversal_of_steps(5, 1e-3, 13, 4e-3)};
  for (const char* scheme : {"moreau_jean", "generalised_alpha", "passive_midpoint", "d1_minus_linear"})
    out.push_back(last_velocity(scheme));
  out.push_back(too_soon());
  return out;
}

}  // namespace aussois
