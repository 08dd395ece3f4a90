// SPDX-License-Identifier: Apache-2.0
// Did a step keep within the bounds that its contacts were found within, and is it proven that the base
// complexes stayed apart? (CA-5), (CA-6)
#pragma once

#include <optional>
#include <string>

#include "integrators/pose/step_pairs.hpp"
#include "lmd/nesting.hpp"

namespace aussois {

/// What the base complexes of a pair must keep apart (CA-6) [m].
double required_distance(const StepPair& pair, const AdvancementOptions& options);

/// Empty if the step kept the bounds that the contacts of these pairs were found within (CA-5), otherwise
/// what broke them.
std::string broken_bound(const StepPath& path, const std::vector<StepPair>& pairs, double alpha);
/// The same for bodies and their reach: pairs that were not even near.
std::string broken_reach(const StepPath& path, const std::vector<double>& reach);

struct StepCertificate {
  double min_distance = kInf;  // of the base complexes, a lower bound over the step [m]
  long rounds = 0;
  std::string failure{};  // empty: certified
};
/// Do all pairs keep their distance along the whole path? (CA-6) Pairs whose boxes are farther apart than
/// they can move, or that one plane parts, do without a look at their simplices. `contacts`, sorted, tell
/// where that plane may lie (CA-15); the proof does not rely on them.
StepCertificate certify_step(const StepPath& path, const std::vector<StepPair>& pairs,
                             const std::vector<BodyBounds>& bounds, const ContactSet& contacts,
                             const AdvancementOptions& options, int threads);

/// The same for one pair, whose dilated shapes are not even to touch (CA-16); finer in time.
StepCertificate certify_apart(const StepPath& path, const StepPair& pair,
                              const std::vector<BodyBounds>& bounds, int threads);

/// Pairs of moved and fixed bodies, at least one of them moved, that can touch on the path; thresholds are
/// left at 0. Nothing can stop them (CA-20). Sorted. Without those of no dilation: nothing can be proven of
/// them.
std::vector<StepPair> driven_pairs(const StepPath& path, const std::vector<BodyBounds>& bounds, int threads);
/// Those of them that are not proven to keep the distance (CA-6), or of which one is inside the other.
std::vector<std::pair<int, int>> driven_overlaps(const StepPath& path, const std::vector<BodyBounds>& bounds,
                                                 const std::vector<Pieces>& pieces,
                                                 const AdvancementOptions& options, int threads);

/// Two bodies whose base complexes are nearer than the certificate will allow.
struct Overlap {
  int a = 0, b = 0;
  double distance = 0, required = 0;  // of the base complexes; by (CA-6) [m]
};
/// The pair that is farthest beyond what is allowed at the state, if there is one.
std::optional<Overlap> deepest_overlap(const Model& model, const State& state,
                                       const std::vector<BodyBounds>& bounds,
                                       const AdvancementOptions& options, int threads);

/// The first of the pairs of which one is inside the other (CA-19), in words; empty: none.
std::string nested_pair(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                        const std::vector<Pieces>& pieces);

/// The same of all that are near; empty as well if no shape is a solid.
std::string nested_at(const Model& model, const State& state, const std::vector<BodyBounds>& bounds,
                      const std::vector<Pieces>& pieces, int threads);

/// Why no run can begin at a state: overlap beyond what is allowed, with names, value and bound, or a body
/// inside another. Empty if one can.
std::string wrong_start(const Model& model, const State& state, const std::vector<BodyBounds>& bounds,
                        const std::vector<Pieces>& pieces, const AdvancementOptions& options, int threads);

}  // namespace aussois
