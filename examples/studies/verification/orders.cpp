// SPDX-License-Identifier: Apache-2.0
// Orders of all schemes on exact motions, events of the reference, and plain Moreau-Jean written apart from
// this kernel: groups A to D.
#include <algorithm>

#include "examples/common/convergence.hpp"
#include "examples/scenes/mechanisms.hpp"
#include "examples/scenes/point_and_wall.hpp"
#include "examples/studies/convergence/study.hpp"
#include "examples/studies/verification/running.hpp"

namespace aussois {
namespace {

/// The cases of an item of the list: what the reference does in long steps, and orders.
struct Item {
  const char *number, *long_steps, *orders;
};
constexpr Item kItems[] = {{"(A1)", "A1.long_steps", "A1.orders"}, {"(A2)", "A2.long_steps", "A2.orders"},
                           {"(A3)", "A3.long_steps", "A3.orders"}, {"(B1)", "B1.long_steps", "B1.orders"},
                           {"(B2)", "B2.long_steps", "B2.orders"}, {"(B3)", "B3.long_steps", "B3.orders"},
                           {"(B4)", "B4.long_steps", "B4.orders"}, {"(B5)", "B5.long_steps", "B5.orders"},
                           {"(C1)", "C1.long_steps", "C1.orders"}, {"(C2)", "C2.long_steps", "C2.orders"},
                           {"(C6)", "C6.long_steps", "C6.orders"}, {"(C10)", "C10.long_steps", "C10.orders"},
                           {"(D1)", "D1.long_steps", "D1.orders"}, {"(D2)", "D2.long_steps", "D2.orders"},
                           {"(D3)", "D3.long_steps", "D3.orders"}};

/// Its number stands at the end of what the case is.
const Item& item_of(const Case& c) {
  for (const Item& item : kItems)
    if (c.what.ends_with(item.number)) return item;
  throw std::logic_error(c.name + " names no item of the verification list: " + c.what);
}

// ---- the reference

SchemeOptions by_events(double h) {
  SchemeOptions out = exact_options(h);
  out.event_driven.ode = {.relative = 1e-12, .absolute = 1e-14};
  return out;
}

/// Seven steps and a bit, whatever happens in them.
double long_step(const Case& c) {
  return c.t_end / 7.3;
}

struct Watched {
  State end{};
  std::vector<StepEvent> events{};
  Worst position{}, velocity{};  // off the exact motion, at the ends of steps
  Worst energy{};                // of a step that its works do not explain [J]
};
Watched watch(const Case& c, const SchemeOptions& o) {
  const CaseScene s = c.scene();
  const ExactMotion exact = c.exact(c.t_end);
  Watched out;
  out.end = run_to(s, "event_driven", o, c.t_end, [&](const State& state, const StepReport& report) {
    out.events.insert(out.events.end(), report.events.begin(), report.events.end());
    const MotionSample computed = c.observe(s, state), right = evaluate(exact, state.t);
    out.position.add((computed.q - right.q).norm());
    out.velocity.add((computed.v - right.v).norm());
    out.energy.add(std::abs(report.energy.residual()));
  });
  return out;
}

constexpr double kSameEvent = 1e-6;  // far above the errors of times, far below the time between events [s]

// Every piece of the exact motion begins with an event. An impact is located to the error of its gap, some
// 1e-14 m, over its speed; slower ones than 1e-4 m/s are left out. Redundant contacts share friction as the
// solver likes: the first to reach its cone lets go, a little early.
Figures in_long_steps(const Case& c) {
  const Watched run = watch(c, by_events(long_step(c)));
  const ExactMotion exact = c.exact(c.t_end);
  Worst time;
  std::vector<double> begins;  // of all new pieces [s]
  for (std::size_t k = 1; k < exact.pieces.size() && exact.pieces[k].begin < c.t_end; ++k) {
    const double t = exact.pieces[k].begin;
    begins.push_back(t);
    if (c.bounces && (exact.pieces[k].at(t).v - exact.pieces[k - 1].at(t).v).norm() < 1e-4) continue;
    Least off;
    for (const StepEvent& event : run.events) off.add(std::abs(event.t - t));
    time.add(off);
  }
  const auto is_unasked = [&](const StepEvent& event) {
    return std::ranges::none_of(begins, [&](double t) { return std::abs(event.t - t) < kSameEvent; });
  };
  return {{"position", run.position},
          {"velocity", run.velocity},
          {"energy", run.energy},
          {"time", time},
          {"unasked", double(std::ranges::count_if(run.events, is_unasked))}};
}

VerificationCase long_steps(const Case& c) {
  const std::string source = "closed form; what tolerances of 1e-12 add up to in a stiff or unstable motion";
  VerificationCase out{
      .name = item_of(c).long_steps,
      .setting = c.name,
      .what = "event_driven in seven steps and a bit, at tolerances of 1e-12",
      .rows = {{"position", "worst position at their ends", "m, rad", 5e-9, source},
               {"velocity", "worst velocity at their ends", "m/s, rad/s", 5e-9, source},
               {"energy", "worst change of energy that no work explains", "J", 2e-9, source},
               {"unasked", "events where the exact motion has none", "-", 0, "closed form", Sense::exactly}},
      .measure = [&c] { return in_long_steps(c); }};
  if (!c.smooth)
    out.rows.push_back({"time", "worst time from a new piece of the motion to an event", "s",
                        c.bounces ? 1e-9 : 5e-8,
                        c.bounces ? "closed form; gap of rounding over the speed"
                                  : "closed form; of redundant contacts the first lets go"});
  return out;
}

// 2 e v / (g (1 - e)) after an impact the last of infinitely many.
VerificationCase end_of_impacts() {
  return {.name = "A1.end_of_impacts",
          .what = "ball from 1 m, e = 1/2, event_driven",
          .rows = {{"time", "end of infinitely many impacts", "s", 1e-8, "closed form: t1 (1 + e) / (1 - e)"},
                   {"events", "events", "-", 19,
                    "18 impacts that leave faster than 10 um/s, and coming to rest", Sense::exactly},
                   {"speed", "speed after it", "m/s, rad/s", 1e-12, "closed form: rest"}},
          .measure = [] {
            const Watched run = watch(case_named("ball_e05"), by_events(1));
            const auto rest = std::ranges::find_if(
                run.events, [](const StepEvent& e) { return e.kind == EventKind::rest; });
            const double t = rest == run.events.end() ? kInf : rest->t;
            return Figures{{"time", std::abs(t - 3 * std::sqrt(2 / kGravity))},
                           {"events", double(run.events.size())},
                           {"speed", run.end.v.norm()}};
          }};
}

// A dilated point that crosses the plate between two internal steps must not be lost: 40 m a step.
VerificationCase bullet_by_events() {
  return {.name = "A5.plate",
          .setting = "event_driven",
          .what = "ball of 800 m/s on a plate, e = 1, one step of 50 ms",
          .rows = {{"events", "events", "-", 1, "one impact", Sense::exactly},
                   {"time", "time of it", "s", 1e-12, "closed form; rounding"},
                   {"speed", "speed upwards at the end", "m/s", 799, "closed form: no tunnelling",
                    Sense::at_least}},
          .measure = [] {
            CaseScene s = case_named("ball_e1").scene();
            twist(s.state, s.body)[2] = -800;
            const double z = pose(s.state, s.body).p.z();
            const double t = (std::sqrt(800 * 800 + 2 * kGravity * z) - 800) / kGravity;
            const StepReport report = step(make_scheme("event_driven", s.model, by_events(5e-2)), s.state);
            return Figures{{"events", double(report.events.size())},
                           {"time", report.events.empty() ? kInf : std::abs(report.events[0].t - t)},
                           {"speed", twist(s.state, s.body)[2]}};
          }};
}

// All contacts of a face end their slip at once, up to rounding: neither it nor the tolerance decides.
VerificationCase any_tolerance() {
  return {.name = "B1.any_tolerance",
          .what = "block sent up 30 degrees, event_driven, at 0.5 to 3 times its tolerances",
          .rows = {{"position", "worst position at the ends of steps", "m, rad", 5e-9,
                    "closed form; tolerances of the equation"},
                   {"velocity", "worst velocity at the ends of steps", "m/s, rad/s", 5e-9,
                    "closed form; tolerances of the equation"}},
          .measure = [] {
            const Case& c = case_named("incline_30_up");
            Worst position, velocity;
            for (const double factor : {0.5, 0.9, 1.01, 1.1, 3.0}) {
              SchemeOptions o = by_events(long_step(c));
              o.event_driven.ode.relative *= factor, o.event_driven.ode.absolute *= factor;
              const Watched run = watch(c, o);
              position.add(run.position), velocity.add(run.velocity);
            }
            return Figures{{"position", position}, {"velocity", velocity}};
          }};
}

/// B9. A rod of 1 kg and half length 1 m in the plane (x, y, angle from the ground), at 45 degrees, its lower
/// left end on the ground, in coordinates of its own; it comes with `speed` towards that end.
CaseScene rod(double mu, double speed) {
  CaseScene out;
  add(out.model, Coordinates{.name = "rod",
                             .size = 3,
                             .mass = [](const VecX&) -> MatX { return Vec3(1, 1, 1.0 / 3).asDiagonal(); },
                             .force = [](double, const VecX&,
                                         const VecX&) { return CoordinateForce{.f = Vec3(0, -kGravity, 0)}; },
                             .potential = [](const VecX& q) { return kGravity * q[1]; }});
  add(out.model, GapFunction{.name = "end",
                             .block = 0,
                             .evaluate =
                                 [](const Model&, const State& s, double) {
                                   const double phi = s.q[2];
                                   GapRows rows{.gap = s.q[1] - std::sin(phi), .J = MatX(2, 3)};
                                   rows.J << 0, 1, -std::cos(phi), 1, 0, std::sin(phi);
                                   return rows;
                                 },
                             .law = {.mu = mu}});
  out.state = rest_state(out.model);
  out.state.q << 0, std::sin(kPi / 4), kPi / 4;
  out.state.v << -speed, 0, 0;
  return out;
}

// No finite force keeps the end on the ground: the impulse (0.375, 0.625) does, to the push that finds it.
VerificationCase jump() {
  constexpr double h = 1e-6;
  return {.name = "B9.jump",
          .setting = "event_driven",
          .what = "rod of 2 m at 45 degrees in coordinates, mu = 2, one step of 1 us at 1, 0.1 and 0.01 m/s",
          .rows = {{"jumps", "runs with one event, a tangential impact", "-", 3,
                    "no finite force is a solution", Sense::exactly},
                   {"impulse", "worst impulse, off 0.375 and 0.625 of the speed", "N s", 10 * h,
                    "closed form; gravity acts for a step"},
                   {"velocity", "worst velocity, off what it leaves", "m/s, rad/s", 20 * h,
                    "closed form; gravity acts for a step"}},
          .measure = [] {
            int jumps = 0;
            Worst impulse, velocity;
            for (const double speed : {1.0, 0.1, 0.01}) {
              CaseScene s = rod(2, speed);
              const StepReport report = step(make_scheme("event_driven", s.model, by_events(h)), s.state);
              jumps += report.events.size() == 1 && report.events[0].kind == EventKind::tangential_impact;
              impulse.add((s.state.r.head<2>() - speed * Vec2(0.375, 0.625)).cwiseAbs().maxCoeff());
              velocity.add(
                  (s.state.v - speed * Vec3(-0.375, 0.375, 0.375 * std::sqrt(2.0))).cwiseAbs().maxCoeff());
            }
            return Figures{{"jumps", double(jumps)}, {"impulse", impulse}, {"velocity", velocity}};
          }};
}

VerificationCase slides_on() {
  return {
      .name = "B9.slides_on",
      .setting = "event_driven",
      .what = "the same rod with mu = 1/2 at 1 m/s, one step of 1 ms",
      .rows = {{"events", "events", "-", 0, "a finite force is a solution", Sense::exactly},
               {"push", "normal impulse", "N s", 1e-6, "the ground pushes", Sense::at_least},
               {"friction", "impulse of friction, off half of it", "N s", 1e-12, "Coulomb's law; rounding"}},
      .measure = [] {
        CaseScene s = rod(0.5, 1);
        const StepReport report = step(make_scheme("event_driven", s.model, by_events(1e-3)), s.state);
        return Figures{{"events", double(report.events.size())},
                       {"push", s.state.r[0]},
                       {"friction", std::abs(s.state.r[1] - s.state.r[0] / 2)}};
      }};
}

// A wall lets go of the slider again and again, at gaps that are rounding of either sign, each time of both
// corners.
VerificationCase leaves_the_wall() {
  return {.name = "C2.leaves_the_wall",
          .setting = "event_driven",
          .what = "slider-crank of angles with clearance, no friction, 0.2 s in steps of 1 ms",
          .rows = {{"slider", "worst place of the slider at the ends of steps", "m", 2e-8,
                    "closed motion; tolerances of the equation over 43 impacts"},
                   {"releases", "releases", "-", 11, "the wall guides between the bounces", Sense::at_least},
                   {"hits", "impacts above 2 cm/s", "-", 2 * 43, "closed motion: 43 of both corners",
                    Sense::exactly}},
          .measure = [] {
            const CaseScene s = slider_crank_of_angles(0);
            const ExactMotion exact = slider_crank_motion(0.2);
            Worst slider;
            int releases = 0, hits = 0;
            run_to(s, "event_driven", by_events(1e-3), 0.2, [&](const State& now, const StepReport& report) {
              for (const StepEvent& e : report.events) {
                releases += e.kind == EventKind::release;
                hits += e.kind == EventKind::impact && e.speed > 0.02;
              }
              slider.add((slider_of_angles(s, now).q - evaluate(exact, now.t).q).norm());
            });
            return Figures{{"slider", slider}, {"releases", double(releases)}, {"hits", double(hits)}};
          }};
}

VerificationCase kept_by_events(const char* name, const char* scene) {
  return {.name = name,
          .setting = "event_driven",
          .what = "free top in steps of 1 s, at tolerances of 1e-12",
          .rows = {{"energy", "energy at the end, relative", "-", 2e-10, "conserved; tolerances"},
                   {"momentum", "angular momentum at the end, relative", "-", 1e-9, "conserved; tolerances"}},
          .measure = [scene] {
            const CaseScene s = case_named(scene).scene();
            const State end = watch(case_named(scene), by_events(1)).end;
            const Vec3 L = momentum(s.model, s.state).angular;
            return Figures{
                {"energy", std::abs(energy(s.model, end).kinetic / energy(s.model, s.state).kinetic - 1)},
                {"momentum", (momentum(s.model, end).angular - L).norm() / L.norm()}};
          }};
}

// ---- orders

/// A study of the case as schemes are delivered: its orders, and what shortened steps do.
VerificationCase orders(const std::string& name, const SchemeVariant& variant, const StudyOptions& o,
                        bool slow = false, const std::string& more = "") {
  const Case& c = case_named(name);
  const auto [expected, why] =
      expected_orders(c, scheme_traits(variant.name, variant.options), step_sizes(c.h, o.levels));
  VerificationCase out{.name = item_of(c).orders,
                       .setting = name + ", " + label(variant.name, variant.options) + more,
                       .what = "orders in the step, of " + std::to_string(o.levels) + " step sizes and " +
                               std::to_string(o.phases) + " phases",
                       .measure =
                           [=, &c] {
                             const Study s = study(c, variant.name, variant.options, o);
                             Figures figures{{"whole", double(std::ranges::count(s.cut, 0))},
                                             {"shortened", shortened_error(s)}};
                             for (std::size_t m = 0; m < kMeasures.size(); ++m)
                               figures[kMeasures[m]] = c.hops_out ? s.order[m] - s.expected[m] : s.order[m];
                             return figures;
                           },
                       .slow = slow,
                       .certified = true};
  char scatter[40];
  std::snprintf(scatter, sizeof scatter, "; less %.2g of scatter", kOrderSlack);
  for (std::size_t m = 0; m < kMeasures.size(); ++m)
    out.rows.push_back(
        {kMeasures[m], std::string("order of ") + kMeasures[m] + (c.hops_out ? ", off that of (CONV-8)" : ""),
         "-", (c.hops_out ? 0 : expected[m]) - kOrderSlack, "theory: " + why[m] + scatter, Sense::at_least});
  out.rows.push_back({"whole", "step sizes without a shortened step", "-", double(o.levels),
                      "theory (CONV-10): a fit needs as many", Sense::at_least});
  out.rows.push_back({"shortened", "error of shortened steps, over that of whole ones of twice the length",
                      "-", 1, "theory (CONV-10): no worse"});
  return out;
}

SchemeVariant moreau_jean(double theta, NormalLaw law) {
  return {"moreau_jean", {.moreau_jean = {.theta = theta, .law = law}}};
}

/// The first setting of every scheme whose error depends on h.
std::vector<SchemeVariant> first_settings() {
  std::vector<SchemeVariant> out;
  for (SchemeVariant& v : scheme_variants())
    if (out.empty() || out.back().name != v.name) out.push_back(std::move(v));
  return out;
}

/// One of each kind, quickly: impacts, a stop and a way back by friction, slip to rolling, tops, impacts of a
/// mechanism; the default at the solver's own tolerance; and, slow, a column of the table for every scheme.
/// The rocking block scatters from level to level and needs all six, a quarter of a minute for each scheme:
/// the others are left to `convergence --all`.
std::vector<VerificationCase> all_orders() {
  constexpr NormalLaw kMoreau = NormalLaw::moreau, kCombined = NormalLaw::combined;
  std::vector<VerificationCase> out;
  for (const auto& [name, variant] : {std::pair{"forced_46", moreau_jean(0.5, kMoreau)},
                                      {"forced_46", moreau_jean(1, kCombined)},
                                      {"incline_30_up", moreau_jean(0.5, kCombined)},
                                      {"bowling", moreau_jean(1, NormalLaw::gap_over_step)},
                                      {"slider_crank", moreau_jean(0.5, kMoreau)},
                                      {"free_top", moreau_jean(0.5, kCombined)},
                                      {"free_top", moreau_jean(1, kCombined)}})
    out.push_back(orders(name, variant, {}));
  for (const SchemeVariant& first : first_settings())
    for (const char* name : {"forced_46", "incline_30_up", "free_top"})
      if (first.name != "moreau_jean") out.push_back(orders(name, first, {}));
  for (const char* name : {"ball_e05", "incline_20_up", "forced_46", "free_top"})
    out.push_back(orders(name, {"moreau_jean", {}}, {.tolerance = SolverOptions{}.tolerance}, false,
                         ", default tolerance"));
  SchemeVariant on_the_way = moreau_jean(0.5, kMoreau);  // gaps at rest are rounding of both signs (MJ-6)
  on_the_way.options.moreau_jean.contacts = ContactsAt::midpoint;
  out.push_back(orders("incline_20_up", on_the_way, {}));
  for (const SchemeVariant& first : first_settings()) {
    for (const char* name : {"ball_e05", "oscillator_e08", "stick_slip"})
      out.push_back(orders(name, first, {.levels = 5}, true));
    out.push_back(orders("heavy_top", first, {.levels = 4}, true));
    if (first.name != "moreau_jean") out.push_back(orders("slider_crank", first, {.levels = 4}, true));
    if (first.name == "moreau_jean") out.push_back(orders("rocking_block", first, {}, true));
  }
  return out;
}

// A uniform brake, and rest: exact at the ends of steps where contacts are looked at on the way.
VerificationCase held_on_the_way() {
  return {
      .name = "B1.held_on_the_way",
      .what = "block sent up 20 degrees, moreau_jean, theta 1/2, contacts at the midpoint, six step sizes",
      .rows = {{"velocity", "worst velocity at the ends of steps", "m/s", 1e-10,
                "closed form: uniform brake and rest; 100 tolerances of the solver"}},
      .measure =
          [] {
            SchemeVariant v = moreau_jean(0.5, NormalLaw::moreau);
            v.options.moreau_jean.contacts = ContactsAt::midpoint;
            Worst velocity;
            for (const Errors& e : study(case_named("incline_20_up"), v.name, v.options, {}).errors)
              velocity.add(e[v_nodes]);
            return Figures{{"velocity", velocity}};
          },
      .certified = true};
}

// Two solves of one problem differ by the solver's tolerance; Newton's loop takes that for no step (MJ-12).
VerificationCase newtons_loop() {
  return {.name = "B2.newtons_loop",
          .what =
              "block that turns back, moreau_jean, contacts at the midpoint, 50 solves at most, at "
              "tolerances of 1e-12 and 1e-8",
          .rows = {{"cut", "shortened steps", "-", 0, "the loop ends where the tolerance does (MJ-12)",
                    Sense::exactly}},
          .measure =
              [] {
                SchemeVariant v = moreau_jean(0.5, NormalLaw::moreau);
                v.options.moreau_jean.contacts = ContactsAt::midpoint;
                v.options.moreau_jean.newton.max_iterations = 50;
                long cut = 0;
                for (const double tolerance : {1e-12, 1e-8})
                  for (const long steps :
                       study(case_named("reversal"), v.name, v.options, {.levels = 3, .tolerance = tolerance})
                           .cut)
                    cut += steps;
                return Figures{{"cut", double(cut)}};
              },
          .certified = true};
}

/// Errors of plain runs, solved to 1e-12 without certificates.
ComputedMotion plain_run(const Case& c, const SchemeVariant& v, double h, double phase = 1) {
  SchemeOptions o = v.options;
  o.step.h = h, o.step.solver.tolerance = 1e-12, o.step.advancement.certify = false;
  return run_case(c, v.name, o, phase);
}

// The impacts of a ball, from the mean over the length of the first step: the phase of an impact in its step
// scatters single errors.
VerificationCase order_of_impacts(NormalLaw law) {
  constexpr double kFinest = 5.3e-4;
  return {.name = "A1.order_of_impacts",
          .setting = to_string(law),
          .what = "ball from 1 m, e = 1/2, moreau_jean, theta 1/2, 10.3 to 0.53 ms, mean of eight phases",
          .rows = {{"order", "order of the worst height", "-", 0.95, "theory: one", Sense::at_least},
                   {"height", "worst height at 0.53 ms", "m", 1.5 * std::sqrt(2 * kGravity) * kFinest,
                    "closed form: (1 + e) v h of the first impact"}},
          .measure = [law] {
            const Case& c = case_named("ball_e05");
            const ExactMotion exact = c.exact(c.t_end);
            const std::vector<double> steps{1.03e-2, 5.7e-3, 3.1e-3, 1.7e-3, 9.1e-4, kFinest};
            std::vector<double> height;
            for (const double h : steps) {
              double sum = 0;
              for (int k = 0; k < 8; ++k)
                sum += errors_of(plain_run(c, moreau_jean(0.5, law), h, (k + 0.5) / 8), exact)[q_max];
              height.push_back(sum / 8);
            }
            return Figures{{"order", fitted_order(steps, height)}, {"height", height.back()}};
          }};
}

/// The order of a measure, from five step sizes.
double observed(const char* name, const SchemeVariant& v, Measure measure, double h) {
  return study(case_named(name), v.name, v.options, {.h = h, .levels = 5}).order[measure];
}

// With theta < 1 a landing left an overlap O(h). Pushed out at a constant 1 cm/s for a time O(h) it would be
// an error of 1 cm/s in the graph whatever the step; landings end closed (MJ-17).
VerificationCase landing_that_ends_closed() {
  return {.name = "A1.landing_that_ends_closed",
          .what = "ball from 1 m, e = 0, laws of the gap, theta 1/2: the graph of the velocity",
          .rows = {{"moreau_jean", "worst order, off 1", "-", 0.1, "theory (MJ-17): one"},
                   {"passive_midpoint", "worst order, off 1", "-", 0.1, "theory (MJ-17): one"}},
          .measure =
              [] {
                Worst moreau, passive;
                for (const NormalLaw law : {NormalLaw::combined, NormalLaw::gap_over_step}) {
                  moreau.add(std::abs(observed("ball_e0", moreau_jean(0.5, law), v_graph, 2e-3) - 1));
                  passive.add(
                      std::abs(observed("ball_e0", {"passive_midpoint", {.passive_midpoint = {.law = law}}},
                                        v_graph, 2e-3) -
                               1));
                }
                return Figures{{"moreau_jean", moreau}, {"passive_midpoint", passive}};
              },
          .slow = true,
          .certified = true};
}

// Moreau's law stops the ball up to half a step before the plate; with theta = 1 it stays there, and falls a
// second time: through O(h), so for O(sqrt h).
VerificationCase second_fall() {
  return {.name = "A1.second_fall",
          .what = "ball from 1 m, e = 0, moreau_jean, theta 1: the graph of the velocity",
          .rows = {{"moreau", "order by Moreau's law, off 1/2", "-", 0.2,
                    "theory (CONV-9); guard at these steps"},
                   {"combined", "order by the combined law, off 1", "-", 0.1, "theory: one"}},
          .measure =
              [] {
                const auto order = [](NormalLaw law) {
                  return observed("ball_e0", moreau_jean(1, law), v_graph, 2e-3);
                };
                return Figures{{"moreau", std::abs(order(NormalLaw::moreau) - 0.5)},
                               {"combined", std::abs(order(NormalLaw::combined) - 1)}};
              },
          .certified = true};
}

// The torque of a contact is turned into the body by the attitude at the start of the step. At the midpoint
// that rotates it by h omega / 2 against the body: of order one where the torque is transverse to the spin,
// although all of the motion before t* is smooth. At theta = 1 it happens to be exact.
VerificationCase torque_across_the_spin() {
  return {.name = "B3.torque_across_the_spin",
          .what = "sphere with side spin that still slips, moreau_jean",
          .rows = {{"midpoint", "order of the velocity at theta 1/2, off 1", "-", 0.05,
                    "theory: the attitude is that of the start"},
                   {"euler", "velocity at theta 1, h = 10 ms", "m/s", 1e-10, "closed form: exact there"}},
          .measure = [] {
            Case c = case_named("side_spin");
            c.t_end *= 0.6;
            const auto off = [&](double theta, double h) {
              const ComputedMotion run = plain_run(c, moreau_jean(theta, NormalLaw::combined), h);
              return (run.node.back().v - evaluate(c.exact(c.t_end), run.t.back()).v).norm();
            };
            const std::vector<double> steps = step_sizes(1e-2, 5);
            std::vector<double> errors;
            for (const double h : steps) errors.push_back(off(0.5, h));
            return Figures{{"midpoint", std::abs(fitted_order(steps, errors) - 1)}, {"euler", off(1, 1e-2)}};
          }};
}

// ---- plain Moreau-Jean, written apart from this kernel

// As the reference takes it: velocities at 60001 instants, by the trapezoidal rule. At its shortest steps,
// with 1.25 instants each, that is 6 % less than the integral (CONV-2).
double sampled_l1(const ComputedMotion& run, const ExactMotion& exact, double t_end, double h) {
  constexpr int kIntervals = 60000;
  double sum = 0;
  for (int i = 0; i <= kIntervals; ++i) {
    const double t = t_end * i / kIntervals;
    const std::size_t node = std::min(std::size_t(t / h + 1e-9), run.node.size() - 1);
    sum += (run.node[node].v - evaluate(exact, t).v).norm() * (i == 0 || i == kIntervals ? 0.5 : 1);
  }
  return sum * t_end / kIntervals;
}

// The same steps of one coordinate; with Moreau's activation both are the same method, so the errors must
// agree to the digits of the file. The graphs of the reference are points 2 mm/s apart.
VerificationCase plain_moreau_jean(const char* name, const std::string& scene, const char* series,
                                   double t_end) {
  return {
      .name = name,
      .setting = scene,
      .what = "moreau_jean, Moreau's law, theta 1/2 and 1, 10 to 0.3125 ms, over plain Moreau-Jean",
      .rows = {{"compared", "runs", "-", 12, "shared series", Sense::exactly},
               {"position", "worst ratio of the errors of the position", "-", 1.001,
                "shared series: the same method; its digits"},
               {"velocity", "worst ratio of the errors of the velocity, L1", "-", 1.001,
                "shared series: the same method; its digits"},
               {"graph", "largest excess of the distance of graphs", "m/s", 2e-3,
                "shared series; its points are 2 mm/s apart"}},
      .measure = [=] {
        Case c = case_named(scene);
        c.t_end = t_end;
        const ExactMotion exact = c.exact(c.t_end);
        int compared = 0;
        Worst position, velocity, graph;
        for (const SeriesRow& row : shared_series("moreau_baseline.csv", series)) {
          const double h = row.at("h");
          const ComputedMotion run = plain_run(c, moreau_jean(row.at("theta"), NormalLaw::moreau), h);
          const Errors errors = errors_of(run, exact);
          position.add(errors[q_max] / row.at("Linf_q"));
          velocity.add(sampled_l1(run, exact, c.t_end, h) / row.at("L1_v"));
          graph.add(errors[v_graph] - row.at("graph_v"));
          ++compared;
        }
        return Figures{
            {"compared", double(compared)}, {"position", position}, {"velocity", velocity}, {"graph", graph}};
      }};
}

// The exact motion that others are held to.
VerificationCase oscillator_of_the_series() {
  return {.name = "A2.exact_motion",
          .what = "the exact motion of the oscillator, z = -1/2, e = 0.8",
          .rows = {{"first", "time of the first impact, off 2 pi / 3", "s", 1e-14, "closed form; rounding"},
                   {"first_speed", "speed before it, off sqrt(3) / 2", "m/s", 1e-14, "closed form; rounding"},
                   {"impacts", "impacts compared", "-", 20, "agreed", Sense::at_least},
                   {"time", "worst time of an impact", "s", 1e-11, "shared series, to its digits"},
                   {"before", "worst speed before an impact", "m/s", 1e-11, "shared series, to its digits"},
                   {"after", "worst speed after an impact", "m/s", 1e-11, "shared series, to its digits"}},
          .measure = [] {
            const std::vector<SeriesRow> events = shared_series("impact_oscillator_events.csv");
            const ExactMotion exact = case_named("oscillator_e08").exact(events.back().at("t") + 1);
            Worst time, before, after;
            for (std::size_t k = 0; k < events.size(); ++k) {
              const double t = exact.pieces.at(k + 1).begin;
              time.add(std::abs(t - events[k].at("t")));
              before.add(std::abs(exact.pieces[k].at(t).v[0] - events[k].at("v_minus")));
              after.add(std::abs(exact.pieces[k + 1].at(t).v[0] - events[k].at("v_plus")));
            }
            const double t = exact.pieces[1].begin;
            return Figures{{"first", std::abs(t - 2 * kPi / 3)},
                           {"first_speed", std::abs(exact.pieces[0].at(t).v[0] + std::sqrt(3) / 2)},
                           {"impacts", double(events.size())},
                           {"time", time},
                           {"before", before},
                           {"after", after}};
          }};
}

// The same in one coordinate of its own.
CaseScene oscillator_of_one_coordinate() {
  CaseScene out{.model = point_and_wall(1, 0, -0.5, 0.8)};
  out.state = rest_state(out.model);
  out.state.q[0] = 1;
  return out;
}

VerificationCase one_coordinate() {
  return {
      .name = "A2.one_coordinate",
      .what = "oscillator of one coordinate for 30 s, moreau_jean",
      .rows = {{"midpoint", "worst position at 10 ms, theta 1/2, Moreau's law", "m", 2.9e-2,
                "plain Moreau-Jean written apart: 2.8e-2, to its digits"},
               {"euler", "worst position at 10 ms, theta 1, Moreau's law", "m", 0.55,
                "plain Moreau-Jean written apart: 5.4e-1, to its digits"},
               {"order", "order of it at theta 1/2, combined law, 10 to 1.1 ms", "-", 0.75,
                "theory: one, with the phase of the impacts in the step", Sense::at_least},
               {"ledger", "worst change of energy that no work explains", "J", 1e-13, "identity; rounding"}},
      .measure =
          [] {
            const CaseScene s = oscillator_of_one_coordinate();
            const ExactMotion exact = case_named("oscillator_e08").exact(30);
            Worst ledger;
            const auto worst = [&](double h, double theta, NormalLaw law) {
              SchemeOptions o = moreau_jean(theta, law).options;
              o.step.h = h;
              Worst position;
              run_to(s, "moreau_jean", o, 30, [&](const State& state, const StepReport& report) {
                position.add(std::abs(state.q[0] - evaluate(exact, state.t).q[0]));
                ledger.add(std::abs(report.energy.residual()));
              });
              return double(position);
            };
            const std::vector<double> steps{1e-2, 6.3e-3, 4.1e-3, 2.7e-3, 1.7e-3, 1.1e-3};
            std::vector<double> errors;
            for (const double h : steps) errors.push_back(worst(h, 0.5, NormalLaw::combined));
            const double midpoint = worst(1e-2, 0.5, NormalLaw::moreau),
                         euler = worst(1e-2, 1, NormalLaw::moreau);
            return Figures{{"midpoint", midpoint},
                           {"euler", euler},
                           {"order", fitted_order(steps, errors)},
                           {"ledger", ledger}};
          },
      .certified = true};
}

VerificationCase impacts_of_one_coordinate() {
  constexpr double h = 1e-3;
  return {
      .name = "A2.impacts_of_one_coordinate",
      .what = "oscillator of one coordinate for 12 s, moreau_jean, theta 1/2, h = 1 ms",
      .rows = {{"impacts", "impacts", "-", 3, "closed form", Sense::exactly},
               {"time", "worst time of an impact", "s", 5 * h, "closed form; five steps"},
               {"speed", "worst speed after an impact", "m/s", 3 * h, "closed form; three steps at 1 m/s^2"}},
      .measure =
          [] {
            const CaseScene s = oscillator_of_one_coordinate();
            const ExactMotion exact = case_named("oscillator_e08").exact(30);
            std::size_t seen = 0;
            double before = 0;
            Worst time, speed;
            SchemeOptions o = moreau_jean(0.5, NormalLaw::combined).options;
            o.step.h = h;
            run_to(s, "moreau_jean", o, 12, [&](const State& state, const StepReport& report) {
              if (state.v[0] > 0 && before < 0 && !report.gaps.empty() && report.gaps[0].impulse.x() > 0.1) {
                const double t = exact.pieces.at(++seen).begin;
                time.add(std::abs(state.t - t));
                speed.add(std::abs(state.v[0] - exact.pieces[seen].at(t).v[0]));
              }
              before = state.v[0];
            });
            return Figures{{"impacts", double(seen)}, {"time", time}, {"speed", speed}};
          },
      .certified = true};
}

}  // namespace

std::vector<VerificationCase> order_verification() {
  std::vector<VerificationCase> out{
      end_of_impacts(),
      order_of_impacts(NormalLaw::moreau),
      order_of_impacts(NormalLaw::combined),
      plain_moreau_jean("A1.plain_moreau_jean", "ball_e05", "bouncing_ball_e05", 1.5),
      landing_that_ends_closed(),
      second_fall(),
      oscillator_of_the_series(),
      plain_moreau_jean("A2.plain_moreau_jean", "oscillator_e08", "impact_oscillator_e08", 30),
      one_coordinate(),
      impacts_of_one_coordinate(),
      bullet_by_events(),
      any_tolerance(),
      held_on_the_way(),
      newtons_loop(),
      torque_across_the_spin(),
      jump(),
      slides_on(),
      leaves_the_wall(),
      kept_by_events("D1.kept_by_events", "dzhanibekov"),
      kept_by_events("D2.kept_by_events", "free_top")};
  for (const Case& c : cases()) out.push_back(long_steps(c));
  for (VerificationCase& c : all_orders()) out.push_back(std::move(c));
  return out;
}

}  // namespace aussois
