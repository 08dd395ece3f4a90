// SPDX-License-Identifier: Apache-2.0
// May a scheme go where it wants to? The bounds that contacts were found within, and the certificate.
#pragma once

#include "integrators/pose/trial.hpp"

namespace aussois {

struct Judgement {
  Objection objection{};
  VecX v_path{};          // all velocities, constant on the path that was tried
  ProjectedState held{};  // what joints projected at its end (MJT-13)
  State next{};           // poses and velocities at its end; it remembers no contacts
  JointError joint_error{};
  int certificate_rounds = 0;
  double min_base_distance = kInf;  // a lower bound over the step [m]
  std::vector<std::pair<int, int>> driven_overlaps{};
  double seconds_certificate = 0;
};

/// Holds the path of a trial against the bounds that its contacts were found within (CA-5), against pairs
/// whose contacts were not asked (CA-16), the certificate (CA-6), the room that overlaps need (CA-17), and
/// the tolerance of the joints, which are projected at its end.
Judgement judge(const StepSetting& setting, const State& state, const Trial& trial);

}  // namespace aussois
