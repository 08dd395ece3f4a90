// SPDX-License-Identifier: Apache-2.0
#include "reduction/kmeans.hpp"

#include <algorithm>
#include <numeric>
#include <random>
#include <string>

#include "geometry/settings.hpp"

namespace aussois {
void describe(SettingVisitor& visit, KMeansOptions& o) {
  visit.begin("KMeansOptions");
  visit.count({"k", "number of centres", "", range_from(1)}, o.k);
  visit.count({"max_iterations", "iterations", "", range_from(0)}, o.max_iterations);
  visit.toggle({"on_sphere", "unit vectors with normalised centres"}, o.on_sphere);
}

namespace {

using Eigen::Index;

// In [0, 1); standard distributions differ between libraries.
double uniform(std::mt19937_64& engine) {
  return double(engine() >> 11) * 0x1p-53;
}

// Squared distance of every point from its nearest of the first `count` centres.
VecX nearest_distances(const MatX& points, const MatX& centres, Index count) {
  VecX out = VecX::Constant(points.cols(), kInf);
  for (Index i = 0; i < points.cols(); ++i)
    for (Index c = 0; c < count; ++c)
      out[i] = std::min(out[i], (points.col(i) - centres.col(c)).squaredNorm());
  return out;
}

// Fills up from `from` on; fewer columns if all points are at a centre already.
void add_farthest(const MatX& points, Index from, MatX& centres) {
  for (Index c = from; c < centres.cols(); ++c) {
    Index far = 0;
    if (c > 0 && nearest_distances(points, centres, c).maxCoeff(&far) == 0) {
      centres.conservativeResize(Eigen::NoChange, c);
      return;
    }
    centres.col(c) = points.col(far);
  }
}

struct Seeds {
  const MatX& points;
  const VecX& weights;
  Index k;

  MatX operator()(const SeedFarthest&) const {
    MatX centres(points.rows(), k);
    add_farthest(points, 0, centres);
    return centres;
  }
  MatX operator()(const SeedRandom& s) const {
    std::mt19937_64 engine(s.seed);
    std::vector<Index> pick(points.cols());
    std::iota(pick.begin(), pick.end(), Index(0));
    MatX centres(points.rows(), k);
    for (Index c = 0; c < k; ++c) {  // the first k of a shuffled deck
      const auto rest = double(points.cols() - c);
      std::swap(pick[c], pick[c + Index(uniform(engine) * rest)]);
      centres.col(c) = points.col(pick[c]);
    }
    return centres;
  }
  MatX operator()(const SeedPlusPlus& s) const {
    std::mt19937_64 engine(s.seed);
    MatX centres(points.rows(), k);
    for (Index c = 0; c < k; ++c) {
      VecX chance = weights;
      if (c > 0) chance = chance.cwiseProduct(nearest_distances(points, centres, c));
      double left = uniform(engine) * chance.sum();
      Index pick = 0;
      if (!(chance.sum() > 0)) {  // nothing that weighs is away from a centre
        centres.conservativeResize(Eigen::NoChange, std::max<Index>(c, 1));
        if (c == 0) centres.col(0) = points.col(0);
        return centres;
      }
      for (Index i = 0; i < points.cols(); ++i) {
        if (chance[i] > 0) pick = i;  // rounding of the sum cannot run off the end
        left -= chance[i];
        if (left < 0) break;
      }
      centres.col(c) = points.col(pick);
    }
    return centres;
  }
  MatX operator()(const SeedWarm& s) const {
    const Index given = std::min(k, s.centres.cols());
    MatX centres(points.rows(), k);
    centres.leftCols(given) = s.centres.leftCols(given);
    add_farthest(points, given, centres);
    return centres;
  }
};

// Labels and objective for the centres; true if a label changed.
bool assign(const MatX& points, const VecX& weights, KMeans& out) {
  bool changed = false;
  double objective = 0;
  std::fill(out.count.begin(), out.count.end(), 0);
  for (Index i = 0; i < points.cols(); ++i) {
    int best = 0;
    double least = kInf;
    for (int c = 0; c < int(out.centres.cols()); ++c) {
      const double d = (points.col(i) - out.centres.col(c)).squaredNorm();
      if (d < least) least = d, best = c;
    }
    changed = changed || out.label[i] != best;
    out.label[i] = best;
    ++out.count[best];
    objective += weights[i] * least;
  }
  out.objective.push_back(objective);
  return changed;
}

// Weighted means; a centre stays where nothing weighs, or where unit vectors cancel.
void move_centres(const MatX& points, const VecX& weights, bool on_sphere, KMeans& out) {
  MatX sum = MatX::Zero(out.centres.rows(), out.centres.cols());
  VecX weight = VecX::Zero(out.centres.cols());
  for (Index i = 0; i < points.cols(); ++i) {
    const int c = out.label[i];
    sum.col(c) += weights[i] * points.col(i);
    weight[c] += weights[i];
  }
  for (Index c = 0; c < sum.cols(); ++c) {
    const double by = on_sphere ? sum.col(c).norm() : weight[c];
    if (by > 1e-12 * weight[c]) out.centres.col(c) = sum.col(c) / by;
  }
}

void check(const MatX& points, const VecX& weights, const KMeansOptions& options) {
  check_ranges(options);
  require(points.allFinite() && weights.allFinite(), "kmeans: points and weights must be finite");
  require(weights.size() == 0 || weights.minCoeff() >= 0, "kmeans: weights must be at least 0");
  require(weights.size() == 0 || weights.size() == points.cols(),
          "kmeans: " + std::to_string(weights.size()) + " weights for " + std::to_string(points.cols()) +
              " points");
  if (const SeedWarm* warm = std::get_if<SeedWarm>(&options.seeding)) {
    require(warm->centres.cols() == 0 || warm->centres.rows() == points.rows(),
            "kmeans: centres of dimension " + std::to_string(warm->centres.rows()) + " for points of " +
                std::to_string(points.rows()));
    require(warm->centres.allFinite(), "kmeans: centres must be finite");
  }
}

}  // namespace

KMeans kmeans(const MatX& points, const VecX& weights, const KMeansOptions& options) {
  check(points, weights, options);
  const Index n = points.cols();
  if (n == 0) return {.converged = true};
  const VecX w = weights.size() > 0 ? weights : VecX(VecX::Ones(n));
  KMeans out{.centres = std::visit(Seeds{points, w, std::min(Index(options.k), n)}, options.seeding),
             .label = std::vector<int>(std::size_t(n), -1)};
  out.count.resize(out.centres.cols());
  assign(points, w, out);
  while (out.iterations < options.max_iterations && !out.converged) {  // (CLU-3)
    move_centres(points, w, options.on_sphere, out);
    out.converged = !assign(points, w, out);
    ++out.iterations;
  }
  return out;
}

}  // namespace aussois
