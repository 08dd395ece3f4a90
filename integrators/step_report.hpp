// SPDX-License-Identifier: Apache-2.0
// What happened in a step; returned by every scheme, printed by nobody but the driver.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lmd/contact_point.hpp"
#include "nsgs/residual.hpp"
#include "nsgs/solve.hpp"

namespace aussois {

enum class StepStatus {
  ok,
  refused,     // no step above the minimal one could be accepted; the state is unchanged
  not_finite,  // a force, velocity or pose stopped being a number; the state is unchanged
};
const char* to_string(StepStatus status);

/// A contact that took part in the solve, as it stood at the start of the step, and what it did.
struct StepContact {
  ContactPoint point{};
  Vec3 impulse = Vec3::Zero();  // on A, world [N s]
};

/// What a step gave to the solver and what came back.
struct StepProblem {
  FrictionProblem problem{};    // of the contacts kept (NSGS-1)
  VecX start{};                 // impulses it was started with, of its rows [N s]
  FrictionSolution solution{};  // its report sums up the rounds of the step
};

/// Where the energy went in a step [J] (MJ-9).
struct EnergyLedger {
  double kinetic_change = 0;  // of the dynamic bodies
  double gravity_work = 0;
  double law_work = 0;         // of the force laws, the virtual coupling for example
  double contact_work = 0;     // of the contact impulses; never positive for e = 0 against bodies at rest
  double gyroscopic_work = 0;  // of the gyroscopic term as discretised
  double residual() const {    // zero to rounding: the balance of (MJ-9)
    return kinetic_change - gravity_work - law_work - contact_work - gyroscopic_work;
  }
};

struct StepReport {
  StepStatus status = StepStatus::ok;
  std::string reason{};      // why refused: the pair, its gap and the bound
  double t = 0, h = 0;       // time reached and step taken [s]
  int contacts_found = 0;    // local minima within the threshold
  int contacts_kept = 0;     // of them in the problem that was solved
  int contacts_matched = 0;  // with an impulse from the last step
  int attempts = 1;          // times the step was tried (threshold enlarged or step halved)
  double threshold = 0;   // largest distance within which contacts were looked for, beyond the dilations [m]
  double min_gap = kInf;  // smallest gap of the contacts found, at the start of the step [m]
  double min_base_distance = kInf;  // lower bound of the distance of the base complexes over the step [m]
  int certificate_rounds = 0;
  SolveReport solve{};
  PhysicalResidual physical{};
  EnergyLedger energy{};
  std::vector<StepContact> contacts{};
  std::optional<StepProblem> problem{};  // the last one solved, also in a step that ended badly; if asked for
  double seconds_contact = 0, seconds_solve = 0, seconds_certificate = 0, seconds_total = 0;  // CPU [s]
  bool ok() const { return status == StepStatus::ok && solve.status == SolveStatus::converged; }
};

}  // namespace aussois
