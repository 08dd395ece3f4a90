// SPDX-License-Identifier: Apache-2.0
// Fewer contacts that can still carry the same loads (RED-1) to (RED-4), and what the others take with them
// (RED-7): contacts of one body pair are clustered, by normal unless asked otherwise, and of each cluster
// some are kept, the deepest one always, and of contacts at one place with other normals the deepest
// (RED-16).
#pragma once

#include <string>
#include <vector>

#include "reduction/clustering.hpp"
#include "reduction/hull_margin.hpp"
#include "reduction/selection.hpp"

namespace aussois {

enum class Reducer {
  none,            // keeps everything
  extreme_points,  // four extremes along two in-plane axes (RED-3)
  hull_exact,      // all corners of the hull (RED-1)
  hull_area_loss,  // a given number of corners, much area (RED-10)
  hull_margin,     // the fewest corners with a given margin (RED-11)
  direction_set,   // extremes along a fan of directions (RED-3)
  wrench_cone,     // of all normals of a pair together: every wrench with friction up to a factor (RED-12)
  load_carrier,    // at most three, which carry the load of the last step (RED-13)
  selector,        // ReductionOptions::selector
};
const char* to_string(Reducer reducer);
/// By its name; throws std::invalid_argument naming all of them.
Reducer reducer(const std::string& name);
std::vector<std::string> reducer_names();

/// Where Coulomb friction acts.
enum class FrictionAt {
  contacts,  // at each contact by itself
  patches,   // at the centre of the contact's patch, with the drilling torque of even pressure on it (RED-15)
};

struct ReductionOptions {
  Reducer reducer = Reducer::hull_margin;
  ClusteringOptions clustering{};  // which contacts of a pair are reduced together
  int min_per_cluster = 4;         // sets of at most this size are kept whole, >= 1
  double layer = 1e-5;  // contacts within this of the deepest are reduced by themselves too [m], >= 0; taste
  double min_margin = 0;  // contacts are added to every cluster until its margin is at least this, in [0, 1];
                          // 0: whatever the reducer leaves
  double hysteresis = 0.02;  // where a reducer has a choice, it stays with the corners of the last step
                             // unless others are better by more than this fraction, in [0, 1); 0: no memory
  double tie = 1e-3;  // extremes within this fraction of the cluster's extent are tied, and of contacts as
                      // near to each other the deepest is kept, in [0, 0.1]; larger than the flatness of real
                      // meshes, or noise chooses the corners
  bool paper_exact = false;  // extreme_points: as published, neither tie rule nor hysteresis
  HullMargin hull_margin{};
  int corners = 4;           // hull_area_loss, >= 3
  int directions = 4;        // direction_set, >= 3
  double wrench_loss = 0.1;  // wrench_cone: at least 1 - this of every wrench is kept, in [0, 1)
  FrictionAt friction = FrictionAt::contacts;
  ContactSelector selector{};  // of Reducer::selector, which needs one; no other takes one
};
void validate(const ReductionOptions& options);  // throws std::invalid_argument: field, value, bound

/// A pure function of the input, whatever the order of its contacts, and the options; kept contacts are
/// neither moved nor merged. Throws std::invalid_argument naming the contact if a point or gap is not finite
/// or a normal not of unit length (1e-6), if a vector of the input has another length than the set, or if a
/// selector names a contact that is not in it.
Selection reduce(const ReductionInput& input, const ReductionOptions& options = {});
Selection reduce(const ContactSet& found, const ReductionOptions& options = {});

/// The worst over all clusters of what the kept contacts lost against the full set (RED-7). `selection` as
/// returned by reduce() for the same set, or any subset of it with the same clusters.
LossReport measure_loss(const ContactSet& found, const Selection& selection);

}  // namespace aussois
