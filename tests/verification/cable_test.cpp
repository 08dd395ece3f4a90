// SPDX-License-Identifier: Apache-2.0
// Cables in contact (doc/theory/beams.md): what they give to others, that they are certified, repeatable, and
// refused where an element turns too far.
#include "mechanics/cable.hpp"

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/pose/contact_problem.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/checkpoint.hpp"
#include "lmd/find_contacts.hpp"
#include "mechanics/surface.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr double kRadius = 3e-3;  // [m]
BeamSection rubber() {
  return beam_section(
      {.radius = kRadius, .young = 5e6, .poisson = 0.45, .density = 1200, .damping_time = 2e-2});
}

struct CableScene {
  Model model{};
  State state{};
  Cable cable{};
  BodyId other{};
};

// A cable across a ball that is free to move, or over a fixed peg.
CableScene cable_over(bool peg) {
  CableScene s;
  s.model.contact_law.mu = 0.4;
  if (peg) {
    const SimplicialComplex rod =
        transformed_complex(make_cylinder(0.03, 0.1, 24), rotation(Vec3::UnitX(), kPi / 2));
    s.other = add(s.model, fixed_body("peg", add(s.model, prepare(dilate(rod, 1e-3)))));
  } else {
    s.other = add(s.model, RigidBody{.name = "ball",
                                     .shape = add(s.model, prepare(dilate(make_point(), 0.03))),
                                     .mass = 0.02,
                                     .inertia = 7e-6 * Mat3::Identity()});
  }
  s.cable =
      add_cable(s.model, {.nodes = frames_along(points_along({{-0.19, 0, 0.0345}, {0.2, 0, 0.0345}}, 21)),
                          .section = rubber(),
                          .radius = kRadius});
  s.state = rest_state(s.model);
  lay(s.cable, s.state);
  return s;
}

// The force and the moment about the origin that the impulse `r` of a row gives to all bodies.
std::pair<Vec3, Vec3> given_by(const CableScene& s, const Layout& dofs, const ContactRow& row,
                               const RowVector& r) {
  VecX all = VecX::Zero(dofs.rows);
  for (const auto& [body, J] : {std::pair(row.body_a, &row.J_a), std::pair(row.body_b, &row.J_b)})
    if (const int first = first_row(dofs, body); first >= 0) all.segment<6>(first) += J->transpose() * r;
  for (const Triplet& e : row.others) all[e.col()] += e.value() * r[e.row()];
  std::pair<Vec3, Vec3> out{Vec3::Zero(), Vec3::Zero()};
  for (const BodyId b : s.model.bodies.ids()) {
    const int first = dofs.first[b];
    if (first < 0) continue;
    const Vec3 force = all.segment<3>(first), torque = pose(s.state, b).R * Vec3(all.segment<3>(first + 3));
    out.first += force;
    out.second += pose(s.state, b).p.cross(force) + torque;
  }
  return out;
}

TEST(CableContacts, GiveToTheBallWhatTheyTakeFromTheNodes) {
  CableScene s = cable_over(false);
  Random random(3);
  for (int trial = 0; trial < 20; ++trial) {
    s.model.contact_law.contensou_radius = trial % 2 ? 1e-3 : 0;
    lay(s.cable, s.state);
    for (const BodyId node : s.cable.nodes) {
      pose(s.state, node).p += random.vector(1e-4);
      pose(s.state, node).R = pose(s.state, node).R * exp_so3(random.vector(0.5));
    }
    const ContactSet found =
        find_contacts(posed_shape(s.model, s.state, s.other), posed_shape(s.model, s.state, s.cable.surface),
                      {.threshold = 5e-3});
    ASSERT_FALSE(found.points.empty());
    const Layout dofs = layout(s.model);
    double turned = 0;
    RowVector r = RowVector::Zero();
    r.head<3>() << 1, 0.3, -0.4;
    if (trial % 2) r[3] = 0.02;  // about the normal
    for (const ContactRow& row : contact_rows(s.model, s.state, dofs, found, VecX::Zero(s.state.v.size()),
                                              1e-3, {.law = NormalLaw::moreau})) {
      const auto [force, moment] = given_by(s, dofs, row, r);
      EXPECT_LT(force.norm(), 1e-15);
      EXPECT_LT(moment.norm(), 1e-16) << "of an impulse of 1.1 N s at an arm of 3 cm";
      for (const Triplet& e : row.others)
        if ((e.col() - dofs.first[s.cable.nodes[0]]) % 6 >= 3) turned = std::max(turned, std::abs(e.value()));
    }
    EXPECT_GT(turned, 1e-3) << "friction turns the cable: arms are its radius";
  }
}

// Its ends hang down, the peg bears its weight, nothing passes through, and no thread and no restart shows.
TEST(CableContacts, ACableHangsOverAPeg) {
  const CableScene start = cable_over(true);
  const auto hung = [&](int threads, int stop, PathAudit* audit) {
    State state = start.state;
    MoreauJean scheme(start.model, {.h = 2e-3, .threads = threads}, {.theta = 1});
    Vec3 impulse = Vec3::Zero();
    double time = 0;
    for (int k = 0; k < 400; ++k) {
      if (k == stop) {
        const auto path = fresh_folder() / "checkpoint.h5";
        write_checkpoint(path, {.fingerprint = 1, .step = k, .state = state});
        state = read_checkpoint(path, 1).state;
        scheme = MoreauJean(start.model, {.h = 2e-3, .threads = threads}, {.theta = 1});
      }
      const State before = state;
      const StepReport report = scheme.step(state);
      EXPECT_TRUE(report.ok()) << report.reason;
      if (audit) audit_path(start.model, before, state, report, 1, *audit);
      if (k < 200) continue;
      time += report.h;
      for (const StepContact& c : report.contacts)
        impulse += (c.point.a.body == start.cable.surface ? 1 : -1) * c.impulse;
    }
    const double weight = rubber().mass_per_length * 0.39 * kGravity;
    EXPECT_NEAR(impulse.z() / time, weight, 0.1 * weight) << "its centre moves at less than 0.4 m/s";
    EXPECT_LT(pose(state, start.cable.nodes.front()).p.z(), 0);
    EXPECT_LT(pose(state, start.cable.nodes.back()).p.z(), -0.05);
    return hash(state);
  };
  PathAudit audit{.samples = 4};
  const std::uint64_t once = hung(1, -1, &audit);
  EXPECT_EQ(audit.violations, 0);
  EXPECT_GT(audit.min_distance, 0.96 * (kRadius + 1e-3));
  EXPECT_EQ(hung(4, -1, nullptr), once);
  EXPECT_EQ(hung(1, 133, nullptr), once);
}

// Each node bears what an element weighs, from the first step on; the one that is fixed, nothing.
TEST(CableContacts, ACableLiesStillOnAFloor) {
  for (const double step : {1e-4, 1e-2, 1.0}) {
    Model model;
    const ShapeId plate = add(model, prepare(dilate(make_plate(2, 2), 1e-3)));
    add(model, fixed_body("floor", plate));
    const double height = kRadius + 1e-3;
    const Cable cable =
        add_cable(model, {.nodes = frames_along(points_along({{-0.4, 0.1, height}, {0.4, 0.1, height}}, 21)),
                          .section = rubber(),
                          .radius = kRadius});
    model.bodies[cable.nodes.front()].motion = FixedMotion{};
    State state = rest_state(model);
    lay(cable, state);
    const MoreauJean scheme(model, {.h = step, .solver = {.tolerance = 1e-12}}, {.theta = 1});
    const double weight = rubber().mass_per_length * 0.04 * kGravity;
    for (int k = 0; k < 20; ++k) {
      const StepReport report = scheme.step(state);
      ASSERT_TRUE(report.ok()) << report.reason;
      EXPECT_EQ(report.contacts.size(), 20U);
      EXPECT_LT(largest_speeds(state).all * report.h, 1e-9);
      for (const StepContact& c : report.contacts) {
        const bool last = std::abs(c.point.x_a.x()) > 0.39;
        EXPECT_NEAR(c.impulse.norm() / report.h, (last ? 0.5 : 1) * weight, 1e-3 * weight) << k;
      }
    }
  }
}

// One end is held, the other spins with a thousand times the energy that the rubber takes up.
TEST(Cable, IsRefusedByNameWhereAnElementTurnsTooFar) {
  Model model;
  model.gravity = Vec3::Zero();
  const Cable cable = add_cable(
      model,
      {.nodes = frames_along(points_along({Vec3::Zero(), 0.1 * Vec3::UnitX()}, 3)), .section = rubber()});
  model.bodies[cable.nodes[0]].motion = FixedMotion{};
  State state = rest_state(model);
  lay(cable, state);
  twist(state, cable.nodes[2])[3] = 1e5;
  const MoreauJean scheme(model, {.h = 1e-3}, {.theta = 1});
  StepReport last;
  for (int k = 0; k < 1000 && last.moved(); ++k) {
    last = scheme.step(state);
    EXPECT_LE(log_so3(pose(state, cable.nodes[1]).R.conjugate() * pose(state, cable.nodes[2]).R).norm(),
              kLargestBeamTurn);
  }
  EXPECT_EQ(last.status, StepStatus::refused);
  EXPECT_NE(last.reason.find("force law (cable): element 1 turns by"), std::string::npos) << last.reason;
}

// Long steps of the linearly implicit midpoint rule make a whipping cable gain energy; that is told, and no
// gain is told where the steps are short enough. Both begin with the same.
TEST(Cable, EnergyThatAStepMakesIsTold) {
  Model model;
  model.gravity = Vec3::Zero();
  BeamSection section = rubber();
  section.damping.setZero();
  const Cable cable = add_cable(
      model,
      {.nodes = frames_along(points_along({Vec3::Zero(), 0.4 * Vec3::UnitX()}, 41)), .section = section});
  for (const auto& [h, rises] : {std::pair(2e-3, true), {2e-5, false}}) {
    State state = rest_state(model);
    lay(cable, state);
    twist(state, cable.nodes.back()) << 0, 0, 8, 0, 0, 0;
    EnergyGain gain = energy_gain(model, state);
    const double begin = gain.stored;
    const MoreauJean scheme(model, {.h = h});
    const StepReport last = run(scheme, state, 0.2, [&](const StepReport& report) {
      if (report.moved()) add_step(model, state, report, gain);
      return report.moved();
    });
    EXPECT_EQ(energy_rises(gain), rises) << "h = " << h << ", " << gain.largest << " of " << begin << " J";
    EXPECT_TRUE(rises || last.ok()) << last.reason;
  }
}

// A cable of nylon strikes an edge at 5 m/s, which turns it by tenths of a radian in a step. One iteration
// takes its forces as they are at the start.
TEST(Cable, ThatIsStruckGainsEnergyByOneIterationAndNoneByTheLoop) {
  Model model;
  model.gravity = Vec3::Zero();
  model.contact_law.mu = 0.3;
  const SimplicialComplex thin = make_box(0.06, 0.06, 1e-4);
  add(model, fixed_body("edge", add(model, prepare(dilate(thin, 1e-3)))));
  const Cable cable = add_cable(
      model, {.nodes = frames_along(points_along({{0.02, -0.03, 0.01}, {0.02, 0.03, 0.02}}, 5)),
              .section = beam_section(
                  {.radius = 1e-3, .young = 2e9, .poisson = 0.4, .density = 1200, .damping_time = 1e-4}),
              .radius = 1e-3});
  for (const bool loop : {false, true}) {
    State state = rest_state(model);
    lay(cable, state);
    for (const BodyId node : cable.nodes) linear_part(state.v, node) = -5 * Vec3::UnitZ();
    const double thrown = energy(model, state).total();
    EnergyGain gain = energy_gain(model, state);
    double most = 0;
    const NewtonOptions newton =
        loop ? NewtonOptions{.max_iterations = 15, .tolerance = 1e-6} : NewtonOptions{};
    const MoreauJean scheme(model, {.h = 6e-3}, {.theta = 1, .newton = newton});
    const StepReport last = run(scheme, state, 0.03, [&](const StepReport& report) {
      if (report.moved()) add_step(model, state, report, gain);
      most = std::max(most, energy(model, state).total());
      return report.ok();
    });
    EXPECT_TRUE(last.ok()) << last.reason;
    EXPECT_EQ(energy_rises(gain), !loop);
    if (loop)
      EXPECT_LT(most, (1 + 1e-9) * thrown);
    else
      EXPECT_GT(most, 5 * thrown);
  }
}

// What moves an end gives energy through the elements; that is no gain.
TEST(Cable, EnergyOfAMovedEndIsNoGain) {
  Model model;
  model.gravity = Vec3::Zero();
  const Cable cable = add_cable(
      model,
      {.nodes = frames_along(points_along({Vec3::Zero(), 0.2 * Vec3::UnitX()}, 11)), .section = rubber()});
  model.bodies[cable.nodes[0]].motion = DrivenMotion{};
  State state = rest_state(model);
  lay(cable, state);
  twist(state, cable.nodes[0])[2] = 1;
  EnergyGain gain = energy_gain(model, state);
  const MoreauJean scheme(model, {.h = 1e-4}, {.theta = 1});
  for (int k = 0; k < 200; ++k) {
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    add_step(model, state, report, gain);
  }
  EXPECT_GT(energy(model, state).kinetic, 1e-4);
  EXPECT_FALSE(energy_rises(gain)) << gain.largest;
}

// A cantilever under its weight: q l^4 / (8 EI) at its tip while it bends little, from above and from below.
TEST(Settle, EndsInTheOneEquilibriumOfASag) {
  Model model;
  const BeamSection steel = beam_section({.radius = 1e-3, .young = 2e11, .density = 7800});
  const Cable cable = add_cable(
      model,
      {.nodes = frames_along(points_along({Vec3::Zero(), 0.2 * Vec3::UnitX()}, 33)), .section = steel});
  model.bodies[cable.nodes[0]].motion = FixedMotion{};
  const MoreauJean scheme(model, {.h = 1e4}, {.theta = 1});
  std::vector<Vec3> tips;
  State hung;
  for (const double push : {0.02, -0.02, 0.0}) {
    State state = rest_state(model);
    lay(cable, state);
    for (const BodyId node : cable.nodes) {
      Vec3& p = pose(state, node).p;
      p.z() += push * p.x() * p.x() / 0.04;
    }
    pose(state, cable.nodes[0]) = cable.laid[0];
    const StepReport report = settle(scheme, state);
    ASSERT_TRUE(report.ok()) << report.reason;
    tips.push_back(pose(state, cable.nodes.back()).p);
    hung = state;
  }
  // The first element bears what hangs on it from its middle on
  const BeamLoad clamp = beam_loads(cable.beam, hung).front();
  const double q = steel.mass_per_length * kGravity, beyond = 0.2 - 0.2 / 64;  // its middle
  EXPECT_NEAR(clamp.stress.segment<2>(1).norm(), q * beyond, 1e-3 * q);
  EXPECT_NEAR(clamp.stress.tail<2>().norm(), q * beyond * beyond / 2, 2e-3 * q * beyond);
  const double sag = q * std::pow(0.2, 4) / (8 * steel.stiffness[4]);
  EXPECT_NEAR(-tips[0].z(), sag, 2e-3 * sag);
  for (const Vec3& tip : tips) EXPECT_LT((tip - tips[0]).norm(), 1e-11);
  EXPECT_EQ(message_of([&] { (void)settle(scheme, hung, {.growth = 1}); }),
            "SettleOptions::growth = 1 must be finite and > 1");
  EXPECT_NE(message_of([&] { (void)settle(scheme, hung, {.displacement = 0}); }).find("displacement = 0"),
            std::string::npos);
  State state = rest_state(model);
  lay(cable, state);
  const StepReport cut = settle(scheme, state, {.max_steps = 2});
  EXPECT_EQ(cut.status, StepStatus::not_solved);
  EXPECT_EQ(cut.reason, "not at rest after 2 steps");
}

}  // namespace
}  // namespace aussois
