// SPDX-License-Identifier: Apache-2.0
// The interface of bench_dynamics to an engine of rigid bodies, ours or a peer: it takes a scene, steps, and
// returns the poses of the bodies.
#pragma once

#include <functional>
#include <optional>

#include "examples/scenes/peer_scenes.hpp"

namespace aussois {

/// A scene inside an engine. Owns everything; deleted with the last copy.
struct EngineRun {
  std::function<void()> step{};  // by the h that the run was started with
  std::function<PeerSample()> sample{};
};

struct PeerEngine {
  std::string name{};
  /// Nothing if the engine cannot run the scene.
  std::function<std::optional<EngineRun>(const PeerScene&, double h)> start{};
};

/// A peer with its defaults, or tuned for accuracy.
struct PeerTuning {
  int steps = 1;       // of its own in each step of the scene
  int iterations = 1;  // of its solver, times its default
};
inline constexpr PeerTuning kTuned{.steps = 10, .iterations = 10};

// All of them without sleeping, in double precision; tuned ones are called NAME+.
PeerEngine aussois_engine();
PeerEngine bullet_engine(const PeerTuning& tuning = {});  // sequential impulses, 10 sweeps; hulls moved in by
                                                          // the margin
PeerEngine ode_engine(const PeerTuning& tuning = {});     // QuickStep, 20 sweeps, friction pyramid; no hulls:
                                                          // its collider aborts on arches
PeerEngine mujoco_engine(const PeerTuning& tuning = {});  // Newton, 100 iterations at most, elliptic cones;
                                                          // restitution by a spring of ten steps contact time
std::string peer_name(const char* name, const PeerTuning& tuning);

/// Ours first, then the peers found at configuration, each with its defaults and tuned.
std::vector<PeerEngine> engines();

}  // namespace aussois
