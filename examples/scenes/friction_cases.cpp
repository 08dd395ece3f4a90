// SPDX-License-Identifier: Apache-2.0
// Friction on a plate. Coulomb's: a block on a slope, a block pushed to and fro, a sphere that slips until it
// rolls. Contensou's ellipsoid: a disc that slides and spins, a sphere that pivots.
#include <algorithm>
#include <cmath>

#include "examples/scenes/cases.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr double kSide = 0.1, kDensity = 1000, kPlateDilation = 1e-2;  // SI; a block of 1 kg
constexpr double kTouching =
    1e-14;  // overlap of what touches at the start, so that rounding does not decide [m]

/// A cube with sharp edges on a dilated plate; gravity is tilted by `slope` about y, so that x leads down.
CaseScene block_on_slope(double mu, double slope, double speed) {
  CaseScene s;
  s.model.gravity = kGravity * Vec3(std::sin(slope), 0, -std::cos(slope));
  s.model.contact_law = {.mu = mu, .restitution = 0};
  const SimplicialComplex box = make_box(kSide, kSide, kSide);
  const auto plate = add(s.model, prepare(dilate(make_plate(40, 40), kPlateDilation)));
  const auto cube = add(s.model, prepare(dilate(box, 0)));
  add(s.model, fixed_body("plate", plate));
  s.body = add(s.model, solid_body("block", cube, mass_properties(box, kDensity)));
  s.state = rest_state(s.model);
  pose(s.state, s.body).p.z() = kSide / 2 + kPlateDilation - kTouching;
  twist(s.state, s.body)[0] = speed;
  return s;
}

MotionSample on_x(double x, double v) {
  return {.q = Vec3(x, 0, 0), .v = Vec3(v, 0, 0)};
}
/// From where the block starts, and its velocity.
MotionSample block_motion(const CaseScene& s, const State& state) {
  return {.q = pose(state, s.body).p - pose(s.state, s.body).p, .v = twist(state, s.body).head<3>()};
}

/// x(t) from (x, v) at `begin` with constant acceleration.
MotionPiece uniform(double begin, double x, double v, double a) {
  return {begin, [=](double t) {
            const double s = t - begin;
            return on_x(x + v * s + a * s * s / 2, v + a * s);
          }};
}

// B1. Up the slope with the brake of gravity and friction, then down again if friction cannot hold it.
ExactMotion block_sent_up(double mu, double slope, double speed) {
  const double pull = kGravity * std::sin(slope), grip = mu * kGravity * std::cos(slope);
  const double stop = speed / (pull + grip), x = -speed * stop / 2;
  ExactMotion out;
  if (speed > 0) out.pieces.push_back(uniform(0, 0, -speed, pull + grip));
  out.pieces.push_back(uniform(stop, x, 0, std::max(0.0, pull - grip)));
  return out;
}

Case incline_case(const char* name, const char* what, double degrees, double speed) {
  constexpr double kMu = 0.5;
  const double slope = degrees * kPi / 180;
  return {.name = name,
          .what = what,
          .t_end = 0.5,
          .h = 1e-2,
          .scene = [=] { return block_on_slope(kMu, slope, -speed); },
          .observe = block_motion,
          .exact = [=](double) { return block_sent_up(kMu, slope, speed); }};
}

// B2. m x'' = A sin(W t) - friction, m = 1 kg: rest until the push exceeds mu m g, then slip in one direction
// to the instant of v = 0; there it sticks, or slips back at once if the push is too strong.
ExactMotion stick_slip(double mu, double A, double W, double t_end) {
  const double grip = mu * kGravity;
  ExactMotion out;
  double begin = 0, x = 0;
  while (begin < t_end) {
    if (std::abs(A * std::sin(W * begin)) < grip) {
      const auto excess = [=](double t) { return std::abs(A * std::sin(W * t)) - grip; };
      const double from = begin, at = x;
      out.pieces.push_back({from, [at](double) { return on_x(at, 0); }});
      begin = first_root(excess, from, from + 2 * kPi / W, 1e-3 / W);
      continue;
    }
    const double from = begin, at = x, direction = std::sin(W * begin) > 0 ? 1 : -1;
    const auto slip = [=](double t) {
      const double s = t - from;
      return on_x(at + A / W * std::cos(W * from) * s - A / (W * W) * (std::sin(W * t) - std::sin(W * from)) -
                      direction * grip * s * s / 2,
                  A / W * (std::cos(W * from) - std::cos(W * t)) - direction * grip * s);
    };
    out.pieces.push_back({from, slip});
    // The speed is zero at `from` too: look from where it has grown.
    begin = first_root([&](double t) { return direction * slip(t).v[0]; }, from + 1e-2 / W,
                       from + 2 * kPi / W, 1e-3 / W);
    x = slip(begin).q[0];
  }
  return out;
}

CaseScene pushed_block(double mu, double A, double W) {
  CaseScene s = block_on_slope(mu, 0, 0);
  s.model.forces.push_back(
      {.name = "push",
       .add_to = [A, W, body = s.body](const Model&, const State&, double t, GeneralisedForce& force) {
         force.f[first_velocity(body)] += A * std::sin(W * t);
       }});
  return s;
}

Case stick_slip_case(const char* name, const char* what, double A) {
  constexpr double kMu = 0.3, kW = 2;
  return {.name = name,
          .what = what,
          .t_end = 5,
          .h = 2e-2,
          .scene = [=] { return pushed_block(kMu, A, kW); },
          .observe = block_motion,
          .exact = [=](double until) { return stick_slip(kMu, A, kW, until); }};
}

// B3. A solid sphere of 1 kg: the slip u = v + omega x (-R n) keeps its direction and falls at 7/2 mu g; then
// it rolls.
struct SlippingSphere {
  double R = 0.1, mu = 0.2;
  Vec3 v = Vec3::Zero(), omega = Vec3::Zero();  // at the start, in the world
  Vec3 slip() const { return v + omega.cross(Vec3(0, 0, -R)); }
  double rolls_at() const { return 2 * slip().norm() / (7 * mu * kGravity); }
  Vec3 pull() const { return -mu * kGravity * slip().normalized(); }  // acceleration while it slips
};

/// Velocities at the surface: that of the centre and R omega [m/s].
MotionSample sphere_motion(const Vec3& x, const Vec3& v, const Vec3& omega, double R) {
  Vec6 velocity;
  velocity << v, R * omega;
  return {.q = x, .v = velocity};
}

ExactMotion slip_to_roll(const SlippingSphere& s) {
  const double t_roll = s.rolls_at();
  const auto slipping = [s](double t) {
    const Vec3 spin_up = Vec3(0, 0, -s.R).cross(s.pull()) / (0.4 * s.R * s.R);
    return sphere_motion(s.v * t + s.pull() * t * t / 2, s.v + s.pull() * t, s.omega + spin_up * t, s.R);
  };
  const MotionSample begin = slipping(t_roll);
  return {
      .pieces = {{0, slipping}, {t_roll, [=](double t) {
                                   return MotionSample{begin.q + begin.v.head<3>() * (t - t_roll), begin.v};
                                 }}}};
}

CaseScene sphere_on_plate(const SlippingSphere& s) {
  CaseScene out;
  out.model.contact_law = {.mu = s.mu, .restitution = 0};
  const auto plate = add(out.model, prepare(dilate(make_plate(20, 20), kPlateDilation)));
  const auto point = add(out.model, prepare(dilate(make_point(), s.R)));
  add(out.model, fixed_body("plate", plate));
  out.body = add(
      out.model,
      RigidBody{.name = "sphere", .shape = point, .mass = 1, .inertia = 0.4 * s.R * s.R * Mat3::Identity()});
  out.state = rest_state(out.model);
  pose(out.state, out.body).p.z() = s.R + kPlateDilation - kTouching;
  twist(out.state, out.body) << s.v, s.omega;
  return out;
}

// `steps`: until it rolls, of the largest step.
Case slip_to_roll_case(const char* name, const char* what, const Vec3& v, const Vec3& omega, int steps = 50) {
  const SlippingSphere s{.v = v, .omega = omega};
  return {.name = name,
          .what = what,
          .t_end = 1.5 * s.rolls_at(),
          .h = s.rolls_at() / steps,
          .scene = [s] { return sphere_on_plate(s); },
          .observe =
              [s](const CaseScene& scene, const State& state) {
                const Vec6 twist_now = twist(state, scene.body);
                const SE3& g = pose(state, scene.body);
                return sphere_motion(g.p - pose(scene.state, scene.body).p, twist_now.head<3>(),
                                     g.R * twist_now.tail<3>(), s.R);
              },
          .exact = [s](double) { return slip_to_roll(s); }};
}

// B4, B5. A straight slip u with a drilling spin omega under the ellipsoid law, W = R_e omega and s = |(u,
// W)|: u' = -a mu g u / s, W' = -b mu g W / s. In the time tau with dtau = mu g dt / s both decay by
// themselves, u = u_0 exp(-a tau), W = W_0 exp(-b tau); clock and way follow by quadrature (TOY-7), (TOY-8).
struct EllipsoidSlip {
  double mu = 0.3, R_e = 0, a = 1, b = 1;  // [-], [m], [-], [-]
  double u = 0, spin = 0;                  // at the start [m/s], [rad/s]
  double slip(double tau) const { return u * std::exp(-a * tau); }
  double drilling(double tau) const { return R_e * spin * std::exp(-b * tau); }  // [m/s]
};

/// Time and way slipped [m] as functions of tau, and their inverse.
struct SlipClock {
  EllipsoidSlip slip{};
  std::function<VecX(double tau)> t_and_way{};
  std::vector<double> ticks{};  // times at multiples of kTick [s]
  double t_end() const { return ticks.back(); }
  double tau_end() const { return kTick * double(ticks.size() - 1); }
  double rate(double tau) const {  // dt / dtau [s]
    return std::hypot(slip.slip(tau), slip.drilling(tau)) / (slip.mu * kGravity);
  }
  double tau(double t) const {
    const auto after = std::ranges::upper_bound(ticks, t);
    if (t <= 0 || after == ticks.end()) return t <= 0 ? 0 : tau_end();
    double tau = kTick * double(after - ticks.begin() - 1);
    for (int k = 0; k < 4; ++k) tau += (t - t_and_way(tau)[0]) / rate(tau);  // Newton: t is smooth in tau
    return tau;
  }
  static constexpr double kTick = 0.05;
};
SlipClock clock_of(const EllipsoidSlip& slip, double tau_end) {
  SlipClock out{.slip = slip};
  const auto rates = [out](double tau, const VecX&) -> VecX {
    return out.rate(tau) * Vec2(1, out.slip.slip(tau));
  };
  out.t_and_way = ode_solution(rates, Vec2::Zero(), tau_end, SlipClock::kTick);
  for (int k = 0; k * SlipClock::kTick <= tau_end; ++k)
    out.ticks.push_back(out.t_and_way(k * SlipClock::kTick)[0]);
  return out;
}

/// Of a body that moves along x: the way, its speed and that of the drilling, R omega.
MotionSample sliding_and_spinning(double x, double v, double drilling) {
  return {.q = VecX::Constant(1, x), .v = Vec2(v, drilling)};
}

/// A disc of 1 kg and radius R: a = 1, b = 2 (R_e / R)^2 (B4). It touches in one point below its centre.
struct SpinningDisc {
  double R = 0.1, v = 1, spin = 10, mu = 0.3;
  double R_e() const { return 2 * R / 3; }  // of uniform pressure
  EllipsoidSlip slip() const {
    return {.mu = mu, .R_e = R_e(), .b = 2 * std::pow(R_e() / R, 2), .u = v, .spin = spin};
  }
};
CaseScene disc_scene(const SpinningDisc& disc) {
  constexpr double kFoot = 5e-3;
  CaseScene out;
  out.model.contact_law = {.mu = disc.mu, .contensou_radius = disc.R_e()};
  const auto plate = add(out.model, prepare(dilate(make_plate(20, 20), kPlateDilation)));
  const auto point = add(out.model, prepare(dilate(make_point(), kFoot)));
  add(out.model, fixed_body("plate", plate));
  const double J = disc.R * disc.R / 4;
  out.body = add(out.model, RigidBody{.name = "disc",
                                      .shape = point,
                                      .g_bs = translation(0, 0, kFoot),
                                      .mass = 1,
                                      .inertia = Vec3(J, J, 2 * J).asDiagonal()});
  out.state = rest_state(out.model);
  pose(out.state, out.body).p.z() = kPlateDilation - kTouching;
  twist(out.state, out.body)[0] = disc.v;
  twist(out.state, out.body)[5] = disc.spin;
  return out;
}
ExactMotion disc_motion(const SpinningDisc& disc) {
  const EllipsoidSlip s = disc.slip();
  const SlipClock clock = clock_of(s, 40);  // exp(-35) of it is left
  const double way = clock.t_and_way(clock.tau_end())[1];
  return {.pieces = {{0,
                      [=](double t) {
                        const double tau = clock.tau(t);
                        return sliding_and_spinning(clock.t_and_way(tau)[1], s.slip(tau),
                                                    disc.R / disc.R_e() * s.drilling(tau));
                      }},
                     {clock.t_end(), [=](double) { return sliding_and_spinning(way, 0, 0); }}}};
}
Case disc_case(const char* name, const char* what, double v, double spin) {
  const SpinningDisc disc{.v = v, .spin = spin};
  const double stop = clock_of(disc.slip(), 40).t_end();
  return {.name = name,
          .what = what,
          .t_end = 1.2 * stop,
          .h = stop / 40,
          .scene = [disc] { return disc_scene(disc); },
          .observe =
              [disc](const CaseScene& s, const State& state) {
                return sliding_and_spinning(pose(state, s.body).p.x(), twist(state, s.body)[0],
                                            disc.R * twist(state, s.body)[5]);
              },
          .exact = [disc](double) { return disc_motion(disc); }};
}

/// B5. A sphere of 1 kg: a = 7/2, b = 5/2 (R_e / R)^2; v falls by 2/7 of what the slip falls. While it spins
/// fast the slip decays exponentially: it never sticks.
struct PivotingSphere {
  double R = 0.05, v = 1, spin = 100, mu = 0.3;
  double R_e() const { return 3 * kPi / 16 * 2e-3; }  // of a Hertz contact of 2 mm
  EllipsoidSlip slip() const {
    return {.mu = mu, .R_e = R_e(), .a = 3.5, .b = 2.5 * std::pow(R_e() / R, 2), .u = v, .spin = spin};
  }
};
CaseScene pivoting_scene(const PivotingSphere& sphere) {
  CaseScene out =
      sphere_on_plate({.R = sphere.R, .mu = sphere.mu, .v = {sphere.v, 0, 0}, .omega = {0, 0, sphere.spin}});
  out.model.contact_law.contensou_radius = sphere.R_e();
  return out;
}
ExactMotion pivoting_motion(const PivotingSphere& sphere, double t_end) {
  const EllipsoidSlip s = sphere.slip();
  double tau_end = 1;
  while (clock_of(s, tau_end).t_end() < t_end) tau_end *= 2;
  const SlipClock clock = clock_of(s, tau_end);
  return {.pieces = {{0, [=](double t) {
                        const double tau = clock.tau(t), rolled = 5.0 / 7 * s.u * t;
                        return sliding_and_spinning(rolled + 2.0 / 7 * clock.t_and_way(tau)[1],
                                                    5.0 / 7 * s.u + 2.0 / 7 * s.slip(tau),
                                                    sphere.R / sphere.R_e() * s.drilling(tau));
                      }}}};
}
Case pivoting_case(const char* name, const char* what) {
  const PivotingSphere sphere;
  return {.name = name,
          .what = what,
          .t_end = 0.3,
          .h = 4e-3,
          .scene = [sphere] { return pivoting_scene(sphere); },
          .observe =
              [sphere](const CaseScene& s, const State& state) {
                const Vec3 omega = pose(state, s.body).R * Vec3(twist(state, s.body).tail<3>());
                return sliding_and_spinning(pose(state, s.body).p.x(), twist(state, s.body)[0],
                                            sphere.R * omega.z());
              },
          .exact = [sphere](double until) { return pivoting_motion(sphere, until); }};
}

}  // namespace

std::vector<Case> friction_cases() {
  return {incline_case("incline_30", "a block slides down a slope of 30 deg, mu = 1/2 (B1)", 30, 0),
          incline_case("incline_30_up", "a block sent up 30 deg stops and slides back (B1)", 30, 2),
          incline_case("incline_20_up", "a block sent up 20 deg stays where it stops (B1)", 20, 2),
          stick_slip_case("stick_slip", "a block under 6 N sin 2t slips, sticks, slips back (B2)", 6),
          stick_slip_case("reversal", "a block under 12 N sin 2t turns back without sticking (B2)", 12),
          slip_to_roll_case("bowling", "a sphere slips until it rolls (B3)", {5, 0, 0}, {0, 0, 0}),
          slip_to_roll_case("back_spin", "a sphere with back spin (B3)", {5, 0, 0}, {0, -80, 0}),
          // the torque of a contact looked at at the end is turned by h omega: 0.6 rad in a fiftieth
          slip_to_roll_case("side_spin", "a sphere with side and pivot spin, on a curved path (B3)",
                            {3, 0, 0}, {40, 0, 10}, 200),
          disc_case("spinning_disc", "a disc that slides and spins, ellipsoid law (B4)", 1, 10),
          disc_case("sliding_disc", "a disc that slides more than it spins (B4)", 1, 2),
          pivoting_case("pivoting_sphere", "a sphere that slips, rolls and pivots, ellipsoid law (B5)")};
}

}  // namespace aussois
