// SPDX-License-Identifier: Apache-2.0
// Group K: cables that touch floors, pegs, each other and themselves (doc/theory/beams.md,
// doc/theory/deforming_shapes.md).
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "examples/scenes/beams.hpp"
#include "examples/scenes/cables.hpp"
#include "examples/studies/verification/linking_number.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/check.hpp"
#include "geometry/primitives.hpp"
#include "integrators/schemes/moreau_jean.hpp"

namespace aussois {
namespace {

Vec3 place_of(const State& state, BodyId body) {
  return pose(state, body).p;
}

// Forces on a beam that lies on a floor, by node, counted from the end that is lifted.
std::map<int, double> floor_forces(const StepReport& report, const Cable& beam, const State& state) {
  std::map<int, double> out;
  const int count = int(beam.nodes.size());
  for (const StepContact& c : report.contacts) {
    const auto distance = [&](int i) {
      return (place_of(state, beam.nodes[std::size_t(i)]) - c.point.x_b).squaredNorm();
    };
    int nearest = 0;
    for (int i = 1; i < count; ++i)
      if (distance(i) < distance(nearest)) nearest = i;
    out[count - 1 - nearest] += std::abs(c.impulse.z()) / report.h;
  }
  return out;
}

// A heavy beam on a floor, EI = q = 1. Its end is lifted to a height by a vertical force.
Figures lift_beam(const SeriesRow& row) {
  constexpr int kPerLength = 40, kElements = 100;
  const double free_length = row.at("free_length"), l = free_length / kPerLength, radius = 1e-4 * free_length,
               height = row.at("H");
  Model model;
  model.gravity = {0, 0, -1};
  model.contact_law.mu = 0;
  add(model, fixed_body("floor", add(model, prepare(dilate(make_plate(20, 20), radius)))));
  const Cable beam = add_cable(
      model, {.name = "beam",
              .nodes = straight_nodes({-kElements * l, 0, 2 * radius}, {0, 0, 2 * radius}, kElements),
              .section = section_of({.EA = 1e5, .GA = 1e5, .mass = 1, .about_x = 1e-4, .across = 1e-4}),
              .radius = radius});
  model.bodies[beam.nodes.front()].motion = FixedMotion{};
  const DeadLoad lift{.body = beam.nodes.back(), .force = Vec3::UnitZ()};
  add(model, lift);
  State state = rest_state(model);
  lay(beam, state);
  const MoreauJean scheme(model, {.h = 10, .solver = {.tolerance = 1e-13}, .advancement = {.certify = false}},
                          {.theta = 1});
  StepReport report;
  const auto too_high = [&](double force) {
    *lift.factor = force;
    report = settle(scheme, state, {.displacement = 1e-9 * free_length});
    require_accepted(report);
    return place_of(state, beam.nodes.back()).z() - 2 * radius - height;
  };
  double before = 0.98 * row.at("end_force"), force = row.at("end_force"), off_before = too_high(before),
         off = too_high(force);
  for (int k = 0; k < 6 && std::abs(off) > 1e-8 * height; ++k) {
    const double next = force - off * (force - before) / (off - off_before);
    before = std::exchange(force, next), off_before = std::exchange(off, too_high(next));
  }
  const std::map<int, double> floor = floor_forces(report, beam, state);
  int last = kElements;  // that bears anything
  for (const auto& [node, f] : floor)
    if (f > 0.01 * l) last = std::min(last, node);
  double sum = 0, moment = 0;  // of what is not weight, near the end of the contact
  Worst elsewhere;
  for (const auto& [node, f] : floor) {
    if (node < last) continue;
    const double more = f - (node == last ? l / 2 : l);
    if (node > last + kPerLength / 2)
      elsewhere.add(std::abs(f / l - 1));
    else
      sum += more, moment += more * node * l;
  }
  return {{"force", std::abs(force / row.at("end_force") - 1)},
          {"length", std::abs(moment / sum / free_length - 1)},
          {"reaction", std::abs(sum / row.at("lift_off_reaction") - 1)},
          {"elsewhere", elsewhere}};
}

VerificationCase heavy_beam() {
  return {.name = "K1.heavy_beam",
          .what =
              "heavy beam on a floor, 40 elements along what is lifted: its end is lifted to six heights, at "
              "rest, without friction",
          .rows = {{"force", "worst force on its end, relative", "-", 1e-2, "shared series: elastica"},
                   {"length", "worst length that is lifted, relative", "-", 1e-2, "shared series: elastica"},
                   {"reaction", "worst force of the floor where it lifts off, relative", "-", 1e-2,
                    "shared series: half the weight of what is lifted, at small slopes"},
                   {"elsewhere", "worst force of the floor on a node farther off, off its weight", "-", 1e-2,
                    "theory: the weight of an element"}},
          .measure = [] {
            std::map<std::string, Worst> worst;
            for (const SeriesRow& row : deformable_series("heavy_beam_on_floor.csv"))
              for (const auto& [name, figure] : lift_beam(row)) worst[name].add(figure);
            return Figures(worst.begin(), worst.end());
          }};
}

// A limp chain of straight links between points, each of which touches the middle of a face of a peg. It ends
// in tangents.
struct PegChain {
  Model model{};
  State state{};
  std::vector<BodyId> nodes{};
  double link_length = 0;     // [m]
  Vec3 pull = Vec3::UnitX();  // of the last link, outwards
  DeadLoad last{};            // along it, times its factor; against 1 N on the first
  explicit PegChain(double mu, double turns, int count) {
    constexpr double kRadius = 0.1, kDilation = 1e-3, kPoint = 1e-6;
    const double angle = 2 * kPi * turns / count;  // from link to link
    const int sides = int(std::lround(count / turns));
    const double distance = kRadius * std::cos(kPi / sides) + kDilation + kPoint;
    model.gravity = Vec3::Zero();
    model.contact_law.mu = mu;
    const ShapeId peg = add(model, prepare(dilate(make_cylinder(kRadius, 0.1, sides), kDilation)));
    const ShapeId point = add(model, prepare(dilate(make_point(), kPoint)));
    add(model, fixed_body("peg", peg));
    const auto along = [](double a) { return Vec3(-std::sin(a), std::cos(a), 0); };
    link_length = 2 * distance * std::sin(angle / 2);
    pull = along(count * angle);
    std::vector<Vec3> x{Vec3::Zero()};
    for (int i = 0; i < count; ++i) {
      const double a = angle * (i + 0.5);
      x.push_back(distance * Vec3(std::cos(a), std::sin(a), 0));
    }
    x.front() = x[1] - link_length * along(0);
    x.push_back(x.back() + link_length * pull);
    for (std::size_t i = 0; i < x.size(); ++i)
      nodes.push_back(add(model, RigidBody{.name = "point",
                                           .shape = i > 0 && i + 1 < x.size() ? point : ShapeId{},
                                           .mass = 1e-3,
                                           .inertia = 1e6 * Mat3::Identity()}));  // none of them rolls
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
      add(model, Joint{.name = "link",
                       .kind = JointKind::distance,
                       .body_a = nodes[i],
                       .body_b = nodes[i + 1],
                       .length = (x[i] - x[i + 1]).norm()});
    add(model, DeadLoad{.body = nodes.front(), .force = -along(0)});
    last = {.body = nodes.back(), .force = pull};
    add(model, last);
    state = rest_state(model);
    for (std::size_t i = 0; i < x.size(); ++i) pose(state, nodes[i]).p = x[i];
  }
  MoreauJean scheme() const {
    return MoreauJean(model, {.h = 2e-4, .solver = {.tolerance = 1e-12}, .advancement = {.certify = false}},
                      {.theta = 1});
  }
};

// The tension of the last link over that of the first while the chain slips.
double slipping_ratio(double mu, double turns, int count) {
  PegChain chain(mu, turns, count);
  chain.model.bodies[chain.nodes.back()].motion = DrivenMotion{};
  *chain.last.factor = 0;
  linear_part(chain.state.v, chain.nodes.back()) = 1e-4 * chain.link_length * chain.pull;
  const MoreauJean scheme = chain.scheme();
  step(scheme, chain.state);  // sets it in motion
  const StepReport report = step(scheme, chain.state);
  return report.joints[JointId::at(count)].force.norm() / report.joints[JointId::at(0)].force.norm();
}

// How far the last point moves in 30 ms under so many times the tension at which the chain slips [m].
double creep(double mu, double turns, int count, double part, double ratio) {
  PegChain chain(mu, turns, count);
  *chain.last.factor = part * ratio;
  const Vec3 before = place_of(chain.state, chain.nodes.back());
  run_accepted(chain.scheme(), chain.state, 0.03);
  return (place_of(chain.state, chain.nodes.back()) - before).norm();
}

VerificationCase capstan(double mu, double turns, int count) {
  std::ostringstream setting;
  setting << "mu " << mu << ", " << turns << " turns, " << count << " links";
  return {.name = "K2.capstan",
          .setting = setting.str(),
          .what = "limp chain around a peg, each point on a face of it",
          .rows = {{"ratio", "ratio of the tensions while it slips, relative", "-", 1e-6,
                    "shared series: product over the points"},
                   {"holds", "way of its end in 30 ms at 1 - 1e-4 of the ratio", "m", 1e-12,
                    "Coulomb's law: none; rounding"},
                   {"slips", "the same at 1 + 1e-4 of it", "m", 1e-9,
                    "Coulomb\'s law: it slips; a thousand times what rounding may leave of rest",
                    Sense::at_least}},
          .measure = [=] {
            const std::vector<SeriesRow> rows = deformable_series("capstan_polygon.csv");
            const auto row = std::ranges::find_if(rows, [&](const SeriesRow& r) {
              return r.at("mu") == mu && r.at("turns") == turns && r.at("vertices") == count;
            });
            require(row != rows.end(), "capstan_polygon.csv lacks this chain");
            const double exact = row->at("T2_over_T1");
            return Figures{{"ratio", std::abs(slipping_ratio(mu, turns, count) / exact - 1)},
                           {"holds", creep(mu, turns, count, 1 - 1e-4, exact)},
                           {"slips", creep(mu, turns, count, 1 + 1e-4, exact)}};
          }};
}

VerificationCase rope_on_peg() {
  return {.name = "K2.rope",
          .what = "thin rope of 120 elements over half of a peg of 96 sides, pulled by 1 mm, mu = 0.3",
          .rows = {{"mean", "mean ratio of its tensions while it slips, relative", "-", 1e-2,
                    "exp(mu pi); its ends lie on a side more or less"},
                   {"scatter", "largest ratio off it, relative", "-", 2e-2,
                    "exp(mu pi) with a side more or less"}},
          .measure = [] {
            constexpr int kSteps = 50, kOnset = 10;
            RopeOnPeg s;
            const MoreauJean scheme(s.model, {.h = 1e-2}, {.theta = 1});
            double sum = 0;
            Worst scatter;
            const double exact = std::exp(RopeOnPeg::kMu * kPi);
            for (int k = 0; k < kSteps; ++k) {
              step(scheme, s.state);
              if (k < kOnset) continue;  // until all of it slips
              const double ratio = beam_loads(s.rope.beam, s.state).back().stress.head<3>().norm() / exact;
              sum += ratio;
              scatter.add(std::abs(ratio - 1));
            }
            return Figures{{"mean", std::abs(sum / (kSteps - kOnset) - 1)}, {"scatter", scatter}};
          }};
}

// Two loops that hang in each other, open towards +z and -z, each pulled at both ends.
VerificationCase clasp() {
  return {
      .name = "K4.clasp",
      .what = "two thick loops hang in each other without friction, at first 80 degrees apart",
      .rows = {{"force", "force between them, over that on their ends, off one", "-", 1e-8, "equilibrium"},
               {"planes", "cosine between their planes", "-", 1e-8, "symmetry: perpendicular"}},
      .measure = [] {
        constexpr double kRadius = 5e-3, kLoop = 0.02, kLeg = 0.1, kTension = 10;
        const double angle = 80 * kPi / 180;
        Model model;
        model.gravity = Vec3::Zero();
        model.contact_law.mu = 0;
        BeamSection section = section_of(
            {.EA = 1e4, .GA = 5e3, .GJ = 1e-3, .EI = 1e-3, .mass = 0.1, .about_x = 2e-6, .across = 1e-6});
        section.damping = 1e-2 * section.stiffness;
        std::array<Cable, 2> loops;
        for (std::size_t k = 0; k < 2; ++k) {
          const double up = k == 0 ? 1 : -1, middle = up * (kLoop - kRadius - 1e-3);
          const Vec3 across = k == 0 ? Vec3(Vec3::UnitX()) : Vec3(std::cos(angle), std::sin(angle), 0);
          std::vector<Vec3> line{Vec3(0, 0, middle + up * kLeg) - kLoop * across};
          for (int i = 0; i <= 200; ++i) {
            const double a = kPi * i / 200;
            line.push_back(Vec3(0, 0, middle - up * kLoop * std::sin(a)) - kLoop * std::cos(a) * across);
          }
          line.push_back(Vec3(0, 0, middle + up * kLeg) + kLoop * across);
          loops[k] = add_cable(
              model, {.nodes = frames_along(points_along(line, 61)), .section = section, .radius = kRadius});
          for (const BodyId end : {loops[k].nodes.front(), loops[k].nodes.back()})
            add(model, DeadLoad{.body = end, .force = up * kTension * Vec3::UnitZ()});
        }
        State state = rest_state(model);
        for (const Cable& loop : loops) lay(loop, state);
        const MoreauJean scheme(model, {.h = 2e-3, .solver = {.tolerance = 1e-12}}, {.theta = 1});
        Vec3 force = Vec3::Zero();
        run_accepted(scheme, state, 2, [&](const StepReport& report) {
          force.setZero();
          for (const StepContact& c : report.contacts) force += c.impulse / report.h;
          return true;
        });
        const auto opening = [&](const Cable& loop) {
          Vec3 d = place_of(state, loop.nodes.back()) - place_of(state, loop.nodes.front());
          d.z() = 0;
          return Vec3(d.normalized());
        };
        return Figures{{"force", std::abs(force.norm() / (2 * kTension) - 1)},
                       {"planes", std::abs(opening(loops[0]).dot(opening(loops[1])))}};
      }};
}

// The scene `knot`, pulled for a while and held.
VerificationCase held_knot() {
  return {.name = "K6.held",
          .what = "open trefoil of rope, mu = 0.2, pulled for 2.4 s, held for 4 s, then watched for 10 s",
          .rows = {{"creep", "largest way of a node in the ten seconds", "m", 1e-9,
                    "Coulomb's law: what sticks does not creep"},
                   {"contacts", "contacts that bear", "-", 3, "topology: a knot crosses itself thrice",
                    Sense::at_least}},
          .measure =
              [] {
                const CaseScene s = knot();
                const MoreauJean scheme(s.model, {.h = 4e-3, .solver = {.tolerance = 1e-9}}, {.theta = 1});
                State state = s.state;
                run_accepted(scheme, state, 2.4);
                for (const BodyId b : s.model.bodies.ids())
                  if (is_moved(s.model.bodies[b])) linear_part(state.v, b).setZero();
                run_accepted(scheme, state, 6.4);
                const PerBody<SE3> from = state.g;
                int bearing = 0;
                Worst creep;
                run_accepted(scheme, state, 16.4, [&](const StepReport& report) {
                  bearing = 0;
                  for (const StepContact& c : report.contacts) bearing += c.impulse.norm() > 0;
                  for (const BodyId b : from.ids()) creep.add((place_of(state, b) - from[b].p).norm());
                  return true;
                });
                return Figures{{"creep", creep}, {"contacts", bearing}};
              },
          .slow = true};
}

// How often a line on the surface of a cable winds about its middle. Both are closed far from it in planes
// side by side: at its ends the line lies along z.
double turns_about_its_middle(const Cable& cable, const State& state) {
  constexpr double kFar = 100, kAside = 1e-4;  // [m]
  std::array<std::vector<Vec3>, 2> curves;
  for (const BodyId node : cable.nodes) {
    curves[0].push_back(place_of(state, node));
    curves[1].push_back(curves[0].back() + kAside * (pose(state, node).R * Vec3::UnitY()));
  }
  for (std::vector<Vec3>& curve : curves) {
    const Vec3 first = curve.front(), last = curve.back();
    curve.insert(curve.end(), {last + Vec3(kFar, 0, 0), last + Vec3(kFar, kFar, 0),
                               first + Vec3(-kFar, kFar, 0), first - Vec3(kFar, 0, 0)});
  }
  return linking_number(curves[0], curves[1]);
}

// A rope between a clamp and an end that is turned and may come nearer.
VerificationCase plectoneme() {
  return {.name = "K8.plectoneme",
          .what = "rope of 1 m under a tension of 0.05 N, one end turned six times: it winds about itself",
          .rows = {{"link", "linking number of the rope with a line on its surface", "-", 6,
                    "topology: the turns; two less or more where it goes through itself", Sense::exactly},
                   {"contacts", "contacts with itself that bear", "-", 10,
                    "it winds about itself more than twice", Sense::at_least}},
          .measure =
              [] {
                constexpr double kRadius = 4e-3, kTurns = 6, kRamp = 3;
                constexpr int kElements = 150;
                Model model;
                model.gravity = Vec3::Zero();
                model.contact_law.mu = 0;
                std::vector<Vec3> line;
                for (int i = 0; i <= kElements; ++i) {
                  const double s = double(i) / kElements;
                  line.emplace_back(s, 2e-3 * std::sin(kPi * s), 1e-3 * std::sin(2 * kPi * s));
                }
                const Cable rope = add_cable(model, {.name = "rope",
                                                     .nodes = frames_along(line),
                                                     .section = beam_section({.radius = kRadius,
                                                                              .young = 5e6,
                                                                              .density = 1100,
                                                                              .bending_stiffness = 2e-4,
                                                                              .damping_time = 2e-2}),
                                                     .radius = kRadius,
                                                     .touches_itself = true});
                model.bodies[rope.nodes.front()].motion = FixedMotion{};
                State state = rest_state(model);
                lay(rope, state);
                Joint end = joint_at(JointKind::cylindrical, "end", rope.nodes.back(), kWorld, state.g,
                                     {Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX()), line.back()});
                end.axis[1].motor = {.kind = MotorKind::speed, .target = [](double t) {
                                       return t < kRamp ? 2 * kPi * kTurns / kRamp : 0.0;
                                     }};
                add(model, end);
                add(model, DeadLoad{.body = rope.nodes.back(), .force = 0.05 * Vec3::UnitX()});
                state = rest_state(model);
                lay(rope, state);
                const MoreauJean scheme(model, {.h = 2e-3}, {.theta = 1});
                int bearing = 0;
                run_accepted(scheme, state, kRamp, [&](const StepReport& report) {
                  bearing = 0;
                  for (const StepContact& c : report.contacts) bearing += c.impulse.norm() > 0;
                  return true;
                });
                return Figures{{"link", std::round(1e6 * turns_about_its_middle(rope, state)) / 1e6},
                               {"contacts", bearing}};
              },
          .slow = true,
          .certified = true};
}

// A rope that floats, and a ball that flies into it.
VerificationCase ball_meets_rope(double mass_ratio) {
  std::ostringstream setting;
  setting << "ball of " << mass_ratio << " times the rope's mass";
  return {.name = "K10.ball_meets_rope",
          .setting = setting.str(),
          .what = "ball flies at 1 m/s into a rope that floats, mu = 0.3, 0.1 s",
          .rows = {{"momentum", "largest change of their momentum in a step, over that of the ball", "-",
                    1e-13, "action and reaction; rounding"},
                   {"gap", "smallest gap at the start of a step, over the sum of the dilations", "-", -0.042,
                    "certificate (CA-6)", Sense::at_least},
                   {"given", "momentum of the rope, over its mass times the ball's first speed", "-", 0.05,
                    "it was met", Sense::at_least}},
          .measure =
              [=] {
                constexpr double kRadius = 5e-3, kLength = 0.4, kDensity = 1000;
                Model model;
                model.gravity = Vec3::Zero();
                model.contact_law.mu = 0.3;
                const double rope_mass = kDensity * kPi * kRadius * kRadius * kLength;
                const SimplicialComplex sphere = make_sphere(0.039, 2);
                const double density = mass_ratio * rope_mass / mass_properties(sphere, 1).mass;
                const BodyId ball = add(model, solid_body("ball", add(model, prepare(dilate(sphere, 1e-3))),
                                                          mass_properties(sphere, density)));
                const Cable rope = add_cable(
                    model, {.name = "rope",
                            .nodes = straight_nodes({-kLength / 2, 0, 0}, {kLength / 2, 0, 0}, 40),
                            .section = beam_section(
                                {.radius = kRadius, .young = 2e7, .density = kDensity, .damping_time = 1e-2}),
                            .radius = kRadius});
                State state = rest_state(model);
                lay(rope, state);
                pose(state, ball).p = {0.01, 0, 0.06};
                linear_part(state.v, ball) = -Vec3::UnitZ();
                const double thrown = momentum(model, state).linear.norm();
                Vec3 before = momentum(model, state).linear;
                Worst jump;
                Least gap;
                const MoreauJean scheme(model, {.h = 1e-3, .solver = {.tolerance = 1e-12}}, {.theta = 0.5});
                run_accepted(scheme, state, 0.1, [&](const StepReport& report) {
                  for (const StepContact& c : report.contacts) gap.add(c.point.gap / (kRadius + 1e-3));
                  const Vec3 after = momentum(model, state).linear;
                  jump.add((after - std::exchange(before, after)).norm() / thrown);
                  return true;
                });
                const Vec3 of_rope = momentum(model, state).linear -
                                     model.bodies[ball].mass * Vec3(linear_part(state.v, ball));
                return Figures{{"momentum", jump}, {"gap", gap}, {"given", of_rope.norm() / rope_mass}};
              },
          .certified = true};
}

// How far from the middle of its ring the cable crosses the plane of each clip [m]; empty where it does not.
std::vector<double> crossings(const CableInClips& s) {
  std::vector<double> out;
  for (const Vec3& middle : s.clips)
    for (std::size_t i = 1; i < s.cable.nodes.size(); ++i) {
      const Vec3 a = place_of(s.state, s.cable.nodes[i - 1]) - middle,
                 b = place_of(s.state, s.cable.nodes[i]) - middle;
      if ((a.x() < 0) == (b.x() < 0)) continue;
      out.push_back((a + a.x() / (a.x() - b.x()) * (b - a)).tail<2>().norm());
    }
  return out;
}

VerificationCase through_clips() {
  return {.name = "K10.clips",
          .what = "cable of rubber pulled through three rings that are not in line, until it has left them",
          .rows = {{"inside", "farthest place where it crosses the plane of a ring, over the ring's radius",
                    "-", 1, "base complexes never cross"},
                   {"gap", "smallest gap at the start of a step, over the sum of the dilations", "-", -0.042,
                    "certificate (CA-6)", Sense::at_least},
                   {"threaded", "rings that it crosses at first", "-", 3, "it is laid so", Sense::exactly},
                   {"left", "rings that it crosses at the end", "-", 0, "it is longer than the way",
                    Sense::exactly}},
          .measure =
              [] {
                CableInClips s;
                const std::size_t threaded = crossings(s).size();
                Worst inside;
                Least gap;
                run_accepted(MoreauJean(s.model, {.h = 2e-3}, {.theta = 1}), s.state, 3,
                             [&](const StepReport& report) {
                               for (const double way : crossings(s)) inside.add(way / CableInClips::kRing);
                               for (const StepContact& c : report.contacts)
                                 gap.add(c.point.gap / (CableInClips::kRadius + CableInClips::kWire));
                               return !crossings(s).empty();
                             });
                return Figures{{"inside", inside},
                               {"gap", gap},
                               {"threaded", double(threaded)},
                               {"left", double(crossings(s).size())}};
              },
          .slow = true,
          .certified = true};
}

}  // namespace

std::vector<VerificationCase> cable_contact_verification() {
  std::vector<VerificationCase> out{heavy_beam()};
  for (const double mu : {0.2, 0.5}) {
    out.push_back(capstan(mu, 0.5, 16));
    out.push_back(capstan(mu, 1, 64));
  }
  out.push_back(rope_on_peg());
  out.push_back(clasp());
  out.push_back(held_knot());
  out.push_back(plectoneme());
  for (const double ratio : {0.1, 1.0, 30.0, 1000.0}) out.push_back(ball_meets_rope(ratio));
  out.push_back(through_clips());
  return out;
}

}  // namespace aussois
