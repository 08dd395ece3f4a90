// SPDX-License-Identifier: Apache-2.0
// Kinds of body that no room behind mechanics knows (doc/theory/deforming_shapes.md): they collide, are
// certified, restart and are drawn.
#include "tests/support/deforming_bodies.hpp"

#include <algorithm>

#include "integrators/pose/contact_problem.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "io/checkpoint.hpp"
#include "io/record.hpp"
#include "io/replay_html.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"
#include "tests/support/scheme_variants.hpp"

namespace aussois {
namespace {

constexpr double kPlate = 1e-3;  // dilation of plates [m]

BodyId add_plate(Model& model, const std::string& name) {
  RigidBody plate = fixed_body(name, add(model, prepare(dilate(make_box(1, 1, 0.02), kPlate))));
  return add(model, plate);
}

struct Fall {
  Model model{};
  State state{};
  BodyId plate{}, ball{};
};

// A pulsating ball above a plate whose upper side is z = 0, by a gap, turned at random.
Fall fall(const PulsatingBall& ball, double gap, double mu = 0.3, std::uint64_t seed = 1) {
  Fall out;
  out.model.contact_law.mu = mu;
  out.plate = add_plate(out.model, "plate");
  out.ball = add_pulsating_ball(out.model, ball);
  out.state = rest_state(out.model);
  pose(out.state, out.plate).p.z() = -0.01 - kPlate;
  pose(out.state, out.ball).p.z() = ball.radius + ball.dilation + gap;
  Random random(seed);
  pose(out.state, out.ball).R = random.rotation();
  return out;
}

double swelling(const State& state) {
  return state.q[0];
}

TEST(Deforming, RowsAreTheRatesOfTheGaps) {
  Fall f = fall({}, 5e-4);
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    pose(f.state, f.ball).R = random.rotation();
    f.state.q[0] = random.uniform(-0.2, 0.2);
    pose(f.state, f.ball).p.z() = 0.1 * (1 + f.state.q[0]) + 1.2e-3;
    VecX v = VecX::Zero(f.state.v.size());
    for (Eigen::Index i = first_velocity(f.ball); i < v.size(); ++i) v[i] = random.uniform(-1, 1);
    const auto contacts = [&](const State& at) {
      return find_contacts(posed_shape(f.model, at, f.plate), posed_shape(f.model, at, f.ball),
                           {.threshold = 0.01});
    };
    const ContactSet now = contacts(f.state);
    ASSERT_FALSE(now.points.empty());
    const Layout dofs = layout(f.model);
    const std::vector<ContactRow> rows =
        contact_rows(f.model, f.state, dofs, now, VecX::Zero(v.size()), 1e-3, {.law = NormalLaw::moreau});
    constexpr double kDt = 1e-6;  // second derivatives of some 10 m/s^2 leave 1e-5, rounding 1e-10
    const ContactSet later = contacts(retract(f.model, f.state, v, kDt)),
                     before = contacts(retract(f.model, f.state, v, -kDt));
    int compared = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto same = [&](const ContactSet& set) {
        return std::ranges::find(set.points, key_of(now.points[i]), key_of);
      };
      const auto a = same(before), b = same(later);
      if (a == before.points.end() || b == later.points.end()) continue;
      ++compared;
      EXPECT_NEAR((b->gap - a->gap) / (2 * kDt), slip_velocity(rows[i], dofs, free_velocities(dofs, v)).x(),
                  1e-8);
    }
    EXPECT_GT(compared, 0);
  }
}

// On the plate the weight rests on a few corners of the ball; what they push inwards is the weight times
// their height below the centre.
TEST(Deforming, ABallAtRestIsPressedInByItsWeight) {
  const PulsatingBall ball{.stiffness = 40, .damping = 1, .subdivisions = 1};
  Fall f = fall(ball, 1e-4, 0);
  const MoreauJean scheme(f.model, {.h = 5e-3, .solver = {.tolerance = 1e-12}}, {.theta = 1});
  ASSERT_TRUE(run_until(scheme, f.state, 6.0).ok());
  EXPECT_LT(f.state.v.norm(), 1e-6);
  // k q = -m g |x_z| of the corners, at rest: pose(ball).z - dilation = (1 + q) |x_z|
  const double weight = 9.81 * ball.mass,
               height = (pose(f.state, f.ball).p.z() - ball.dilation) / (1 + swelling(f.state));
  EXPECT_NEAR(swelling(f.state), -weight * height / ball.stiffness, 1e-6);
  EXPECT_LT(swelling(f.state), -0.02);
}

// What gravity gives to the ball, the ball and the cloth's points have: contacts give to both sides the same.
TEST(Deforming, ContactsGiveToPointsWhatTheyTakeFromTheBall) {
  Model model;
  model.contact_law.mu = 0.5;
  add_cloth(model, 0.2, 5, 0.5, 0, 2e-3);
  PulsatingBall ball{.radius = 0.03, .dilation = 2e-3, .swelling_mass = 1e-4, .stiffness = 20};
  const BodyId hit = add_pulsating_ball(model, ball);
  State state = rest_state(model);
  pose(state, hit).p = {0.01, 0.02, 0.035};
  twist(state, hit) << 0.3, 0.1, -1, 3, 2, 1;
  const MoreauJean scheme(model, {.h = 1e-3}, {.theta = 1});
  const Vec3 before = linear_part(state.v, hit);
  bool touched = false;
  PathAudit audit{.samples = 4};
  for (int k = 0; k < 60; ++k) {
    const State start = state;
    const StepReport report = scheme.step(state);
    ASSERT_TRUE(report.ok()) << report.reason;
    audit_path(model, start, state, report, 1, audit);
    for (const StepContact& contact : report.contacts) touched = touched || contact.impulse.norm() > 0;
    Vec3 momentum = ball.mass * linear_part(state.v, hit);
    for (Eigen::Index i = first_speed(model, 0); i < first_speed(model, 1); i += 3)
      momentum += 0.5 / 25 * state.v.segment<3>(i);
    EXPECT_LT((momentum - ball.mass * (before + state.t * model.gravity)).norm(), 1e-12);
  }
  EXPECT_TRUE(touched);
  EXPECT_EQ(audit.violations, 0);
  EXPECT_GT(state.q.head(75).norm(), 1e-3);
}

// A ball between two plates whose surface swells at up to 60 m/s: two plate distances a step.
TEST(Deforming, NothingIsSweptThroughBySwelling) {
  Fall f = fall({.swelling_mass = 1e-3, .stiffness = 400, .subdivisions = 1}, 0.02, 0);
  f.model.gravity.setZero();
  const BodyId lid = add_plate(f.model, "lid");
  const State low = f.state;
  f.state = rest_state(f.model);
  for (const BodyId body : {f.plate, f.ball}) pose(f.state, body) = pose(low, body);
  pose(f.state, lid).p.z() = 2 * 0.1 + 0.04 + 0.01 + 3 * kPlate;
  f.state.v[first_speed(f.model, 0)] = 600;
  const MoreauJean scheme(f.model, {.h = 2e-3}, {.theta = 1});
  PathAudit audit{.samples = 8};
  for (int k = 0; k < 40; ++k) {
    const State start = f.state;
    const StepReport report = scheme.step(f.state);
    ASSERT_TRUE(report.ok()) << report.reason;
    audit_path(f.model, start, f.state, report, 1, audit);
  }
  EXPECT_EQ(audit.violations, 0);
  EXPECT_GT(audit.min_distance, 0.96 * 2e-3);
}

TEST(Deforming, HasTheSameBitsForAnyThreadsAndAfterARestart) {
  const Fall f = fall({.damping = 0.1}, 1e-3);
  const auto after = [&](int threads, int stop) {
    State state = f.state;
    MoreauJean scheme(f.model, {.h = 1e-3, .threads = threads}, {.theta = 1});
    for (int k = 0; k < 80; ++k) {
      if (k == stop) {
        const auto path = fresh_folder() / "checkpoint.h5";
        write_checkpoint(path, {.fingerprint = 1, .step = k, .state = state});
        state = read_checkpoint(path, 1).state;
        scheme = MoreauJean(f.model, {.h = 1e-3, .threads = threads}, {.theta = 1});
      }
      EXPECT_TRUE(scheme.step(state).ok());
    }
    return hash(state);
  };
  const std::uint64_t once = after(1, -1);
  EXPECT_EQ(after(4, -1), once);
  EXPECT_EQ(after(1, 37), once);
}

TEST(Deforming, IsRecordedAndDrawn) {
  Fall f = fall({}, 1e-3);
  const std::size_t vertices = f.model.shapes[f.model.bodies[f.ball].shape]->complex.vertices.size();
  f.model.bodies[f.ball].deformation.field = {
      .what = "swelling", .unit = "m", .values = [vertices](const Model&, const State& state) {
        return std::vector<double>(vertices, swelling(state));
      }};
  const auto folder = fresh_folder();
  const MoreauJean scheme(f.model, {.h = 2e-3}, {.theta = 1});
  RunWriter writer(folder / "run.h5", run_header(f.model));
  std::vector<double> q;
  for (int k = 0; k < 70; ++k) {
    const StepReport report = scheme.step(f.state);
    writer.append(run_step(k, f.model, f.state, report));
    q.push_back(swelling(f.state));
  }
  writer.close();
  const RunData run = read_run(folder / "run.h5");
  const std::vector<Vec3>& rest = run.header.meshes.at("ball").vertices;
  EXPECT_EQ(run.header.bodies[f.ball.index()].moving_vertices, int(rest.size()));
  EXPECT_EQ(run.header.bodies[f.plate.index()].moving_vertices, 0);
  EXPECT_EQ(run.header.bodies[f.ball.index()].field, "swelling");
  EXPECT_EQ(run.header.bodies[f.ball.index()].field_unit, "m");
  EXPECT_EQ(run.header.bodies[f.plate.index()].field, "");
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    EXPECT_EQ(run.steps[k].field, std::vector<double>(rest.size(), q[k]));
    for (std::size_t i = 0; i < rest.size(); ++i)
      EXPECT_LT((run.steps[k].vertices[i] - (1 + q[k]) * rest[i]).norm(), 1e-15);
  }
  EXPECT_LT(*std::ranges::min_element(q), -1e-3);
  write_replay_html(folder / "replay.html", run);
}

class DeformingInEveryScheme : public ::testing::TestWithParam<SchemeVariant> {};

TEST_P(DeformingInEveryScheme, FallsOnThePlateAndStaysThere) {
  Fall f = fall({.damping = 1, .subdivisions = 1}, 5e-3);
  SchemeOptions options = GetParam().options;
  options.step.h = 1e-3;
  const Scheme scheme = make_scheme(GetParam().name, f.model, options);
  const double before = energy(f.model, f.state).total();
  PathAudit audit{.samples = 2};
  for (int k = 0; k < 100; ++k) {
    const State start = f.state;
    const StepReport report = scheme.step(f.state, kInf);
    ASSERT_TRUE(report.ok()) << report.reason << " at t = " << f.state.t;
    audit_path(f.model, start, f.state, report, 1, audit);
  }
  EXPECT_EQ(audit.violations, 0);
  EXPECT_LT(energy(f.model, f.state).total(), before);  // damping and plastic impacts take, nothing gives
  EXPECT_LT(pose(f.state, f.ball).p.z(), 0.1 + 2 * kPlate);
}

INSTANTIATE_TEST_SUITE_P(Registry, DeformingInEveryScheme, ::testing::ValuesIn(scheme_variants()),
                         [](const auto& tested) { return test_name(tested.param); });

TEST(Deforming, IsRefusedWhereItIsNotUnderstood) {
  const auto refused = [](const auto& change) {
    Fall f = fall({}, 1e-3);
    change(f.model.bodies[1], f.model);
    return message_of([&] { validate(f.model); });
  };
  EXPECT_EQ(refused([](RigidBody& b, Model&) { b.deformation.columns = nullptr; }),
            "body 1 (ball): deformation needs columns beside vertices");
  EXPECT_EQ(refused([](RigidBody& b, Model&) { b.shape = -1; }), "body 1 (ball): deformation needs a shape");
  EXPECT_EQ(refused([](RigidBody& b, Model& m) { b.shape = m.bodies[0].shape; }),
            "body 1 (ball): deformation needs a shape prepared with LmdShapeOptions::deforming");
  Fall f = fall({}, 1e-3);
  const std::string only = ": body 1 (ball) deforms; only rigid bodies may";
  EXPECT_EQ(message_of([&] { (void)make_scheme("event_driven", f.model, {}); }), "event_driven" + only);
  const MoreauJeanOptions hessians{.contacts = ContactsAt::midpoint,
                                   .newton = {.max_iterations = 9, .gap_hessians = true}};
  EXPECT_EQ(message_of([&] { (void)MoreauJean(f.model, {}, hessians); }),
            "NewtonOptions::gap_hessians" + only);
  EXPECT_EQ(message_of([&] { (void)MoreauJean(f.model, {.persistence = {.anchors = true}}); }),
            "PersistenceOptions::anchors" + only);
  const auto right = f.model.bodies[1].deformation;
  f.model.bodies[1].deformation.vertices = [](const Model&, const State&) { return std::vector<Vec3>(3); };
  EXPECT_EQ(message_of([&] { (void)posed_shape(f.model, f.state, 1); }),
            "body 1 (ball): deformation.vertices: size = 3 must be 162, as of its shape");
  // Columns that are not those of the vertices: the path that was proven is not the one that was taken
  f.model.bodies[1].deformation = right;
  f.model.bodies[1].deformation.columns = [](const Model&, const State&, int, std::vector<VertexColumn>&) {};
  f.state.v.tail(1)[0] = 1;
  const StepReport report = MoreauJean(f.model, {.h = 1e-4}, {.theta = 1}).step(f.state);
  EXPECT_EQ(report.status, StepStatus::refused);
  EXPECT_NE(report.reason.find("away from where the columns of its deformation led"), std::string::npos)
      << report.reason;
}

}  // namespace
}  // namespace aussois
