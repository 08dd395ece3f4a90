// SPDX-License-Identifier: Apache-2.0
// Every method on every kind of problem, in both forms, to what it can reach.
#include <cmath>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"
#include "tests/unit/nsgs/planted_problem.hpp"
#include "tests/unit/nsgs/random_problems.hpp"

namespace aussois {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Tried {
  Method method;
  double tolerance;    // on problems of full rank
  double hyperstatic;  // on those whose contacts outnumber the velocities
  int max_iterations = 20000;
  int anderson = 0;
};
std::ostream& operator<<(std::ostream& out, const Tried& tried) {
  return out << to_string(tried.method) << " with a memory of " << tried.anderson;
}

const Tried kTried[] = {
    {Method::automatic, 1e-12, 1e-10},         {Method::nsgs, 1e-12, 1e-6},
    {Method::nsgs, 1e-12, 1e-6, 20000, 5},     {Method::sor_prox, 1e-12, 1e-6},
    {Method::sor_prox, 1e-12, 1e-6, 20000, 5}, {Method::jor_prox, 1e-12, 1e-5},
    {Method::jor_prox, 1e-12, 1e-5, 20000, 5}, {Method::coulomb_pgs, 1e-12, 1e-6},
    {Method::proximal_newton, 1e-12, 1e-10},   {Method::admm, 1e-12, 1e-6},
    {Method::admm, 1e-12, 1e-6, 20000, 5},     {Method::projected_gradient, 1e-11, 1e-6},
    {Method::interior_point, 1e-12, 1e-8},     {Method::coloured_nsgs, 1e-12, 1e-6},
};

SolverOptions options_of(const Tried& tried, double tolerance) {
  return {.method = tried.method,
          .tolerance = tolerance,
          .max_iterations = tried.max_iterations,
          .anderson = tried.anderson};
}

std::string name_of(const ::testing::TestParamInfo<Tried>& info) {
  return to_string(info.param.method) + std::string(info.param.anderson > 0 ? "_anderson" : "");
}

class AllMethods : public ::testing::TestWithParam<Tried> {
 protected:
  // Solves both forms; the judge outside of all solvers confirms what they report.
  FrictionSolution solved(const FrictionProblem& problem, double tolerance, const std::string& what) {
    const SolverOptions options = options_of(GetParam(), tolerance);
    const LocalProblem local = condense(problem);
    FrictionSolution both[] = {solve(problem, {}, options), solve(local, {}, options)};
    for (const FrictionSolution& s : both) {
      EXPECT_EQ(s.report.status, SolveStatus::converged)
          << what << ": " << to_string(s.report.status) << " at " << s.report.residual << " after "
          << s.report.iterations;
      EXPECT_LE(scaled_residual(local, s.r), 1.01 * tolerance + 1e-14) << what;
    }
    return both[0];
  }
};

TEST_P(AllMethods, FindThePlantedVelocitiesOfEveryLaw) {
  const std::vector<std::pair<std::string, std::function<Law(Random&)>>> kinds = {
      {"coulomb", [](Random& random) { return coulomb(random.uniform(0, 0.4)); }},
      {"planar", [](Random& random) { return coulomb_2d(random.uniform(0, 0.4)); }},
      {"rolling",
       [](Random& random) {
         const double mu = random.uniform(0.1, 0.4);
         return rolling(mu, random.uniform(0.01, 0.1));
       }},
      {"contensou",
       [](Random& random) {
         const double mu = random.uniform(0.1, 0.4);
         return contensou(mu, random.uniform(0.2, 1));
       }},
      {"unilateral", [](Random&) { return unilateral(); }},
      {"bilateral", [](Random& random) { return bilateral(1 + random.index(3)); }},
      {"dry friction", [](Random& random) { return dry_friction(random.uniform(0.05, 0.5)); }}};
  for (const auto& [name, law] : kinds)
    for (unsigned seed = 0; seed < 8; ++seed) {
      Random random(seed);
      std::vector<Law> laws;
      for (int c = 0; c < 1 + int(seed) % 4; ++c) laws.push_back(law(random));
      const Planted made = planted(random, laws, 36);
      const FrictionSolution s =
          solved(made.problem, GetParam().tolerance, name + " of seed " + std::to_string(seed));
      EXPECT_LT((s.u - made.u).norm(), 1e-6 * (1 + made.u.norm())) << name << " of seed " << seed;
    }
}

TEST_P(AllMethods, FindThePlantedVelocitiesOfMixedLaws) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    Random random(100 + seed);
    const Planted made = planted(random, random_laws(random, 7), 36, 0.05);
    const FrictionSolution s = solved(made.problem, GetParam().tolerance, "seed " + std::to_string(seed));
    EXPECT_LT((s.u - made.u).norm(), 1e-6 * (1 + made.u.norm())) << "seed " << seed;
  }
}

TEST_P(AllMethods, CarryAStackOfCubes) {
  const double weight = 2.0 * 9.81 * 1e-3, tolerance = GetParam().hyperstatic;
  const FrictionSolution s = solved(cube_stack(3, 2.0, 0.6), tolerance, "three cubes");
  for (int b = 0; b < 3; ++b) {  // four contacts under each cube: their sum is unique, their shares are not
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += s.r[12 * b + 3 * k];
    // the residual in scaled units, times a few for the condition of the stack
    EXPECT_NEAR(sum, (3 - b) * weight, 100 * tolerance * weight) << "cube " << b;
  }
}

TEST_P(AllMethods, HoldPegsInHoles) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    Random random(seed);
    const FrictionProblem problem = random_peg_in_hole(random, 1 + int(seed % 2), 8, 0.2);
    // Sweeps and splittings rest on a plateau at 4e-5 with one of them.
    const double tolerance = GetParam().hyperstatic > 1e-8 ? 1e-4 : GetParam().hyperstatic;
    solved(problem, tolerance, "seed " + std::to_string(seed));
  }
}

TEST_P(AllMethods, DoNotSeeUnits) {
  Random random(5);
  const Planted made = planted(random, {coulomb(0.3), coulomb(0.2), coulomb(0.1), unilateral()}, 18);
  FrictionProblem other = made.problem;  // masses times 2^20, lengths times 2^-10: about 1e6 and 1e-3
  const double mass = 0x1p20, length = 0x1p-10;
  other.M *= mass;
  other.f *= mass * length;
  other.w *= length;
  const SolverOptions options = options_of(GetParam(), 1e-6);
  const FrictionSolution a = solve(made.problem, {}, options), b = solve(other, {}, options);
  ASSERT_EQ(a.report.status, SolveStatus::converged);
  EXPECT_EQ(a.report.iterations, b.report.iterations);
  EXPECT_EQ(a.report.newton_iterations, b.report.newton_iterations);
  EXPECT_NEAR(a.report.residual, b.report.residual, 1e-3 * a.report.residual);
  EXPECT_LT((b.u - length * a.u).norm(), 1e-9 * b.u.norm());
}

TEST_P(AllMethods, SayWhenNumbersAreNotFinite) {
  for (const double bad : {kNan, kInf}) {
    for (const int field : {0, 1, 2, 3}) {
      FrictionProblem problem = cube_stack(1, 1.0, 0.5);
      if (field == 0) problem.f[2] = bad;
      if (field == 1) problem.w[0] = bad;
      if (field == 2) problem.M.coeffRef(0, 0) = bad;
      if (field == 3) problem.H.coeffRef(2, 0) = bad;
      const FrictionSolution s = solve(problem, {}, options_of(GetParam(), 1e-8));
      EXPECT_EQ(s.report.status, SolveStatus::not_finite) << "field " << field << " is " << bad;
      EXPECT_TRUE(s.r.isZero(0)) << "field " << field << " is " << bad;
    }
  }
}

TEST_P(AllMethods, HaveTheSameBitsForAnyNumberOfThreads) {
  const FrictionProblem problem = bead_chains({200, 40, 1, 3}, 0.3);
  const auto on_threads = [](int n, const std::function<void(int)>& f) {
    std::vector<std::thread> threads;
    for (int t = 0; t < 2; ++t)
      threads.emplace_back([&, t] {
        for (int i = t; i < n; i += 2) f(i);
      });
    for (std::thread& thread : threads) thread.join();
  };
  const auto backwards = [](int n, const std::function<void(int)>& f) {
    for (int i = n - 1; i >= 0; --i) f(i);
  };
  SolverOptions options = options_of(GetParam(), 1e-6);
  options.max_iterations = 300;
  const LocalProblem local = condense(problem);
  const FrictionSolution one = solve(problem, {}, options), one_local = solve(local, {}, options);
  for (const auto& for_all : {decltype(options.for_all)(on_threads), decltype(options.for_all)(backwards)}) {
    options.for_all = for_all;
    EXPECT_EQ(solve(problem, {}, options).r, one.r);
    EXPECT_EQ(solve(local, {}, options).r, one_local.r);
  }
}

TEST_P(AllMethods, NeedNoStepWhenTheyStartAtTheSolution) {
  Random random(8);
  const Planted made = planted(random, random_laws(random, 7), 36);
  const FrictionSolution s = solve(made.problem, made.r, options_of(GetParam(), 1e-10));
  EXPECT_EQ(s.report.status, SolveStatus::converged);
  EXPECT_EQ(s.report.iterations, 0);
}

TEST_P(AllMethods, NeedNothingWithoutContacts) {
  EXPECT_EQ(solve(LocalProblem{}, {}, options_of(GetParam(), 1e-8)).report.status, SolveStatus::converged);
}

TEST_P(AllMethods, GiveTheSameBitsTwice) {
  Random random(9);
  const Planted made = planted(random, random_laws(random, 14), 18);
  SolverOptions options = options_of(GetParam(), 1e-10);
  options.max_iterations = 30;
  EXPECT_EQ(solve(made.problem, {}, options).r, solve(made.problem, {}, options).r);
}

TEST_P(AllMethods, EndWhereThereIsNoSolution) {
  Mat3 W;  // OneContact.SaysThatAPainleveBlockHasNoSolution
  W << 1, 3, 0, 3, 9, 0, 0, 0, 1;
  const LocalProblem problem{.W = MatX(W).sparseView(), .q = Vec3(-1, 4, 0), .laws = {coulomb(1)}};
  SolverOptions options = options_of(GetParam(), 1e-8);
  options.max_iterations = 10000;
  const FrictionSolution s = solve(problem, {}, options);
  EXPECT_EQ(s.report.status, SolveStatus::stagnated) << to_string(s.report.status);
  EXPECT_TRUE(s.r.allFinite());
  EXPECT_NEAR(scaled_residual(problem, s.r), s.report.residual, 1e-12);
  EXPECT_LE(s.report.residual, scaled_residual(problem, VecX::Zero(3)));  // the best met
}

INSTANTIATE_TEST_SUITE_P(Methods, AllMethods, ::testing::ValuesIn(kTried), name_of);

// The table of SolverOptions is not only believed: what a method is said to read changes its iterates.
TEST(MethodFamilies, ReadTheOptionsThatTheyAreSaidToRead) {
  Random random(3);
  const FrictionProblem problem = planted(random, random_laws(random, 9), 24).problem;
  const auto impulses = [&](Method method, const auto& set) -> std::optional<VecX> {
    SolverOptions options{.method = method, .tolerance = 1e-14, .max_iterations = 40};
    set(options);
    try {
      return solve(problem, {}, options).r;
    } catch (const std::invalid_argument&) {
      return {};  // not read
    }
  };
  const std::pair<const char*, std::function<void(SolverOptions&)>> changes[] = {
      {"relaxation", [](SolverOptions& o) { o.relaxation = 0.7; }},
      {"local", [](SolverOptions& o) { o.local = LocalSolver::projection; }},
      {"prox", [](SolverOptions& o) { o.prox = ProxMetric::spectral; }},
      {"anderson", [](SolverOptions& o) { o.anderson = 3; }}};
  int read = 0;
  for (const Tried& tried : kTried) {
    if (tried.anderson > 0) continue;
    const VecX plain = *impulses(tried.method, [](SolverOptions&) {});
    for (const auto& [name, change] : changes)
      if (const std::optional<VecX> changed = impulses(tried.method, change)) {
        EXPECT_NE(*changed, plain) << name << " of " << to_string(tried.method);
        ++read;
      }
  }
  EXPECT_EQ(read, 6 + 3 + 2 + 6);
}

TEST(MethodFamilies, AgreeInTheVelocities) {
  int hyperstatic = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const Planted made = planted(random, random_laws(random, 7 + int(seed % 8)), 24);
    hyperstatic += made.problem.w.size() > 24;
    VecX u;
    for (const Method method : {Method::automatic, Method::interior_point, Method::admm}) {
      const FrictionSolution s = solve(made.problem, {},
                                       {.method = method,
                                        .tolerance = 1e-8,
                                        .max_iterations = 20000,
                                        .anderson = method == Method::admm ? 5 : 0});
      ASSERT_EQ(s.report.status, SolveStatus::converged)
          << to_string(method) << " of seed " << seed << " at " << s.report.residual;
      if (u.size() == 0) u = s.u;
      EXPECT_LT((s.u - u).norm(), 1e-5 * (1 + u.norm())) << to_string(method) << " of seed " << seed;
    }
  }
  EXPECT_GT(hyperstatic, 10);
}

}  // namespace
}  // namespace aussois
