// SPDX-License-Identifier: Apache-2.0
// What a scheme returns: where it wants to go, with which impulses. Whether it may go there is judged, and
// what happened told, by others.
#pragma once

#include "integrators/pose/impulse_step.hpp"

namespace aussois {

enum class Outcome { accepted, bound_exceeded, meets, not_certified, not_solved, not_finite };

/// Where a scheme wants to go: velocities constant on the path, and those at its end; rows of the problem.
struct Move {
  VecX v_path{}, v_end{};
  std::optional<State> end{};  // other poses and coordinates that the path is to end at (PRJ-4)
  // How long a contact that ends overlapped and closing goes on like that before the scheme turns it [s]; the
  // step leaves room for it (CA-17)
  double goes_on = 0;
  // Impulses act for `lasts`; forces of joints are means about the time `about`; parts of h (MJT-17)
  double lasts = 1, about = 0.5;
};

/// Why a trial may not be taken as it is; accepted: nothing speaks against it.
struct Objection {
  Outcome outcome = Outcome::accepted;
  std::string reason{};
  std::vector<std::pair<int, int>> meeting{};  // pairs of Found::apart that meet, sorted
};

/// What only some schemes have to say of a step; told as they are (StepReport).
struct SchemeFigures {
  int newton_iterations = 1;
  double newton_change = 0;  // [m/s, rad/s]
  int contacts_made_passive = 0;
  double projection = 0;    // [m, rad]
  double overlap_left = 0;  // [m]
};

struct Trial {
  std::optional<State> from{};  // the state behind an impact that the step begins with (IMP-1)
  Found found{};
  ImpulseStep impulses{};
  Move move{};
  VecX a{};                // State::a after it
  Objection beforehand{};  // of the scheme itself: it is not worth a proof
  Objection afterwards{};  // of the scheme itself, if nothing else speaks against it
  SchemeFigures figures{};
};

}  // namespace aussois
