// SPDX-License-Identifier: Apache-2.0
// A scene of the peers run by Moreau-Jean, judged after every step; every step must be accepted and solved.
#pragma once

#include <gtest/gtest.h>

#include "examples/scenes/peer_scenes.hpp"

namespace aussois {

struct PeerRun {
  double error = 0, worst = 0, fall_time = kInf;
  double sunk = 0;         // of the stone or body `watched`: how far it went down [m]
  double energy_gain = 0;  // largest energy of a step over the one before [J]
  int steps = 0;
};

/// Ends early when a body has fallen.
inline PeerRun run_peer_scene(const PeerScene& scene, const MoreauJeanOptions& options, double t_end,
                              int watched = 1) {
  KernelScene k = kernel_scene(scene);
  const MoreauJean scheme(k.model, options);
  PeerJudge judge(scene);
  judge.see(sample(k.state));
  PeerRun run;
  const double height = pose(k.state, watched).p.z();
  double before = energy(k.model, k.state).total();
  for (; k.state.t < t_end - options.h / 2 && judge.fall_time() == kInf; ++run.steps) {
    const StepReport report = scheme.step(k.state);
    EXPECT_TRUE(report.ok()) << scene.name << " at " << k.state.t << " s: " << report.reason;
    if (!report.ok()) break;
    judge.see(sample(k.state));
    const double now = energy(k.model, k.state).total();
    run.energy_gain = std::max(run.energy_gain, now - before);
    before = now;
    run.sunk = std::max(run.sunk, height - pose(k.state, watched).p.z());
  }
  run.error = judge.error();
  run.worst = judge.worst();
  run.fall_time = judge.fall_time();
  return run;
}

}  // namespace aussois
