// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <Eigen/LU>

#include "examples/scenes/toys.hpp"
#include "examples/studies/verification/rolling_bodies.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr double kTilt = 0.1;
const double kPrecession = std::sqrt(4 * kGravity / (EulerDisc{}.radius * std::sin(kTilt)));  // 102.38 rad/s
const double kTurn = 2 * kPi / kPrecession;

// Contacts in the middle of the step and the law of the mean velocity: no slip works nothing (MJ-10).
const MoreauJeanOptions kMean = rolling_options().moreau_jean;

SchemeOptions options(double h, const MoreauJeanOptions& own = {.contacts = ContactsAt::midpoint}) {
  return {.step = {.h = h, .solver = {.tolerance = 1e-12}}, .moreau_jean = own};
}

/// Largest relative changes, and the way of the centre [m].
struct Changes {
  Worst tilt{}, precession{}, energy{}, way{};
};
Changes changes(const CaseScene& s, const std::string& name, const SchemeOptions& o, double t_end) {
  const double W = precession(s, s.state), E = energy(s.model, s.state).total(),
               tilt = axis_angle(s, s.state);
  Changes out;
  run_to(s, name, o, t_end, [&](const State& state, const StepReport&) {
    out.tilt.add(std::abs(axis_angle(s, state) / tilt - 1));
    out.precession.add(std::abs(precession(s, state) / W - 1));
    out.energy.add(std::abs(energy(s.model, state).total() / E - 1));
    out.way.add(pose(state, s.body).p.head<2>().norm());
  });
  return out;
}

// (TOY-14), (TOY-15) of the scene itself.
VerificationCase steady_motion() {
  return {
      .name = "B8.steady_motion",
      .what = "Euler's disc at its start",
      .rows = {{"listed", "precession, off 102.38", "rad/s", 5e-3, "agreed, to its digits"},
               {"precession", "precession", "rad/s", 1e-11, "closed form (TOY-14); rounding"},
               {"energy", "energy, off 3/2 m g a sin(tilt)", "J", 1e-13, "closed form (TOY-15); rounding"},
               {"spin", "spin about the vertical, off W sin^2(tilt)", "rad/s", 1e-12,
                "closed form (TOY-14); rounding"},
               {"gap", "gap", "m", 1e-13, "it touches; rounding"},
               {"slip", "velocity of the point that touches", "m/s", 1e-13, "it rolls; rounding"}},
      .measure = [] {
        const EulerDisc disc;
        const CaseScene s = euler_disc(disc);
        const double height = disc.radius * std::sin(kTilt), weight = disc.mass * kGravity;
        const Vec3 omega = pose(s.state, s.body).R * Vec3(twist(s.state, s.body).tail<3>());
        const auto touch = s.model.gaps[0].evaluate(s.model, s.state, 0);
        return Figures{{"listed", std::abs(kPrecession - 102.38)},
                       {"precession", std::abs(precession(s, s.state) - kPrecession)},
                       {"energy", std::abs(energy(s.model, s.state).total() - 1.5 * weight * height)},
                       {"spin", std::abs(omega.z() - kPrecession * std::pow(std::sin(kTilt), 2))},
                       {"gap", std::abs(touch.gap)},
                       {"slip", (touch.J * s.state.v).norm()}};
      }};
}

VerificationCase ten_turns_on_the_mean() {
  return {
      .name = "B8.ten_turns_with_the_mean_velocity",
      .what = "Euler's disc for ten turns, moreau_jean, law of the mean velocity, h = 0.05 ms",
      .rows = {{"tilt", "worst tilt, relative", "-", 6e-6, "steady motion; guard: order two"},
               {"precession", "worst precession, relative", "-", 1.1e-5, "steady motion; guard: order two"},
               {"energy", "worst energy, relative", "-", 3e-6, "conserved; guard: order two"},
               {"way", "shift of the centre", "m", 1.1e-8, "steady motion; guard: order two"},
               {"order", "order of the tilt, 0.2 to 0.05 ms, off 2", "-", 0.3,
                "two (MJ-10); guard at these steps"},
               {"order_of_precession", "order of the precession, 0.2 to 0.05 ms, off 2", "-", 0.15,
                "two (MJ-10); guard at these steps"}},
      .measure = [] {
        const CaseScene s = euler_disc({});
        const Changes coarse = changes(s, "moreau_jean", options(2e-4, kMean), 10 * kTurn),
                      fine = changes(s, "moreau_jean", options(5e-5, kMean), 10 * kTurn);
        const auto off_two = [](double a, double b) { return std::abs(std::log(a / b) / std::log(4) - 2); };
        return Figures{{"tilt", fine.tilt},
                       {"precession", fine.precession},
                       {"energy", fine.energy},
                       {"way", fine.way},
                       {"order", off_two(coarse.tilt, fine.tilt)},
                       {"order_of_precession", off_two(coarse.precession, fine.precession)}};
      }};
}

VerificationCase ten_turns_exactly() {
  return {
      .name = "B8.ten_turns",
      .setting = "event_driven",
      .what = "Euler's disc for ten turns",
      .rows = {{"change", "worst tilt, precession or energy, relative", "-", 2e-6,
                "steady motion; tolerances of the equation"}},
      .measure = [] {
        const Changes run = changes(euler_disc({}), "event_driven", options(1e-2), 10 * kTurn);
        return Figures{{"change", std::max({double(run.tilt), double(run.precession), double(run.energy)})}};
      }};
}

// Laws of the last velocity, with the arms of another time, are of order one here as for the rattleback.
VerificationCase ten_turns(const std::string& scheme) {
  const double bound = scheme == "d1_minus_linear"                              ? 0.23
                       : scheme == "passive_midpoint"                           ? 0.11
                       : scheme == "moreau_jean" || scheme == "schatzman_paoli" ? 2.1e-3
                                                                                : 0.065;
  return {
      .name = "B8.ten_turns",
      .setting = scheme,
      .what = "Euler's disc for ten turns with the law of the last velocity, h = 0.05 ms",
      .rows = {{"tilt", "worst tilt, relative", "-", bound, "steady motion; guard: order one"},
               {"precession", "worst precession, relative", "-", std::max(bound / 2, 4.2e-3),
                "steady motion; guard: order one"},
               {"way", "shift of the centre", "m", 1e-4, "steady motion; guard: order one"},
               {"order", "order of the tilt, 0.1 to 0.05 ms, off 1", "-", 0.12, "one; guard at these steps"}},
      .measure = [scheme] {
        const CaseScene s = euler_disc({});
        const Changes coarse = changes(s, scheme, options(1e-4), 10 * kTurn),
                      fine = changes(s, scheme, options(5e-5), 10 * kTurn);
        return Figures{{"tilt", fine.tilt},
                       {"precession", fine.precession},
                       {"way", fine.way},
                       {"order", std::abs(std::log2(coarse.tilt / fine.tilt) - 1)}};
      }};
}

// Rolling without slip, of gamma (up) and omega in the body: (TOY-11) and (TOY-12) with the moments of the
// losses (TOY-16). That the first of them loses what its power says is B8.power_of_the_contour.
VecX rolling(const EulerDisc& disc, const VecX& y) {
  const Vec3 up = y.head<3>(), omega = y.tail<3>(), up_rate = up.cross(omega), axis = Vec3::UnitZ();
  const double a = disc.radius, m = disc.mass, level = up.head<2>().norm();
  const Vec3 flat(up.x(), up.y(), 0), flat_rate(up_rate.x(), up_rate.y(), 0);
  const Vec3 rho = -a / level * flat,
             rho_rate = -a / level * (flat_rate - flat * flat.dot(flat_rate) / (level * level));
  const Mat3 I = (m * a * a / 4 * Vec3(1, 1, 2)).asDiagonal(), S = skew(rho);
  const Vec3 contour = disc.contour / (level * level) * (axis - up.z() * up);
  const Vec3 moment = -omega.cross(I * omega) +
                      m * rho.cross(rho_rate.cross(omega) + omega.cross(rho.cross(omega))) +
                      m * kGravity * rho.cross(up) + contour - std::copysign(disc.pivot, omega.dot(up)) * up;
  VecX rate(6);
  rate << up_rate, (I - m * S * S).inverse() * moment;
  return rate;
}
std::function<VecX(double)> exact(const EulerDisc& disc, double t_end) {
  const CaseScene s = euler_disc(disc);
  VecX y(6);
  y << pose(s.state, s.body).R.conjugate() * Vec3::UnitZ(), twist(s.state, s.body).tail<3>();
  return ode_solution([disc](double, const VecX& now) { return rolling(disc, now); }, y, t_end, 1e-4);
}
double tilt_of(const VecX& y) {
  return std::atan2(y.head<2>().norm(), y[2]);
}

/// Followed by a scheme: largest difference of the tilt from the equations [rad].
double off_equations(const EulerDisc& disc, const std::string& name, const SchemeOptions& o, double t_end) {
  const auto y = exact(disc, t_end);
  const CaseScene s = euler_disc(disc);
  Worst worst;
  run_to(s, name, o, t_end, [&](const State& state, const StepReport&) {
    worst.add(std::abs(axis_angle(s, state) - tilt_of(y(std::min(state.t, t_end)))));
  });
  return worst;
}

constexpr EulerDisc kContour{.contour = 8e-5}, kPivot{.pivot = 3e-4};

// alpha^(3/2) falls straight to zero (TOY-17): all of it would take 1.977 s. What the law leaves out is the
// nutation with which it starts, and higher powers of the tilt.
VerificationCase contour_friction() {
  return {
      .name = "B8.contour_friction",
      .what = "Euler's disc with friction along its contour, 1.5 s",
      .rows = {{"law", "worst tilt of the equations up to 1.8 s, off the law, relative", "-", 0.01,
                "closed form (TOY-17), small tilt"},
               {"tilt", "their tilt after 1.8 s", "rad", 0.022, "closed form (TOY-17): 1.977 s to the end"},
               {"exactly", "worst tilt, event_driven", "rad", 1e-6, "equations of rolling; tolerances"},
               {"steps", "worst tilt, moreau_jean, law of the mean velocity, h = 0.1 ms", "rad", 2e-5,
                "equations of rolling; guard: order two"},
               {"order", "order of that, 0.2 to 0.1 ms, off 2", "-", 0.3,
                "two (MJ-10); guard at these steps"}},
      .measure = [] {
        const EulerDisc& d = kContour;
        const double q = std::sqrt(kGravity / d.radius), weight = d.mass * kGravity * d.radius;
        const auto y = exact(d, 1.8);
        Worst off_law;
        for (const double t : {0.3, 0.6, 0.9, 1.2, 1.5, 1.8}) {
          const double law = std::pow(std::pow(kTilt, 1.5) - 2 * d.contour * q / weight * t, 2.0 / 3);
          off_law.add(std::abs(tilt_of(y(t)) / law - 1));
        }
        const double coarse = off_equations(d, "moreau_jean", options(2e-4, kMean), 1.5),
                     fine = off_equations(d, "moreau_jean", options(1e-4, kMean), 1.5);
        return Figures{{"law", off_law},
                       {"tilt", tilt_of(y(1.8))},
                       {"exactly", off_equations(d, "event_driven", options(1e-2), 1.5)},
                       {"steps", fine},
                       {"order", std::abs(std::log2(coarse / fine) - 2)}};
      }};
}

// A moment about the vertical is one about the axis, nearly: before it takes any height it spins the disc up
// (TOY-19), its centre leaves its place, and the law (TOY-18) of a centre at rest does not hold.
VerificationCase pivot_torque() {
  return {.name = "B8.pivot_torque",
          .what = "Euler's disc with a pivot torque, 1 s",
          .rows = {{"spin", "spin of the equations about the axis, off (TOY-19), relative", "-", 0.05,
                    "closed form, small tilt"},
                   {"share", "loss of tilt over that of (TOY-18), off 0.506", "-", 0.01, "guard: half of it"},
                   {"exactly", "worst tilt, event_driven", "rad", 1e-6, "equations of rolling; tolerances"},
                   {"steps", "worst tilt, moreau_jean, law of the mean velocity, h = 0.1 ms", "rad", 2e-5,
                    "equations of rolling; guard: order two"}},
          .measure = [] {
            const EulerDisc& d = kPivot;
            const double t = 1, q = std::sqrt(kGravity / d.radius), weight = d.mass * kGravity * d.radius;
            const double law = std::pow(std::pow(kTilt, -0.5) + 2 * d.pivot * q / (3 * weight) * t, -2);
            const double spin = -2 * d.pivot * t / (3 * d.mass * d.radius * d.radius);
            const VecX y = exact(d, t)(t);
            return Figures{{"spin", std::abs(y[5] / spin - 1)},
                           {"share", std::abs((kTilt - tilt_of(y)) / (kTilt - law) - 0.506)},
                           {"exactly", off_equations(d, "event_driven", options(1e-2), t)},
                           {"steps", off_equations(d, "moreau_jean", options(1e-4, kMean), t)}};
          }};
}

// The equations lose what the power of the contour's moment takes: c times the speed of the contact along the
// rim, in radii.
VerificationCase power_of_the_contour() {
  return {.name = "B8.power_of_the_contour",
          .what = "the equations with friction along the contour, 1 s",
          .rows = {{"along", "path of the contact along the rim", "rad", 100, "the effect is visible",
                    Sense::at_least},
                   {"energy", "energy lost, off the moment times that path", "J", 1e-9, "identity (TOY-16)"}},
          .measure = [] {
            const auto y = exact(kContour, 1);
            const auto energy_at = [&](double t) {
              const VecX now = y(t);
              const Vec3 up = now.head<3>(), omega = now.tail<3>(),
                         rho = -kContour.radius * Vec3(up.x(), up.y(), 0).normalized();
              const double I = kContour.mass * std::pow(kContour.radius, 2) / 4;
              return 0.5 * I * (omega.squaredNorm() + omega.z() * omega.z()) +
                     0.5 * kContour.mass * rho.cross(omega).squaredNorm() +
                     kContour.mass * kGravity * kContour.radius * up.head<2>().norm();
            };
            double along = 0, before = std::atan2(y(0)[1], y(0)[0]);  // by its angle in the body [rad]
            for (int k = 1; k <= 10000; ++k) {
              const VecX now = y(1e-4 * k);
              const double angle = std::atan2(now[1], now[0]);
              along += std::remainder(angle - before, 2 * kPi);
              before = angle;
            }
            const double lost = energy_at(0) - energy_at(1);
            return Figures{{"along", std::abs(along)},
                           {"energy", std::abs(lost - kContour.contour * std::abs(along))}};
          }};
}

// A rim of edges is struck at each of its corners: what a mesh of a wheel loses in one turn has no other
// cause. Finer steps do not help, more corners do.
double lost_in_a_turn(int corners, double h, const std::string& scheme) {
  constexpr double kRound = 1e-3, kPlate = 1e-2;
  const EulerDisc disc;
  const CaseScene smooth = euler_disc(disc);
  CaseScene s;
  s.model.contact_law = {.mu = disc.mu};
  RigidBody plate = fixed_body("plate", add(s.model, prepare(dilate(make_plate(1, 1), kPlate))));
  plate.g_bs = translation(0, 0, -kPlate - kRound);
  add(s.model, plate);
  std::vector<Vec3> rim;
  for (int k = 0; k < corners; ++k)
    rim.push_back(rotation(Vec3::UnitZ(), 2 * kPi * k / corners) * Vec3(0, -disc.radius, 0));
  RigidBody body = smooth.model.bodies[smooth.body];
  body.shape = add(s.model, prepare(dilate(make_complex(rim, {}), kRound)));
  s.body = add(s.model, body);
  s.state = rest_state(s.model);
  pose(s.state, s.body) = pose(smooth.state, smooth.body);
  twist(s.state, s.body) = twist(smooth.state, smooth.body);
  return changes(s, scheme, options(h), kTurn).energy;
}

// As the reference that finds every impact says, to the order of the scheme.
VerificationCase polygon(int corners) {
  return {.name = "B8.polygon",
          .setting = std::to_string(corners) + " corners",
          .what = "Euler's disc with a rim of corners, moreau_jean, one turn",
          .rows = {{"reference", "energy lost in event_driven, relative", "-", 8. / corners,
                    "impacts at corners", Sense::at_least},
                   {"lost", "energy lost at 0.025 ms, off that, relative to it", "-", 0.02,
                    "event_driven; guard: order one"},
                   {"order", "order of it, 0.1 to 0.025 ms", "-", 0.8, "one; guard at these steps",
                    Sense::at_least}},
          .measure = [corners] {
            const double reference = lost_in_a_turn(corners, 1e-2, "event_driven"),
                         coarse = std::abs(lost_in_a_turn(corners, 1e-4, "moreau_jean") - reference),
                         fine = std::abs(lost_in_a_turn(corners, 2.5e-5, "moreau_jean") - reference);
            return Figures{{"reference", reference},
                           {"lost", fine / reference},
                           {"order", std::log2(coarse / fine) / 2}};
          }};
}

VerificationCase no_corners() {
  return {.name = "B8.no_corners",
          .what = "Euler's disc with its circle, moreau_jean, one turn at 0.1 ms",
          .rows = {{"lost", "energy lost, relative", "-", 1e-3, "no impacts; order one"}},
          .measure = [] {
            return Figures{{"lost", changes(euler_disc({}), "moreau_jean", options(1e-4), kTurn).energy}};
          }};
}

}  // namespace

std::vector<VerificationCase> euler_disc_verification() {
  std::vector<VerificationCase> out{steady_motion(), ten_turns_on_the_mean(), ten_turns_exactly()};
  for (const std::string& scheme : scheme_names())
    if (scheme != "event_driven") out.push_back(ten_turns(scheme));
  for (VerificationCase& c :
       std::vector<VerificationCase>{contour_friction(), pivot_torque(), power_of_the_contour(), polygon(32),
                                     polygon(128), no_corners()})
    out.push_back(std::move(c));
  return out;
}

}  // namespace aussois
