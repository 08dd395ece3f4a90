// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/training_check.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "examples/common/random.hpp"

namespace aussois {
namespace {

constexpr int kInputs = 24, kClasses = 17;
constexpr double kDecay = 1e-3;

// The largest error of a slope over the largest slope, of a network that is not trained.
double gradient_error(std::uint64_t seed) {
  constexpr int kDirections = 5;
  // Differences of fourth order: h^4 of truncation and 1e-16 / h of rounding are both below 1e-10.
  constexpr double h = 1e-5;
  const MatX X = formula_inputs(60), Y = formula_targets(X);
  const Network network = first_network(X, kClasses, {.seed = seed});
  const VecX weights = weights_of(network), gradient = training_loss(network, X, Y, kDecay).gradient;
  Random random(seed);
  double error = 0, largest = 0;
  for (int k = 0; k < kDirections; ++k) {
    VecX d(weights.size());
    for (double& x : d) x = random.uniform(-1, 1);
    const auto loss = [&](double s) {
      return training_loss(with_weights(network, weights + s * d), X, Y, kDecay).value;
    };
    const double slope = (8 * (loss(h) - loss(-h)) - (loss(2 * h) - loss(-2 * h))) / (12 * h);
    error = std::max(error, std::abs(gradient.dot(d) - slope));
    largest = std::max(largest, std::abs(slope));
  }
  return error / largest;
}

int weights_that_differ(std::uint64_t seed) {
  const MatX X = formula_inputs(80), Y = formula_targets(X);
  const TrainingOptions options{.iterations = 60, .seed = seed};
  const VecX a = weights_of(train(X, Y, options).network), b = weights_of(train(X, Y, options).network);
  int differ = 0;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    differ += std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i]);
  return differ;
}

}  // namespace

MatX formula_inputs(int count) {
  MatX X(kInputs, count);
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < kInputs; ++j)
      X(j, i) = std::sin(0.37 * (j + 1) * (i + 1) + 0.01 * (j + 1) * (j + 1) * (i + 1));
  return X;
}

MatX formula_targets(const MatX& X) {
  MatX Y = MatX::Zero(kClasses, X.cols());
  for (Eigen::Index i = 0; i < X.cols(); ++i) {
    const double x = std::tanh(1.5 * (X(0, i) + X(1, i) * X(2, i) - 0.5 * X(3, i)));
    Y(std::clamp(int(std::floor(kClasses * (0.5 + 0.5 * x))), 0, kClasses - 1), i) = 1;
  }
  return Y;
}

double TrainingCheck::loss_error() const {
  return std::abs(loss / kSciPyLoss - 1);
}

TrainingCheck check_training(std::uint64_t seed) {
  const MatX X = formula_inputs(500), Y = formula_targets(X);
  return {.seed = seed,
          .gradient = gradient_error(seed),
          .weights_that_differ = weights_that_differ(seed),
          .loss = train(X, Y, {.iterations = 500, .decay = kDecay, .seed = seed}).loss};
}

}  // namespace aussois
