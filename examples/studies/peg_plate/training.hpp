// SPDX-License-Identifier: Apache-2.0
// Training of the small network: cross-entropy, its gradient, L-BFGS over all samples (PEG-13).
#pragma once

#include <cstdint>
#include <functional>

#include "reduction/network.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct TrainingOptions {
  int hidden = 40;         // units
  int iterations = 100;    // of L-BFGS; with more it learns the noise (doc/theory/peg_plate.md)
  double decay = 1e-5;     // on the squares of all weights and biases
  std::uint64_t seed = 1;  // of the first weights
};
void describe(SettingVisitor& visit, TrainingOptions& options);

/// Weights N(0, 1 / fan in), biases zero, scaling from the columns of X (inputs x samples): mean and standard
/// deviation, 1 where an input never changes.
Network first_network(const MatX& X, int outputs, const TrainingOptions& options);

/// [W1; b1; W2; b2], column by column, and back.
VecX weights_of(const Network& network);
Network with_weights(Network network, const VecX& weights);

/// Mean cross-entropy of the targets Y (outputs x samples) plus decay / 2 |weights|^2, and its gradient in
/// the order of weights_of (PEG-13).
struct Loss {
  double value = 0;
  VecX gradient{};
};
Loss training_loss(const Network& network, const MatX& X, const MatX& Y, double decay);

struct Training {
  Network network{};
  double loss = 0;
  int iterations = 0;
  bool converged = false;  // else the iterations were used up, or no step was smaller
};
/// The same bits for the same arguments on one machine. `progress` hears of every iteration; false ends.
Training train(const MatX& X, const MatX& Y, const TrainingOptions& options = {},
               const std::function<bool(int iteration, double loss)>& progress = {});

}  // namespace aussois
