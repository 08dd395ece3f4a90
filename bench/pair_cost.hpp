// SPDX-License-Identifier: Apache-2.0
// What all contacts of a pair cost along its path, beside what peers ask for one distance of the same meshes:
// CPU time of one thread, of every pose the fastest of some repeats, of all poses the median.
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
  double ablation = 0;               // at this threshold each test is left out in turn; 0: none is [-]
  int poses = 9;                     // of the path, spread evenly
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

/// `step(done)` hears how much is done, from 0 to 1, and answers whether to go on; if not, what is measured
/// so far is not to be used. Throws NumericalFailure if contacts depend on which tests prune.
PairCost measure_pair(const AssemblyInput& input, const CostOptions& options,
                      const std::function<bool(double)>& step);

}  // namespace aussois
