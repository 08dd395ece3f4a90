// SPDX-License-Identifier: Apache-2.0
// Conservative advancement: which pairs can touch within a step, did the step keep its word, and is it proven
// that the base complexes stayed apart? (CA-4) to (CA-6)
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "lmd/broad_phase.hpp"
#include "lmd/find_contacts.hpp"
#include "lmd/motion_bound.hpp"
#include "lmd/nesting.hpp"
#include "mechanics/state.hpp"

namespace aussois {

/// Contacts are looked for within a bound of the step's displacement, and a step is accepted only if it kept
/// within the bound and the base complexes provably kept apart.
struct AdvancementOptions {
  bool certify = true;        // false: no proof, no refusal for overlap (for comparison only)
  double enlargement = 1.25;  // beta: the estimate of the speeds is enlarged by this [-], in [1, 4]
  double floor = 0.1;         // smallest search distance, of the sum of the dilations [-], in (0, 1]
  // Dilated shapes may overlap by this part of the sum of the dilations [-], in [0, 0.99]
  double max_overlap = 0.04;
  double min_h = 1e-7;    // a step that needs less is refused [s], > 0
  double growth = 1.5;    // of the step after an accepted one [-], in [1, 4]
  int max_attempts = 60;  // >= 1
};
void validate(const AdvancementOptions& options);  // throws std::invalid_argument: field, value, bound

/// Two bodies with shapes, at least one of them dynamic, that can touch in a step.
struct StepPair {
  int a = 0, b = 0;
  double dilation = 0;   // sum of the two [m]
  double threshold = 0;  // contacts are looked for up to this gap [m]
  double rotation = 0;   // bound of the relative rotation [rad]
};

/// What a body's shape fits into, seen from the body frame; nothing for a body without a shape.
struct BodyBounds {
  double radius = 0;  // of the base complex about the centre of mass [m]
  DilatedBox box{};   // around the dilated shape
};
std::vector<BodyBounds> body_bounds(const Model& model);

/// A step that is tried: all six velocities of every body of the model, constant on the path of the step, and
/// its length.
struct StepMotion {
  const Model& model;
  const State& state;
  const VecX& v;
  double h = 0;
};

/// The same, body by body, with all that the bounds of pairs ask for; speeds times `enlargement`.
struct StepPath {
  const Model& model;
  double h = 0;
  std::vector<MovingBody> bodies{};
};
StepPath step_path(const StepMotion& step, const std::vector<BodyBounds>& bounds, double enlargement = 1);

/// What a scheme keeps of its pairs from step to step: it saves time and changes no result. Who finds it in
/// use by another thread goes without.
struct ContactScratch {
  std::mutex in_use{};
  std::vector<std::pair<int, int>> bodies{};  // sorted
  std::vector<PairScratch> pairs{};
  BroadPhaseScratch near{};
};

/// Who is near whom.
struct NearPairs {
  std::vector<StepPair> pairs{};  // sorted by (a, b)
  std::vector<double> reach{};    // of every body: how far it may move without meeting any other [m]
  int passing = 0;                // pairs that are near too, but pass through each other (Model::passing)
};
/// Pairs whose boxes come nearer than the sum of their `reach` [m], one per body; thresholds are left at 0.
/// Sorted by (a, b).
NearPairs near_pairs(const Model& model, const State& state, const std::vector<BodyBounds>& bounds,
                     std::vector<double> reach, int threads, ContactScratch* scratch = nullptr);
std::vector<StepPair> pairs_within(const Model& model, const State& state,
                                   const std::vector<BodyBounds>& bounds, const std::vector<double>& reach,
                                   int threads, ContactScratch* scratch = nullptr);

/// What can touch if the bodies move at most as in `estimate`, enlarged.
NearPairs step_pairs(const StepMotion& estimate, const std::vector<BodyBounds>& bounds,
                     const AdvancementOptions& options, int threads, ContactScratch* scratch = nullptr);

/// Contacts of the pairs within their thresholds, cones enlarged by their rotations; sorted by pair. Many
/// pairs share the threads, few pairs get them all.
ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options);

ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options, ContactScratch& scratch);

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

/// The pieces of the complex of every shape of a model.
std::vector<Pieces> pieces_of_shapes(const Model& model);

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

/// Smallest distance of the base complexes of bodies that can touch [m], or `cutoff`.
double min_base_distance(const Model& model, const State& state, double cutoff, int threads);

}  // namespace aussois
