// SPDX-License-Identifier: Apache-2.0
// LU, block by block, of a matrix whose rows belong to bodies. Pivots are chosen within a body; bodies are
// eliminated in an order that causes little fill-in. For chains, stacks and stars of bodies the cost is
// linear in their length (PROX-9). Private to nsgs.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

inline constexpr int kBodyRows = 6;

class BodyLu {
 public:
  /// `body[i]` is the body of row i; bodies ascend without gaps and have at most kBodyRows rows each. Two
  /// bodies of a coupling share off-diagonal blocks.
  BodyLu(std::vector<int> body, const std::vector<std::pair<int, int>>& couplings);
  /// Of the same couplings, to be factorised with other numbers.
  BodyLu again() const { return BodyLu(graph_); }

  double cost() const { return graph_->cost; }  // approximate multiplications of a factorisation
  /// Index of the block of rows of body a and columns of body b, which must be coupled or the same.
  int block(int a, int b) const;
  const std::vector<int>& bodies() const { return graph_->body; }  // the body of every row
  int place(int row) const { return graph_->place[row]; }          // place of the row within its body
  int body(int row) const { return graph_->body[row]; }

  /// Blocks to fill in before factorise(). They are zero, but ones on the diagonal pad a body with fewer
  /// rows.
  std::vector<Mat6> zero() const;
  /// False if a body's pivot vanishes or anything is not finite.
  bool factorise(std::vector<Mat6> blocks);
  VecX solve(const VecX& b) const;

 private:
  struct Below {
    int node = 0, column = 0, row = 0;  // a node eliminated later; blocks (node, this), (this, node)
  };
  struct Graph {
    std::vector<int> body{}, place{}, node_of{}, size{};
    std::vector<Below> below{};  // node by node, in the order of elimination
    std::vector<std::size_t> below_begin{};
    int block_count = 0;
    double cost = 0;

    std::span<const Below> below_node(std::size_t node) const;
    int block_between(int a, int b) const;  // of nodes
  };
  explicit BodyLu(std::shared_ptr<const Graph> graph) : graph_(std::move(graph)) {}

  std::shared_ptr<const Graph> graph_{};
  std::vector<Mat6> blocks_{};
  std::vector<Mat6> inverse_{};  // of the pivots
};

}  // namespace aussois
