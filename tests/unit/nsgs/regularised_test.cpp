// SPDX-License-Identifier: Apache-2.0
// Compliant contact in three readings (regularised.md). T_5_1 to T_5_9 are the numbers of its tests.
#include "nsgs/regularised.hpp"

#include <cmath>
#include <numeric>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/support/message_of.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

constexpr double kG = 9.81, kH = 1e-3, kBlockMass = 2, kHalf = 0.05;
constexpr FrictionReading kAll[] = {FrictionReading::coulomb_pgs, FrictionReading::convex_cone,
                                    FrictionReading::hybrid};
const RegularisedOptions kSharp{.tolerance = 1e-10, .max_iterations = 200000};

RegularisedOptions sharp(FrictionReading reading) {
  RegularisedOptions options = kSharp;
  options.reading = reading;
  if (reading == FrictionReading::convex_cone) options.max_iterations = 200;
  return options;
}

FrictionProblem block_on(const std::vector<Vec2>& feet, double mu, const Vec6& v) {
  FrictionProblem problem;
  std::vector<ContactSpec> specs;
  for (const Vec2& foot : feet) specs.push_back({.a = 0, .x_a = Vec3(foot.x(), foot.y(), -kHalf)});
  problem.M =
      block_diagonal({kBlockMass * Mat3::Identity(), kBlockMass * 4 * kHalf * kHalf / 6 * Mat3::Identity()});
  problem.H = contact_directions(1, specs);
  problem.w = VecX::Zero(3 * Eigen::Index(feet.size()));
  problem.laws.assign(feet.size(), coulomb(mu));
  Vec6 free = v;
  free[2] -= kG * kH;
  problem.f = problem.M * free;
  return problem;
}

std::vector<Vec2> grid(int nx, int ny) {
  std::vector<Vec2> feet;
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      feet.emplace_back(kHalf * (2.0 * i / (nx - 1) - 1), kHalf * (2.0 * j / (ny - 1) - 1));
  return feet;
}

// 17 points: the centre and two rings of eight.
std::vector<Vec2> rings() {
  std::vector<Vec2> feet{Vec2::Zero()};
  for (const double r : {kHalf / 2, kHalf})
    for (int i = 0; i < 8; ++i) feet.push_back(r * Vec2(std::cos(i * kPi / 4), std::sin(i * kPi / 4)));
  return feet;
}

double carried(const VecX& lambda) {
  double sum = 0;
  for (Eigen::Index k = 0; k < lambda.size(); k += 3) sum += lambda[k];
  return sum;
}

double kinetic_energy(const FrictionProblem& problem, const VecX& v) {
  return 0.5 * v.dot(problem.M * v);
}

TEST(Regularised, T_5_2_CarriesTheWeightButForItsCompliance) {
  for (const FrictionReading reading : kAll)
    for (const double rho : {1e-3, 1e-2})
      for (const std::vector<Vec2>& feet : {grid(2, 2), rings(), grid(10, 10)}) {
        const LocalProblem problem = condense(block_on(feet, 0.5, Vec6::Zero()));
        const VecX R = regularisation(problem, rho);
        const RegularisedOptions options = sharp(reading);
        const RegularisedSolution s = solve_regularised(problem, R, {}, options);
        ASSERT_EQ(s.report.status, SolveStatus::converged)
            << to_string(reading) << " " << feet.size() << " " << s.report.residual;
        const double weight = kBlockMass * kG * kH;
        EXPECT_NEAR(carried(s.lambda), weight, rho * weight);
        // (REG-8): least norm of equal contacts shares the weight, but r differs with the place of the foot
        double inverse_r = 0;  // all feet approach at one speed v: sum lambda = v sum 1/r
        for (Eigen::Index k = 0; k < R.size(); k += 3) inverse_r += 1 / R[k];
        const double speed = kG * kH / (1 + inverse_r / kBlockMass);
        EXPECT_NEAR(carried(s.lambda), speed * inverse_r, 10 * options.tolerance * weight);
        EXPECT_NEAR(s.violation, speed, 1e-5 * speed);  // residual / rho, times the root of 100
      }
}

TEST(Regularised, T_5_2_SharesSmoothlyWhenContactsAreAdded) {
  // A foot added where others stand takes part of their load: none of the others gets more.
  const std::vector<Vec2> all = rings();
  VecX before;
  for (std::size_t n = 9; n <= all.size(); n += 8) {
    const LocalProblem problem = condense(block_on({all.begin(), all.begin() + long(n)}, 0.5, Vec6::Zero()));
    const RegularisedSolution s =
        solve_regularised(problem, regularisation(problem, 1e-3), {}, sharp(FrictionReading::hybrid));
    ASSERT_EQ(s.report.status, SolveStatus::converged);
    for (Eigen::Index k = 0; k < before.size(); k += 3) {
      EXPECT_LT(s.lambda[k], before[k]);
      EXPECT_GT(s.lambda[k], 0.3 * before[k]);
    }
    before = s.lambda;
  }
}

TEST(Regularised, T_5_3_PgsAndTheShiftFindTheSameImpulses) {
  int compared = 0, slipping = 0;
  for (unsigned seed = 0; seed < 500; ++seed) {
    Random random(seed);
    const LocalProblem problem =
        condense(random_peg_in_hole(random, 1 + int(seed % 2), 2 + int(seed % 7), random.uniform(0.05, 0.6)));
    const VecX R = regularisation(problem, random.log_uniform(1e-3, 0.3));
    const RegularisedSolution pgs = solve_regularised(problem, R, {}, sharp(FrictionReading::coulomb_pgs)),
                              hybrid = solve_regularised(problem, R, {}, sharp(FrictionReading::hybrid));
    if (pgs.report.status != SolveStatus::converged || hybrid.report.status != SolveStatus::converged)
      continue;
    ++compared;
    EXPECT_LT((pgs.lambda - hybrid.lambda).norm(), 1e-7 * hybrid.lambda.norm() + 1e-300) << "seed " << seed;
    for (Eigen::Index k = 0; k < R.size(); k += 3)
      slipping += hybrid.lambda[k] > 0 && hybrid.v.segment<2>(k + 1).norm() > 1e-3 * hybrid.v.norm();
  }
  EXPECT_EQ(compared, 500);  // all converge
  EXPECT_GT(slipping, 200);
}

TEST(Regularised, T_5_4_OnlyTheConvexConeLiftsWhatSlides) {
  Vec6 v = Vec6::Zero();
  v[0] = 1;
  const double mu = 0.5;
  const LocalProblem problem = condense(block_on(grid(2, 2), mu, v));
  const VecX R = regularisation(problem, 1e-4);
  for (const FrictionReading reading : kAll) {
    const RegularisedSolution s = solve_regularised(problem, R, {}, sharp(reading));
    ASSERT_EQ(s.report.status, SolveStatus::converged) << to_string(reading);
    int closed = 0;
    for (Eigen::Index k = 0; k < R.size(); k += 3) {
      if (!(s.lambda[k] > 1e-9 * carried(s.lambda))) continue;
      ++closed;
      const double slip = s.v.segment<2>(k + 1).norm(), lift = s.v[k] + R[k] * s.lambda[k];
      // w_T of (REG-5) has the compliance too
      const double w_T = (s.v.segment<2>(k + 1) + R[k] * s.lambda.segment<2>(k + 1)).norm();
      EXPECT_NEAR(lift, reading == FrictionReading::convex_cone ? mu * w_T : 0, 1e-7);
      EXPECT_GT(slip, 0.3);
    }
    EXPECT_GE(closed, 2) << to_string(reading);
  }
}

TEST(Regularised, T_5_5_ASlidingBlockBrakesWithMuG) {
  const double mu = 0.4;
  for (const FrictionReading reading : {FrictionReading::coulomb_pgs, FrictionReading::hybrid}) {
    Vec6 v = Vec6::Zero();
    v[0] = 1;
    for (int step = 0; step < 20; ++step) {  // what one step lacks the next one has in b
      const FrictionProblem bodies = block_on(grid(2, 2), mu, v);
      const LocalProblem problem = condense(bodies);
      const RegularisedSolution s =
          solve_regularised(problem, regularisation(problem, 1e-3), {}, sharp(reading));
      ASSERT_EQ(s.report.status, SolveStatus::converged);
      const double before = v[0];
      const VecX momentum = bodies.f + bodies.H * s.lambda;
      v.head<3>() = momentum.head<3>() / kBlockMass;
      v.tail<3>() = momentum.tail<3>() / (kBlockMass * 4 * kHalf * kHalf / 6);
      EXPECT_NEAR((before - v[0]) / kH, mu * kG, (step == 0 ? 2e-3 : 1e-3) * mu * kG) << step;
    }
  }
}

TEST(Regularised, T_5_6_ASymmetricProblemHasSymmetricForces) {
  for (const FrictionReading reading : kAll) {
    Vec6 v = Vec6::Zero();
    v[0] = 0.3;  // the mirror image in y is the same problem
    const LocalProblem problem = condense(block_on(grid(3, 3), 0.3, v));
    const RegularisedSolution s =
        solve_regularised(problem, regularisation(problem, 0.02), {}, sharp(reading));
    ASSERT_EQ(s.report.status, SolveStatus::converged) << to_string(reading);
    const Vec3 n = Vec3::UnitZ(), t1 = n.unitOrthogonal(), t2 = n.cross(t1);
    const auto force = [&](int i, int j) -> Vec3 {
      const Vec3 r = s.lambda.segment<3>(3 * (3 * i + j));
      return r[0] * n + r[1] * t1 + r[2] * t2;
    };
    for (int i = 0; i < 3; ++i) {
      const Vec3 mirrored = force(i, 0).cwiseProduct(Vec3(1, -1, 1));
      EXPECT_LT((mirrored - force(i, 2)).norm(), 1e-6 * s.lambda.norm()) << to_string(reading);
    }
  }
}

TEST(Regularised, T_5_7_APointMassBouncesWithE) {
  const double e = 0.6, rho = 1e-6, m = 0.5;
  for (const FrictionReading reading : kAll)
    for (const double speed : {1.5, 0.005}) {  // the second is below the threshold
      const Vec3 before(-speed, 0, 0);
      LocalProblem problem{.W = SparseMatrix((MatX::Identity(3, 3) / m).sparseView()),
                           .laws = {coulomb(0.3)}};
      problem.q = with_restitution(before, before, problem.laws, e);
      const RegularisedSolution s =
          solve_regularised(problem, regularisation(problem, rho), {}, sharp(reading));
      // b of (REG-3) carries e v_N in every step, so v+ of the body is v' - e v
      const double bounce = speed > 0.01 ? e * speed : 0;
      const double after = before[0] + s.lambda[0] / m;
      EXPECT_NEAR(after, bounce, 2 * rho * (1 + e) * speed + 1e-9) << to_string(reading);
    }
}

TEST(Regularised, T_5_8_EnergyNeverRisesWithoutRestitutionOrForces) {
  int lost = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Random random(seed);
    FrictionProblem bodies = random_peg_in_hole(random, 1, 2 + int(seed % 7), 0.3);
    bodies.M = 0.5 * (bodies.M + SparseMatrix(bodies.M.transpose()));
    bodies.w.setZero();  // all contacts closed
    const LocalProblem problem = condense(bodies);
    const VecX R = regularisation(problem, 1e-2);
    const VecX v_before = MatX(bodies.M).partialPivLu().solve(bodies.f);
    for (const FrictionReading reading : kAll) {
      const RegularisedSolution s = solve_regularised(problem, R, {}, sharp(reading));
      if (s.report.status != SolveStatus::converged) continue;
      const VecX v_after = MatX(bodies.M).partialPivLu().solve(bodies.f + bodies.H * s.lambda);
      const double before = kinetic_energy(bodies, v_before), after = kinetic_energy(bodies, v_after);
      EXPECT_LE(after, before * (1 + 1e-9)) << to_string(reading) << " seed " << seed;
      lost += after < 0.99 * before;
    }
  }
  EXPECT_GT(lost, 300);
}

TEST(Regularised, T_5_8_ASingleContactTakesBackEOfItsSpeed) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    FrictionProblem bodies = random_peg_in_hole(random, 1, 1, random.uniform(0, 0.5));
    bodies.w.setZero();
    const LocalProblem free = condense(bodies);
    const double e = random.uniform(0, 1);
    LocalProblem problem = free;
    problem.q = with_restitution(free.q, free.q, free.laws, e, 0);
    const VecX R = regularisation(problem, 1e-3);
    for (const FrictionReading reading : {FrictionReading::coulomb_pgs, FrictionReading::hybrid}) {
      const RegularisedSolution s = solve_regularised(problem, R, {}, sharp(reading));
      ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed;
      const double after = (free.W * s.lambda + free.q)[0];  // without the e v in b
      if (free.q[0] < 0) {
        EXPECT_NEAR(after, -e * free.q[0], R[0] * s.lambda[0] + 1e-8 * free.q.norm()) << "seed " << seed;
      } else {
        EXPECT_GE(after, -1e-12);
      }
    }
  }
}

TEST(Regularised, T_5_9_SensitivityIsTheDerivative) {
  int compared = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    LocalProblem problem = condense(random_peg_in_hole(random, 1, 2 + int(seed % 4), 0.3));
    problem.W = 0.5 * (problem.W + SparseMatrix(problem.W.transpose()));
    const VecX R = regularisation(problem, 0.05);
    for (const FrictionReading reading : {FrictionReading::convex_cone, FrictionReading::hybrid}) {
      RegularisedOptions options = sharp(reading);
      options.tolerance = 1e-13;
      const auto impulses = [&](const VecX& b) {
        LocalProblem moved = problem;
        moved.q = b;
        return solve_regularised(moved, R, {}, options).lambda;
      };
      const VecX lambda = impulses(problem.q);
      const MatX S = impulse_sensitivity(problem, R, lambda, reading);
      const VecX d = uniform_vector(random, int(R.size()), -1, 1) * problem.q.norm();
      // Where both sides agree no contact changes its mode; two steps of difference must not change them.
      const double h = 1e-6;
      const VecX plus = impulses(problem.q + h * d), minus = impulses(problem.q - h * d);
      const VecX forward = (plus - lambda) / h, backward = (lambda - minus) / h;
      if ((forward - backward).norm() > 1e-3 * forward.norm()) continue;
      compared += lambda.norm() > 0;
      EXPECT_LE((S * d - (plus - minus) / (2 * h)).norm(), 1e-4 * (S * d).norm() + 1e-9 * lambda.norm() / h)
          << to_string(reading) << " seed " << seed;
    }
  }
  EXPECT_GT(compared, 90);
}

// A body that spins on four feet about an axis that is not a principal one, with its gyroscopic term written
// in two ways. Impulses are of the size of the step, so the velocities agree to its second order.
TEST(Regularised, TakesAGyroscopicDelassusOperator) {
  Random random(3);
  const Mat3 turn = random_rotation(random);
  const Mat3 J = turn * Vec3(1e-3, 2e-3, 2.5e-3).asDiagonal() * turn.transpose();
  const Vec3 spin(0, 0, 5);
  Mat3 C;  // -S(J omega)
  const Vec3 L = J * spin;
  C << 0, L[2], -L[1], -L[2], 0, L[0], L[1], -L[0], 0;
  std::vector<ContactSpec> specs;
  for (const Vec2& foot : grid(2, 2))
    specs.push_back({.a = 0, .x_a = Vec3(2 * foot.x(), 2 * foot.y(), -0.01)});
  double last = 0;
  for (const double h : {4e-4, 2e-4, 1e-4}) {
    FrictionProblem implicit;
    implicit.H = contact_directions(1, specs);
    implicit.laws.assign(4, coulomb(0.3));
    implicit.w = VecX::Zero(12);
    Vec6 v;
    v << 0, 0, -kG * h, spin;
    FrictionProblem explicit_C = implicit;
    implicit.M = block_diagonal({0.3 * Mat3::Identity(), J + h / 2 * C});
    implicit.f.resize(6);
    implicit.f << 0.3 * v.head<3>(), J * spin - h / 2 * C * spin;
    explicit_C.M = block_diagonal({0.3 * Mat3::Identity(), J});
    explicit_C.f = implicit.f;
    explicit_C.f.tail<3>() = J * spin - h * C * spin;
    LocalProblem a = condense(implicit), b = condense(explicit_C);
    EXPECT_GT((MatX(a.W) - MatX(a.W).transpose()).norm(), h * a.W.norm());  // or it says nothing
    const VecX R = regularisation(b, 1e-3);
    const auto velocity = [&](const LocalProblem& problem, FrictionReading reading) {
      const RegularisedSolution s = solve_regularised(problem, R, {}, sharp(reading));
      EXPECT_EQ(s.report.status, SolveStatus::converged) << to_string(reading) << " " << s.report.residual;
      EXPECT_GT(carried(s.lambda), 0.1 * 0.3 * kG * h);
      return s.v;
    };
    const VecX pgs = velocity(a, FrictionReading::coulomb_pgs), shift = velocity(a, FrictionReading::hybrid);
    EXPECT_LT((pgs - shift).norm(), 1e-7 * shift.norm());
    a.laws.assign(4,
                  coulomb(0));  // convex cones lift what slides, by impulses that are not of the step's size
    b.laws = a.laws;
    const double difference =
        (velocity(a, FrictionReading::convex_cone) - velocity(b, FrictionReading::convex_cone)).norm();
    if (last > 0) {
      EXPECT_NEAR(last / difference, 4, 0.1) << h;
    }
    last = difference;
  }
}

TEST(Regularised, RefusesWhatItCannotMean) {
  LocalProblem problem = condense(block_on(grid(2, 2), 0.5, Vec6::Zero()));
  const VecX R = regularisation(problem);
  EXPECT_EQ(R.size(), 12);
  EXPECT_NE(message_of([&] { regularisation(problem, -1); }).find("rho = -1"), std::string::npos);
  EXPECT_NE(message_of([&] { solve_regularised(problem, R.head(3)); }).find("R.size() = 3"),
            std::string::npos);
  EXPECT_NE(message_of([&] { solve_regularised(problem, -R); }).find("R = -"), std::string::npos);
  EXPECT_NE(message_of([&] { with_restitution(problem.q, problem.q, problem.laws, 2); }).find("e = 2"),
            std::string::npos);
  EXPECT_EQ(message_of([&] { solve_regularised(problem, R, {}, {.tolerance = 1}); }),
            "RegularisedOptions::tolerance = 1 must lie in (0, 1)");
  problem.laws[1] = bilateral(3);
  EXPECT_NE(message_of([&] { solve_regularised(problem, R); }).find("laws[1].kind"), std::string::npos);
}

TEST(Regularised, ReadingsHaveNames) {
  for (const FrictionReading reading : kAll)
    EXPECT_EQ(value_named(to_string(reading), "reading", kFrictionReadings), reading);
}

}  // namespace
}  // namespace aussois
