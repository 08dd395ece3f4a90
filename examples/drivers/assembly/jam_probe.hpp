// SPDX-License-Identifier: Apache-2.0
// Is a part that is stuck wedged, or which way does it come free?
#pragma once

#include "station/session_stage.hpp"

namespace aussois {

struct JamOptions {
  double force = 100,
         torque = 5;     // of each push, a torque of no more than the force at the radius [N], [N m]
  double time = 0.1;     // for which it is pushed [s]
  double enough = 1e-5;  // way of the part's farthest point that counts as free [m]
  double radius = 0.1;   // of the part, from its centre [m]
};

/// What the best of all pushes did.
struct JamProbe {
  bool wedged = true;        // no push moved the part
  double way = 0;            // of its farthest point, followed up to twenty times `enough` [m]
  Vec6 push = Vec6::Zero();  // force and torque, both in the frame of the part, as shares of the limits
  std::string name{};        // "-z", "turn +x", "screw +z"
};

/// Lets go of copies of the present state and pushes each along and about the axes of the part: to and fro,
/// turned both ways, and screwed right-handed and left-handed, 24 in all.
JamProbe probe_jam(const SessionStage& stage, const JamOptions& options);

}  // namespace aussois
