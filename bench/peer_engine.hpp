// SPDX-License-Identifier: Apache-2.0
// An engine of rigid bodies, ours or a peer, as bench_dynamics sees it: it takes a scene, steps, and tells
// where the bodies are.
#pragma once

#include <functional>
#include <optional>

#include "examples/scenes/peer_scenes.hpp"

namespace aussois {

/// A scene that an engine has taken in. Owns everything; gone with the last copy.
struct EngineRun {
  std::function<void()> step{};  // by the h that the run was started with
  std::function<PeerSample()> sample{};
};

struct PeerEngine {
  std::string name{};
  /// Nothing if the engine cannot run the scene.
  std::function<std::optional<EngineRun>(const PeerScene&, double h)> start{};
};

// All of them with their defaults, sleeping off, double precision.
PeerEngine aussois_engine();
PeerEngine bullet_engine();  // sequential impulses, 10 sweeps; hulls moved in by the margin
PeerEngine ode_engine();  // QuickStep, 20 sweeps, friction pyramid; no hulls: its collider aborts on arches
PeerEngine mujoco_engine();  // Newton, elliptic cones; restitution by a spring of ten steps contact time

/// Ours first, then the peers that were there when this was configured.
std::vector<PeerEngine> engines();

}  // namespace aussois
