// SPDX-License-Identifier: Apache-2.0
// Finds the pairs that can touch within a step, and their contacts (CA-4), (CA-12).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "integrators/step_options.hpp"
#include "lmd/broad_phase.hpp"
#include "lmd/level_contacts.hpp"
#include "lmd/motion_bound.hpp"
#include "lmd/nesting.hpp"
#include "mechanics/surface.hpp"

namespace aussois {

/// Two bodies with shapes, at least one of them dynamic, that can touch in a step.
struct StepPair {
  BodyId a{}, b{};
  double dilation = 0;       // sum of both dilations [m]
  double threshold = 0;      // contacts are searched for up to this gap [m]
  double rotation = 0;       // bound on the relative rotation [rad]
  double fine_to = 0;        // up to this gap the shapes themselves answer, whatever their levels [m]
  bool has_contacts = true;  // false: the search found none
};
inline BodyPair bodies_of(const StepPair& pair) {
  return {pair.a, pair.b};
}

/// What encloses a body's shape, seen from the body frame; nothing for a body without a shape.
struct BodyBounds {
  double radius = 0;  // of the base complex about the centre of mass [m]
  DilatedBox box{};   // around the dilated shape
};
/// Bounds of the shapes as they are in the model.
PerBody<BodyBounds> body_bounds(const Model& model);

/// An attempted step: all six velocities of every body of the model, constant on the path of the step, and
/// its length.
struct StepMotion {
  const Model& model;
  const State& state;
  const VecX& v;
  double h = 0;
};

/// The shape of a body that deforms on a path.
struct DeformingShape {
  std::vector<Vec3> vertices{};  // at its start, in the frame of the shape [m]
  std::vector<Vec3> velocity{};  // the same [m/s]
  BodyBounds bounds{};
};

/// The path of an attempted step, body by body, with all that the bounds of pairs need; step_path multiplies
/// speeds by `enlargement`.
struct StepPath {
  const Model& model;
  double h = 0;
  bool starts_apart = false;  // CertificateOptions::starts_apart, of all pairs
  int levels = 0;             // StepOptions::levels
  PerBody<MovingBody> bodies{};
  std::map<BodyId, DeformingShape> deforming{};                                   // by body
  std::shared_ptr<DeformedShapes> deformed = std::make_shared<DeformedShapes>();  // at its start
};
StepPath step_path(const StepMotion& step, const PerBody<BodyBounds>& bounds, double enlargement = 1);
/// Empty if the vertices of deforming bodies are where the path led them at its end, otherwise which ones are
/// not (DEF-2).
std::string strayed(const StepPath& path, const State& end);

/// What a scheme keeps of its pairs from step to step. It saves time and changes no result; a thread that
/// finds it in use by another goes without.
struct ContactScratch {
  std::mutex in_use{};
  std::vector<BodyPair> bodies{};  // sorted
  std::vector<PairScratch> pairs{};
  BroadPhaseScratch near{};
  std::shared_ptr<DeformedShapes> deformed = std::make_shared<DeformedShapes>();  // has a lock of its own
};

/// The memory of its lists [bytes]; 0 while another thread uses it.
std::size_t bytes_of(ContactScratch& scratch);

/// The pairs of bodies that are near each other.
struct NearPairs {
  std::vector<StepPair> pairs{};  // sorted by (a, b)
  PerBody<double> reach{};        // of every body: how far it may move without meeting any other [m]
  int passing = 0;                // number of pairs that are near too, but pass through each other
                                  // (Model::passing)
};
/// Pairs whose boxes come nearer than the sum of their `reach` [m], one per body; thresholds are left at 0.
/// Sorted by (a, b).
NearPairs near_pairs(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                     PerBody<double> reach, int threads, ContactScratch* scratch = nullptr);
std::vector<StepPair> pairs_within(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                                   const PerBody<double>& reach, int threads,
                                   ContactScratch* scratch = nullptr);

/// The pairs that can touch if the bodies move at most as in `estimate`, enlarged.
NearPairs step_pairs(const StepMotion& estimate, const PerBody<BodyBounds>& bounds,
                     const AdvancementOptions& options, int threads, ContactScratch* scratch = nullptr);

/// Contacts of the pairs within their thresholds, cones enlarged by their rotations; sorted by pair. Many
/// pairs share the threads; if there are few, each pair gets them all.
ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options);
/// The same, where coarser levels stand for parts that are far (LOD-4); StepPair::fine_to is read, not that
/// of `use`.
LevelContacts contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                          const LmdOptions& options, const LevelUse& use, ContactScratch& scratch);

/// The pieces of the complex of every shape of a model.
Table<ShapeId, Pieces> pieces_of_shapes(const Model& model);

/// The shape of a body; null: none.
const LmdShape* shape_of(const Model& model, BodyId body);
/// How far the two bodies of a pair may move and turn relative to each other along the path; the rotation is
/// capped where enlarged cones no longer exclude anything.
RelativeBounds bounds_of(const StepPath& path, const StepPair& pair);

/// Splits the work on the pairs into parts, which do not depend on the number of threads. Each part calls f
/// once, with the threads that it may use itself.
int count_of_parts(const std::vector<StepPair>& pairs);
void for_each_part(const std::vector<StepPair>& pairs, int threads,
                   const std::function<void(int part, std::span<const StepPair>, int threads)>& f);

/// The bodies of the pairs, each posed once by `pose_of(body)`; the others are default-constructed.
template <class Posed, class PoseOf>
PerBody<Posed> posed_once(std::size_t bodies, const std::vector<StepPair>& pairs, const PoseOf& pose_of) {
  PerBody<Posed> out(bodies);
  PerBody<char> done(bodies, 0);
  for (const StepPair& pair : pairs)
    for (const BodyId body : {pair.a, pair.b})
      if (!std::exchange(done[body], 1)) out[body] = pose_of(body);
  return out;
}

}  // namespace aussois
