// SPDX-License-Identifier: Apache-2.0
// What a user may set of a step: laws of normal rows, impacts and joints, the advancement, and all that the
// search, the reducer and the solver are told.
#pragma once

#include <string>

#include "lmd/lmd_options.hpp"
#include "mechanics/motion.hpp"
#include "nsgs/solve.hpp"
#include "reduction/reduce.hpp"
#include "reduction/warm_start.hpp"

namespace aussois {

/// What the normal rows of a step say (decision record 0006).
enum class NormalLaw {
  moreau,         // impact law u+ >= -e u-, active once the gap predicted half a step ahead closes
  gap_over_step,  // u+ + g / h >= 0: the gap at the end of the step stays open; plastic
  combined,       // impact law where a contact with e > 0 closes within the step, gap over step elsewhere
};
const char* to_string(NormalLaw law);
/// By its name; throws std::invalid_argument naming the three.
NormalLaw normal_law(const std::string& name);

struct NormalLawOptions {
  NormalLaw law = NormalLaw::combined;
  double correction_speed = 0.01;  // overlaps are pushed apart no faster than this [m/s]
  // Gaps up to this are closed to Moreau's law (MJ-6), less in short steps: the solver's tolerance and
  // rounding leave such to bodies at rest [m; rad of a turning limit]
  double touching = 1e-8;
  // The laws of contacts and stops speak of gamma u+ + (1 - gamma) u- [-], in [1/2, 1]; that is a restitution
  // of (1 - gamma) / gamma (MJ-10)
  double gamma = 1;
};

enum class ImpactLaw {
  newton,   // u+ >= -e u- (IMP-2)
  poisson,  // expansion gives back e times the normal impulse of compression (IMP-3)
};
enum class ImpactOrder {
  simultaneous,  // one problem of all contacts that close (IMP-4)
  sequential,    // one contact after the other, the fastest first (IMP-5)
};
const char* to_string(ImpactLaw law);
const char* to_string(ImpactOrder order);
/// By their names; throw std::invalid_argument naming what there is.
ImpactLaw impact_law(const std::string& name);
ImpactOrder impact_order(const std::string& name);

struct ImpactOptions {
  ImpactLaw law = ImpactLaw::newton;
  ImpactOrder order = ImpactOrder::simultaneous;
  int max_pairs = 10000;  // one-contact impacts of a step, >= 1; what is left then is plastic
};
void validate(const ImpactOptions& options);  // throws std::invalid_argument: field, value, bound

/// Newton's law for all at once needs no map of its own: it is the normal law of the step (MJ-6).
inline bool in_the_step(const ImpactOptions& o) {
  return o.law == ImpactLaw::newton && o.order == ImpactOrder::simultaneous;
}

/// What an impact did at the start of a step.
struct JointOptions {
  bool project = true;         // joints hold to rounding after each step, positions and velocities (MJT-13)
  double stabilisation = 0.2;  // part of the drift that a step takes back [-], in [0, 1] (MJT-11)
  double tolerance = 1e-6;     // before the first step and after each projection; what is off by more is
                               // refused [m, rad], > 0
};
void validate(const JointOptions& options);  // throws std::invalid_argument: field, value, bound

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

enum class OdeMethod {
  adams,  // orders 1 to 12, iterated by fixed point: smooth motion
  bdf,    // orders 1 to 5, Newton with a dense matrix of differences: stiff springs
};

struct OdeOptions {
  OdeMethod method = OdeMethod::adams;
  // Tolerances of every component, > 0, for each 0.1 s: shorter steps of event_driven ask for proportionally
  // less, both by the same factor, down to 1e-14 relative (EVD-12)
  double relative = 1e-10, absolute = 1e-12;
  double largest_step = kInf;  // [s], > 0
  long max_steps = 100000;     // internal ones in one step of event_driven, >= 1; more are refused
};
void validate(const OdeOptions& options);  // throws std::invalid_argument: field, value, bound

struct StepOptions {
  double h = 1e-3;  // largest step [s], > 0
  NormalLawOptions normal{};
  JointOptions joints{};
  LmdOptions lmd{};  // its threshold is set in each step by the displacement bound
  ReductionOptions reduction{};
  PersistenceOptions persistence{};
  SolverOptions solver{};
  AdvancementOptions advancement{};
  GroupUpdate update = GroupUpdate::exponential;
  int threads = 1;            // the result does not depend on it
  bool keep_problem = false;  // StepReport::problem holds what was solved, to save and replay it
};
void validate(const StepOptions& options);  // throws std::invalid_argument: field, value, bound

/// For schemes whose rows say something else than how bodies slip on the step: throws std::invalid_argument
/// if anchors are asked for.
void refuse_anchors(const StepOptions& options, const char* scheme);

}  // namespace aussois
