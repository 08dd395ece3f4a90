// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/convergence/error_measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace aussois {
namespace {

constexpr int kSamples = 20;         // of each smooth piece of a step
constexpr double kPrecision = 1e-3;  // of a graph distance, relative
constexpr double kMostPoints = 1e5;  // of the exact graph
constexpr double kRounding = 1e-15;  // distances below are none
constexpr int kHalvings = 50;        // of a segment of a graph, at most

// Integral of |v_h - v| over a step, v_h constant: midpoints, of each smooth piece of v apart (CONV-2).
double l1_of_step(double begin, double end, const VecX& v_h, const ExactMotion& exact) {
  double sum = 0;
  for (std::size_t k = piece_at(exact, begin); begin < end; ++k) {
    const double until = k + 1 < exact.pieces.size() ? std::min(end, exact.pieces[k + 1].begin) : end;
    const double width = (until - begin) / kSamples;
    for (int i = 0; i < kSamples; ++i)
      sum += width * (exact.pieces[k].at(begin + (i + 0.5) * width).v - v_h).norm();
    begin = until;
  }
  return sum;
}

double distance_to_segment(const VecX& x, const Graph& g, Eigen::Index i) {
  const VecX along = g.col(i + 1) - g.col(i), from = x - g.col(i);
  const double length2 = along.squaredNorm();
  const double s = length2 > 0 ? std::clamp(from.dot(along) / length2, 0.0, 1.0) : 0;
  return (from - s * along).norm();
}

struct Nearest {
  double distance = kInf;
  Eigen::Index segment = 0;
};

// The nearest segment of the graph, looked for forwards and backwards from the time of x until time alone is
// farther; a distance of no more than `enough` need not be the smallest.
Nearest nearest_segment(const VecX& x, const Graph& g, double enough) {
  const Eigen::Index last = g.cols() - 2;
  const double* t = g.data();             // of column i: t[i * rows]
  Eigen::Index low = 0, high = last + 1;  // the first segment that ends at or after x[0] is in [low, high]
  while (low < high) {
    const Eigen::Index middle = (low + high) / 2;
    t[(middle + 1) * g.rows()] < x[0] ? low = middle + 1 : high = middle;
  }
  Nearest out;
  const auto look = [&](Eigen::Index i) {
    const double d = distance_to_segment(x, g, i);
    if (d < out.distance) out = {d, i};
  };
  Eigen::Index forward = std::min(low, last), backward = forward - 1;
  for (bool more = true; more && out.distance > enough;) {
    more = false;
    if (forward <= last && t[forward * g.rows()] - x[0] < out.distance) look(forward++), more = true;
    if (backward >= 0 && x[0] - t[(backward + 1) * g.rows()] < out.distance) look(backward--), more = true;
  }
  return out;
}

struct Piece {
  VecX a{}, b{};
  int halvings = 0;  // left
};

// The largest distance of a point of [a, b] from the graph, if it is more than `known`: halves are looked at
// while a bound of theirs is. Distance grows no faster than the point moves, and that from one segment is
// convex.
double farthest_of_segment(const VecX& a, const VecX& b, const Graph& g, double known) {
  std::vector<Piece> left{{a, b, kHalvings}};
  while (!left.empty()) {
    const Piece piece = std::move(left.back());
    left.pop_back();
    const VecX middle = (piece.a + piece.b) / 2;
    const double half = (piece.b - piece.a).norm() / 2;
    const auto bound = [&] { return known * (1 + kPrecision) + kRounding; };
    const Nearest nearest = nearest_segment(middle, g, bound() - half);
    if (nearest.distance + half <= bound()) continue;
    known = std::max(known, nearest.distance);
    const double convex = std::max(distance_to_segment(piece.a, g, nearest.segment),
                                   distance_to_segment(piece.b, g, nearest.segment));
    if (std::min(nearest.distance + half, convex) <= bound() || piece.halvings == 0) continue;
    left.push_back({middle, piece.b, piece.halvings - 1});
    left.push_back({piece.a, middle, piece.halvings - 1});
  }
  return known;
}

// sup over a of the distance to b.
double directed_distance(const Graph& a, const Graph& b) {
  double known = 0;
  for (Eigen::Index i = 0; i < a.cols(); ++i)
    known = std::max(known, nearest_segment(a.col(i), b, known).distance);
  for (Eigen::Index i = 0; i + 1 < a.cols(); ++i)
    known = farthest_of_segment(a.col(i), a.col(i + 1), b, known);
  return known;
}

Graph graph_from(const std::vector<double>& t, const std::vector<VecX>& v) {
  Graph g(1 + v.front().size(), Eigen::Index(t.size()));
  for (std::size_t i = 0; i < t.size(); ++i) g.col(Eigen::Index(i)) << t[i], v[i];
  return g;
}

}  // namespace

Graph graph_of(const ComputedMotion& computed) {
  std::vector<VecX> v;
  for (const MotionSample& node : computed.node) v.push_back(node.v);
  return graph_from(computed.t, v);
}

Graph graph_of(const ExactMotion& exact, double t_end, double spacing) {
  std::vector<double> t;
  std::vector<VecX> v;
  for (std::size_t k = 0; k < exact.pieces.size() && exact.pieces[k].begin <= t_end; ++k) {
    const MotionPiece& piece = exact.pieces[k];
    const double end = k + 1 < exact.pieces.size() ? std::min(t_end, exact.pieces[k + 1].begin) : t_end;
    const int points = std::max(1, int(std::ceil((end - piece.begin) / spacing)));
    for (int i = 0; i <= points; ++i) {
      t.push_back(i == points ? end : piece.begin + i * (end - piece.begin) / points);
      v.push_back(piece.at(t.back()).v);
    }
  }
  return graph_from(t, v);
}

double graph_distance(const Graph& a, const Graph& b) {
  return std::max(directed_distance(a, b), directed_distance(b, a));
}

Errors errors_of(const ComputedMotion& computed, const ExactMotion& exact) {
  Errors out{};
  const std::size_t last = computed.t.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const double t = computed.t[k];
    const MotionSample there = evaluate(exact, t);
    out[q_max] = std::max(out[q_max], (computed.node[k].q - there.q).norm());  // (CONV-1)
    if (k == 0) continue;
    const double h = t - computed.t[k - 1];
    out[v_l1] += l1_of_step(computed.t[k - 1], t, computed.node[k - 1].v, exact);  // (CONV-2)
    out[v_nodes] += h * (computed.node[k].v - there.v).norm();                     // (CONV-4)
  }
  const double t_end = computed.t[last], points = std::min(kMostPoints, kSamples * double(last));
  out[v_graph] = graph_distance(graph_of(computed), graph_of(exact, t_end, t_end / points));  // (CONV-3)
  return out;
}

}  // namespace aussois
