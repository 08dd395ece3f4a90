// SPDX-License-Identifier: Apache-2.0
// Keeps fewer contacts that can still carry the same loads (RED-1) to (RED-4), and measures what is lost
// (RED-7). The contacts of a body pair are clustered, by normal unless asked otherwise, and some of each
// cluster are kept. The deepest contact is always kept, and so is the deepest of contacts at one place with
// different normals (RED-16).
#pragma once

#include <string>
#include <vector>

#include "reduction/clustering.hpp"
#include "reduction/hull_margin.hpp"
#include "reduction/selection.hpp"

namespace aussois {

class SettingVisitor;

enum class Reducer {
  none,            // keeps everything
  extreme_points,  // four extremes along two in-plane axes (RED-3)
  hull_exact,      // all corners of the hull (RED-1)
  hull_area_loss,  // a given number of corners that keep much area (RED-10)
  hull_margin,     // the fewest corners with a given margin (RED-11)
  direction_set,   // extremes along a fan of directions (RED-3)
  wrench_cone,     // all normals of a pair together; keeps every wrench with friction up to a factor (RED-12)
  load_carrier,    // at most three that can carry the load of the last step (RED-13)
  selector,        // ReductionOptions::selector
};
const char* to_string(Reducer reducer);
/// The reducer with this name; throws std::invalid_argument listing all names.
Reducer reducer(const std::string& name);
std::vector<std::string> reducer_names();

/// Where Coulomb friction acts.
enum class FrictionAt {
  contacts,  // at each contact by itself
  patches,   // at the centre of the contact's patch, with the drilling torque of even pressure on it (RED-15)
};

/// `describe` gives the ranges, and the reducers that read an option: with others only its default is taken.
struct ReductionOptions {
  Reducer reducer = Reducer::hull_margin;
  ClusteringOptions clustering{};  // which contacts of a pair are reduced together
  int min_per_cluster = 4;         // sets of at most this size are kept whole
  double layer = 1e-5;       // contacts within this of the deepest are also reduced by themselves [m]; a
                             // matter of taste
  double min_margin = 0;     // contacts are added to every cluster until its margin is at least this;
                             // 0: whatever the reducer leaves
  double hysteresis = 0.02;  // where a reducer has a choice, it stays with the corners of the last step
                             // unless others are better by more than this fraction; 0: no memory. hull_exact
                             // and load_carrier, which have no choice, only ask whether it is 0
  double tie = 1e-3;  // extremes within this fraction of the cluster's extent are tied, and of contacts that
                      // close to each other the deepest is kept; must exceed the flatness of
                      // real meshes, or noise chooses the corners
  bool paper_exact = false;  // as published, without tie rule or hysteresis
  HullMargin hull_margin{};
  int corners = 4;
  int directions = 4;
  double wrench_loss = 0.1;  // at least 1 - this of every wrench is kept
  FrictionAt friction = FrictionAt::contacts;
  ContactSelector selector{};  // for Reducer::selector, which needs one; no other reducer takes one
};
void validate(const ReductionOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, ReductionOptions& options);

/// A pure function of the input and the options; the order of the contacts does not matter. Kept contacts are
/// neither moved nor merged. Throws std::invalid_argument naming the contact if a point or gap is not finite
/// or a normal does not have unit length (1e-6). Also throws if a vector of the input differs in length from
/// the set, or if a selector names a contact that is not in the set.
Selection reduce(const ReductionInput& input, const ReductionOptions& options = {});
Selection reduce(const ContactSet& found, const ReductionOptions& options = {});

/// What the kept contacts lose against the full set, the worst over all clusters (RED-7). `selection` as
/// returned by reduce() for the same set, or any subset of it with the same clusters.
LossReport measure_loss(const ContactSet& found, const Selection& selection);

}  // namespace aussois
