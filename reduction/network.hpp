// SPDX-License-Identifier: Apache-2.0
// A small neural network as plain data, and its evaluation (NET-1): one hidden layer of tanh, softmax at the
// end. Its training is in examples/studies/peg_plate, its text file in io/network_file.hpp.
#pragma once

#include "geometry/types.hpp"

namespace aussois {

struct Network {
  VecX mean{}, scale{};  // of the inputs; scale > 0
  MatX W1{};             // hidden x inputs
  VecX b1{};             // hidden
  MatX W2{};             // outputs x hidden
  VecX b2{};             // outputs

  Eigen::Index inputs() const { return W1.cols(); }
  Eigen::Index hidden() const { return W1.rows(); }
  Eigen::Index outputs() const { return W2.rows(); }
};

/// Throws std::invalid_argument naming the field unless sizes fit, all numbers are finite and all scales are
/// positive.
void validate(const Network& network);

/// Probabilities of the outputs, which are positive and sum to one. Throws std::invalid_argument unless x has
/// as many entries as the network has inputs. A pure function.
VecX network_output(const Network& network, const VecX& x);

}  // namespace aussois
