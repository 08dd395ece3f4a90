// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/toss/toss_rollout.hpp"

#include <algorithm>
#include <cmath>

#include "examples/common/random.hpp"
#include "geometry/check.hpp"
#include "geometry/convex_hull.hpp"
#include "geometry/primitives.hpp"
#include "geometry/so3.hpp"
#include "integrators/run.hpp"

namespace aussois {
namespace {

constexpr double kDilation = 5e-5;   // of cube and board [m]: corners are round by so much
constexpr double kBoardSide = 20;    // [m]
constexpr double kRate = 148;        // of recordings [1/s]
constexpr double kClearance = 1e-6;  // of a start that was raised [m]
constexpr int kCube = 0;

double lowest_corner(const SE3& g) {
  double z = kInf;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    z = std::min(z, (g * (kTossEdge / 2 * corner)).z());
  }
  return z;
}

// Each corner becomes three, one on each of its edges.
SimplicialComplex cut_cube(double edge, double cut) {
  if (cut == 0) return make_box(edge, edge, edge);
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 x = edge / 2 * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      x[axis] *= 1 - 2 * cut / edge;
      corners.push_back(x);
    }
  return make_complex(corners, convex_hull(corners), {}, true);
}

}  // namespace

void describe(SettingVisitor& visit, TossWorld& o) {
  visit.begin("TossWorld");
  visit.group("law", o.law);
  visit.count({"substeps", "steps per recorded row", "", {1, 1000}, "--substeps"}, o.substeps);
  visit.number({"board", "height of the board's surface", "m", {-kTossEdge, kTossEdge}, "--board"}, o.board);
  visit.number({"cut", "length cut off the edges at each corner of the cube; 0: keep the corners", "m",
                range_open_above(0, kTossEdge / 2 - kDilation), "--cut"},
               o.cut);
}

Model toss_model(const TossWorld& world) {
  check_ranges(world);
  Model model;
  model.gravity = {0, 0, -kTossGravity};
  model.contact_law = world.law;
  const double inner = kTossEdge - 2 * kDilation;
  const auto cube = add(model, prepare(dilate(cut_cube(inner, world.cut), kDilation)));
  const auto board = add(model, prepare(dilate(make_plate(kBoardSide, kBoardSide), kDilation)));
  add(model,
      RigidBody{
          .name = "cube", .shape = cube, .mass = kTossMass, .inertia = kTossInertia * Mat3::Identity()});
  add(model, fixed_body("board", board));
  return model;
}

TossRun roll_out(const Toss& toss, const TossWorld& world) {
  return roll_out(toss, start_of(toss), world);
}
TossRun roll_out(const Toss& toss, const TossWorld& world, const WatchFlags& flags, const std::string& name) {
  return roll_out(toss, start_of(toss), world, {}, flags, name);
}

TossRun roll_out(const Toss& toss, const TossStart& start, const TossWorld& world, const LookAtStep& look,
                 const WatchFlags& flags, const std::string& name) {
  const Model model = toss_model(world);
  RunWatch watch(flags, name);
  SchemeOptions options = world.options;
  watch.set_options(options.step);
  options.step.h = (toss.t.back() - toss.t.front()) / double(toss.t.size() - 1) / world.substeps;
  const Scheme scheme = watch.watched(model, make_scheme(world.scheme, model, options));
  State state = rest_state(model);
  pose(state, 1) = translation(0, 0, world.board - kDilation);
  pose(state, kCube) = start.pose;
  twist(state, kCube) = start.twist;
  TossRun run{.start = start.row};
  if (const double below = world.board - lowest_corner(start.pose); below > 0) {
    run.lifted = below + kClearance;
    pose(state, kCube).p.z() += run.lifted;
  }
  for (std::size_t row = start.row; row < toss.t.size() && run.failure.empty(); ++row) {
    const double until = toss.t[row] - toss.t[start.row];
    const StepReport last = run_until(scheme, state, until, [&](const StepReport& report) {
      ++run.steps;
      run.reduced_steps += report.contacts_kept < report.contacts_found;
      run.most_contacts = std::max(run.most_contacts, report.contacts_found);
      if (look) look(state, report);
    });
    if (last.status == StepStatus::not_solved)
      run.failure = "not solved at t = " + std::to_string(last.t) + " s";
    else if (!last.ok())
      run.failure = last.reason;
    if (!run.failure.empty()) break;
    run.pose.push_back(pose(state, kCube));
    run.twist.push_back(twist(state, kCube));
    run.contacts.push_back(run.most_contacts);
    const SE3& measured = toss.pose[row];
    const double dp = (run.pose.back().p - measured.p).norm();
    const double angle = log_so3((measured.R.conjugate() * run.pose.back().R).normalized()).norm();
    run.errors.position += dp;
    run.errors.rotation += angle;
    run.errors.loss += dp * dp / (kTossEdge / 2) + angle * angle;
  }
  const double rows = double(std::max(run.pose.size(), std::size_t(1)));
  run.errors.position /= rows;
  run.errors.rotation /= rows;
  run.errors.loss /= rows;
  run.audit = watch.audit();
  return run;
}

Toss synthetic_toss(unsigned seed, const TossWorld& world, double noise) {
  Random random(seed);
  const std::string number = std::to_string(seed);
  Toss toss{.name = "toss_" + std::string(3 - std::min(number.size(), std::size_t(3)), '0') + number};
  constexpr int kRows = 110;
  for (int k = 0; k < kRows; ++k) {
    toss.t.push_back(k / kRate);
    toss.pose.emplace_back();
    toss.twist.emplace_back(Vec6::Zero());
  }
  TossStart thrown;
  thrown.pose.R = exp_so3(random.vector(2));
  thrown.pose.p.z() = random.uniform(0.13, 0.2);
  thrown.twist.head<3>() = random.vector(1);
  thrown.twist.tail<3>() = random.vector(8);
  const TossRun run = roll_out(toss, thrown, world);
  for (std::size_t k = 0; k < toss.t.size(); ++k) {
    const std::size_t i = std::min(k, run.pose.size() - 1);
    const Vec3 shift = noise * random.normal_vector(),
               turn = noise / (kTossEdge / 2) * random.normal_vector();
    toss.pose[k] = {(run.pose[i].R * exp_so3(turn)).normalized(), run.pose[i].p + shift};
    toss.twist[k] = run.twist[i];
  }
  return toss;
}

}  // namespace aussois
