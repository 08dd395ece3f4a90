// SPDX-License-Identifier: Apache-2.0
// The user's options of a step, which all schemes share: joints, the advancement, and the settings of the
// search, the reducer and the solver; and laws of normal rows and impacts that some schemes offer.
#pragma once

#include "geometry/named.hpp"
#include "lmd/lmd_options.hpp"
#include "mechanics/motion.hpp"
#include "nsgs/solve.hpp"
#include "reduction/reduce.hpp"
#include "reduction/warm_start.hpp"

namespace aussois {

class SettingVisitor;

/// The law of the normal rows of a step (decision record 0006).
enum class NormalLaw {
  moreau,         // impact law u+ >= -e u-, active once the gap predicted half a step ahead closes
  gap_over_step,  // u+ + g / h >= 0: the gap at the end of the step stays open; plastic, refuses e > 0
  combined,       // impact law where a contact with e > 0 closes within the step, gap over step elsewhere
};
inline constexpr Named<NormalLaw> kNormalLaws[] = {{NormalLaw::moreau, "moreau"},
                                                   {NormalLaw::combined, "combined"},
                                                   {NormalLaw::gap_over_step, "gap_over_step"}};
const char* to_string(NormalLaw law);

enum class ImpactLaw {
  newton,   // u+ >= -e u- (IMP-2)
  poisson,  // expansion gives back e times the normal impulse of compression (IMP-3)
};
enum class ImpactOrder {
  simultaneous,  // one problem of all contacts that close (IMP-4)
  sequential,    // one contact after the other, the fastest first (IMP-5)
};
inline constexpr Named<ImpactLaw> kImpactLaws[] = {{ImpactLaw::newton, "newton"},
                                                   {ImpactLaw::poisson, "poisson"}};
inline constexpr Named<ImpactOrder> kImpactOrders[] = {{ImpactOrder::simultaneous, "simultaneous"},
                                                       {ImpactOrder::sequential, "sequential"}};

/// `describe` gives the ranges.
struct ImpactOptions {
  ImpactLaw law = ImpactLaw::newton;
  ImpactOrder order = ImpactOrder::simultaneous;
  int max_pairs = 10000;  // most one-contact impacts in a step; those left over are plastic
};
void describe(SettingVisitor& visit, ImpactOptions& options);

/// True for Newton's law at all contacts at once. It needs no map of its own: it is the normal law of the
/// step (MJ-6).
inline bool in_the_step(const ImpactOptions& o) {
  return o.law == ImpactLaw::newton && o.order == ImpactOrder::simultaneous;
}

/// How joints are kept from drifting: stabilisation in the step and projection after it; and how far off they
/// may be.
/// `describe` gives the ranges.
struct JointOptions {
  bool project = true;         // joints hold to rounding after each step, positions and velocities (MJT-13)
  double stabilisation = 0.2;  // fraction of the drift that a step removes [-] (MJT-11)
  double tolerance = 1e-6;     // largest error before the first step, also without `project`, and after each
                               // projection; a larger one is refused [m, rad]
};
void describe(SettingVisitor& visit, JointOptions& options);
/// Contacts are searched for within a bound on the step's displacement. A step is accepted only if it stayed
/// within the bound and the base complexes provably stayed apart.
/// `describe` gives the ranges.
struct AdvancementOptions {
  bool certify = true;        // false: no proof, no refusal for overlap (for comparison only)
  double enlargement = 1.25;  // beta: factor that enlarges the estimated speeds [-]
  double floor = 0.1;         // smallest search distance, fraction of the sum of the dilations [-]
  // Dilated shapes may overlap by this fraction of the sum of the dilations [-]
  double max_overlap = 0.04;
  double min_h = 0;     // a step that would have to be shorter is refused [s], at most h; 0: the smaller of
                        // 1e-7 s and h / 10000
  double growth = 1.5;  // growth factor of the step after an accepted one [-]
  int max_attempts = 60;
};
void validate(const AdvancementOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, AdvancementOptions& options);

/// `describe` gives the ranges.
struct StepOptions {
  double h = 1e-3;                 // largest step [s]
  double correction_speed = 0.01;  // at most, of overlaps that are pushed apart; moreau pushes none [m/s]
  // Gaps up to this count as closed for moreau (MJ-6); in short steps the limit is smaller. The solver's
  // tolerance and rounding leave such gaps to bodies at rest [m; rad for a limit of a rotation]
  double touching = 1e-8;
  JointOptions joints{};
  LmdOptions lmd{};  // without threshold: the displacement bound sets it in each step
  ReductionOptions reduction{};
  PersistenceOptions persistence{};
  // Impacts (IMP-1) are solved to 1e-13 and displacements (PRJ-2) to 1e-12 where its tolerance is larger, and
  // displacements always by Method::automatic
  SolverOptions solver{};
  AdvancementOptions advancement{};
  GroupUpdate update = GroupUpdate::exponential;
  // Coarser levels of shapes that may stand for them where gaps are large (LOD-4); 0: the shapes themselves
  // alone. The levels are those of LmdShape::levels
  int levels = 0;
  int threads = 1;            // the result does not depend on it
  bool keep_problem = false;  // keeps the solved problem in StepReport::problem, to save and replay it
  bool profile = false;       // takes the CPU time of each stage too (StepReport::stages)
};
void validate(const StepOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, StepOptions& options);

}  // namespace aussois
