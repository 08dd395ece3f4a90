// SPDX-License-Identifier: Apache-2.0
// Judges whether the motion that a scheme proposes is accepted: by the bounds within which contacts were
// found, and by the certificate.
#pragma once

#include "integrators/pose/trial.hpp"

namespace aussois {

struct Judgement {
  Objection objection{};
  VecX v_path{};          // all velocities, constant on the path that was tried
  ProjectedState held{};  // result of projecting the joints at its end (MJT-13)
  State next{};           // poses and velocities at its end; without contact memory
  JointError joint_error{};
  int certificate_rounds = 0;
  double min_base_distance = kInf;  // a lower bound over the step [m]
  std::vector<BodyPair> driven_overlaps{};
  StageTimes times{};
};

/// Checks the path of a trial against the bounds within which its contacts were found (CA-5), against pairs
/// whose contacts were left out (CA-16), contacts of coarser levels (LOD-6), the certificate (CA-6), the room
/// that overlaps need (CA-17), and the tolerance of the joints, which it projects at the end of the path,
/// where all laws must have a force. `starts_apart`: is_proven_apart of the model and the state.
Judgement judge(const StepSetting& setting, const State& state, const Trial& trial, bool starts_apart);

}  // namespace aussois
