// SPDX-License-Identifier: Apache-2.0
#include "integrators/energy_gain.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>

#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

double stored(const Model& model, const State& state, const Energy& now) {
  return now.kinetic + now.gravity + spring_energy(model, state);
}

// What came from outside in a step: all work of laws, joints and contacts but that of those which can only
// take, and of springs, whose energy is stored. Forces of coordinates hold what their masses make of it.
double given(const Model& model, const StepReport& report) {
  const EnergyLedger& e = report.energy;
  double out = e.law_work + e.joint_work + e.contact_work;
  if (!model.coordinates.empty()) out += e.gyroscopic_work;
  for (const StepJoint& joint : report.joints) {
    const JointWork& w = joint.work;
    out -= w.locked + w.couplings + w.stops + w.friction + w.springs;
  }
  return std::accumulate(report.law_work.begin(), report.law_work.end(), out, std::minus<>());
}

}  // namespace

EnergyGain energy_gain(const Model& model, const State& start) {
  const Energy now = energy(model, start);
  return {.stored = stored(model, start, now), .kinetic = now.kinetic};
}

void add(const Model& model, const State& state, const StepReport& report, EnergyGain& gain) {
  const Energy now = energy(model, state);
  const double before = std::exchange(gain.stored, stored(model, state, now));
  gain.above = std::max(0.0, gain.above + gain.stored - before - given(model, report));
  gain.largest = std::max(gain.largest, gain.above);
  const double mass =
      std::accumulate(model.bodies.begin(), model.bodies.end(), 0.0,
                      [](double sum, const RigidBody& b) { return is_dynamic(b) ? sum + b.mass : sum; });
  gain.kinetic = std::max({gain.kinetic, now.kinetic, mass * (report.h * model.gravity).squaredNorm() / 2});
}

}  // namespace aussois
