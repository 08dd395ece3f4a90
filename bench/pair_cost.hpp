// SPDX-License-Identifier: Apache-2.0
// Measures the cost of all contacts of a pair along its path, and of one distance of the same meshes by
// peers. Times are CPU times of one thread: the fastest of some repeats of each pose, the median of all
// poses.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "lmd/find_contacts.hpp"

namespace aussois {

inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

struct CostOptions {
  std::vector<double> thresholds{};  // largest distances of the bases, in moving radii [-]
  double ablation = 0;  // the threshold at which each test is left out in turn; 0: none is left out [-]
  int poses = 9;        // of the path, spread evenly
  int repeats = 3;
};

/// A query at one threshold; medians over the poses, each by itself.
struct QueryCost {
  double threshold = 0;  // [-]
  double ms = 0;
  double contacts = 0, node_pairs = 0, leaf_pairs = 0, exact_tests = 0;
  double ms_cgal = kNotMeasured, cgal_pairs = kNotMeasured;  // at every third pose, once
};

/// A query with one of the tests left out.
struct AblationCost {
  std::string without{};  // "nothing", "cones", ...
  QueryCost cost{};
};

struct PairCost {
  std::string name{};
  double triangles = 0;
  double radius = 0;  // of the moving part about the middle of its box [m]
  double leaves = 0;  // of both shapes: vertices, chains and triangles that can carry a contact
  double ms_build = 0, ms_build_fcl = kNotMeasured;
  double bytes_per_triangle = 0;  // of what a search reads (search_bytes)
  double ms_fcl = kNotMeasured;   // one distance
  std::vector<QueryCost> queries{};
  std::vector<AblationCost> ablation{};
};

/// The query at `threshold`; nullptr if it was not measured.
const QueryCost* query_at(const PairCost& pair, double threshold);

/// `step(done)` is called with the fraction done, from 0 to 1, and returns whether to go on. If not, the
/// result is not to be used. Throws NumericalFailure if contacts depend on which tests prune.
PairCost measure_pair(const AssemblyInput& input, const CostOptions& options,
                      const std::function<bool(double)>& step);

}  // namespace aussois
