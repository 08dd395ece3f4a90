// SPDX-License-Identifier: Apache-2.0
// A simulated hand pushes a part against what is in its way: how much energy does it get beyond what
// was stored? (doc/theory/ports.md)
#pragma once

#include <functional>

#include "ports/simulated_hand.hpp"

namespace aussois {

enum class HapticScene {
  wall,   // a cube against a plate
  slot,   // a square peg in a tight square hole, with friction
  wedge,  // the same peg between two slopes, with friction
};
inline constexpr Named<HapticScene> kHapticScenes[] = {
    {HapticScene::wall, "wall"}, {HapticScene::slot, "slot"}, {HapticScene::wedge, "wedge"}};

/// Where the force on the hand comes from.
enum class HapticWay {
  held,          // the pull at the end of the last step of the bodies
  held_reserve,  // the same, through the valve (PORT-4)
  local,         // the local model (PORT-5)
  reserve        // the same, through the valve
};
inline constexpr Named<HapticWay> kHapticWays[] = {{HapticWay::held, "held"},
                                                   {HapticWay::held_reserve, "held_reserve"},
                                                   {HapticWay::local, "local"},
                                                   {HapticWay::reserve, "reserve"}};

struct HapticTrial {
  HapticScene scene = HapticScene::wall;
  HandKind hand = HandKind::soft;
  HapticWay way = HapticWay::reserve;
  double stiffness = 2e3;  // of the port [N/m]
  int every = 1;           // samples of the device for one step of the bodies
  int late = 0;            // samples by which the force on the hand is late
  int pushes = 300;
  std::uint64_t seed = 7;
  ReserveOptions reserve{};
  SimulatedDeviceOptions device{};
};

struct HapticResult {
  // The largest of what left between any two times beyond what was stored at the first [J]: by the encoders,
  // and in truth
  double excess = 0, true_excess = 0;
  double given = 0;       // to the hand in all; negative: it worked [J]
  double changed = 0;     // part of the samples whose force the valve changed [-]
  double force_left = 1;  // of the force, root of mean squares [-]
  double peak = 0;        // force on the hand [N]
  std::int64_t samples = 0, steps = 0, unsolved = 0;
  std::int64_t beyond = 0;  // samples in which the handle was faster than the bounds of the reserve
  std::int64_t events = 0;  // times at which the part met or left what was in its way
  bool flew_off = false;    // the handle
  bool refused = false;     // a step of the bodies
};
/// `go_on(pushes)` returning false ends it early.
HapticResult haptic_trial(const HapticTrial& trial, const std::function<bool(std::int64_t)>& go_on = {});

}  // namespace aussois
