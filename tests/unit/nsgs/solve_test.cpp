// SPDX-License-Identifier: Apache-2.0
#include "nsgs/solve.hpp"

#include <gtest/gtest.h>

#include "nsgs/residual.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Impulses and velocities that satisfy the law by construction; q is what makes them the solution.
LocalProblem planted_problem(Random& random, int contacts, VecX& u) {
  const int n = 3 * contacts;
  const MatX factor = MatX::NullaryExpr(n, n, [&] { return random.uniform(-1, 1); });
  const MatX W = factor * factor.transpose() / n + 0.1 * MatX::Identity(n, n);
  LocalProblem problem;
  problem.W = W.sparseView();
  VecX r = VecX::Zero(n);
  u = VecX::Zero(n);
  for (int c = 0; c < contacts; ++c) {
    const double mu = random.uniform(0, 0.3), kind = random.uniform(0, 3);
    const double angle = random.uniform(-kPi, kPi), size = random.uniform(0.1, 1);
    const Vec3 t(0, std::cos(angle), std::sin(angle));
    problem.laws.push_back(coulomb(mu));
    if (kind < 1) {  // open
      u.segment<3>(3 * c) = size * Vec3::UnitX() + random.uniform(-1, 1) * t;
    } else if (kind < 2) {  // sticking
      r.segment<3>(3 * c) = size * (Vec3::UnitX() + 0.5 * mu * t);
    } else {  // slipping
      r.segment<3>(3 * c) = size * (Vec3::UnitX() - mu * t);
      u.segment<3>(3 * c) = random.uniform(0.1, 1) * t;
    }
  }
  problem.q = u - W * r;
  return problem;
}

TEST(Solve, FindsPlantedSolutions) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    VecX u;
    const LocalProblem problem = planted_problem(random, 2 + int(seed % 12), u);
    for (const Method method : {Method::nsgs, Method::automatic}) {
      const FrictionSolution s = solve(problem, {}, {.method = method, .tolerance = 1e-12});
      ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed;
      EXPECT_LT((s.u - u).norm(), 1e-9 * problem.q.norm())
          << "seed " << seed;  // 1e-12 times the condition of W
    }
  }
}

TEST(Solve, GivesEachCubeOfAStackTheWeightAboveIt) {
  for (const int n : {1, 3, 10}) {
    const FrictionProblem problem = cube_stack(n, 2.0, 0.6);
    const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-10});
    ASSERT_EQ(s.report.status, SolveStatus::converged) << n << " cubes";
    const double weight = 2.0 * 9.81 * 1e-3;
    for (int b = 0; b < n; ++b) {  // four contacts under each cube: their sum is unique, their shares are not
      double sum = 0;
      for (int k = 0; k < 4; ++k) sum += s.r[12 * b + 3 * k];
      EXPECT_NEAR(sum, (n - b) * weight, 1e-7 * n * weight) << n << " cubes, cube " << b;
    }
    EXPECT_LT(s.v.norm(), 1e-8 * 9.81e-3 * n);
  }
}

TEST(Solve, HoldsAHeavyCubeOnALightOne) {
  FrictionProblem problem = cube_stack(2, 1e-3, 0.5);
  for (int i = 6; i < 12; ++i) problem.M.coeffRef(i, i) *= 1e6;
  problem.f.tail<6>() *= 1e6;
  // Impulses a million times the free momentum of the light cube: rounding ends at 1e-10.
  const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-9});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  const double weight = 1e-3 * 9.81e-3;
  EXPECT_NEAR(s.r[0] + s.r[3] + s.r[6] + s.r[9], (1 + 1e6) * weight, 1e-3 * 1e6 * weight);
}

// Two bodies, one of them with a third on a joint, move at 1 m/s and 10 um/s towards each other. Stop and dry
// friction act along one direction, and their speeds differ by a rounding of 1 m/s, which is 1e-11 of q: load
// goes from one to the other by that much a sweep until all of it has gone.
TEST(Solve, TakesRoundingOfWhatCancelsForNoneWithJointsToo) {
  for (const bool joint : {false, true}) {
    FrictionProblem problem;
    const Vec3 mass(1, 2, 3);
    problem.M = MatX(mass.asDiagonal()).sparseView();
    problem.f = mass;
    problem.H = (MatX(3, 2) << 1, 1, -1, -1, 0, 0).finished().sparseView();
    problem.w = Vec2(-1e-5, -1e-5 + 1e-16);
    problem.laws = {unilateral(), dry_friction(1e-6)};
    if (joint) {
      problem.G = (MatX(3, 1) << 0, 1, -1).finished().sparseView();
      problem.b = VecX::Zero(1);
    }
    for (const double tolerance : {1e-12, 1e-15}) {
      const FrictionSolution s = solve(problem, {}, {.tolerance = tolerance});
      EXPECT_EQ(s.report.status, SolveStatus::at_rounding);
      EXPECT_LT(s.report.iterations, 10);
      EXPECT_LT(s.u.norm(), 1e-15);
      const double m = joint ? 5.0 / 6 : 2.0 / 3;
      EXPECT_NEAR(s.r.sum(), 1e-5 * m, 1e-15);
      const double judge = scaled_residual(condense(problem), s.r);  // q has five digits less than 1 m/s
      EXPECT_NEAR(s.report.residual, judge, 1e-10);
      EXPECT_GT(s.report.residual, 1e-12);
      EXPECT_LT(s.report.residual, 1e-9);
    }
  }
}

// Parts of one problem that do not feel each other.
FrictionProblem beside(const std::vector<FrictionProblem>& parts) {
  FrictionProblem out;
  std::vector<Triplet> M, H;
  Eigen::Index n = 0, m = 0;
  const auto append = [](const SparseMatrix& A, Eigen::Index row, Eigen::Index column,
                         std::vector<Triplet>& to) {
    for (int j = 0; j < A.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(A, j); it; ++it)
        to.emplace_back(int(row + it.row()), int(column) + j, it.value());
  };
  for (const FrictionProblem& part : parts) {
    append(part.M, n, n, M);
    append(part.H, n, m, H);
    n += part.f.size();
    m += part.w.size();
    out.f.conservativeResize(n);
    out.f.tail(part.f.size()) = part.f;
    out.w.conservativeResize(m);
    out.w.tail(part.w.size()) = part.w;
    out.laws.insert(out.laws.end(), part.laws.begin(), part.laws.end());
  }
  out.M.resize(n, n);
  out.M.setFromTriplets(M.begin(), M.end());
  out.H.resize(n, m);
  out.H.setFromTriplets(H.begin(), H.end());
  return out;
}

// Boxes on a heavy car, everything at 100 m/s in each direction: in every row these speeds cancel, and
// gravity, which the car does not feel, leaves 1 cm/s.
FrictionProblem train(int boxes) {
  FrictionProblem problem = cube_stack(boxes + 1, 10.0, 0.5);
  for (int i = 0; i < 6; ++i) problem.M.coeffRef(i, i) *= 1e3;
  problem.f[2] = 0;
  VecX v = VecX::Zero(problem.f.size());
  for (int b = 0; b <= boxes; ++b) v.segment<3>(6 * b).setConstant(100);
  problem.f += problem.M * v;
  problem.H = SparseMatrix(problem.H.rightCols(problem.H.cols() - 12));  // the car touches nothing below it
  problem.w = VecX(problem.w.tail(problem.H.cols()));
  problem.laws.resize(problem.laws.size() - 4);
  return problem;
}

// Ten cubes of 1 mg at rest, a ton that comes in at 100 m/s, a block of 1000 t at 1 km/s, and the train.
std::vector<FrictionProblem> unequal_islands() {
  std::vector<FrictionProblem> parts{cube_stack(10, 1e-6, 0.5), cube_stack(1, 1e3, 0.5),
                                     cube_stack(1, 1e6, 0.3), train(6)};
  parts[1].f[2] -= 1e3 * 100;
  parts[1].f[0] += 1e3 * 30;
  parts[2].f[2] -= 1e6 * 1000;
  return parts;
}

TEST(Solve, GivesEachIslandTheBitsThatItHasAlone) {
  const std::vector<FrictionProblem> parts = unequal_islands();
  const FrictionProblem whole = beside(parts);
  const LocalProblem local = condense(whole);
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const SolverOptions options{.tolerance = tolerance};
    const FrictionSolution together = solve(whole, {}, options), condensed = solve(local, {}, options);
    EXPECT_EQ(together.report.status, SolveStatus::converged);
    EXPECT_EQ(condensed.report.status, SolveStatus::converged);
    EXPECT_LE(together.report.worst_island, tolerance);
    EXPECT_NEAR(together.report.residual, scaled_residual(local, together.r), 1e-12);
    Eigen::Index row = 0, dof = 0;
    double worst = 0;
    for (const FrictionProblem& part : parts) {
      const Eigen::Index m = part.w.size(), n = part.f.size();
      const FrictionSolution alone = solve(part, {}, options);
      EXPECT_EQ(alone.r, VecX(together.r.segment(row, m)));
      EXPECT_EQ(alone.v, VecX(together.v.segment(dof, n)));
      EXPECT_EQ(solve(condense(part), {}, options).r, VecX(condensed.r.segment(row, m)));
      EXPECT_DOUBLE_EQ(alone.report.residual, alone.report.worst_island);
      EXPECT_LE(scaled_residual(condense(part), together.r.segment(row, m)), 1.01 * tolerance + 1e-14);
      worst = std::max(worst, alone.report.worst_island);
      row += m;
      dof += n;
    }
    EXPECT_EQ(together.report.worst_island, worst);
  }
}

TEST(Solve, OfATrainAtSpeedIsAsGoodAsAtRest) {
  const FrictionProblem fast = train(6);
  FrictionProblem slow = fast;
  VecX v = VecX::Zero(fast.f.size());
  for (int b = 0; b < 7; ++b) v.segment<3>(6 * b).setConstant(100);
  slow.f -= slow.M * v;
  const FrictionSolution a = solve(fast, {}, {.tolerance = 1e-10}), b = solve(slow, {}, {.tolerance = 1e-10});
  EXPECT_EQ(a.report.status, SolveStatus::converged);
  EXPECT_EQ(b.report.status, SolveStatus::converged);
  // f holds 1e-2 of 1e5 m/s, so q has 1e-14 * 1e3 / 1e-2 of its digits
  EXPECT_LT((a.u - b.u).norm(), 1e-9 * 9.81e-3);
  EXPECT_LE(scaled_residual(condense(fast), a.r), 1e-9);
}

TEST(Solve, SaysThatImpulsesAreAsGoodAsRoundingLetsThem) {
  FrictionProblem problem = cube_stack(2, 1e-3, 0.5);
  for (int i = 6; i < 12; ++i) problem.M.coeffRef(i, i) *= 1e6;
  problem.f.tail<6>() *= 1e6;
  const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-16});
  EXPECT_EQ(s.report.status, SolveStatus::at_rounding);
  EXPECT_GT(s.report.residual, 1e-16);
  EXPECT_LT(s.report.residual, 1e-8);  // 1e-15 of impulses that are 1e6 of |q|, some of them for each cube
  EXPECT_TRUE(is_solved(s.report.status));
  EXPECT_FALSE(is_solved(SolveStatus::stagnated));
}

TEST(Solve, EstimatesHowFarVelocitiesAreFromTheExactOnes) {
  int seen = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 30, 0.2);
    const LocalProblem local = condense(problem);
    const VecX s = row_scales(local.W.diagonal(), local.laws).cwiseSqrt().cwiseInverse();
    for (const double tolerance : {1e-3, 1e-5}) {
      const FrictionSolution plain = solve(problem, {}, {.tolerance = tolerance});
      const FrictionSolution told = solve(problem, {}, {.tolerance = tolerance, .estimate_error = true});
      EXPECT_EQ(plain.r, told.r) << "seed " << seed;
      EXPECT_LT(plain.report.error, 0);
      const SolverOptions sweeps{.method = Method::nsgs, .tolerance = 1e-13, .max_iterations = 100000};
      const FrictionSolution exact =
          solve(problem, told.r, sweeps);  // of several solutions the one next to it
      if (!is_solved(exact.report.status)) continue;
      const double error = (told.u - exact.u).cwiseProduct(s).norm() / local.q.cwiseProduct(s).norm();
      if (error < 1e-11) continue;  // the reference has no more digits
      ++seen;
      EXPECT_LT(told.report.error, 2 * error) << "seed " << seed << " tolerance " << tolerance;
      EXPECT_GT(told.report.error, error / 2) << "seed " << seed << " tolerance " << tolerance;
    }
  }
  EXPECT_GT(seen, 60);
}

TEST(Solve, NeverAddsKineticEnergy) {
  int dissipating = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    Random random(seed);
    FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 4 + int(seed % 40), 0.4);
    problem.M = SparseMatrix(0.5 * (problem.M + SparseMatrix(problem.M.transpose())));  // a mass: symmetric
    problem.w.setZero();
    const VecX v0 = uniform_vector(random, int(problem.f.size()), -1, 1);
    problem.f = problem.M * v0;
    const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-10});
    ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed;
    const double before = v0.dot(problem.M * v0) / 2, after = s.v.dot(problem.M * s.v) / 2;
    EXPECT_LE(after, before * (1 + 1e-9)) << "seed " << seed;
    dissipating += after < 0.99 * before;
  }
  EXPECT_GT(dissipating, 250);
}

TEST(Solve, AgreesOnBothFormsOfTheProblem) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 6 + int(seed % 10), 0.2);
    const LocalProblem local = condense(problem);
    const SolverOptions few{.method = Method::nsgs, .tolerance = 1e-15, .max_iterations = 3};
    const FrictionSolution a = solve(problem, {}, few), b = solve(local, {}, few);
    EXPECT_LE((a.r - b.r).norm(), 1e-9 * a.r.norm()) << "seed " << seed;  // the same sweeps
    const FrictionSolution s = solve(problem, {}), t = solve(local, {});
    ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed;
    ASSERT_EQ(t.report.status, SolveStatus::converged) << "seed " << seed;
    // One judge for both; and u is that of r and of v.
    EXPECT_LT(scaled_residual(local, s.r), 1.01e-8) << "seed " << seed;
    EXPECT_LT((s.u - (local.W * s.r + local.q)).norm(), 1e-10 * local.q.norm()) << "seed " << seed;
    EXPECT_LT((s.u - (problem.H.transpose() * s.v + problem.w)).norm(), 1e-12 * local.q.norm())
        << "seed " << seed;
  }
}

TEST(Solve, SolvesCoupledMassesByCondensing) {
  Random random(7);
  FrictionProblem problem = cube_stack(6, 1.0, 0.5);
  for (int i = 0; i + 1 < 36; ++i) {  // one component of 36 rows
    problem.M.coeffRef(i, i + 1) = 1e-5;
    problem.M.coeffRef(i + 1, i) = 1e-5;
  }
  problem.M.makeCompressed();
  const FrictionSolution s = solve(problem, {}, {.tolerance = 1e-10});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  EXPECT_LT((problem.M * s.v - problem.H * s.r - problem.f).norm(), 1e-12 * problem.f.norm());
  EXPECT_LT(scaled_residual(condense(problem), s.r), 1.01e-10);
}

TEST(Solve, DoesNotSeeUnits) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 20, 0.2);
    FrictionProblem other =
        problem;  // masses times 2^20, lengths times 2^-10: exact in binary, so bit for bit
    const double mass = 0x1p20, length = 0x1p-10;
    const auto unit = [&](Eigen::Index row) { return row % 6 < 3 ? 1.0 : length; };
    for (int j = 0; j < other.M.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(other.M, j); it; ++it)
        it.valueRef() *= mass * unit(it.row()) * unit(j);
    for (int j = 0; j < other.H.outerSize(); ++j)
      for (SparseMatrix::InnerIterator it(other.H, j); it; ++it) it.valueRef() *= unit(it.row());
    for (Eigen::Index i = 0; i < other.f.size(); ++i) other.f[i] *= mass * length * unit(i);
    other.w *= length;
    const FrictionSolution a = solve(problem, {}), b = solve(other, {});
    EXPECT_EQ(a.report.iterations, b.report.iterations) << "seed " << seed;
    EXPECT_EQ(a.report.newton_iterations, b.report.newton_iterations) << "seed " << seed;
    EXPECT_EQ(a.report.residual, b.report.residual) << "seed " << seed;
    EXPECT_EQ(b.r, VecX(mass * length * a.r)) << "seed " << seed;
  }
}

TEST(Solve, StartsFromTheSolutionWithoutASweep) {
  Random random(9);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 30, 0.2);
  const FrictionSolution first = solve(problem, {}), again = solve(problem, first.r);
  ASSERT_GT(first.report.iterations, 0);
  EXPECT_EQ(again.report.iterations, 0);
  EXPECT_EQ(again.report.newton_iterations, 0);
  EXPECT_EQ(again.report.status, SolveStatus::converged);
  EXPECT_LT((again.v - first.v).norm(), 1e-12 * first.v.norm());
}

TEST(Solve, ForgetsAStartThatIsWorseThanNone) {
  Random random(10);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 10, 0.2);
  const FrictionSolution cold = solve(problem, {}), wild = solve(problem, VecX::Constant(30, 1e9));
  EXPECT_EQ(cold.r, wild.r);
}

TEST(Solve, GivesTheSameBitsTwice) {
  Random random(11);
  const FrictionProblem problem = random_peg_in_hole(random, 2, 60, 0.2);
  EXPECT_EQ(solve(problem, {}).r, solve(problem, {}).r);
}

TEST(Solve, WithoutContactsIsFreeMotion) {
  FrictionProblem problem = cube_stack(1, 2.0, 0.5);
  problem.H = SparseMatrix(6, 0);
  problem.w = VecX(0);
  problem.laws.clear();
  const FrictionSolution s = solve(problem, {});
  EXPECT_EQ(s.report.status, SolveStatus::converged);
  EXPECT_EQ(s.report.iterations, 0);
  EXPECT_NEAR(s.v[2], -9.81e-3, 1e-15);
  EXPECT_EQ(solve(LocalProblem{}, {}).report.status, SolveStatus::converged);
}

// Beads on a line, the first three touching, the first heavy and fast: what its neighbours do says that the
// gap to the fourth opens (ISL-2), and it closes. The last two meet far away, or not.
FrictionProblem beads_on_a_line(VecX& v_free, double crash) {
  const Eigen::Index n = 6;
  v_free = VecX::Zero(n);
  v_free[0] = 10;
  v_free[4] = crash;
  VecX mass = VecX::Ones(n);
  mass[0] = 1000;
  FrictionProblem problem{.M = SparseMatrix(mass.asDiagonal()),
                          .H = SparseMatrix(n, 4),
                          .f = mass.cwiseProduct(v_free),
                          .w = Eigen::Vector4d(0, 0, 5, 0),
                          .laws = std::vector<Law>(4, unilateral())};
  for (int c = 0; c < 4; ++c) {
    const int bead = c < 3 ? c : 4;
    problem.H.insert(bead, c) = -1;
    problem.H.insert(bead + 1, c) = 1;
  }
  problem.H.makeCompressed();
  return problem;
}

TEST(Solve, TakesInAGapThatClosesAgainstTheGuess) {
  const double together = 10005.0 / 1003;  // of three beads, and the fourth slower by 5: momentum
  VecX before;
  for (const double crash : {0.0, 1e3}) {
    VecX v_free;
    const FrictionProblem problem = beads_on_a_line(v_free, crash);
    const std::optional<MassInverse> inverse = invert_mass(problem.M);
    const FrictionSolution s = solve(problem, {*inverse, v_free}, {}, {.tolerance = 1e-12});
    ASSERT_EQ(s.report.status, SolveStatus::converged);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(s.v[i], i < 3 ? together : together - 5, 1e-9) << i;
    EXPECT_NEAR(s.r[2], together - 5, 1e-9);
    EXPECT_NEAR(s.v[4], crash / 2, 1e-9);
    const VecX now = s.v.head(4);
    EXPECT_EQ(now, crash > 0 ? before : now);  // they do not feel the crash
    before = now;
  }
}

TEST(Solve, TakesInAGapWithoutATraceElsewhere) {
  VecX v_free, last;
  for (const double w : {5.0, 50.0}) {
    FrictionProblem problem = beads_on_a_line(v_free, 1.0 / 3);
    problem.w[2] = w;
    const std::optional<MassInverse> inverse = invert_mass(problem.M);
    const FrictionSolution s = solve(problem, {*inverse, v_free}, VecX(), {.tolerance = 1e-6});
    EXPECT_EQ(s.r[2] > 0, w < 10);
    EXPECT_TRUE(last.size() == 0 || s.v.tail(2) == last);
    last = s.v.tail(2);
  }
}

// Each gap of the row opens by what is known, and closes as the one before it does: all are taken in at once.
TEST(Solve, TakesInARowOfGapsThatCloseOneAfterTheOther) {
  const Eigen::Index n = 300;
  VecX v_free = VecX::Zero(n);
  v_free[0] = 1;
  FrictionProblem problem{.M = SparseMatrix(VecX(VecX::Ones(n)).asDiagonal()),
                          .H = SparseMatrix(n, n - 1),
                          .f = v_free,
                          .w = VecX::Constant(n - 1, 1e-3),
                          .laws = std::vector<Law>(std::size_t(n - 1), unilateral())};
  for (int c = 0; c + 1 < n; ++c) {
    problem.H.insert(c, c) = -1;
    problem.H.insert(c + 1, c) = 1;
  }
  problem.H.makeCompressed();
  const std::optional<MassInverse> inverse = invert_mass(problem.M);
  const FrictionSolution s = solve(problem, {*inverse, v_free}, VecX(), {.tolerance = 1e-10});
  ASSERT_EQ(s.report.status, SolveStatus::converged);
  const FrictionSolution whole = solve(problem, VecX(), {.tolerance = 1e-10});
  EXPECT_LT((s.v - whole.v).norm(), 1e-8);
  EXPECT_LE(s.report.iterations + s.report.newton_iterations,
            2 * (whole.report.iterations + whole.report.newton_iterations));
}

TEST(Solve, OfAKnownMotionSolvesTheWholeProblem) {
  int left_out = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 40, 0.2);
    const std::optional<MassInverse> inverse = invert_mass(problem.M);
    const FrictionSolution s = solve(problem, {*inverse, *inverse * problem.f}, {}, {.tolerance = 1e-10});
    ASSERT_EQ(s.report.status, SolveStatus::converged) << "seed " << seed;
    const LocalProblem local = condense(problem);
    EXPECT_LE(scaled_residual(local, s.r), 1.01e-10) << "seed " << seed;  // W has its own rounding
    EXPECT_LT((local.W * s.r + local.q - s.u).norm(), 1e-10 * local.q.norm()) << "seed " << seed;
    const VecX v_free = *inverse * problem.f, u_free = problem.H.transpose() * v_free + problem.w;
    const VecX moves = problem.H.cwiseAbs().transpose() * v_free.cwiseAbs();
    double fastest = 0;
    for (int c = 0; c < 40; ++c)
      if (u_free[3 * c] <= 2 * moves[3 * c]) fastest = std::max(fastest, u_free.segment<3>(3 * c).norm());
    for (int c = 0; c < 40; ++c) left_out += u_free[3 * c] > 2 * std::max(moves[3 * c], fastest);
  }
  EXPECT_GT(left_out, 50);
}

TEST(Solve, SaysWhenABlockThatOpensIsNotFinite) {
  for (const int row : {0, 1}) {
    FrictionProblem problem = cube_stack(1, 1.0, 0.5);
    problem.w[0] = 100;
    problem.w[row] = kInf;
    const std::optional<MassInverse> inverse = invert_mass(problem.M);
    const VecX v_free = *inverse * problem.f;
    const FrictionSolution s = solve(problem, {*inverse, v_free}, VecX());
    EXPECT_EQ(s.report.status, SolveStatus::not_finite) << "row " << row;
  }
}

TEST(Solve, SolvesOneBodyOnManyContacts) {
  Random random(12);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 10000, 0.3);
  const FrictionSolution s = solve(problem, {});
  EXPECT_EQ(s.report.status, SolveStatus::converged);
  EXPECT_LT(physical_residual(s.u, s.r, problem.laws).worst_cone_violation, 1e-15);
}

TEST(Solve, EveryLocalSolverEndsAtTheSameResidual) {
  Random random(13);
  VecX u;
  const LocalProblem problem = planted_problem(random, 8, u);
  for (const LocalSolver local :
       {LocalSolver::enumerative, LocalSolver::alart_curnier, LocalSolver::projection, LocalSolver::hybrid}) {
    const FrictionSolution s =
        solve(problem, {}, {.method = Method::nsgs, .relaxation = 0.9, .local = local});
    EXPECT_EQ(s.report.status, SolveStatus::converged) << int(local);
    EXPECT_LT((s.u - u).norm(), 1e-5 * problem.q.norm()) << int(local);
  }
}

TEST(Solve, EndsAPainleveBlockAsStagnated) {
  Mat3 W;  // without solution: OneContact.SaysThatAPainleveBlockHasNoSolution
  W << 1, 3, 0, 3, 9, 0, 0, 0, 1;
  const LocalProblem problem{.W = MatX(W).sparseView(), .q = Vec3(-1, 4, 0), .laws = {coulomb(1)}};
  const FrictionSolution s = solve(problem, {});
  EXPECT_EQ(s.report.status, SolveStatus::stagnated);
  EXPECT_GE(s.report.iterations, 1000);
  EXPECT_LT(s.report.iterations, 5000);
  EXPECT_GT(s.report.local_failures, 0);
  EXPECT_NEAR(scaled_residual(problem, s.r), s.report.residual, 1e-12);
  EXPECT_LE(s.report.residual, scaled_residual(problem, VecX::Zero(3)));
}

// Walls all around a peg come nearer than it is thick. Three tries have 100, 300 and 400 solves.
TEST(Solve, GivesNewtonUpWhereThereIsNoSolution) {
  for (const auto& [seed, contacts] : {std::pair(14, 12), {15, 12}, {14, 40}, {15, 40}}) {
    Random random(seed);
    FrictionProblem problem = random_peg_in_hole(random, 1, contacts, 0.5);
    for (Eigen::Index k = 0; k < problem.w.size(); k += 3) problem.w[k] = -1;
    const FrictionSolution s = solve(problem, {});
    EXPECT_EQ(s.report.status, SolveStatus::stagnated) << seed << ", " << contacts;
    EXPECT_LT(s.report.newton_iterations, 1000) << seed << ", " << contacts;
  }
}

TEST(Solve, ReportsNumbersThatAreNotFinite) {
  Random random(14);
  const FrictionProblem good = random_peg_in_hole(random, 1, 6, 0.2);
  FrictionProblem bad = good;
  bad.f[1] = kNan;
  EXPECT_EQ(solve(bad, {}).report.status, SolveStatus::not_finite);
  EXPECT_EQ(solve(bad, {}).r, VecX::Zero(18));
  bad = good;
  bad.w[4] = kInf;
  EXPECT_EQ(solve(bad, {}).report.status, SolveStatus::not_finite);
  bad = good;
  bad.H.coeffRef(2, 3) = kNan;
  EXPECT_EQ(solve(bad, {}).report.status, SolveStatus::not_finite);
  bad = good;
  bad.M.coeffRef(0, 0) = kNan;
  EXPECT_EQ(solve(bad, {}).report.status, SolveStatus::not_finite);
  bad = good;
  bad.M.coeffRef(0, 0) = 0;
  EXPECT_EQ(solve(bad, {}).report.status, SolveStatus::not_finite);
  EXPECT_EQ(solve(good, VecX::Constant(18, kNan)).report.status, SolveStatus::not_finite);
  bad = good;
  bad.H *= 0;  // nothing that can move
  EXPECT_EQ(solve(bad, {}).report.status, SolveStatus::not_finite);
}

TEST(Solve, StopsAtTheLastSweepWithTheBestIterate) {
  Random random(15);
  const FrictionProblem problem = random_peg_in_hole(random, 1, 60, 0.2);
  const SolverOptions options{.method = Method::nsgs, .tolerance = 1e-14, .max_iterations = 7};
  const FrictionSolution s = solve(problem, {}, options);
  EXPECT_EQ(s.report.status, SolveStatus::max_iterations);
  EXPECT_EQ(s.report.iterations, 7);
  EXPECT_NEAR(scaled_residual(condense(problem), s.r), s.report.residual, 1e-9 * s.report.residual);
}

TEST(Solve, RefusesBadOptionsAtTheDoor) {
  const LocalProblem none;
  EXPECT_THROW(solve(none, {}, {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW(solve(none, {}, {.max_iterations = 0}), std::invalid_argument);
  EXPECT_THROW(solve(none, {}, {.relaxation = 2}), std::invalid_argument);
  EXPECT_THROW(solve(none, {}, {.anderson = 21}), std::invalid_argument);
  EXPECT_THROW(solve(none, {}, {.anderson = -1}), std::invalid_argument);
  EXPECT_THROW(solve(none, VecX::Zero(3)), std::invalid_argument);
  EXPECT_STREQ(to_string(SolveStatus::stagnated), "stagnated");
}

}  // namespace
}  // namespace aussois
