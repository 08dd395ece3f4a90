// SPDX-License-Identifier: Apache-2.0
// A ball above a plate: falling, on a spring, on a spring that is shaken. Without friction, so height and
// speed are all there is.
#include <cmath>

#include "examples/scenes/cases.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr double kRadius = 0.05;      // of the ball and of the plate [m]
constexpr double kLastSpeed = 1e-12;  // a ball that leaves slower is at rest [m/s]

MotionSample along_z(double z, double v) {
  return {.q = VecX::Constant(1, z), .v = VecX::Constant(1, v)};
}

/// A dilated point of 1 kg; z = 0 where it touches the plate, whose top is `top` above the world's origin.
CaseScene ball_over_plate(double e, double z, double v, double top = 0) {
  CaseScene s;
  s.model.contact_law = {.mu = 0, .restitution = e};
  const auto plate = add(s.model, prepare(dilate(make_plate(2, 2), kRadius)));
  const auto point = add(s.model, prepare(dilate(make_point(), kRadius)));
  const auto ground = add(s.model, fixed_body("plate", plate));
  s.body = add(
      s.model,
      RigidBody{
          .name = "ball", .shape = point, .mass = 1, .inertia = 0.4 * kRadius * kRadius * Mat3::Identity()});
  s.state = rest_state(s.model);
  pose(s.state, ground).p.z() = top - 2 * kRadius;
  pose(s.state, s.body).p = Vec3(0.03, 0.02, top + z);
  twist(s.state, s.body)[2] = v;
  return s;
}

/// z and its speed, z = 0 at the world's origin.
MotionSample height(const CaseScene& s, const State& state) {
  return along_z(pose(state, s.body).p.z(), twist(state, s.body)[2]);
}

/// m z'' = -k z + A cos(W t + phase), k = 1 N/m, along z.
ForceLaw shaken_spring(BodyId body, double A, double W, double phase) {
  return {.name = "spring",
          .add_to =
              [=](const Model&, const State& state, double t, GeneralisedForce& force) {
                const int row = first_velocity(body) + 2;
                force.f[row] += -pose(state, body).p.z() + A * std::cos(W * t + phase);
                force.K.emplace_back(row, row, 1.0);
              },
          .potential =
              [=](const Model&, const State& state, double t) {
                const double z = pose(state, body).p.z();
                return z * z / 2 - A * z * std::cos(W * t + phase);
              }};
}

// A1. Free fall, then ever shorter hops: e < 1 ends them in finite time.
ExactMotion bouncing_ball(double e, double drop, double t_end) {
  ExactMotion out;
  const auto add_flight = [&](double begin, double z, double v) {
    out.pieces.push_back({begin, [=](double t) {
                            const double s = t - begin;
                            return along_z(z + v * s - kGravity * s * s / 2, v - kGravity * s);
                          }});
  };
  add_flight(0, drop, 0);
  double begin = std::sqrt(2 * drop / kGravity);
  double speed = e * kGravity * begin;
  for (; speed > kLastSpeed && begin < t_end; speed *= e) {
    add_flight(begin, 0, speed);
    begin += 2 * speed / kGravity;
  }
  if (speed <= kLastSpeed) out.pieces.push_back({begin, [](double) { return along_z(0, 0); }});
  return out;
}

Case bouncing_ball_case(const char* name, double e, double t_end) {
  constexpr double kDrop = 1;
  return {.name = name,
          .what = "a ball dropped from 1 m (A1)",
          .t_end = t_end,
          .h = e > 0 && e < 1 ? 2e-3 : 5e-3,  // the last hops of a ball that comes to rest need small steps
          .bounces = e > 0,
          .lands = e == 0,
          .hops_out = e > 0 && e < 1,
          .scene = [e] { return ball_over_plate(e, kDrop, 0); },
          .observe = height,
          .exact = [e](double until) { return bouncing_ball(e, kDrop, until); }};
}

// A2. z'' = -z above a stop at z = -1/2: arcs of circles in the phase plane.
constexpr double kStop = -0.5;

ExactMotion impact_oscillator(double e, double t_end) {
  ExactMotion out;
  double begin = 0, z = 1, v = 0;
  while (begin < t_end) {
    const double amplitude = std::hypot(z, v),
                 phase = std::atan2(-v, z);  // z = amplitude cos(t - begin + phase)
    out.pieces.push_back({begin, [=](double t) {
                            const double s = t - begin + phase;
                            return along_z(amplitude * std::cos(s), -amplitude * std::sin(s));
                          }});
    // Meets the stop on its way down: at the angle whose cosine is stop / amplitude, in the upper half turn.
    double turn = std::acos(kStop / amplitude) - phase;
    while (turn <= 1e-9) turn += 2 * kPi;
    v = e * amplitude * std::sin(turn + phase);
    z = kStop, begin += turn;
  }
  return out;
}

CaseScene impact_oscillator_scene(double e) {
  CaseScene s = ball_over_plate(e, 1 - kStop, 0, kStop);
  s.model.gravity = Vec3::Zero();
  s.model.forces.push_back(shaken_spring(s.body, 0, 0, 0));
  return s;
}

// A3. z'' = -z + A cos(W t) above a stop at z = 0, on its orbit with one impact in each period T of the
// force: with t from an impact, z = c cos t + d sin t + B cos(W t + phase), z(0) = z(T) = 0, v(0) = -e v(T).
struct PeriodicOrbit {
  double A = 1, W = 1, e = 0;
  double period = 0, c = 0, d = 0, B = 0, phase = 0;
  MotionSample at(double t) const {
    return along_z(c * std::cos(t) + d * std::sin(t) + B * std::cos(W * t + phase),
                   -c * std::sin(t) + d * std::cos(t) - B * W * std::sin(W * t + phase));
  }
};

PeriodicOrbit periodic_orbit(double A, double W, double e) {
  PeriodicOrbit o{.A = A, .W = W, .e = e, .period = 2 * kPi / W, .B = A / (1 - W * W)};
  // d = c tan(T/2) closes the orbit; the impact law then gives the phase, up to half a turn.
  o.phase = std::atan(-std::tan(o.period / 2) * (1 - e) / (W * (1 + e)));
  for (int half = 0; half < 2; ++half, o.phase += kPi) {
    o.c = -o.B * std::cos(o.phase), o.d = o.c * std::tan(o.period / 2);
    if (o.at(o.period / 2).q[0] > 0 && o.at(0).v[0] > 0) break;  // the other one goes through the stop
  }
  return o;
}

// The run starts in the middle between two impacts.
ExactMotion forced_oscillator(const PeriodicOrbit& o, double t_end) {
  ExactMotion out;
  for (int k = 0; (k - 0.5) * o.period < t_end; ++k)
    out.pieces.push_back({std::max(0.0, (k - 0.5) * o.period),
                          [o, shift = (k - 0.5) * o.period](double t) { return o.at(t - shift); }});
  return out;
}

CaseScene forced_oscillator_scene(const PeriodicOrbit& o) {
  const MotionSample start = o.at(o.period / 2);
  CaseScene s = ball_over_plate(o.e, start.q[0], start.v[0]);
  s.model.gravity = Vec3::Zero();
  s.model.forces.push_back(shaken_spring(s.body, o.A, o.W, o.phase + o.W * o.period / 2));
  return s;
}

// `periods`: few where the orbit is unstable; near it errors grow by the factor named in each period.
Case forced_oscillator_case(const char* name, double W, double e, double periods) {
  const PeriodicOrbit orbit = periodic_orbit(1, W, e);
  return {.name = name,
          .what = "a spring and a harmonic force drive a ball against a stop, once a period (A3)",
          .t_end = periods * orbit.period,
          .h = orbit.period / 200,
          .bounces = true,
          .scene = [orbit] { return forced_oscillator_scene(orbit); },
          .observe = height,
          .exact = [orbit](double until) { return forced_oscillator(orbit, until); }};
}

}  // namespace

std::vector<Case> impact_cases() {
  return {bouncing_ball_case("ball_e0", 0, 1.0),
          bouncing_ball_case("ball_e05", 0.5, 1.5),
          bouncing_ball_case("ball_e1", 1, 3.0),
          {.name = "oscillator_e08",
           .what = "a spring pulls a ball against a stop (A2)",
           .t_end = 12,
           .h = 2e-2,
           .bounces = true,
           .scene = [] { return impact_oscillator_scene(0.8); },
           .observe = height,
           .exact = [](double until) { return impact_oscillator(0.8, until); }},
          forced_oscillator_case("forced_26", 2.6, 0.8, 5.25),   // 0.8
          forced_oscillator_case("forced_28", 2.8, 0.8, 2.25),   // 3.0
          forced_oscillator_case("forced_46", 4.6, 0.7, 1.25)};  // 35
}

}  // namespace aussois
