// SPDX-License-Identifier: Apache-2.0
#include "nsgs/one_contact.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "nsgs/law.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

using Real = long double;
using Real3 = std::array<Real, 3>;

// The oracle: all three cases in long double, slip by looking at every direction. Written for clarity only.
struct Oracle {
  std::array<Real3, 3> W{};
  Real3 q{};
  Real mu = 0;

  Oracle(const Mat3& W_in, const Vec3& q_in, double mu_in) : mu(mu_in) {
    for (int i = 0; i < 3; ++i) {
      q[std::size_t(i)] = q_in[i];
      for (int j = 0; j < 3; ++j) W[std::size_t(i)][std::size_t(j)] = W_in(i, j);
    }
  }
  Real3 velocity(const Real3& r) const {
    Real3 u = q;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) u[i] += W[i][j] * r[j];
    return u;
  }
  Real3 cross(const Real3& a, const Real3& b) const {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  Real3 stick() const {  // Cramer
    const Real3 column0{W[0][0], W[1][0], W[2][0]}, column1{W[0][1], W[1][1], W[2][1]},
        column2{W[0][2], W[1][2], W[2][2]}, b{-q[0], -q[1], -q[2]};
    const auto dot = [](const Real3& a, const Real3& c) { return a[0] * c[0] + a[1] * c[1] + a[2] * c[2]; };
    const Real det = dot(column0, cross(column1, column2));
    return {dot(b, cross(column1, column2)) / det, dot(column0, cross(b, column2)) / det,
            dot(column0, cross(column1, b)) / det};
  }
  Real3 slip(Real angle) const {  // u_N = 0; r_N may come out negative: no solution there
    const Real c = std::cos(angle), s = std::sin(angle);
    const Real r_n = -q[0] / (W[0][0] - mu * (W[0][1] * c + W[0][2] * s));
    return {r_n, -mu * r_n * c, -mu * r_n * s};
  }
  Real misalignment(Real angle) const {
    const Real3 u = velocity(slip(angle));
    return std::cos(angle) * u[2] - std::sin(angle) * u[1];
  }
  std::vector<Real3> solutions() const {
    std::vector<Real3> found;
    if (q[0] >= 0) found.push_back({0, 0, 0});
    const Real3 r = stick();
    if (r[0] >= 0 && std::hypot(r[1], r[2]) <= mu * r[0]) found.push_back(r);
    constexpr int directions = 720;
    const Real step = 2 * std::acos(Real(-1)) / directions;
    for (int i = 0; i < directions; ++i) {
      Real low = i * step, high = low + step;
      const bool rising = misalignment(low) < 0;
      if (rising == (misalignment(high) < 0)) continue;
      for (int k = 0; k < 80; ++k) {
        const Real middle = (low + high) / 2;
        ((misalignment(middle) < 0) == rising ? low : high) = middle;
      }
      const Real3 s = slip(low), u = velocity(s);
      if (s[0] >= 0 && u[1] * std::cos(low) + u[2] * std::sin(low) >= 0 &&
          std::abs(misalignment(low)) <
              1e-6L * std::hypot(q[0], std::hypot(q[1], q[2])))  // a root, not a pole
        found.push_back(s);
    }
    return found;
  }
  // The natural map in units of the block, relative to what rounding in double allows.
  Real wrong(const Vec3& r) const {
    const Real w = (W[0][0] + W[1][1] + W[2][2]) / 3,
               size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    const Real3 u = velocity({r[0], r[1], r[2]});
    const Vec3 r_c = r * double(w / size), u_c(double(u[0] / size), double(u[1] / size), double(u[2] / size));
    const Law law = coulomb(double(mu));
    const double map = (r_c - project<3>(law, r_c - modified_velocity<3>(law, u_c))).norm();
    return map / (1 + 3 * r_c.norm());
  }
};

struct Sample {
  Mat3 W = Mat3::Identity();
  Vec3 q = Vec3::Zero();
  double mu = 0;
};

// Eigenvalues over up to `decades`, turned at random, with or without a skew part; the symmetric part is
// definite.
Sample random_sample(Random& random, double decades) {
  const Mat3 R = random_rotation(random);
  const Vec3 logs = uniform_vector(random, 3, -decades, 0);
  const Vec3 eigenvalues(std::pow(10, logs[0]), std::pow(10, logs[1]), std::pow(10, logs[2]));
  Mat3 W = R * eigenvalues.asDiagonal() * R.transpose();
  if (random.uniform(0, 1) < 0.5) {
    const Vec3 s = 0.3 * eigenvalues.minCoeff() * Vec3(uniform_vector(random, 3, -1, 1));
    Mat3 skew;
    skew << 0, -s[2], s[1], s[2], 0, -s[0], -s[1], s[0], 0;
    W += skew;
  }
  const double choice = random.uniform(0, 1);
  const double mu = choice < 0.1 ? 0 : choice < 0.2 ? 10 : random.uniform(0, 1.2);
  const double scale = random.log_uniform(1e-6, 1e6);
  return {W * scale, uniform_vector(random, 3, -1, 1) * random.log_uniform(1e-6, 1e6), mu};
}

double distance(const Vec3& r, const std::vector<Real3>& solutions) {
  double nearest = kInf;
  for (const Real3& s : solutions)
    nearest = std::min(nearest, (r - Vec3(double(s[0]), double(s[1]), double(s[2]))).norm());
  return nearest;
}

TEST(OneContact, AgreesWithTheExhaustiveSearchOnAHundredThousandBlocks) {
  Random random(20);
  int separated = 0, stuck = 0, slipped = 0, compared = 0;
  for (int i = 0; i < 100000; ++i) {
    const Sample s = random_sample(random, 2);
    const LocalSolver solver = i % 2 ? LocalSolver::enumerative : LocalSolver::hybrid;
    const LocalSolution local = solve_one_contact(s.W, s.q, s.mu, Vec3::Zero(), solver);
    const Oracle oracle(s.W, s.q, s.mu);
    ASSERT_TRUE(local.solved) << "seed 20, case " << i;
    ASSERT_LT(oracle.wrong(local.r), 1e-13) << "seed 20, case " << i;  // ten times (ONE-6): |W| <= 3 w
    const Vec3 u = s.W * local.r + s.q;
    ++(local.r[0] == 0 ? separated : u.norm() < 1e-9 * s.q.norm() ? stuck : slipped);
    if (i % 20) continue;  // the search over directions is slow
    const std::vector<Real3> solutions = oracle.solutions();
    if (solutions.empty()) continue;  // a tangential root between two directions
    ++compared;
    // The natural map bounds the distance by the condition number, 100, except near a change of case, where a
    // root is double and only its square root survives.
    ASSERT_LT(distance(local.r, solutions), 1e-5 * local.r.norm() + 1e-300) << "seed 20, case " << i;
  }
  EXPECT_GT(separated, 20000);
  EXPECT_GT(stuck, 5000);
  EXPECT_GT(slipped, 20000);
  EXPECT_GT(compared, 4900);
}

TEST(OneContact, SolvesIllConditionedBlocksToRoundingOrSaysSo) {
  Random random(21);
  int fail_safes = 0, unsolved = 0;
  for (int i = 0; i < 20000; ++i) {
    const Sample s = random_sample(random, 12);
    const LocalSolution local = solve_one_contact(s.W, s.q, s.mu, Vec3::Zero());
    fail_safes += local.fail_safe;
    unsolved += !local.solved;
    const double impulse = local.r.norm() * s.W.trace() / 3 / s.q.norm();  // 1 for a well-conditioned block
    ASSERT_TRUE(local.solved || impulse > 1e5) << "seed 21, case " << i << ", impulse " << impulse;
    if (local.solved) {
      ASSERT_LT(Oracle(s.W, s.q, s.mu).wrong(local.r), 1e-13) << "seed 21, case " << i;
    }
  }
  EXPECT_GT(fail_safes, 0);  // Newton alone does not do it
  EXPECT_LT(unsolved, 2000);
}

TEST(OneContact, AnswersByHand) {
  const Mat3 W = Vec3(2, 4, 4).asDiagonal();
  // Separation.
  EXPECT_EQ(solve_one_contact(W, {1, 5, 0}, 0.5, Vec3::Zero()).r, Vec3::Zero());
  // Stick: r = -W^-1 q = (1, -0.25, 0).
  EXPECT_LT((solve_one_contact(W, {-2, 1, 0}, 0.5, Vec3::Zero()).r - Vec3(1, -0.25, 0)).norm(), 1e-13);
  // Slip: r_N = 1, friction full against the velocity.
  EXPECT_LT((solve_one_contact(W, {-2, 3, 4}, 0.5, Vec3::Zero()).r - Vec3(1, -0.3, -0.4)).norm(), 1e-13);
  // Without friction.
  EXPECT_LT((solve_one_contact(W, {-2, 3, 4}, 0, Vec3::Zero()).r - Vec3(1, 0, 0)).norm(), 1e-13);
}

// Pressing speeds the point up, so friction presses it down again: W_NN - mu W_NT < 0 for slip along +t. Slip
// the other way ends with u_T = q_T + 3 = 7 > 0, every other direction with u_T off that direction, and W is
// singular: no stick.
TEST(OneContact, SaysThatAPainleveBlockHasNoSolution) {
  Mat3 W;
  W << 1, 3, 0, 3, 9, 0, 0, 0, 1;
  const Vec3 q(-1, 4, 0);
  for (const LocalSolver solver :
       {LocalSolver::hybrid, LocalSolver::enumerative, LocalSolver::alart_curnier}) {
    const LocalSolution local = solve_one_contact(W, q, 1, Vec3::Zero(), solver);
    EXPECT_FALSE(local.solved);
    EXPECT_TRUE(local.r.allFinite());
  }
  EXPECT_TRUE(solve_one_contact(W, {-1, -4, 0}, 1, Vec3::Zero()).solved);  // sliding out of it is no trouble
}

TEST(OneContact, BadNumbersAreNotSolved) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Mat3 I = Mat3::Identity();
  EXPECT_FALSE(solve_one_contact(I, {nan, 0, 0}, 0.3, Vec3::Zero()).solved);
  EXPECT_FALSE(solve_one_contact(nan * I, {-1, 0, 0}, 0.3, Vec3::Zero()).solved);
  EXPECT_FALSE(solve_one_contact(0 * I, {-1, 0, 0}, 0.3, Vec3::Zero()).solved);
  EXPECT_EQ(solve_one_contact(I, {nan, 0, 0}, 0.3, Vec3::Zero()).r, Vec3::Zero());
  EXPECT_TRUE(solve_one_contact(I, {-1, 0, 0}, 0.3, {nan, 0, 0}).solved);  // a bad start is only a bad start
}

TEST(OneContact, RepeatedProjectionReachesTheSameAnswer) {
  Random random(22);
  for (int i = 0; i < 200; ++i) {
    Sample s = random_sample(random, 0.5);
    s.mu = std::min(s.mu, 0.3);
    const Vec3 exact = solve_one_contact(s.W, s.q, s.mu, Vec3::Zero()).r;
    LocalSolution step;
    for (int k = 0; k < 1000; ++k) step = solve_one_contact(s.W, s.q, s.mu, step.r, LocalSolver::projection);
    EXPECT_LT((step.r - exact).norm(), 1e-9 * (exact.norm() + 1e-300)) << "seed 22, case " << i;
  }
}

TEST(OneContact, WithALockedNormalGetsNoImpulse) {
  Mat3 W = Mat3::Zero();
  W(1, 1) = W(2, 2) = 2;
  W(0, 0) = 1e-17;
  for (const LocalSolver solver : {LocalSolver::hybrid, LocalSolver::enumerative}) {
    const LocalSolution s = solve_one_contact(W, {-1e-16, 0.3, 0.1}, 0.5, Vec3::Zero(), solver);
    EXPECT_EQ(s.r, Vec3::Zero());
    EXPECT_TRUE(s.solved);
    EXPECT_FALSE(solve_one_contact(W, {-0.1, 0.3, 0.1}, 0.1, Vec3::Zero(), solver).solved);  // nothing helps
  }
}

}  // namespace
}  // namespace aussois
