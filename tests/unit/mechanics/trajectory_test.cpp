// SPDX-License-Identifier: Apache-2.0
// doc/theory/mechanics.md, recorded motions.
#include "mechanics/trajectory.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

Trajectory random_path(Random& random, int rows) {
  Trajectory path;
  for (int i = 0; i < rows; ++i) {
    path.t.push_back(i == 0 ? 0.5 : path.t.back() + random.uniform(0.1, 1));
    path.pose.push_back(random.pose(1));
  }
  return path;
}

TEST(Trajectory, GoesThroughItsRows) {
  Random random(3);
  const Trajectory path = random_path(random, 6);
  for (std::size_t i = 0; i < path.t.size(); ++i) {
    const SE3 g = trajectory_point(path, path.t[i]).pose;
    EXPECT_LT((g.p - path.pose[i].p).norm(), 1e-15);
    EXPECT_LT(angle_between(g.R, path.pose[i].R), 1e-15);
  }
}

TEST(Trajectory, MovesOnALineAndAGeodesicAtConstantSpeed) {
  const Trajectory path{{1, 3}, {{Quat::Identity(), {1, 0, 0}}, {rotation({0, 0, 1}, 1.0).R, {1, 4, 0}}}};
  const TrajectoryPoint quarter = trajectory_point(path, 1.5);
  EXPECT_LT((quarter.pose.p - Vec3(1, 1, 0)).norm(), 1e-15);
  EXPECT_LT(angle_between(quarter.pose.R, rotation({0, 0, 1}, 0.25).R), 1e-15);
  EXPECT_LT((quarter.twist - (Vec6() << 0, 2, 0, 0, 0, 0.5).finished()).norm(), 1e-15);
}

// v = dp/dt in the world, [omega] = R^T dR/dt in the body, by central differences inside the segments.
TEST(Trajectory, TwistIsTheDerivativeOfThePose) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Trajectory path = random_path(random, 4);
    const std::size_t i = std::size_t(random.index(3));
    const double t = path.t[i] + random.uniform(0.1, 0.9) * (path.t[i + 1] - path.t[i]), e = 1e-5;
    const TrajectoryPoint at = trajectory_point(path, t);
    const SE3 before = trajectory_point(path, t - e).pose, after = trajectory_point(path, t + e).pose;
    const Vec3 v = (after.p - before.p) / (2 * e);
    const Vec3 omega = log_so3(before.R.conjugate() * after.R) / (2 * e);
    EXPECT_LT((at.twist.head<3>() - v).norm(), 1e-9) << "seed " << seed;  // rounding 1e-16 / e
    EXPECT_LT((at.twist.tail<3>() - omega).norm(), 1e-9)
        << "seed " << seed;  // the turn is at constant speed: no truncation
  }
}

TEST(Trajectory, TakesTheShorterWayRoundWhateverTheSignOfTheQuaternion) {
  Trajectory path{{0, 1}, {SE3{}, rotation({1, 0, 0}, 0.4)}};
  const Vec6 twist = trajectory_point(path, 0.5).twist;
  path.pose[1].R.coeffs() *= -1;
  EXPECT_LT((trajectory_point(path, 0.5).twist - twist).norm(), 1e-15);
  EXPECT_NEAR(twist[3], 0.4, 1e-15);
}

TEST(Trajectory, IsHeldOutsideItsTimes) {
  Random random(5);
  const Trajectory path = random_path(random, 3);
  const TrajectoryPoint before = trajectory_point(path, path.t.front() - 1e-9),
                        after = trajectory_point(path, path.t.back() + 1e-9);
  EXPECT_EQ(before.pose.p, path.pose.front().p);
  EXPECT_EQ(after.pose.p, path.pose.back().p);
  EXPECT_EQ(before.twist, Vec6::Zero());
  EXPECT_EQ(after.twist, Vec6::Zero());
}

TEST(Trajectory, ARowBelongsToTheSegmentItBegins) {
  const Trajectory path{{0, 1, 2}, {translation(0, 0, 0), translation(1, 0, 0), translation(3, 0, 0)}};
  EXPECT_EQ(trajectory_point(path, 0).twist[0], 1);
  EXPECT_EQ(trajectory_point(path, 1).twist[0], 2);
  EXPECT_EQ(trajectory_point(path, 2).twist[0], 2);
}

// A nut turned on a bolt: the axis is straight in any frame on it, so the interpolation is exact for frames
// on the axis.
TEST(Trajectory, IsExactForAScrewAtTheRows) {
  const auto screw = [](double angle) {
    return rotation({0, 0, 1}, angle) * translation(0, 0, 2e-3 * angle / (2 * kPi));
  };
  Trajectory path;
  for (int i = 0; i <= 8; ++i) {
    path.t.push_back(0.1 * i);
    path.pose.push_back(screw(0.7 * i));
  }
  for (const double t : {0.05, 0.1, 0.333, 0.8}) {
    const SE3 g = trajectory_point(path_of_attached_frame(path, translation(0, 0, 0.01)), t).pose,
              exact = screw(7 * t) * translation(0, 0, 0.01);
    EXPECT_LT((g.p - exact.p).norm(), 1e-15) << t;
    EXPECT_LT(angle_between(g.R, exact.R), 1e-14) << t;
  }
}

TEST(Trajectory, AttachedFramesDifferByTheSagitta) {
  const double arm = 0.2, angle = 0.1;
  const Trajectory path{{0, 1}, {SE3{}, rotation({0, 0, 1}, angle)}};
  const SE3 g_old_new = translation(arm, 0, 0) * rotation({0, 1, 0}, 0.3);
  const Trajectory other = path_of_attached_frame(path, g_old_new);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LT((other.pose[i].p - (path.pose[i] * g_old_new).p).norm(), 1e-15);
  const SE3 chord = trajectory_point(other, 0.5).pose, arc = trajectory_point(path, 0.5).pose * g_old_new;
  EXPECT_NEAR((chord.p - arc.p).norm(), arm * (1 - std::cos(angle / 2)), 1e-15);  // (TRJ-2)
  EXPECT_LT((chord.p - arc.p).norm(), arm * angle * angle / 8);
  EXPECT_LT(angle_between(chord.R, arc.R), 1e-15);  // the rotation is the same geodesic in any frame
}

TEST(Trajectory, NormalisesWhatItReturns) {
  Trajectory path{{0, 1}, {SE3{}, rotation({1, 2, 3}, 1)}};
  for (SE3& g : path.pose) g.R.coeffs() *= 1 + 5e-7;
  EXPECT_NO_THROW(validate(path));
  for (const double t : {-1.0, 0.3, 2.0}) EXPECT_NEAR(trajectory_point(path, t).pose.R.norm(), 1, 1e-15);
}

std::string refusal(const Trajectory& path) {
  return message_of([&] { validate(path); });
}

TEST(Trajectory, RefusesBadRows) {
  const Trajectory good{{0, 1, 2}, {SE3{}, SE3{}, SE3{}}};
  EXPECT_EQ(refusal(good), "");
  Trajectory path = good;
  path.t[2] = 1;
  EXPECT_NE(refusal(path).find("row 2: t = 1"), std::string::npos) << refusal(path);
  path = good;
  path.t[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(path).find("row 1: t = nan"), std::string::npos) << refusal(path);
  path = good;
  path.pose[1].R.coeffs() *= 1.01;
  EXPECT_NE(refusal(path).find("row 1: pose"), std::string::npos) << refusal(path);
  path = good;
  path.pose[2].p.x() = kInf;
  EXPECT_NE(refusal(path).find("row 2: pose"), std::string::npos) << refusal(path);
  path = good;
  path.pose.pop_back();
  EXPECT_NE(refusal(path).find("3 times for 2 poses"), std::string::npos) << refusal(path);
  EXPECT_NE(refusal({{0}, {SE3{}}}).find("1 rows must be at least 2"), std::string::npos);
}

}  // namespace
}  // namespace aussois
