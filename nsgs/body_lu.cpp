// SPDX-License-Identifier: Apache-2.0
#include "nsgs/body_lu.hpp"

#include <algorithm>

#include <Eigen/LU>

#include "nsgs/sparse_lu.hpp"

namespace aussois {

namespace {

constexpr double kProduct = kBodyRows * kBodyRows * kBodyRows;

}  // namespace

BodyLu::BodyLu(std::vector<int> body, const std::vector<std::pair<int, int>>& couplings)
    : body_(std::move(body)) {
  const std::size_t count = body_.empty() ? 0 : std::size_t(body_.back()) + 1;
  size_.resize(count);
  for (const int b : body_) place_.push_back(size_[std::size_t(b)]++);

  std::vector<std::vector<int>> graph(count);
  for (std::size_t b = 0; b < count; ++b) graph[b].push_back(int(b));
  for (const auto& [a, b] : couplings)
    if (a != b) graph[std::size_t(a)].push_back(b), graph[std::size_t(b)].push_back(a);
  std::vector<int> begin{0}, other;
  for (std::vector<int>& neighbours : graph) {
    std::ranges::sort(neighbours);
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    other.insert(other.end(), neighbours.begin(), neighbours.end());
    begin.push_back(int(other.size()));
  }
  const std::vector<int> order = fill_reducing_order(begin, other);
  node_of_.resize(count);
  for (std::size_t k = 0; k < count; ++k) node_of_[std::size_t(order[k])] = int(k);

  // What is eliminated couples all that it was coupled with; the first of them hands that on.
  std::vector<std::vector<int>> later(count);
  for (std::size_t k = 0; k < count; ++k)
    for (const int b : graph[std::size_t(order[k])])
      if (const int node = node_of_[std::size_t(b)]; node > int(k)) later[k].push_back(node);
  below_.resize(count);
  block_count_ = int(count);
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<int>& nodes = later[k];
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (const int node : nodes) {
      below_[k].push_back({.node = node, .column = block_count_, .row = block_count_ + 1});
      block_count_ += 2;
    }
    if (nodes.size() > 1) {
      std::vector<int>& heir = later[std::size_t(nodes.front())];
      heir.insert(heir.end(), nodes.begin() + 1, nodes.end());
    }
    const double n = double(nodes.size());
    cost_ += kProduct * (1 + n + n * n);
  }
}

int BodyLu::block_between(int a, int b) const {
  if (a == b) return a;
  const std::vector<Below>& below = below_[std::size_t(std::min(a, b))];
  const auto found = std::ranges::lower_bound(below, std::max(a, b), {}, &Below::node);
  return a > b ? found->column : found->row;
}

int BodyLu::block(int a, int b) const {
  return block_between(node_of_[std::size_t(a)], node_of_[std::size_t(b)]);
}

std::vector<Mat6> BodyLu::zero() const {
  std::vector<Mat6> out(std::size_t(block_count_), Mat6::Zero());
  for (std::size_t b = 0; b < size_.size(); ++b)
    for (int i = size_[b]; i < kBodyRows; ++i) out[std::size_t(node_of_[b])](i, i) = 1;
  return out;
}

bool BodyLu::factorise(std::vector<Mat6> blocks) {
  blocks_ = std::move(blocks);
  inverse_.resize(below_.size());
  for (std::size_t k = 0; k < below_.size(); ++k) {
    const Eigen::PartialPivLU<Mat6> pivot(blocks_[k]);
    const auto diagonal = pivot.matrixLU().diagonal().array();
    if (!((diagonal.abs() > 0).all() && diagonal.isFinite().all())) return false;
    inverse_[k] = pivot.inverse();
    for (const Below& j : below_[k]) {
      Mat6& row = blocks_[std::size_t(j.row)];
      row = (inverse_[k] * row).eval();
      for (const Below& i : below_[k])
        blocks_[std::size_t(block_between(i.node, j.node))].noalias() -= blocks_[std::size_t(i.column)] * row;
    }
  }
  return true;
}

VecX BodyLu::solve(const VecX& b) const {
  std::vector<Vec6> x(below_.size(), Vec6::Zero());
  for (std::size_t i = 0; i < body_.size(); ++i)
    x[std::size_t(node_of_[std::size_t(body_[i])])][place_[i]] = b[Eigen::Index(i)];
  for (std::size_t k = 0; k < x.size(); ++k) {
    x[k] = (inverse_[k] * x[k]).eval();
    for (const Below& i : below_[k])
      x[std::size_t(i.node)].noalias() -= blocks_[std::size_t(i.column)] * x[k];
  }
  for (std::size_t k = x.size(); k-- > 0;)
    for (const Below& j : below_[k]) x[k].noalias() -= blocks_[std::size_t(j.row)] * x[std::size_t(j.node)];
  VecX out(b.size());
  for (std::size_t i = 0; i < body_.size(); ++i)
    out[Eigen::Index(i)] = x[std::size_t(node_of_[std::size_t(body_[i])])][place_[i]];
  return out;
}

}  // namespace aussois
