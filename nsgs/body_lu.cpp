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

BodyLu::BodyLu(std::vector<int> body, const std::vector<std::pair<int, int>>& couplings)
    : body_(std::move(body)) {
  const std::size_t count = body_.empty() ? 0 : std::size_t(body_.back()) + 1;
  size_.resize(count);
  place_.reserve(body_.size());
  for (const int b : body_) place_.push_back(size_[b]++);

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
  node_of_.resize(count);
  for (std::size_t k = 0; k < count; ++k) node_of_[order[k]] = int(k);

  // What is eliminated couples all that it was coupled with; the first of them hands that on.
  std::vector<std::vector<int>> later(count);
  for (const auto& [a, b] : graph)
    if (const int node = node_of_[a], next = node_of_[b]; next > node) later[node].push_back(next);
  below_.reserve(graph.size());
  below_begin_.reserve(count + 1);
  below_begin_.push_back(0);
  block_count_ = int(count);
  for (std::vector<int>& nodes : later) {
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const int node : nodes) {
      below_.push_back({.node = node, .column = block_count_, .row = block_count_ + 1});
      block_count_ += 2;
    }
    below_begin_.push_back(below_.size());
    if (nodes.size() > 1) {
      std::vector<int>& heir = later[nodes.front()];
      heir.insert(heir.end(), nodes.begin() + 1, nodes.end());
    }
    const double n = double(nodes.size());
    cost_ += kProduct * (1 + n + n * n);
  }
}

std::span<const BodyLu::Below> BodyLu::below(std::size_t node) const {
  return std::span(below_).subspan(below_begin_[node], below_begin_[node + 1] - below_begin_[node]);
}

int BodyLu::block_between(int a, int b) const {
  if (a == b) return a;
  const auto found = std::ranges::lower_bound(below(std::min(a, b)), std::max(a, b), {}, &Below::node);
  return a > b ? found->column : found->row;
}

int BodyLu::block(int a, int b) const {
  return block_between(node_of_[a], node_of_[b]);
}

std::vector<Mat6> BodyLu::zero() const {
  std::vector<Mat6> out(std::size_t(block_count_), Mat6::Zero());
  for (std::size_t b = 0; b < size_.size(); ++b)
    for (int i = size_[b]; i < kBodyRows; ++i) out[node_of_[b]](i, i) = 1;
  return out;
}

bool BodyLu::factorise(std::vector<Mat6> blocks) {
  blocks_ = std::move(blocks);
  inverse_.resize(size_.size());
  for (std::size_t k = 0; k < inverse_.size(); ++k) {
    inverse_[k] = blocks_[k];
    if (!invert(inverse_[k])) return false;
    for (const Below& j : below(k)) {
      Mat6& row = blocks_[j.row];
      row = (inverse_[k] * row).eval();
      for (const Below& i : below(k))
        blocks_[block_between(i.node, j.node)].noalias() -= blocks_[i.column] * row;
    }
  }
  return true;
}

VecX BodyLu::solve(const VecX& b) const {
  std::vector<Vec6> x(size_.size(), Vec6::Zero());
  for (std::size_t i = 0; i < body_.size(); ++i) x[node_of_[body_[i]]][place_[i]] = b[Eigen::Index(i)];
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = (inverse_[k] * x[k]).eval();
    for (const Below& i : below(k)) x[i.node].noalias() -= blocks_[i.column] * x[k];
  }
  for (std::size_t k = x.size(); k-- > 0;)
    for (const Below& j : below(k)) x[k].noalias() -= blocks_[j.row] * x[j.node];
  VecX out(b.size());
  for (std::size_t i = 0; i < body_.size(); ++i) out[Eigen::Index(i)] = x[node_of_[body_[i]]][place_[i]];
  return out;
}

}  // namespace aussois
