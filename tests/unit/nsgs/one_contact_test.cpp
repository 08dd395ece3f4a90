// SPDX-License-Identifier: Apache-2.0
#include "nsgs/one_contact.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

#include "nsgs/block_solver.hpp"
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
      q[i] = q_in[i];
      for (int j = 0; j < 3; ++j) W[i][j] = W_in(i, j);
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
    constexpr int kDirections = 720;
    const Real step = 2 * std::acos(Real(-1)) / kDirections;
    for (int i = 0; i < kDirections; ++i) {
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
  const Vec3 q = uniform_vector(random, 3, -1, 1);
  return {W * scale, q * random.log_uniform(1e-6, 1e6), mu};
}

double distance(const Vec3& r, const std::vector<Real3>& solutions) {
  double nearest = kInf;
  for (const Real3& s : solutions)
    nearest = std::min(nearest, (r - Vec3(double(s[0]), double(s[1]), double(s[2]))).norm());
  return nearest;
}

TEST(OneContact, SolvesAHundredThousandBlocksAsTheExhaustiveSearchDoes) {
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

// Blocks of any condition in numbers of 50 digits: all answers, slip from the directions that it may have
// (the solver asks for the compliance of the slip instead).
class ExactOracle {
 public:
  using Number = boost::multiprecision::cpp_bin_float_50;
  using Numbers = std::array<Number, 3>;

  ExactOracle(const Mat3& W, const Vec3& q, double mu) : mu_(mu) {
    const Number w = (Number(W(0, 0)) + W(1, 1) + W(2, 2)) / 3;
    size_ = length({q[0], q[1], q[2]});
    unit_ = size_ / w;
    for (int i = 0; i < 3; ++i) {
      q_[i] = q[i] / size_;
      for (int j = 0; j < 3; ++j) W_[i][j] = W(i, j) / w;
    }
  }

  static Number length(const Numbers& x) {
    using std::sqrt;
    return sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
  }
  Numbers scaled(const Vec3& r) const { return {r[0] / unit_, r[1] / unit_, r[2] / unit_}; }
  Numbers velocity(const Numbers& r) const {
    Numbers u = q_;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) u[i] += W_[i][j] * r[j];
    return u;
  }
  Numbers natural_map(const Numbers& r) const {  // r - P(r - u^)
    Numbers y = velocity(r);
    y[0] += mu_ * length({0, y[1], y[2]});
    for (std::size_t i = 0; i < 3; ++i) y[i] = r[i] - y[i];
    const Number side = length({0, y[1], y[2]});
    Numbers p = y;
    if (y[0] < 0 || side > mu_ * y[0]) {
      Number normal = (y[0] + mu_ * side) / (1 + mu_ * mu_);
      if (normal < 0) normal = 0;
      const Number shrink = side > 0 ? Number(mu_ * normal / side) : Number(0);
      p = {normal, shrink * y[1], shrink * y[2]};
    }
    return {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  }
  std::vector<Numbers> solutions() const {  // of q_N < 0
    std::vector<Numbers> found;
    if (const Numbers r = stick(); r[0] >= 0 && length({0, r[1], r[2]}) <= mu_ * r[0]) found.push_back(r);
    for (const Number& z : quartic_roots()) {
      const Number c = (1 - z * z) / (1 + z * z), s = 2 * z / (1 + z * z);
      const Number normal = -q_[0] / (W_[0][0] - mu_ * (W_[0][1] * c + W_[0][2] * s));
      const Numbers r{normal, -mu_ * normal * c, -mu_ * normal * s}, u = velocity(r);
      if (normal >= 0 && u[1] * c + u[2] * s >= 0) found.push_back(r);
    }
    return found;
  }

 private:
  static Numbers cross(const Numbers& a, const Numbers& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  Numbers stick() const {  // Cramer
    const auto column = [&](std::size_t j) { return Numbers{W_[0][j], W_[1][j], W_[2][j]}; };
    const auto dot = [](const Numbers& a, const Numbers& b) {
      return Number(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    };
    const Numbers b{-q_[0], -q_[1], -q_[2]};
    const Number det = dot(column(0), cross(column(1), column(2)));
    return {dot(b, cross(column(1), column(2))) / det, dot(column(0), cross(b, column(2))) / det,
            dot(column(0), cross(column(1), b)) / det};
  }
  // u_T x t = 0 times the denominator of r_N: k.t + t.Q t = 0, with t = (1 - z^2, 2 z) / (1 + z^2).
  std::vector<Number> quartic_roots() const {
    const Number kx = q_[2] * W_[0][0] - q_[0] * W_[2][0], ky = -(q_[1] * W_[0][0] - q_[0] * W_[1][0]);
    const auto A = [&](std::size_t i, std::size_t j) {
      return Number(mu_ * (q_[0] * W_[i][j] - q_[i] * W_[0][j]));
    };
    const Number xx = A(2, 1), xy = A(2, 2) - A(1, 1), yy = -A(1, 2);
    return real_roots({kx + xx, 2 * (ky + xy), 4 * yy - 2 * xx, 2 * (ky - xy), xx - kx});
  }
  // Between two roots of the derivative lies at most one.
  static std::vector<Number> real_roots(const std::vector<Number>& c) {
    if (c.size() < 2) return {};
    const auto value = [&](const Number& x) {
      Number sum = 0;
      for (std::size_t k = c.size(); k-- > 0;) sum = sum * x + c[k];
      return sum;
    };
    std::vector<Number> slope, roots;
    Number bound = 1;
    for (std::size_t k = 0; k < c.size(); ++k) {
      if (k > 0) slope.push_back(k * c[k]);
      bound += abs(c[k] / c.back());  // Cauchy's
    }
    std::vector<Number> ends = real_roots(slope);
    ends.insert(ends.begin(), -bound);
    ends.push_back(bound);
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      Number low = ends[k], high = ends[k + 1];
      const bool rising = value(low) < 0;
      if (rising == (value(high) < 0)) continue;
      for (int i = 0; i < 165; ++i) {
        const Number middle = (low + high) / 2;
        ((value(middle) < 0) == rising ? low : high) = middle;
      }
      roots.push_back((low + high) / 2);
    }
    return roots;
  }

  std::array<Numbers, 3> W_{};
  Numbers q_{};
  Number mu_, size_, unit_;
};

// A symmetric part of condition 1e12, all three eigenvalues over the decades between, and a skew part of 0.9
// of the largest one, or of all decades below; in one of two about a direction across that of the largest,
// where W may be as ill-conditioned.
Sample unsymmetric_sample(Random& random, bool full) {
  const Mat3 R = random_rotation(random);
  const Vec3 eigenvalues(1, random.log_uniform(1e-12, 1), 1e-12);
  const Mat3 symmetric = R * eigenvalues.asDiagonal() * R.transpose();
  Vec3 axis = uniform_vector(random, 3, -1, 1).normalized();
  if (random.uniform(0, 1) < 0.5) axis -= R.col(0) * R.col(0).dot(axis);
  const Vec3 s = (full ? 1 : random.log_uniform(1e-12, 1)) * 0.9 * axis.normalized();
  Mat3 skew;
  skew << 0, -s[2], s[1], s[2], 0, -s[0], -s[1], s[0], 0;
  const double choice = random.uniform(0, 1), scale = random.log_uniform(1e-6, 1e6);
  const double mu = choice < 0.1 ? 0 : choice < 0.2 ? 10 : random.uniform(0, 1.2);
  Vec3 q = uniform_vector(random, 3, -1, 1);
  q *= random.log_uniform(1e-6, 1e6);
  q[0] = -std::abs(q[0]);
  return {(0.5 * (symmetric + symmetric.transpose()) + skew) * scale, q, mu};
}

void solves_unsymmetric_blocks(int count, unsigned seed) {
  Random random(seed);
  int ill = 0, skew = 0, full = 0, ill_and_full = 0, fail_safes = 0, stuck = 0, slipped = 0, inside = 0;
  for (int i = 0; i < count; ++i) {
    const Sample s = unsymmetric_sample(random, i % 4 < 2);
    const Vec3 singular = Eigen::JacobiSVD<Mat3>(s.W).singularValues();
    const Mat3 even = (s.W + s.W.transpose()) / 2, odd = s.W - even;
    const double largest = Eigen::SelfAdjointEigenSolver<Mat3>(even).eigenvalues()[2];
    const bool is_ill = singular[0] > 1e10 * singular[2],
               is_full = std::abs(odd.norm() / std::sqrt(2) - 0.9 * largest) < 1e-12 * largest;
    ill += is_ill, full += is_full, ill_and_full += is_ill && is_full;
    skew += odd.norm() > 0.05 * s.W.norm();
    const LocalSolver solver = i % 2 ? LocalSolver::enumerative : LocalSolver::hybrid;
    const LocalSolution local = solve_one_contact(s.W, s.q, s.mu, Vec3::Zero(), solver);
    ASSERT_TRUE(local.solved) << "seed " << seed << ", case " << i;
    fail_safes += local.fail_safe;
    const ExactOracle oracle(s.W, s.q, s.mu);
    const ExactOracle::Numbers r = oracle.scaled(local.r);
    const double size = double(oracle.length(r)), wrong = double(oracle.length(oracle.natural_map(r)));
    ASSERT_LT(wrong, 1e-13 * (1 + 3 * size))
        << "seed " << seed << ", case " << i;  // (ONE-6) and the rounding of r
    const std::vector<ExactOracle::Numbers> solutions = oracle.solutions();
    ASSERT_FALSE(solutions.empty()) << "seed " << seed << ", case " << i;
    ++(double(oracle.length(oracle.velocity(r))) < 1e-13 * (1 + 3 * size) ? stuck : slipped);
    if (double(s.mu * r[0] - oracle.length({0, r[1], r[2]})) < 1e-9 * size) continue;
    ++inside;  // of the cone: there the natural map is u^, and r is as far off as W^-1 makes of it
    double nearest = kInf;
    for (const ExactOracle::Numbers& exact : solutions)
      nearest = std::min(nearest, double(oracle.length({r[0] - exact[0], r[1] - exact[1], r[2] - exact[2]})));
    ASSERT_LE(nearest, 1.01 * (1 + s.mu) * s.W.trace() / 3 / singular[2] * wrong)
        << "seed " << seed << ", case " << i;
  }
  ::testing::Test::RecordProperty("ill_conditioned", ill);
  ::testing::Test::RecordProperty("ill_conditioned_and_full", ill_and_full);
  EXPECT_EQ(full, count / 2);
  EXPECT_GT(ill, count / 4);
  EXPECT_GT(ill_and_full, count / 20);
  EXPECT_GT(skew, 11 * count / 20);
  EXPECT_GT(fail_safes, count / 40);  // Newton alone does not do it
  EXPECT_GT(stuck, count / 8);
  EXPECT_GT(slipped, count / 4);
  EXPECT_GT(inside, count / 8);
}

TEST(OneContact, SolvesEveryUnsymmetricBlockOfConditionTwelve) {
  solves_unsymmetric_blocks(4000, 21);
}
TEST(OneContact, SolvesAHundredThousandUnsymmetricBlocks) {
  solves_unsymmetric_blocks(100000, 22);
}

TEST(OneContact, SolvesPlanarBlocksOfConditionTwelveToo) {
  Random random(23);
  for (int i = 0; i < 4000; ++i) {
    const double angle = random.uniform(-kPi, kPi), c = std::cos(angle), s = std::sin(angle);
    const double least = random.log_uniform(1e-12, 1), skew = random.log_uniform(1e-12, 0.9);
    RowBlock<2> W;
    W << c * c + least * s * s, (1 - least) * c * s - skew, (1 - least) * c * s + skew, s * s + least * c * c;
    const Rows<2> q{-random.uniform(1e-3, 1), random.uniform(-1, 1)};
    const Law law = coulomb_2d(random.uniform(0, 1.2));
    if (W(0, 0) < 1e-11) continue;  // locked (ONE-10)
    ASSERT_TRUE(solve_block(prepare_block(W, law), q, law, Rows<2>::Zero(), LocalSolver::hybrid).solved)
        << "seed 23, case " << i;
  }
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
