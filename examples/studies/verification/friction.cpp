// SPDX-License-Identifier: Apache-2.0
// Group B: friction and rolling. B6 is in tippe_top.cpp, B7 in rattleback.cpp, B8 in euler_disc.cpp.
#include <algorithm>

#include "examples/scenes/cases.hpp"
#include "examples/studies/verification/rolling_bodies.hpp"
#include "examples/studies/verification/running.hpp"
#include "examples/studies/verification/tippe_top.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

CaseScene block_on(double mu, double slope) {
  CaseScene s = case_named("incline_30").scene();
  s.model.gravity = kGravity * Vec3(std::sin(slope), 0, -std::cos(slope));
  s.model.contact_law.mu = mu;
  return s;
}

// Below the friction angle a block rests for ever. On the angle, which is that of mu = 0.5 to the last digit,
// it takes rounding for an acceleration, and event_driven for a slip of 1e-9 m/s that does not end; on the
// same slope mu = 0.49 lets it slide.
VerificationCase incline(const std::string& scheme) {
  const bool event_driven = scheme == "event_driven";
  return {.name = "B1.incline",
          .setting = scheme,
          .what = "block on a slope, mu = 1/2, steps of 10 ms (event_driven: 1 s)",
          .rows = {{"creep", "distance in 10 s on tan a = 0.45", "m", 1e-13, "closed form; agreed: 1e-10"},
                   {"on_the_angle", "distance in 10 s on tan a = mu", "m", event_driven ? 1e-8 : 1e-10,
                    "undecidable; rounding, over 10 s"},
                   {"slide", "distance in 1 s at mu = 0.49, off a t^2 / 2", "m", 1e-6,
                    "closed form; rounding of a slow slip"}},
          .measure = [=] {
            const double angle = std::atan(0.5), pull = kGravity * (std::sin(angle) - 0.49 * std::cos(angle));
            const auto way = [&](double mu, double slope, double t) {
              const CaseScene s = block_on(mu, slope);
              const SchemeOptions o = exact_options(event_driven ? 1 : 1e-2, NormalLaw::combined, 1e-12);
              return Vec3(pose(run_to(s, scheme, o, t), s.body).p - pose(s.state, s.body).p);
            };
            return Figures{{"creep", way(0.5, std::atan(0.45), 10).norm()},
                           {"on_the_angle", way(0.5, angle, 10).norm()},
                           {"slide", std::abs(way(0.49, angle, 1).x() - pull / 2)}};
          }};
}

// A cone, not a pyramid: the way down does not depend on where the slope points, nor on how the block is
// turned.
VerificationCase every_direction() {
  return {.name = "B1.every_direction",
          .what = "block down 30 degrees for 0.5 s in steps of 5 ms, slope and block turned about the normal",
          .rows = {{"way", "worst difference from the path along x", "m", 1e-9,
                    "isotropy; rounding of 100 steps"}},
          .measure = [] {
            const CaseScene along_x = case_named("incline_30").scene();
            const SchemeOptions o = exact_options(5e-3);
            const double way = pose(run_to(along_x, "moreau_jean", o, 0.5), along_x.body).p.x();
            Worst off;
            for (const double turn : {0.0, kPi / 4})
              for (const double direction : {kPi / 4, 1.0}) {
                CaseScene s = case_named("incline_30").scene();
                s.model.gravity = rotation(Vec3::UnitZ(), direction) * s.model.gravity;
                pose(s.state, s.body).R = rotation(Vec3::UnitZ(), turn).R;
                const Vec3 p = pose(run_to(s, "moreau_jean", o, 0.5), s.body).p;
                off.add(std::abs(p.x() - way * std::cos(direction)));
                off.add(std::abs(p.y() - way * std::sin(direction)));
              }
            return Figures{{"way", off}};
          }};
}

// Slip begins, turns and ends.
VerificationCase stick_slip(const std::string& scene) {
  constexpr double h = 1e-3;
  const std::size_t changes = case_named(scene).exact(5).pieces.size() - 1;
  return {.name = "B2.stick_slip",
          .setting = scene,
          .what = case_named(scene).what + "; moreau_jean, theta 1/2, h = 1 ms, 5 s",
          .rows = {{"changes", "changes of the direction of slip", "-", double(changes), "closed form",
                    Sense::exactly},
                   {"time", "worst time of a change", "s", 3 * h, "closed form; three steps"}},
          .measure = [=] {
            const CaseScene s = case_named(scene).scene();
            const ExactMotion exact = case_named(scene).exact(5);
            std::size_t count = 0;
            Worst off;
            int direction = 0;  // of slip; 0: stick
            run_to(s, "moreau_jean", exact_options(h), 5, [&](const State& state, const StepReport&) {
              const double v = twist(state, s.body)[0];
              const int now = v > 1e-6 ? 1 : v < -1e-6 ? -1 : 0;
              if (now == 0 || now == direction) return;
              direction = now;
              if (++count <= changes) off.add(std::abs(state.t - exact.pieces[count].begin));
            });
            return Figures{{"changes", double(count)}, {"time", off}};
          }};
}

// Friction is constant while the sphere slips: with a step that divides t*, nothing is left but rounding.
VerificationCase slip_to_roll(const std::string& scene) {
  return {
      .name = "B3.rolling",
      .setting = scene,
      .what = case_named(scene).what + "; moreau_jean, theta 1, h = t*/50",
      .rows = {{"velocity", "velocity at the end, relative", "-", 1e-12, "closed form; agreed"},
               {"pivot", "pivot spin at the end", "rad/s", 1e-12, "closed form: it does not change"}},
      .measure = [scene] {
        const Case& c = case_named(scene);
        const CaseScene s = c.scene();
        const ExactMotion exact = c.exact(c.t_end);
        SchemeOptions o = exact_options(exact.pieces[1].begin / 50);
        o.moreau_jean.theta = 1;
        const VecX v = c.observe(s, run_to(s, "moreau_jean", o, c.t_end)).v,
                   right = evaluate(exact, c.t_end).v;
        return Figures{{"velocity", (v - right).norm() / right.norm()}, {"pivot", std::abs(v[5] - right[5])}};
      }};
}

// The kernel's law is the ellipsoid, F = e / n and T = (4/9) / n with n = hypot(e, 2/3), of the slip e = v /
// (R omega): how far from the law of a uniform pressure. Read off a single step.
VerificationCase ellipsoid() {
  return {.name = "B4.ellipsoid",
          .what = "disc of 0.1 m at the slips of the shared table, one step of 10 us",
          .rows = {{"force", "worst force, off the ellipsoid's, relative", "-", 1e-4,
                    "closed form; h mu g / R omega"},
                   {"torque", "worst torque, off the ellipsoid's, relative", "-", 1e-4,
                    "closed form; h mu g / R omega"},
                   {"force_of_disc", "largest distance from the force of the disc, off 0.117 mu N", "-", 1e-3,
                    "quadrature in the shared table"},
                   {"torque_of_disc", "largest distance from the torque of the disc, off 0.097 mu N R", "-",
                    1e-3, "quadrature in the shared table"},
                   {"pade", "Pade forms of the table", "-", 1e-12, "closed form"}},
          .measure = [] {
            constexpr double R = 0.1, kMu = 0.3, kSpin = 10, h = 1e-5;
            Worst off_force, off_torque, force_of_disc, torque_of_disc, pade;
            for (const SeriesRow& row : shared_series("contensou_disc_coefficients.csv")) {
              const double e = row.at("eps_v_over_Rw"), n = std::hypot(e, 2.0 / 3);
              CaseScene s = case_named("spinning_disc").scene();
              twist(s.state, s.body)[0] = e * R * kSpin, twist(s.state, s.body)[5] = kSpin;
              const State end = run_to(s, "moreau_jean", exact_options(h, NormalLaw::combined, 1e-12), h);
              const double force = (e * R * kSpin - twist(end, s.body)[0]) / (h * kMu * kGravity),
                           torque = (kSpin - twist(end, s.body)[5]) * R / 2 / (h * kMu * kGravity);
              off_force.add(std::abs(force / (e / n) - 1));
              off_torque.add(std::abs(torque / (4.0 / 9 / n) - 1));
              force_of_disc.add(std::abs(e / n - row.at("F_over_muN")));
              torque_of_disc.add(std::abs(4.0 / 9 / n - row.at("T_over_muNR")));
              pade.add(std::abs(row.at("F_pade") - e / (1 + e)));
              pade.add(std::abs(row.at("T_pade") - (2.0 / 3) / (1 + 4.0 / 3 * e)));
            }
            return Figures{{"force", off_force},
                           {"torque", off_torque},
                           {"force_of_disc", std::abs(force_of_disc - 0.117)},    // 0.123 at e = 0.40
                           {"torque_of_disc", std::abs(torque_of_disc - 0.097)},  // 0.100 at e = 1.27
                           {"pade", pade}};
          }};
}

// What that makes of the motion: the disc stops sooner.
VerificationCase stop_of_the_disc(double spin, double time, double way) {
  char setting[32], times[64], ways[64];
  std::snprintf(setting, sizeof setting, "%g rad/s", spin);
  std::snprintf(times, sizeof times, "time of the stop over the disc's, off %.3f", time);
  std::snprintf(ways, sizeof ways, "distance over the disc's, off %.3f", way);
  return {.name = "B4.stop_of_the_disc",
          .setting = setting,
          .what = "disc of 0.1 m, 1 m/s and a spin, moreau_jean, h = 0.2 ms, until it rests",
          .rows = {{"time", times, "-", 2e-3, "ellipsoid law against the shared disc; five steps"},
                   {"way", ways, "-", 2e-3, "ellipsoid law against the shared disc"}},
          .measure = [=] {
            const std::vector<SeriesRow> rows = shared_series("contensou_disc_motion.csv");
            const auto row =
                std::ranges::find_if(rows, [&](const SeriesRow& r) { return r.at("w0") == spin; });
            if (row == rows.end()) throw MissingData("contensou_disc_motion.csv has no such spin");
            CaseScene s = case_named("spinning_disc").scene();
            twist(s.state, s.body)[0] = 1, twist(s.state, s.body)[5] = spin;
            double stop = 0;
            const State end = run_to(s, "moreau_jean", exact_options(2e-4, NormalLaw::combined, 1e-12), 1,
                                     [&](const State& now, const StepReport&) {
                                       if (twist(now, s.body).norm() > 1e-6) stop = now.t;
                                     });
            const double gone = pose(end, s.body).p.x() - pose(s.state, s.body).p.x();
            return Figures{{"time", std::abs(stop / row->at("t_stop_s") - time)},
                           {"way", std::abs(gone / row->at("path_m") - way)}};
          }};
}

SchemeOptions spinning_options(double h) {
  return {.step = {.h = h, .solver = {.tolerance = 1e-12}, .advancement = {.certify = false}},
          .moreau_jean = {.theta = 0.5}};
}

// Contensou's friction, against the closed motion of its ellipsoid law.
VerificationCase slide_and_spin(const std::string& scheme) {
  constexpr double h = 1e-3;
  return {.name = "B4.contensou",
          .setting = scheme,
          .what = "two discs and a sphere that slide and spin, h = 1 ms, at 0.3, 0.7 and all of their time",
          .rows = {{"position", "worst position", "m", 2 * h, "closed form; order one: 2 h"},
                   {"velocity", "worst velocity", "m/s, m rad/s", 5 * h, "closed form; order one: 5 h"}},
          .measure = [scheme] {
            Worst position, velocity;
            for (const char* name : {"spinning_disc", "sliding_disc", "pivoting_sphere"}) {
              const Case& c = case_named(name);
              const CaseScene s = c.scene();
              const ExactMotion exact = c.exact(c.t_end);
              for (const double part : {0.3, 0.7, 1.0}) {
                const double t = part * c.t_end;
                const MotionSample computed = c.observe(s, run_to(s, scheme, spinning_options(h), t)),
                                   right = evaluate(exact, t);
                position.add((computed.q - right.q).norm());
                velocity.add((computed.v - right.v).norm());
              }
            }
            return Figures{{"position", position}, {"velocity", velocity}};
          }};
}

/// The plate follows its own velocity and spin about z.
void move_plate(CaseScene& s, const Vec3& v, double spin, double t_end) {
  constexpr double kRow = 0.05;
  Trajectory path;
  for (int k = 0; (k - 1) * kRow < t_end; ++k) {
    const double t = k * kRow;
    path.t.push_back(t);
    path.pose.push_back({rotation(Vec3::UnitZ(), spin * t).R, t * v});
  }
  s.model.bodies[0].motion = PrescribedMotion{path};
}

// Galilei: on a plate that moves straight on, the same motion beside it.
VerificationCase moving_plate(const std::string& scheme) {
  return {.name = "B4.moving_plate",
          .setting = scheme,
          .what = "disc that slides and spins for 0.3 s on a plate at 0.5 m/s and on one at rest, h = 2 ms",
          .rows = {{"position", "difference of positions beside the plate", "m", 1e-8,
                    "Galilean invariance; guard, rounding may move events"},
                   {"velocity", "difference of velocities beside the plate", "m/s", 1e-8,
                    "Galilean invariance; guard, rounding may move events"},
                   {"spin", "difference of spins", "rad/s", 1e-7, "Galilean invariance; the same over R"}},
          .measure = [scheme] {
            constexpr double t = 0.3;
            const Vec3 v(0.4, -0.3, 0);
            const CaseScene still = case_named("spinning_disc").scene();
            CaseScene moving = case_named("spinning_disc").scene();
            move_plate(moving, v, 0, 1);
            twist(moving.state, moving.body).head<3>() += v;
            twist(moving.state, 0).head<3>() = v;
            const State a = run_to(still, scheme, spinning_options(2e-3), t),
                        b = run_to(moving, scheme, spinning_options(2e-3), t);
            return Figures{
                {"position", (pose(b, moving.body).p - t * v - pose(a, still.body).p).norm()},
                {"velocity", (twist(b, moving.body).head<3>() - v - twist(a, still.body).head<3>()).norm()},
                {"spin", std::abs(twist(b, moving.body)[5] - twist(a, still.body)[5])}};
          }};
}

// On a turntable of 8 rad/s a disc of 30 rad/s loses 2 mu g R_e / R^2 per second until it goes along.
VerificationCase turntable(const std::string& scheme) {
  constexpr double kTable = 8, kBegin = 30, R = 0.1, kRate = 2 * 0.3 * kGravity * (2 * R / 3) / (R * R);
  const double h = scheme == "event_driven" ? 2e-2 : 2e-3;
  return {.name = "B4.turntable",
          .setting = scheme,
          .what = "disc of 30 rad/s on a turntable of 8 rad/s, h = 2 ms (event_driven: 20 ms)",
          .rows = {{"braking", "spin halfway", "rad/s", kRate * h, "closed form; one step of braking"},
                   {"caught", "spin two steps after it is caught, off the table's", "rad/s", 1e-6,
                    "closed form; solver"},
                   {"carried", "spin half as long after that, off the table's", "rad/s", 1e-6,
                    "closed form; solver"}},
          .measure = [=] {
            const double caught = (kBegin - kTable) / kRate;
            CaseScene s = case_named("spinning_disc").scene();
            move_plate(s, Vec3::Zero(), kTable, 2);
            twist(s.state, 0)[5] = kTable;
            twist(s.state, s.body) << 0, 0, 0, 0, 0, kBegin;
            const auto spin = [&](double t) {
              return twist(run_to(s, scheme, spinning_options(h), t), s.body)[5];
            };
            return Figures{{"braking", std::abs(spin(0.5 * caught) - (kBegin - kRate * 0.5 * caught))},
                           {"caught", std::abs(spin(caught + 2 * h) - kTable)},
                           {"carried", std::abs(spin(1.5 * caught) - kTable)}};
          }};
}

// The closed motion of the disc stops both at once; slip over drilling speed falls as exp(-(1 - b) tau), b =
// 8/9.
VerificationCase closed_motion() {
  return {.name = "B4.closed_motion",
          .what = "the closed motion that B4.contensou is compared with",
          .rows = {{"exponent", "log of drilling over log of slip, off 8/9", "-", 1e-9, "closed form"},
                   {"stop", "slip and drilling 1e-9 before the stop", "m/s", 1e-7,
                    "closed form: both stop at once"},
                   {"slip", "slip there", "m/s", 1e-300, "closed form: not before", Sense::at_least}},
          .measure = [] {
            const ExactMotion exact = case_named("spinning_disc").exact(case_named("spinning_disc").t_end);
            const double stop = exact.pieces[1].begin, R_e = 0.2 / 3;
            const auto slip_and_drilling = [&](double t) {
              const VecX v = evaluate(exact, t).v;
              return Vec2(v[0], v[1] / 0.1 * R_e);
            };
            Worst exponent;
            for (const double part : {0.1, 0.5, 0.9}) {
              const Vec2 v = slip_and_drilling(part * stop);
              exponent.add(std::abs(std::log(v[1] / (10 * R_e)) / std::log(v[0]) - 8.0 / 9));
            }
            const Vec2 last = slip_and_drilling(stop * (1 - 1e-9));
            return Figures{{"exponent", exponent}, {"stop", last.norm()}, {"slip", last[0]}};
          }};
}

// Three seconds: rolling since 0.1 s, then the pivot spin falls by 5/2 mu g R_e / R^2 per second.
VerificationCase pivoting_sphere() {
  return {.name = "B5.pivoting_sphere",
          .what = "sphere of 50 mm, 1 m/s, pivot spin 100 rad/s, moreau_jean, h = 1 ms, 3 s",
          .rows = {{"decay", "decay of the pivot spin in the closed motion, two seconds", "rad/s", 1e-9,
                    "closed form 5/2 mu g R_e / R^2"},
                   {"rolls", "its speed, off 5/7", "m/s", 1e-12, "closed form: no slip is left"},
                   {"velocity", "speed at the end", "m/s", 3e-4, "closed form; order one, h = 1 ms"},
                   {"spin", "pivot spin at the end", "rad/s", 3e-3, "closed form; order one: 3 h"},
                   {"position", "position at the end", "m", 1e-3, "closed form; order one: h"}},
          .measure = [] {
            constexpr double R = 0.05, R_e = 3 * kPi / 16 * 2e-3,
                             kRate = 2.5 * 0.3 * kGravity * R_e / (R * R), t = 3;
            const Case& c = case_named("pivoting_sphere");
            const CaseScene s = c.scene();
            const ExactMotion exact = c.exact(t);
            const MotionSample right = evaluate(exact, t),
                               computed = c.observe(s, run_to(s, "moreau_jean", spinning_options(1e-3), t));
            return Figures{{"decay", std::abs((evaluate(exact, 1).v[1] - right.v[1]) / R - 2 * kRate)},
                           {"rolls", std::abs(right.v[0] - 5.0 / 7)},
                           {"velocity", std::abs(computed.v[0] - right.v[0])},
                           {"spin", std::abs(computed.v[1] - right.v[1]) / R},
                           {"position", std::abs(computed.q[0] - right.q[0])}};
          }};
}

CaseScene painleve_rod() {
  const double J = 1.0 / 3;
  CaseScene s;
  s.model.contact_law = {.mu = 2, .restitution = 0};
  const auto plate = add(s.model, prepare(dilate(make_plate(4, 4), 0.05)));
  const auto rod = add(s.model, prepare(dilate(make_segment(2), 0)));
  add(s.model, fixed_body("plate", plate));
  s.body = add(s.model,
               RigidBody{.name = "rod", .shape = rod, .mass = 1, .inertia = Vec3(1e-6, J, J).asDiagonal()});
  s.state = rest_state(s.model);
  pose(s.state, s.body).R = rotation(Vec3::UnitY(), -kPi / 4).R;  // its tip at -x, rising towards +x
  pose(s.state, s.body).p = Vec3(0, 0, 0.05 - 1e-14 + std::sin(kPi / 4));
  return s;
}

// A rod slides on its tip, mu = 2 above the critical 1.3: no force is consistent with sliding on in the
// direction that digs the tip in, an impulse is, (0.375, 0.625) N s. In the other direction it slides on.
// The jump goes with the speed; gravity adds 7.4 m/s^2 h.
VerificationCase painleve() {
  return {
      .name = "B9.painleve",
      .what = "rod of 2 m at 45 degrees, mu = 2, one step of 1e-4, 1e-5, 1e-6 s at 1, 0.1 and 0.01 m/s",
      .rows = {{"stopped", "velocity after the impulse that stops its tip, per h", "m/s^2, rad/s^2", 8,
                "closed form; gravity acts for h"},
               {"slid", "velocity when it slides on, per h", "m/s^2, rad/s^2", 20,
                "closed form; forces act for h"}},
      .measure = [] {
        CaseScene s = painleve_rod();
        Vec6 stopped, slid;
        stopped << -0.375, 0, 0.375, 0, -0.375 * std::sqrt(2.0), 0;
        slid << 1, 0, 0, 0, 0, 0;
        Worst off_stopped, off_slid;
        for (const double h : {1e-4, 1e-5, 1e-6})
          for (const double speed : {1.0, 0.1, 0.01}) {
            const auto after = [&](double v) {
              twist(s.state, s.body)[0] = v;
              return Vec6(twist(run_to(s, "moreau_jean", exact_options(h, NormalLaw::moreau), h), s.body));
            };
            off_stopped.add((after(-speed) - speed * stopped).norm() / h);
            off_slid.add((after(speed) - speed * slid).norm() / h);
          }
        return Figures{{"stopped", off_stopped}, {"slid", off_slid}};
      }};
}

}  // namespace

std::vector<VerificationCase> friction_verification() {
  std::vector<VerificationCase> out;
  const auto for_all = [&](const std::vector<std::string>& settings,
                           VerificationCase (*make)(const std::string&)) {
    for (const std::string& setting : settings) out.push_back(make(setting));
  };
  for_all(scheme_names(), incline);
  out.push_back(every_direction());
  for_all({"stick_slip", "reversal"}, stick_slip);
  for_all({"bowling", "back_spin", "side_spin"}, slip_to_roll);
  out.push_back(ellipsoid());
  out.push_back(stop_of_the_disc(10, 0.934, 0.961));
  out.push_back(stop_of_the_disc(30, 0.965, 0.852));
  out.push_back(stop_of_the_disc(2, 0.984, 1.000));
  for_all(scheme_names(), slide_and_spin);
  for_all(scheme_names(), moving_plate);
  for_all(scheme_names(), turntable);
  out.push_back(closed_motion());
  out.push_back(pivoting_sphere());
  for (const auto& group : {tippe_top_verification, rattleback_verification, euler_disc_verification})
    for (VerificationCase& c : group()) out.push_back(std::move(c));
  out.push_back(painleve());
  return out;
}

}  // namespace aussois
