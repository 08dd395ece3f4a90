// SPDX-License-Identifier: Apache-2.0
// A trial of a scheme: the motion that it proposes, and the impulses. Other parts judge whether it is
// accepted, and report what happened.
#pragma once

#include "integrators/pose/impulse_step.hpp"

namespace aussois {

enum class Outcome {
  accepted,
  bound_exceeded,
  meets,
  levels_meet,
  levels_meet_far,
  not_certified,
  not_solved,
  not_finite
};

/// The motion that a scheme proposes: velocities constant on the path, and those at its end; rows of the
/// problem.
struct Move {
  VecX v_path{}, v_end{};
  std::optional<State> end{};  // other poses and coordinates at which the path must end (PRJ-4)
  // How long a contact that ends overlapped and still closing goes on before the scheme reverses it [s]; the
  // step leaves room for that (CA-17)
  double goes_on = 0;
  // Impulses act for the time `lasts`; joint forces are means about the time `about`; both as fractions of h
  // (MJT-17)
  double lasts = 1, about = 0.5;
};

/// Why a trial may not be taken as it is; accepted: there is no objection.
struct Objection {
  Outcome outcome = Outcome::accepted;
  std::string reason{};
  std::vector<BodyPair> meeting{};       // pairs of FoundContacts::apart that meet, sorted
  std::map<BodyPair, double> fine_to{};  // for pairs whose levels meet, Estimate::fine_to
};

/// Figures that only some schemes have; reported as they are (StepReport).
struct SchemeFigures {
  int newton_iterations = 1;
  double newton_change = 0;  // [m/s, rad/s]
  int contacts_made_passive = 0;
  double projection = 0;    // [m, rad]
  double overlap_left = 0;  // [m]
};

struct Trial {
  std::optional<State> from{};  // state after an impact at the start of the step (IMP-1)
  FoundContacts found{};
  ImpulseStep impulses{};
  Move move{};
  VecX a{};                // State::a after the trial
  Objection beforehand{};  // by the scheme itself: the trial is not worth a proof
  Objection afterwards{};  // by the scheme itself, if there is no other objection
  SchemeFigures figures{};
};

}  // namespace aussois
