// SPDX-License-Identifier: Apache-2.0
#include "examples/peg_plate/labels.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"

namespace aussois {

MatX choice_errors(const SolverView& view, PegScenario scenario, const std::vector<PegSample>& samples,
                   int threads, const std::function<void()>& progress) {
  const std::vector<std::vector<int>> choices = peg_choices(scenario);
  MatX errors(choices.size(), samples.size());
  parallel_for(int(samples.size()), threads, [&](int s) {
    const PegSample& sample = samples[std::size_t(s)];
    const std::vector<PegContact> all = peg_contacts(scenario, sample);
    const Vec3 measured = sample.plate_force;
    for (std::size_t c = 0; c < choices.size(); ++c) {
      const Vec3 force = plate_force(view, sample, picked(all, choices[c]));
      errors(Eigen::Index(c), s) = (force - measured).norm() / measured.norm();
    }
    if (progress) progress();
  });
  return errors;
}

std::vector<int> ranking(const MatX& errors) {
  const VecX mean_square = errors.rowwise().squaredNorm();
  std::vector<int> order(std::size_t(errors.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int c) { return mean_square[c]; });
  return order;
}

const char* to_string(LabelMode mode) {
  switch (mode) {
    case LabelMode::argmin:
      return "argmin";
    case LabelMode::soft:
      return "soft";
    case LabelMode::ranked:
      break;
  }
  return "ranked";
}

std::vector<int> chosen_labels(const MatX& errors, const LabelOptions& options) {
  std::vector<int> order(std::size_t(errors.rows()));
  std::iota(order.begin(), order.end(), 0);
  double delta = 0;
  if (options.mode == LabelMode::ranked) {
    order = ranking(errors);
    delta = options.delta;
  }
  std::vector<int> out;
  for (Eigen::Index s = 0; s < errors.cols(); ++s) {
    const double enough = errors.col(s).minCoeff() + delta;
    out.push_back(*std::ranges::find_if(order, [&](int c) { return errors(c, s) <= enough; }));
  }
  return out;
}

MatX targets(const MatX& errors, const std::vector<std::vector<int>>& choices, int outputs,
             const LabelOptions& options) {
  require_field(options.tau > 0, "LabelOptions::tau", options.tau, "be positive");
  require_field(options.delta >= 0, "LabelOptions::delta", options.delta, "be at least 0");
  MatX out = MatX::Zero(outputs, errors.cols());
  const auto add = [&](Eigen::Index s, std::size_t c, double weight) {
    for (const int i : choices[c]) out(i, s) += weight / double(choices[c].size());
  };
  if (options.mode != LabelMode::soft) {
    const std::vector<int> labels = chosen_labels(errors, options);
    for (std::size_t s = 0; s < labels.size(); ++s) add(Eigen::Index(s), std::size_t(labels[s]), 1);
    return out;
  }
  for (Eigen::Index s = 0; s < errors.cols(); ++s) {
    const VecX weight = (-(errors.col(s).array() - errors.col(s).minCoeff()) / options.tau).exp();
    for (std::size_t c = 0; c < choices.size(); ++c) add(s, c, weight[Eigen::Index(c)] / weight.sum());
  }
  return out;
}

}  // namespace aussois
