// SPDX-License-Identifier: Apache-2.0
// Certifies a step: it stayed within the bounds used to find its contacts, and the base complexes provably
// stayed apart (CA-5), (CA-6).
#pragma once

#include <optional>
#include <string>

#include "integrators/pose/step_pairs.hpp"
#include "lmd/nesting.hpp"

namespace aussois {

/// The distance that the base complexes of a pair must keep (CA-6) [m].
double required_distance(const StepPair& pair, const AdvancementOptions& options);

/// Empty if the step kept the bounds within which the contacts of these pairs were found (CA-5), otherwise
/// what broke them.
std::string broken_bound(const StepPath& path, const std::vector<StepPair>& pairs, double alpha);
/// The same for bodies and their reach; this covers pairs that were not even near.
std::string broken_reach(const StepPath& path, const PerBody<double>& reach);

struct StepCertificate {
  double min_distance = kInf;  // lower bound on the distance of the base complexes over the step [m]
  long rounds = 0;
  std::string failure{};  // empty: certified
};
/// Checks whether all pairs keep their distance along the whole path (CA-6). A pair whose boxes are farther
/// apart than they can move, or that one plane separates, needs no look at its simplices. `contacts`, sorted,
/// suggest where that plane may lie (CA-15); the proof does not rely on them.
StepCertificate certify_step(const StepPath& path, const std::vector<StepPair>& pairs,
                             const PerBody<BodyBounds>& bounds, const ContactSet& contacts,
                             const AdvancementOptions& options, int threads);

/// The same for one pair whose dilated shapes must not even touch (CA-16); finer in time.
StepCertificate certify_apart(const StepPath& path, const StepPair& pair, const PerBody<BodyBounds>& bounds,
                              int threads);

/// Pairs of moved and fixed bodies, at least one of them moved, that can touch on the path; thresholds are
/// left at 0. Nothing can stop them (CA-20). Sorted. Pairs without any dilation are left out, since nothing
/// can be proven of them.
std::vector<StepPair> driven_pairs(const StepPath& path, const PerBody<BodyBounds>& bounds, int threads);
/// Those pairs that are not proven to keep the distance (CA-6), or in which one body is inside the other.
std::vector<BodyPair> driven_overlaps(const StepPath& path, const PerBody<BodyBounds>& bounds,
                                      const Table<ShapeId, Pieces>& pieces, const AdvancementOptions& options,
                                      int threads);

/// Two bodies whose base complexes are nearer than the certificate allows.
struct Overlap {
  BodyId a{}, b{};
  double distance = 0, required = 0;  // distance of the base complexes; what (CA-6) requires [m]
};
/// The pair that most exceeds what is allowed at the state, if any does.
std::optional<Overlap> deepest_overlap(const Model& model, const State& state,
                                       const PerBody<BodyBounds>& bounds, const AdvancementOptions& options,
                                       int threads);

/// The first of the pairs in which one body is inside the other (CA-19), in words; empty if there is none.
std::string nested_pair(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                        const Table<ShapeId, Pieces>& pieces);

/// The same for all pairs that are near; also empty if no shape is a solid.
std::string nested_at(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                      const Table<ShapeId, Pieces>& pieces, int threads);

/// Why no run can begin at a state: overlap beyond what is allowed, with names, value and bound, or a body
/// inside another. Empty if a run can begin.
std::string wrong_start(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                        const Table<ShapeId, Pieces>& pieces, const AdvancementOptions& options, int threads);

}  // namespace aussois
