// SPDX-License-Identifier: Apache-2.0
// Group E: beams joined to frames, loops and rigid bodies: E9 and E14 (doc/theory/beams.md).
#include <cmath>
#include <functional>
#include <memory>

#include "examples/common/convergence.hpp"
#include "examples/scenes/beams.hpp"
#include "examples/studies/verification/plane_rod.hpp"
#include "examples/studies/verification/running.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

// So stiff about other axes that it stays in its plane.
BeamSection lees_section() {
  constexpr double kMuch = 100;
  BeamSection out = section_of(lees_numbers());
  out.stiffness[3] *= kMuch, out.stiffness[4] *= kMuch;
  return out;
}

struct LeesFrame {
  BeamScene scene{};
  BodyId pushed{};
  explicit LeesFrame(int per_leg)
      : scene(legs_scene({{0, 0, 0}, {0, kLeesLeg, 0}, {kLeesLeg, kLeesLeg, 0}}, per_leg, lees_section())),
        pushed(scene.cable.nodes[std::size_t(per_leg + per_leg / 5)]) {
    for (const BodyId end : {scene.first(), scene.last()})
      add(scene.model, joint_at(JointKind::revolute, "hinge", end, kWorld, scene.state.g,
                                {Quat::Identity(), pose(scene.state, end).p}));
    scene.state = rest_state(scene.model);
    lay(scene.cable, scene.state);
  }
};

// The load as the pushed point is moved down, from depth to depth.
class LeesPath {
 public:
  explicit LeesPath(int per_leg) : frame_(per_leg) {
    BeamScene& s = frame_.scene;
    Joint guide = joint_at(JointKind::planar, "guide", frame_.pushed, kWorld, s.state.g,
                           {Quat::Identity(), pose(s.state, frame_.pushed).p});
    guide.axis[1].motor = {.kind = MotorKind::position,
                           .target = [depth = depth_](double) { return -*depth; }};
    guide_ = add(s.model, guide);
    s.state = rest_state(s.model);
    lay(s.cable, s.state);
    scheme_ = std::make_unique<MoreauJean>(s.model, StepOptions{.h = 100}, MoreauJeanOptions{.theta = 1});
  }
  double load_at(double depth) {
    *depth_ = depth;
    const StepReport report = settle(*scheme_, frame_.scene.state, {.first_h = 100, .displacement = 1e-7});
    require_accepted(report);
    return -report.joints[guide_].effort[1];
  }

 private:
  LeesFrame frame_;
  std::shared_ptr<double> depth_ = std::make_shared<double>(0);
  JointId guide_{};
  std::unique_ptr<MoreauJean> scheme_{};
};

// The largest load on the way down: in steps of 2 m, then by a parabola through three depths about it.
double limit_load(const std::function<double(double)>& load_at) {
  double depth = 2, load = load_at(depth);
  for (double next = load_at(depth + 2); next > load; next = load_at(depth + 2)) load = next, depth += 2;
  const auto top = [&](double half) {
    const double a = load_at(depth - half), b = load_at(depth), c = load_at(depth + half);
    const double x = (a - c) / (2 * (a - 2 * b + c));
    depth += x * half;
    return b - (a - c) * x / 4;
  };
  top(2);
  return top(0.25);
}

VerificationCase lees_frame() {
  return {
      .name = "E9.lees_frame",
      .what = "Lee's frame, hinged at both ends, pushed down 24 m from its corner, 5 to 40 elements a leg",
      .rows = {{"limit", "limit load with 20 elements a leg, relative", "-", 5e-3,
                "the same frame by shooting"},
               {"order", "fitted order of the limit load, 5 to 40 elements a leg", "-", 1.9, "theory: 2",
                Sense::at_least},
               {"known", "limit load by shooting off 1.855 N, relative", "-", 5e-3,
                "literature: 18.55 with ten times the stiffness; its figure has a shear of its own"}},
      .measure = [] {
        const double exact = limit_load(lees_load);
        std::vector<double> l, off;
        for (const int n : {5, 10, 20, 40}) {
          LeesPath path(n);
          l.push_back(1.0 / n);
          off.push_back(std::abs(limit_load([&](double depth) { return path.load_at(depth); }) / exact - 1));
        }
        return Figures{
            {"limit", off[2]}, {"order", fitted_order(l, off)}, {"known", std::abs(exact / 1.855 - 1)}};
      }};
}

// More than the frame can bear: it snaps through to where it can.
VerificationCase lees_snap() {
  return {
      .name = "E9.snap",
      .what = "Lee's frame, 40 elements a leg, under 1.05 times the limit load until it is at rest again",
      .rows = {{"depth", "depth of the pushed point", "m", 70, "beyond the limit, which is at 49 m",
                Sense::at_least},
               {"load", "load that keeps it there, off the load, relative", "-", 5e-3,
                "the same frame by shooting"}},
      .measure = [] {
        LeesFrame frame(40);
        BeamScene& s = frame.scene;
        const double load = 1.05 * limit_load(lees_load);
        add(s.model, DeadLoad{.body = frame.pushed, .force = -load * Vec3::UnitY()});
        const MoreauJean scheme(s.model, {.h = 0.1}, {.theta = 1});
        run_accepted(scheme, s.state, 30);
        const MoreauJean still(s.model, {.h = 100}, {.theta = 1});
        require_accepted(settle(still, s.state, {.displacement = 1e-7}));
        const double depth = kLeesLeg - pose(s.state, frame.pushed).p.y();
        const SE3& foot = pose(s.state, s.first());
        const Vec3 force = foot.R * exp_so3(kPi / 2 * Vec3::UnitZ()) *
                           Vec3(beam_loads(s.cable.beam, s.state).front().stress.head<3>());
        const LeesAnswer near = {force.head<2>(), log_so3(foot.R).z(), load};
        return Figures{{"depth", depth}, {"load", std::abs(lees_equilibrium(depth, near).load / load - 1)}};
      }};
}

// A crank that is turned, a coupler that bends, a rocker; ground pivots at the origin and at (0.3, 0).
VerificationCase flexible_coupler() {
  return {
      .name = "E14.coupler",
      .what =
          "four-bar whose coupler is a beam of 16 elements, its crank brought to 2 pi rad/s in 0.5 s, 2 s",
      .rows = {{"joints", "largest error of a joint", "m", 1e-12, "held at each end of a step; rounding"},
               {"rocker", "largest place of its head off that of rigid bars, over its length", "-", 1e-3,
                "closed form; inertia stretches and bends the coupler by less"},
               {"bends", "largest bend of the coupler's middle, over its length", "-", 1e-6,
                "it is no rigid bar", Sense::at_least}},
      .measure = [] {
        constexpr double kCrank = 0.1, kCoupler = 0.3, kRocker = 0.25, kGround = 0.3, kRise = 0.5;
        // The head of the rocker over that of the crank
        const auto head = [&](const Vec3& b) -> Vec3 {
          const Vec3 d = Vec3(kGround, 0, 0) - b;
          const double r = d.norm(), along = (kCoupler * kCoupler - kRocker * kRocker + r * r) / (2 * r);
          return b + along / r * d +
                 std::sqrt(kCoupler * kCoupler - along * along) / r * Vec3(-d.y(), d.x(), 0);
        };
        const Vec3 b(0, kCrank, 0), c = head(b), pivot(kGround, 0, 0);
        BeamScene s = beam_scene(
            straight_nodes(b, c, 16),
            {.EA = 1e5, .GA = 4e4, .GJ = 10, .EI = 10, .mass = 0.2, .about_x = 2e-5, .across = 1e-5}, false);
        const auto bar = [&](const char* name) {
          return add(s.model, RigidBody{.name = name, .mass = 0.2, .inertia = 1e-3 * Mat3::Identity()});
        };
        const BodyId crank = bar("crank"), rocker = bar("rocker");
        s.state = rest_state(s.model);
        lay(s.cable, s.state);
        pose(s.state, crank).p = b / 2, pose(s.state, rocker).p = (c + pivot) / 2;
        const auto hinge = [&](BodyId on, BodyId to, const Vec3& at) {
          return joint_at(JointKind::revolute, "hinge", on, to, s.state.g, {Quat::Identity(), at});
        };
        Joint driven = hinge(crank, kWorld, Vec3::Zero());
        driven.axis[0].motor = {.kind = MotorKind::speed, .target = [](double t) {
                                  return t < kRise ? kPi * (1 - std::cos(kPi * t / kRise)) : 2 * kPi;
                                }};
        add(s.model, driven);
        add(s.model, hinge(s.first(), crank, b));
        add(s.model, hinge(s.last(), rocker, c));
        add(s.model, hinge(rocker, kWorld, pivot));
        const PerBody<SE3> laid = s.state.g;
        s.state = rest_state(s.model);
        s.state.g = laid;
        Worst joints, off, bend;
        const MoreauJean scheme(s.model, {.h = 1e-3, .solver = {.tolerance = 1e-12}}, {.theta = 0.5});
        run_accepted(scheme, s.state, 2, [&](const StepReport&) {
          joints.add(joint_error(s.model, s.state).translation);
          const Vec3 from = pose(s.state, s.first()).p, to = pose(s.state, s.last()).p;
          off.add((to - head(from)).norm() / kRocker);
          bend.add((pose(s.state, s.cable.nodes[8]).p - (from + to) / 2).norm() / kCoupler);
          return true;
        });
        return Figures{{"joints", joints}, {"rocker", off}, {"bends", bend}};
      }};
}

// Two nodes of a beam that flies are pinned to a box that turns.
BeamScene pinned_scene(BodyId& box) {
  BeamScene s = beam_scene(
      straight_nodes({-0.2, 0, 0.06}, {0.2, 0, 0.06}, 20),
      {.EA = 1e4, .GA = 4e3, .GJ = 0.1, .EI = 0.1, .mass = 0.5, .about_x = 2e-4, .across = 1e-4}, false);
  box = add(s.model, RigidBody{.name = "box", .mass = 1, .inertia = Vec3(2e-3, 4e-3, 5e-3).asDiagonal()});
  s.state = rest_state(s.model);
  lay(s.cable, s.state);
  for (const std::size_t k : {5u, 15u}) {
    const BodyId node = s.cable.nodes[k];
    add(s.model, joint_at(JointKind::spherical, "pin", node, box, s.state.g,
                          {Quat::Identity(), pose(s.state, node).p}));
  }
  const Vec3 turn(1, 2, 3);
  for (const BodyId b : s.model.bodies.ids()) {
    linear_part(s.state.v, b) = turn.cross(pose(s.state, b).p);
    angular_part(s.state.v, b) = pose(s.state, b).R.conjugate() * turn;
  }
  return s;
}

Figures fly_pinned(double h) {
  BodyId box{};
  BeamScene s = pinned_scene(box);
  const auto end_on_box = [&] {
    const SE3& g = pose(s.state, box);
    return Vec3(g.R.conjugate() * (pose(s.state, s.last()).p - g.p));
  };
  double mass = 0;
  for (const BodyId b : s.model.bodies.ids()) mass += s.model.bodies[b].mass;
  const Momentum start = momentum(s.model, s.state);
  const Vec3 laid = end_on_box();
  Momentum before = start;
  Worst joints, linear, bend;
  const MoreauJean scheme(s.model, {.h = h, .solver = {.tolerance = 1e-14}},
                          {.theta = 0.5, .newton = {.max_iterations = 12, .tolerance = 1e-12}});
  run_accepted(scheme, s.state, 0.5, [&](const StepReport&) {
    const Momentum now = momentum(s.model, s.state);
    linear.add((now.linear - std::exchange(before, now).linear).norm() / mass);
    joints.add(joint_error(s.model, s.state).translation);
    bend.add((end_on_box() - laid).norm());
    return true;
  });
  return {{"joints", joints},
          {"linear", linear},
          {"angular", (before.angular - start.angular).norm() / start.angular.norm()},
          {"bends", bend}};
}

VerificationCase pinned_beam() {
  return {.name = "E14.pinned",
          .what =
              "free box that turns at 3.7 rad/s, two nodes of a beam of 20 elements pinned to it, 0.5 s, "
              "h = 1 ms and 0.5 ms",
          .rows = {{"joints", "largest error of a joint", "m", 1e-12, "no drift; rounding"},
                   {"linear", "largest change of the momentum in a step, over the mass times 1 m/s", "-",
                    1e-13, "action and reaction; rounding"},
                   {"angular", "change of the angular momentum, relative", "-", 1e-6,
                    "kept but for the order in h"},
                   {"order", "order of that change", "-", 1.9, "theory: 2", Sense::at_least},
                   {"bends", "largest distance of the beam's end from its place on the box", "m", 1e-4,
                    "it is not rigid", Sense::at_least}},
          .measure = [] {
            Figures out = fly_pinned(1e-3);
            out["order"] = std::log2(out["angular"] / fly_pinned(5e-4)["angular"]);
            return out;
          }};
}

}  // namespace

std::vector<VerificationCase> beam_frame_verification() {
  return {lees_frame(), lees_snap(), flexible_coupler(), pinned_beam()};
}

}  // namespace aussois
