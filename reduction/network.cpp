// SPDX-License-Identifier: Apache-2.0
#include "reduction/network.hpp"

#include <cmath>
#include <string>

#include "geometry/check.hpp"

namespace aussois {

void validate(const Network& network) {
  const auto has_size = [](const char* field, Eigen::Index size, Eigen::Index wanted) {
    require(size == wanted, std::string(field) + " has " + std::to_string(size) + " entries and must have " +
                                std::to_string(wanted));
  };
  require(network.inputs() > 0 && network.hidden() > 0 && network.outputs() > 0,
          "Network: inputs, hidden and outputs must be positive");
  has_size("Network::mean", network.mean.size(), network.inputs());
  has_size("Network::scale", network.scale.size(), network.inputs());
  has_size("Network::b1", network.b1.size(), network.hidden());
  has_size("Network::W2", network.W2.size(), network.outputs() * network.hidden());
  has_size("Network::b2", network.b2.size(), network.outputs());
  require(network.mean.allFinite() && network.scale.allFinite() && network.W1.allFinite() &&
              network.b1.allFinite() && network.W2.allFinite() && network.b2.allFinite(),
          "Network: every number must be finite");
  require_field(network.scale.minCoeff() > 0, "Network::scale", network.scale.minCoeff(), "be positive");
}

VecX network_output(const Network& network, const VecX& x) {
  require(x.size() == network.inputs(), "network_output: x has " + std::to_string(x.size()) +
                                            " entries and must have " + std::to_string(network.inputs()));
  const VecX scaled = (x - network.mean).cwiseQuotient(network.scale);
  const VecX hidden = (network.W1 * scaled + network.b1).array().tanh();
  const VecX score = network.W2 * hidden + network.b2;
  const VecX e = (score.array() - score.maxCoeff()).exp();
  return e / e.sum();
}

}  // namespace aussois
