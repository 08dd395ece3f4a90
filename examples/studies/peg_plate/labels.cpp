// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/labels.hpp"

#include <algorithm>
#include <tuple>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

using Serves = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace

MatX choice_errors(const SolverView& view, PegScenario scenario, const std::vector<PegSample>& samples,
                   int threads, const std::function<void()>& progress) {
  const std::vector<std::vector<int>> choices = peg_choices(scenario);
  MatX errors(choices.size(), samples.size());
  parallel_for(int(samples.size()), threads, [&](int s) {
    const PegSample& sample = samples[s];
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

std::vector<int> ranking(const MatX& errors, double delta) {
  const VecX mean_square = errors.rowwise().squaredNorm();
  Serves left = (errors.rowwise() - errors.colwise().minCoeff()).array() <= delta;
  std::vector<int> order;
  for (;;) {
    const Eigen::ArrayXi count = left.cast<int>().rowwise().sum();
    int best = 0;
    for (int c = 1; c < count.size(); ++c)
      if (std::tie(count[c], mean_square[best]) > std::tie(count[best], mean_square[c])) best = c;
    if (count.size() == 0 || count[best] == 0) return order;
    order.push_back(best);
    for (Eigen::Index s = 0; s < left.cols(); ++s)
      if (left(best, s)) left.col(s).setConstant(false);
  }
}

constexpr Named<LabelMode> kNamesOfModes[] = {
    {LabelMode::argmin, "argmin"}, {LabelMode::soft, "soft"}, {LabelMode::ranked, "ranked"}};

const char* to_string(LabelMode mode) {
  return name_of(mode, kNamesOfModes);
}

void describe(SettingVisitor& visit, LabelOptions& o) {
  visit.begin("LabelOptions");
  visit.choice({"mode", "how targets follow from the errors"}, o.mode, kNamesOfModes);
  visit.number({"tau", "scale of the errors of soft targets", "-", positive_range()}, o.tau);
  visit.number(
      {"delta", "difference of errors within which a choice serves a sample", "-", not_negative_range()},
      o.delta);
}

std::vector<int> chosen_labels(const MatX& errors, const LabelOptions& options) {
  std::vector<int> order, out;
  if (options.mode == LabelMode::ranked) order = ranking(errors, options.delta);
  for (Eigen::Index s = 0; s < errors.cols(); ++s) {
    Eigen::Index least = 0;
    const double error = errors.col(s).minCoeff(&least);
    const auto serves = [&](int c) { return errors(c, s) - error <= options.delta; };
    out.push_back(options.mode == LabelMode::ranked ? *std::ranges::find_if(order, serves) : int(least));
  }
  return out;
}

MatX targets(const MatX& errors, const std::vector<std::vector<int>>& choices, int outputs,
             const LabelOptions& options) {
  check_ranges(options);
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
