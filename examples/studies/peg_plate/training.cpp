// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/training.hpp"

#include <cmath>
#include <lbfgs.h>
#include <memory>
#include <new>

#include "examples/common/random.hpp"
#include "geometry/check.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

constexpr int kMemory = 10;      // of L-BFGS
constexpr double kStill = 1e-9;  // gradient over weights: nothing is left to learn

// What L-BFGS hands back and forth.
struct Objective {
  Network network{};  // sizes and scaling
  MatX X{};           // scaled
  const MatX* Y = nullptr;
  double decay = 0;
  const std::function<bool(int, double)>* progress = nullptr;
  int iterations = 0;
};

MatX scaled(const Network& network, const MatX& X) {
  return (X.colwise() - network.mean).array().colwise() / network.scale.array();
}

Loss loss_of(const Network& network, const MatX& scaled_X, const MatX& Y, double decay) {
  const double n = double(Y.cols());
  const MatX hidden = ((network.W1 * scaled_X).colwise() + network.b1).array().tanh();
  MatX score = (network.W2 * hidden).colwise() + network.b2;
  score.rowwise() -= score.colwise().maxCoeff().eval();
  const MatX e = score.array().exp();
  const Eigen::RowVectorXd sum = e.colwise().sum();
  const Eigen::RowVectorXd log_sum = sum.array().log();

  const VecX weights = weights_of(network);
  Loss out{.value = -(Y.array() * (score.rowwise() - log_sum).array()).sum() / n +
                    decay / 2 * weights.squaredNorm()};
  const MatX d_score = (e.array().rowwise() / sum.array() - Y.array()) / n;
  const MatX d_hidden = (network.W2.transpose() * d_score).array() * (1 - hidden.array().square());
  Network gradient;
  gradient.W1 = d_hidden * scaled_X.transpose();
  gradient.b1 = d_hidden.rowwise().sum();
  gradient.W2 = d_score * hidden.transpose();
  gradient.b2 = d_score.rowwise().sum();
  out.gradient = weights_of(gradient) + decay * weights;
  return out;
}

lbfgsfloatval_t evaluate_objective(void* instance, const lbfgsfloatval_t* x, lbfgsfloatval_t* gradient, int n,
                                   lbfgsfloatval_t) {
  const Objective& objective = *static_cast<const Objective*>(instance);
  // a copy: the library's memory may be aligned otherwise from run to run, and sums with it
  VecX weights(n);
  std::copy(x, x + n, weights.data());
  const Loss loss =
      loss_of(with_weights(objective.network, weights), objective.X, *objective.Y, objective.decay);
  std::copy(loss.gradient.begin(), loss.gradient.end(), gradient);
  return loss.value;
}

int after_iteration(void* instance, const lbfgsfloatval_t*, const lbfgsfloatval_t*, lbfgsfloatval_t value,
                    lbfgsfloatval_t, lbfgsfloatval_t, lbfgsfloatval_t, int, int k, int) {
  Objective& objective = *static_cast<Objective*>(instance);
  objective.iterations = k;
  return *objective.progress && !(*objective.progress)(k, value) ? 1 : 0;
}

}  // namespace

Network first_network(const MatX& X, int outputs, const TrainingOptions& options) {
  Random random(options.seed);
  const auto normal = [&](Eigen::Index rows, Eigen::Index columns) {
    MatX out(rows, columns);
    for (double& weight : out.reshaped()) weight = random.normal() / std::sqrt(double(columns));
    return out;
  };
  Network network;
  network.mean = X.rowwise().mean();
  network.scale = ((X.colwise() - network.mean).rowwise().squaredNorm() / double(X.cols())).cwiseSqrt();
  for (Eigen::Index i = 0; i < X.rows(); ++i)
    if (!(network.scale[i] > 1e-12 * (1 + std::abs(network.mean[i])))) network.scale[i] = 1;
  network.W1 = normal(options.hidden, X.rows());
  network.b1 = VecX::Zero(options.hidden);
  network.W2 = normal(outputs, options.hidden);
  network.b2 = VecX::Zero(outputs);
  return network;
}

VecX weights_of(const Network& n) {
  VecX out(n.W1.size() + n.b1.size() + n.W2.size() + n.b2.size());
  out << n.W1.reshaped(), n.b1, n.W2.reshaped(), n.b2;
  return out;
}

Network with_weights(Network n, const VecX& weights) {
  Eigen::Index next = 0;
  const auto take = [&](auto& part) {
    part.reshaped() = weights.segment(next, part.size());
    next += part.size();
  };
  take(n.W1);
  take(n.b1);
  take(n.W2);
  take(n.b2);
  return n;
}

Loss training_loss(const Network& network, const MatX& X, const MatX& Y, double decay) {
  return loss_of(network, scaled(network, X), Y, decay);
}

void describe(SettingVisitor& visit, TrainingOptions& o) {
  visit.begin("TrainingOptions");
  visit.count({"hidden", "number of units of the hidden layer", "", {1, 10000}, "--hidden"}, o.hidden);
  visit.count({"iterations", "maximum number of L-BFGS iterations", "", {1, 1e6}, "--iterations"},
              o.iterations);
  visit.number({"decay", "weight decay", "-", not_negative_range()}, o.decay);
  visit.seed({"seed", "seed of the first weights"}, o.seed);
}

Training train(const MatX& X, const MatX& Y, const TrainingOptions& options,
               const std::function<bool(int, double)>& progress) {
  check_ranges(options);
  require(X.cols() == Y.cols() && X.cols() > 0, "train: X has " + std::to_string(X.cols()) +
                                                    " samples and Y " + std::to_string(Y.cols()) +
                                                    ", they must have the same number, at least one");
  Objective objective{.network = first_network(X, int(Y.rows()), options),
                      .Y = &Y,
                      .decay = options.decay,
                      .progress = &progress};
  objective.X = scaled(objective.network, X);
  const VecX start = weights_of(objective.network);

  const auto release = [](lbfgsfloatval_t* x) { lbfgs_free(x); };
  const std::unique_ptr<lbfgsfloatval_t[], decltype(release)> x(lbfgs_malloc(int(start.size())), release);
  if (!x) throw std::bad_alloc();
  std::copy(start.begin(), start.end(), x.get());
  lbfgs_parameter_t parameter;
  lbfgs_parameter_init(&parameter);
  parameter.m = kMemory;
  parameter.max_iterations = options.iterations;
  parameter.epsilon = kStill;
  double value = 0;
  const int status =
      lbfgs(int(start.size()), x.get(), &value, evaluate_objective, after_iteration, &objective, &parameter);
  VecX best(start.size());
  std::copy(x.get(), x.get() + start.size(), best.data());
  return {.network = with_weights(objective.network, best),
          .loss = value,
          .iterations = objective.iterations,
          .converged = status == LBFGS_SUCCESS || status == LBFGS_ALREADY_MINIMIZED};
}

}  // namespace aussois
