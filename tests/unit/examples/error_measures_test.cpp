// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/convergence/error_measures.hpp"

#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "tests/support/random.hpp"

namespace aussois {
namespace {

MotionSample scalar(double q, double v) {
  return {.q = VecX::Constant(1, q), .v = VecX::Constant(1, v)};
}

Graph graph(std::initializer_list<std::pair<double, double>> points) {
  Graph g(2, Eigen::Index(points.size()));
  Eigen::Index i = 0;
  for (const auto& [t, v] : points) g.col(i++) << t, v;
  return g;
}

// Speed 1 up to t = 1, then -1.
ExactMotion reversal() {
  return {.pieces = {{0, [](double t) { return scalar(t, 1); }},
                     {1, [](double t) { return scalar(2 - t, -1); }}}};
}

ComputedMotion sampled(const ExactMotion& exact, double delay, double t_end, double h) {
  ComputedMotion out;
  for (int k = 0; k * h < t_end + h / 2; ++k) {
    out.t.push_back(k * h);
    out.node.push_back(evaluate(exact, std::max(0.0, k * h - delay)));
  }
  return out;
}

TEST(ErrorMeasures, OfAReversalThatComesLateAreItsDelayTimesTheJump) {
  // Nodes every 1/8; the reversal is seen first at t = 1.25 instead of 1.
  const Errors errors = errors_of(sampled(reversal(), 0.25, 2, 0.125), reversal());
  EXPECT_NEAR(errors[v_l1], 0.25 * 2, 1e-12);          // speeds differ by 2 during 1/4 s
  EXPECT_NEAR(errors[v_nodes], 2 * 0.125 * 2, 1e-12);  // at the nodes 1 and 1.125
  EXPECT_NEAR(errors[q_max], 0.25, 1e-12);             // of a path that is 1/4 s late
  // The corner (1, -1) is that far from the line from (1.125, 1) to (1.25, -1).
  EXPECT_NEAR(errors[v_graph], 0.25 / std::hypot(1, 0.125 / 2), 1e-3 * 0.25);
}

// The exact jump need not be a node: an integral over the pieces has no sampling error at all.
TEST(ErrorMeasures, OfAConstantVelocityDoNotDependOnWhereTheJumpLiesInItsStep) {
  for (const double begin : {0.5, 0.5001, 0.51, 0.58}) {
    const ExactMotion exact = {.pieces = {{0, [](double t) { return scalar(t, 1); }},
                                          {begin, [](double t) { return scalar(t, -1); }}}};
    ComputedMotion computed;
    for (int k = 0; k <= 10; ++k) computed.t.push_back(0.1 * k), computed.node.push_back(scalar(0.1 * k, 1));
    EXPECT_NEAR(errors_of(computed, exact)[v_l1], 2 * (1 - begin), 1e-13);
  }
}

// v = -g t sampled at the nodes is exact there, but as a step function off by g h / 2 on the mean: the
// order-one bias that (CONV-2) has for every scheme, and (CONV-3), (CONV-4) have not.
TEST(ErrorMeasures, OfAnExactFallAreTheBiasOfStepFunctionsAlone) {
  const ExactMotion fall = {.pieces = {{0, [](double t) { return scalar(-9.81 * t * t / 2, -9.81 * t); }}}};
  for (const double h : {0.1, 0.05, 0.01}) {
    const Errors errors = errors_of(sampled(fall, 0, 1, h), fall);
    EXPECT_NEAR(errors[v_l1], 9.81 * h / 2, 1e-12);
    EXPECT_LT(errors[q_max], 1e-15);
    EXPECT_LT(errors[v_nodes], 1e-15);
    EXPECT_LT(errors[v_graph], 1e-14);
  }
}

TEST(GraphDistance, IsTheHausdorffDistanceOfTwoCurves) {
  const Graph step = graph({{0, 0}, {1, 0}, {1, 2}, {2, 2}});
  EXPECT_EQ(graph_distance(step, step), 0);
  EXPECT_NEAR(graph_distance(step, graph({{0, 0}, {1.1, 0}, {1.1, 2}, {2, 2}})), 0.1, 1e-4);
  // A ramp instead of the jump: the corners (1, 0) and (1, 2) are sqrt(2)/4 away from the line of slope
  // ... 4.
  EXPECT_NEAR(graph_distance(step, graph({{0, 0}, {0.75, 0}, {1.25, 2}, {2, 2}})),
              0.25 / std::sqrt(1 + 1.0 / 16), 3e-4);
  // One spike of height 3 between nodes of the other: both directions count.
  const Graph flat = graph({{0, 0}, {10, 0}}), spike = graph({{0, 0}, {5, 0}, {5, 3}, {5, 0}, {10, 0}});
  EXPECT_NEAR(graph_distance(flat, spike), 3, 3e-3);
  EXPECT_NEAR(graph_distance(spike, flat), 3, 3e-3);
}

// The largest distance lies inside a segment: the middle of a long chord is far from a roof below it.
TEST(GraphDistance, SeesTheMiddleOfASegment) {
  EXPECT_NEAR(graph_distance(graph({{0, 0}, {2, 0}}), graph({{0, 0}, {1, 0.5}, {2, 0}})), 0.5, 5e-4);
  const Graph valley = graph({{0, 0}, {0, -1}, {2, -1}, {2, 0}}), chord = graph({{0, 0}, {2, 0}});
  EXPECT_NEAR(graph_distance(chord, valley), 1, 1e-3);
}

// Dense points on both, every pair: slow and plain.
double brute_force(const Graph& a, const Graph& b, double spacing) {
  const auto dense = [&](const Graph& g) {
    std::vector<VecX> points;
    for (Eigen::Index i = 0; i + 1 < g.cols(); ++i) {
      const int n = std::max(1, int((g.col(i + 1) - g.col(i)).norm() / spacing));
      for (int k = 0; k <= n; ++k) points.emplace_back(g.col(i) + double(k) / n * (g.col(i + 1) - g.col(i)));
    }
    return points;
  };
  const auto directed = [](const std::vector<VecX>& from, const std::vector<VecX>& to) {
    double farthest = 0;
    for (const VecX& x : from) {
      double nearest = kInf;
      for (const VecX& y : to) nearest = std::min(nearest, (x - y).norm());
      farthest = std::max(farthest, nearest);
    }
    return farthest;
  };
  const std::vector<VecX> p = dense(a), q = dense(b);
  return std::max(directed(p, q), directed(q, p));
}

TEST(GraphDistance, IsThatOfAllPairsOfPoints) {
  constexpr int kSeed = 20261121;
  std::cout << "seed " << kSeed << "\n";
  Random random(kSeed);
  for (int run = 0; run < 12; ++run) {
    const auto curve = [&](int points) {  // in one or two velocities, with jumps
      Graph g(2 + run % 2, points);
      double t = 0;
      for (int i = 0; i < points; ++i) {
        g(0, i) = t;
        for (Eigen::Index r = 1; r < g.rows(); ++r) g(r, i) = random.uniform(-1, 1) / (1 + run % 5);
        if (random.uniform(0, 1) > 0.3) t += random.uniform(0, 0.3);
      }
      return g;
    };
    const Graph a = curve(12), b = curve(20);
    const double slow = brute_force(a, b, 2e-3);
    EXPECT_NEAR(graph_distance(a, b), slow, 1e-3 * slow + 4e-3) << "run " << run;
    EXPECT_NEAR(graph_distance(b, a), slow, 1e-3 * slow + 4e-3) << "run " << run;
  }
}

TEST(ExactMotion, IsRightContinuousAtAJump) {
  EXPECT_EQ(evaluate(reversal(), 1).v[0], -1);
  EXPECT_EQ(evaluate(reversal(), std::nextafter(1.0, 0.0)).v[0], 1);
  EXPECT_EQ(evaluate(reversal(), 0).v[0], 1);
}

TEST(FirstRoot, IsTheFirstChangeOfSign) {
  EXPECT_NEAR(first_root([](double t) { return std::sin(t); }, 0.1, 10, 0.01), kPi, 1e-14);
  EXPECT_EQ(first_root([](double t) { return 2 + std::sin(t); }, 0, 10, 0.01), kInf);
  EXPECT_THROW(root([](double) { return 1.0; }, 0, 1), std::invalid_argument);
}

TEST(OdeSolution, OfAnOscillatorIsItsCosine) {
  const auto y =
      ode_solution([](double, const VecX& at) -> VecX { return Vec2(at[1], -at[0]); }, Vec2(1, 0), 20, 0.05);
  for (double t = 0; t <= 20; t += 0.0313) {
    EXPECT_NEAR(y(t)[0], std::cos(t), 1e-13);
    EXPECT_NEAR(y(t)[1], -std::sin(t), 1e-13);
  }
}

}  // namespace
}  // namespace aussois
