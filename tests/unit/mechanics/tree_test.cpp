// SPDX-License-Identifier: Apache-2.0
// doc/theory/trees.md: poses, twists, masses and forces of random trees against their definitions.
#include "mechanics/tree.hpp"

#include <gtest/gtest.h>

#include "mechanics/forces.hpp"
#include "mechanics/mechanism.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/tree_terms.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_tree.hpp"

namespace aussois {
namespace {

constexpr double kDifferences = 1e-8;  // of fourth order, of numbers of order one

TEST(JointPose, InvertsTheCoordinatesOfTheAxes) {
  Random random(1);
  for (const JointKind kind : kKindsWithCoordinates) {
    const Joint joint{.kind = kind,
                      .body_a = 1,
                      .body_b = 0,
                      .frame_a = random.pose(1),
                      .frame_b = random.pose(1),
                      .pitch = 0.3};
    double q[3] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    PerBody<SE3> g{random.pose(1), {}};
    g[1] = g[0] * joint.frame_b * joint_pose(joint, q) * inverse(joint.frame_a);
    for (int i = 0; i < axis_count(kind); ++i)
      EXPECT_NEAR(axis_row(joint, g, i).value, q[i], 1e-14) << to_string(kind);
    for (const JointRow& row : locked_rows(joint, g)) EXPECT_NEAR(row.value, 0, 1e-14) << to_string(kind);
  }
}

class Trees : public ::testing::TestWithParam<bool> {
 protected:
  Random random{GetParam() ? 3u : 2u};
  RandomTree tree = random_tree(random, 12, GetParam());
  const Model& model = tree.model;
  State state = random_state(random, model);

  // A time later, speeds and the twist of the base staying.
  State later(double time) const {
    State out = retract(model, state, state.v, time);
    carry_twists(model, out.g, out.v);
    return out;
  }
  VecX on_links(const VecX& v, BodyId body) const {
    VecX out = VecX::Zero(6);
    for (const TwistColumn& c : carried_columns(model, state.g, body)) out += v[c.velocity] * c.twist;
    return out;
  }
};
INSTANTIATE_TEST_SUITE_P(Bases, Trees, ::testing::Bool(),
                         [](const auto& base) { return base.param ? "floating" : "fixed"; });

TEST_P(Trees, HoldTheirJointsAndKeepTheirCoordinates) {
  for (const JointId j : tree.joints) {
    EXPECT_LT(joint_error(tree.maximal, state, j).translation, 1e-14);
    EXPECT_LT(joint_error(tree.maximal, state, j).rotation, 1e-14);
    for (int i = 0; i < axis_count(model.joints[j].kind); ++i) {
      EXPECT_EQ(joint_coordinate(model, state, j, i), state.q[tree_coordinate(model, j, i)]);
      EXPECT_NEAR(joint_coordinate(tree.maximal, state, j, i), state.q[tree_coordinate(model, j, i)], 1e-13);
      EXPECT_NEAR(joint_speed(tree.maximal, state, j, i), state.v[tree_speed(model, j, i)], 1e-13);
    }
  }
}

TEST_P(Trees, MoveTheirLinksAsTheCoordinatesGo) {
  for (const BodyId b : model.bodies.ids()) {
    if (!is_carried(model.bodies[b])) continue;
    const Vec3 v = slope([&](double t) { return later(t).g[b].p; });
    const Vec3 omega = slope([&](double t) { return log_so3(state.g[b].R.conjugate() * later(t).g[b].R); });
    EXPECT_LT((v - twist(state, b).head<3>()).norm(), kDifferences);
    EXPECT_LT((omega - twist(state, b).tail<3>()).norm(), kDifferences);
    EXPECT_LT((on_links(state.v, b) - twist(state, b)).norm(), 1e-13);
  }
}

// M, gravity and gyroscopic forces as sums over links of T^T (.) with the columns T of each.
TEST_P(Trees, HaveTheMassesAndForcesOfTheirLinks) {
  const TreeTerms terms = tree_terms(model, 0, state);
  const auto count = Eigen::Index(terms.velocity.size());
  MatX mass = MatX::Zero(count, count);
  VecX gravity = VecX::Zero(count), gyroscopic = gravity;
  for (const BodyId b : model.bodies.ids()) {
    if (!is_carried(model.bodies[b])) continue;
    const RigidBody& body = model.bodies[b];
    MatX T = MatX::Zero(6, count);
    for (const TwistColumn& c : carried_columns(model, state.g, b))
      T.col(std::find(terms.velocity.begin(), terms.velocity.end(), c.velocity) - terms.velocity.begin()) =
          c.twist;
    Mat6 M = Mat6::Zero();
    M.topLeftCorner<3, 3>() = body.mass * Mat3::Identity();
    M.bottomRightCorner<3, 3>() = body.inertia;
    mass += T.transpose() * M * T;
    Vec6 weight, inertial;
    weight << body.mass * model.gravity, Vec3::Zero();
    gravity += T.transpose() * weight;
    const Vec6 rate = slope([&](double t) { return Vec6(twist(later(t), b)); });
    const Vec3 omega = twist(state, b).tail<3>();
    inertial << Vec3::Zero(), omega.cross(body.inertia * omega);
    gyroscopic -= T.transpose() * (M * rate + inertial);
  }
  EXPECT_LT((terms.mass - mass).norm(), 1e-13 * mass.norm());
  EXPECT_LT((terms.gravity - gravity).norm(), 1e-13 * gravity.norm());
  EXPECT_LT((terms.gyroscopic - gyroscopic).norm(), kDifferences * gyroscopic.norm());
}

TEST_P(Trees, KnowHowTheirMomentumTurnsWhileNoSpeedChanges) {
  const auto all = [&](const State& s) {
    const Momentum now = momentum(model, s);
    Vec6 out;
    out << now.linear, now.angular;
    return out;
  };
  Vec6 rate = slope([&](double t) { return all(later(t)); });
  for (const BodyId b : model.bodies.ids()) {  // a base turns by itself
    if (!is_dynamic(model.bodies[b])) continue;
    const Vec3 omega = twist(state, b).tail<3>();
    rate.tail<3>() -= state.g[b].R * omega.cross(model.bodies[b].inertia * omega);
  }
  const Momentum turning = tree_terms(model, 0, state).turning;
  EXPECT_LT((turning.linear - rate.head<3>()).norm(), kDifferences * (1 + rate.norm()));
  EXPECT_LT((turning.angular - rate.tail<3>()).norm(), kDifferences * (1 + rate.norm()));
}

TEST_P(Trees, KnowHowTheirForcesChangeWithTheSpeeds) {
  const TreeTerms terms = tree_terms(model, 0, state);
  for (Eigen::Index k = 0; k < std::ssize(terms.velocity); ++k) {
    const VecX change = slope([&](double d) {
      State other = state;
      other.v[terms.velocity[std::size_t(k)]] += d;
      return tree_terms(model, 0, other).gyroscopic;
    });
    EXPECT_LT((terms.C.col(k) + change).norm(), kDifferences * (1 + change.norm())) << k;
  }
}

TEST_P(Trees, PassForcesOnLinksToTheirCoordinates) {
  GeneralisedForce force{.f = VecX::Zero(state.v.size())};
  for (double& f : force.f) f = random.uniform(-1, 1);
  VecX pushed = force.f;
  const MatX A = MatX::Random(6, 6);
  const BodyId last = BodyId::at(12);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      force.K.emplace_back(first_velocity(last) + i, first_velocity(last) + j, A(i, j));
  const auto pattern = block_pattern(6, {0, first_velocity(last)}, {{0, 1}});  // of the base and a link
  ForceMatrix blocks{.pattern = pattern, .K = std::vector<double>(pattern->values()), .C = {}};
  for (double& k : blocks.K) k = random.uniform(-1, 1);
  force.matrices.push_back(blocks);
  carry_forces(model, state.g, force);
  // The work on any motion is the same.
  EXPECT_NEAR(force.f.dot(state.v), pushed.dot(state.v), 1e-12 * pushed.norm());
  VecX other = state.v;
  for (double& v : other.tail(state.q.size())) v = random.uniform(-1, 1);
  carry_twists(model, state.g, other);
  VecX of_base = 0 * state.v;  // what stays in the blocks
  of_base.head<6>() = state.v.head<6>();
  double work = other.head<6>().dot(force_change({blocks}, of_base, 0 * of_base).head<6>());
  for (const Triplet& e : force.K) work += other[e.row()] * e.value() * state.v[e.col()];
  EXPECT_NEAR(work,
              Vec6(body_part(other, last)).dot(A * Vec6(twist(state, last))) +
                  other.dot(force_change({blocks}, state.v, 0 * state.v)),
              1e-12);
  for (const BodyId b : model.bodies.ids())
    EXPECT_TRUE(!is_carried(model.bodies[b]) || body_part(force.f, b).isZero(0));
}

TEST_P(Trees, KeepAStateOfMaximalCoordinates) {
  State maximal = rest_state(tree.maximal);
  maximal.g = state.g;
  maximal.v = state.v.head(maximal.v.size());
  const State there = in_joint_coordinates(model, maximal);
  EXPECT_LT((there.q - state.q).norm(), 1e-13);
  EXPECT_LT((there.v - state.v).norm(), 1e-12);
  EXPECT_NEAR(energy(model, there).total(), energy(tree.maximal, maximal).total(), 1e-12);
  EXPECT_LT((momentum(model, there).angular - momentum(tree.maximal, maximal).angular).norm(), 1e-12);
}

Model two_bodies_and_joints() {
  Model model;
  for (int i = 0; i < 3; ++i) add(model, RigidBody{.name = "link", .mass = 1, .inertia = Mat3::Identity()});
  add(model, Joint{.name = "hip", .kind = JointKind::revolute, .body_a = 0});
  add(model, Joint{.name = "knee", .kind = JointKind::revolute, .body_a = 1, .body_b = 0});
  add(model, Joint{.name = "ball", .kind = JointKind::spherical, .body_a = 2, .body_b = 1});
  add(model, Joint{.name = "closing", .kind = JointKind::revolute, .body_a = 1});
  add(model, Joint{.name = "foot", .kind = JointKind::prismatic, .body_a = 2, .body_b = 1});
  return model;
}

TEST(Trees, RefuseWhatIsNoTree) {
  const auto message = [](const std::vector<JointId>& joints) {
    Model model = two_bodies_and_joints();
    return message_of([&] { add_tree(model, "leg", joints); });
  };
  EXPECT_EQ(message({}), "tree (leg): joints must not be empty");
  EXPECT_EQ(message({7}), "tree (leg): joint = 7 must lie in [0, 5)");
  EXPECT_EQ(message({0, 1, 0}), "tree (leg): joint 0 (hip) is listed twice");
  EXPECT_EQ(message({0, 1, 2}), "tree (leg): joint 2 (ball) is spherical: such joints have no coordinates");
  EXPECT_EQ(message({0, 3, 1}),
            "tree (leg): joint 1 (knee) closes a cycle: leave it out, and it stays an equation");
  EXPECT_EQ(message({0, 4}), "tree (leg): joint 4 (foot) does not hang on the others");
  EXPECT_EQ(message({0, 1, 4}), "");
  Model moved = two_bodies_and_joints();
  moved.bodies[0].motion = DrivenMotion{};
  EXPECT_EQ(message_of([&] { add_tree(moved, "leg", {1}); }),
            "tree (leg): joint 1 (knee) holds body 0 (link), which must be dynamic or fixed");
  Model without_mass = two_bodies_and_joints();
  without_mass.bodies[1].mass = 0;
  EXPECT_NE(message_of([&] {
              add_tree(without_mass, "leg", {0, 1}), validate(without_mass);
            }).find("mass"),
            std::string::npos);
  Model twice = two_bodies_and_joints();
  add_tree(twice, "leg", {0, 1});
  EXPECT_EQ(message_of([&] { add_tree(twice, "foot", {1}); }),
            "tree (foot): joint 1 (knee) is of another tree");
}

TEST(Trees, RefuseAStateThatTheirCoordinatesDoNotGive) {
  Model model = two_bodies_and_joints();
  add_tree(model, "leg", {0, 1, 4});
  State state = rest_state(model);
  validate(model, state);
  state.q[0] = 0.1;
  EXPECT_NE(message_of([&] { validate(model, state); }).find("call carry()"), std::string::npos);
  carry(model, state);
  validate(model, state);
}

}  // namespace
}  // namespace aussois
