// SPDX-License-Identifier: Apache-2.0
#include "nsgs/body_lu.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "nsgs/sparse_lu.hpp"

namespace aussois {

namespace {

constexpr double kProduct = kBodyRows * kBodyRows * kBodyRows;

// A^-1 in place by Gauss and Jordan's elimination, columns pivoted; false if a pivot vanishes or is not
// finite.
bool invert(Mat6& A) {
  std::array<int, kBodyRows> swapped{};
  for (int k = 0; k < kBodyRows; ++k) {
    int p = k;
    for (int j = k + 1; j < kBodyRows; ++j)
      if (std::abs(A(k, j)) > std::abs(A(k, p))) p = j;
    swapped[k] = p;
    if (p != k) A.col(k).swap(A.col(p));
    const double pivot = A(k, k);
    if (!(std::abs(pivot) > 0) || !std::isfinite(pivot)) return false;
    A(k, k) = 1;
    A.col(k) /= pivot;
    for (int j = 0; j < kBodyRows; ++j) {
      if (j == k) continue;
      const double factor = A(k, j);
      A(k, j) = 0;
      A.col(j) -= factor * A.col(k);
    }
  }
  for (int k = kBodyRows; k-- > 0;)
    if (const int p = swapped[k]; p != k) A.row(k).swap(A.row(p));
  return true;
}

}  // namespace

BodyLu::BodyLu(std::vector<int> body, const std::vector<std::pair<int, int>>& couplings) {
  auto made = std::make_shared<Graph>();
  Graph& g = *made;
  g.body = std::move(body);
  const std::size_t count = g.body.empty() ? 0 : std::size_t(g.body.back()) + 1;
  g.size.resize(count);
  g.place.reserve(g.body.size());
  for (const int b : g.body) g.place.push_back(g.size[b]++);

  std::vector<std::pair<int, int>> graph;  // both ways, and every body with itself
  graph.reserve(2 * couplings.size() + count);
  for (int b = 0; b < int(count); ++b) graph.emplace_back(b, b);
  for (const auto& [a, b] : couplings)
    if (a != b) graph.emplace_back(a, b), graph.emplace_back(b, a);
  std::ranges::sort(graph);
  graph.erase(std::unique(graph.begin(), graph.end()), graph.end());
  std::vector<int> begin(count + 1), other;
  other.reserve(graph.size());
  for (const auto& [a, b] : graph) {
    ++begin[std::size_t(a) + 1];
    other.push_back(b);
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  const std::vector<int> order = fill_reducing_order(begin, other);
  g.node_of.resize(count);
  for (std::size_t k = 0; k < count; ++k) g.node_of[order[k]] = int(k);

  // What is eliminated couples all that it was coupled with; the first of them hands that on.
  std::vector<std::vector<int>> later(count);
  for (const auto& [a, b] : graph)
    if (const int node = g.node_of[a], next = g.node_of[b]; next > node) later[node].push_back(next);
  g.below.reserve(graph.size());
  g.below_begin.reserve(count + 1);
  g.below_begin.push_back(0);
  g.block_count = int(count);
  for (std::vector<int>& nodes : later) {
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const int node : nodes) {
      g.below.push_back({.node = node, .column = g.block_count, .row = g.block_count + 1});
      g.block_count += 2;
    }
    g.below_begin.push_back(g.below.size());
    if (nodes.size() > 1) {
      std::vector<int>& heir = later[nodes.front()];
      heir.insert(heir.end(), nodes.begin() + 1, nodes.end());
    }
    const double n = double(nodes.size());
    g.cost += kProduct * (1 + n + n * n);
    nodes = {};
  }
  graph_ = std::move(made);
}

std::span<const BodyLu::Below> BodyLu::Graph::below_node(std::size_t node) const {
  return std::span(below).subspan(below_begin[node], below_begin[node + 1] - below_begin[node]);
}

int BodyLu::Graph::block_between(int a, int b) const {
  if (a == b) return a;
  const auto found = std::ranges::lower_bound(below_node(std::min(a, b)), std::max(a, b), {}, &Below::node);
  return a > b ? found->column : found->row;
}

int BodyLu::block(int a, int b) const {
  return graph_->block_between(graph_->node_of[a], graph_->node_of[b]);
}

std::vector<Mat6> BodyLu::zero() const {
  const Graph& g = *graph_;
  std::vector<Mat6> out(std::size_t(g.block_count), Mat6::Zero());
  for (std::size_t b = 0; b < g.size.size(); ++b)
    for (int i = g.size[b]; i < kBodyRows; ++i) out[g.node_of[b]](i, i) = 1;
  return out;
}

bool BodyLu::factorise(std::vector<Mat6> blocks) {
  const Graph& g = *graph_;
  blocks_ = std::move(blocks);
  inverse_.resize(g.size.size());
  for (std::size_t k = 0; k < inverse_.size(); ++k) {
    inverse_[k] = blocks_[k];
    if (!invert(inverse_[k])) return false;
    for (const Below& j : g.below_node(k)) {
      Mat6& row = blocks_[j.row];
      row = (inverse_[k] * row).eval();
      for (const Below& i : g.below_node(k))
        blocks_[g.block_between(i.node, j.node)].noalias() -= blocks_[i.column] * row;
    }
  }
  return true;
}

VecX BodyLu::solve(const VecX& b) const {
  const Graph& g = *graph_;
  std::vector<Vec6> x(g.size.size(), Vec6::Zero());
  for (std::size_t i = 0; i < g.body.size(); ++i) x[g.node_of[g.body[i]]][g.place[i]] = b[Eigen::Index(i)];
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = (inverse_[k] * x[k]).eval();
    for (const Below& i : g.below_node(k)) x[i.node].noalias() -= blocks_[i.column] * x[k];
  }
  for (std::size_t k = x.size(); k-- > 0;)
    for (const Below& j : g.below_node(k)) x[k].noalias() -= blocks_[j.row] * x[j.node];
  VecX out(b.size());
  for (std::size_t i = 0; i < g.body.size(); ++i) out[Eigen::Index(i)] = x[g.node_of[g.body[i]]][g.place[i]];
  return out;
}

}  // namespace aussois
