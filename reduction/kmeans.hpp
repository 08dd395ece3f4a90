// SPDX-License-Identifier: Apache-2.0
// Lloyd's k-means in any dimension, in space or on the unit sphere (CLU-3), with reproducible seeds (CLU-4).
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

class SettingVisitor;

struct SeedFarthest {};  // the first point, then each time the one farthest from its nearest seed
struct SeedRandom {      // distinct points, every set equally likely
  std::uint64_t seed = 0;
};
struct SeedPlusPlus {  // each next point with a probability proportional to weight times distance squared
  std::uint64_t seed = 0;
};
struct SeedWarm {  // previous centres, one per column; if too few, the rest as SeedFarthest
  MatX centres{};
};
using KMeansSeeding = std::variant<SeedFarthest, SeedRandom, SeedPlusPlus, SeedWarm>;

/// `describe` gives the ranges.
struct KMeansOptions {
  int k = 3;  // no more centres than points are made
  KMeansSeeding seeding{};
  int max_iterations = 100;
  bool on_sphere = false;  // unit vectors: centres are normalised sums
};
void describe(SettingVisitor& visit, KMeansOptions& options);

struct KMeans {
  MatX centres{};            // one per column
  std::vector<int> label{};  // the nearest centre of each point; of tied centres the lowest
  std::vector<int> count{};  // number of points of each centre; a centre without points stays where it was
  // Sum of weight times distance squared, at the seeds and after each iteration
  std::vector<double> objective{};
  int iterations = 0;
  bool converged = false;  // the last iteration changed no label
};

/// `points`: one per column; `weights`: >= 0, one per point, or empty (all one). A pure function of its
/// input; the order of the points matters only for ties and seeds. Throws std::invalid_argument if a number
/// is not finite, a weight negative, a size wrong, or k or max_iterations out of bounds. Without points there
/// are no centres.
KMeans kmeans(const MatX& points, const VecX& weights, const KMeansOptions& options = {});

}  // namespace aussois
