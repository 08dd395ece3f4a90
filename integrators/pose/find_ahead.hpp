// SPDX-License-Identifier: Apache-2.0
// How an attempt of a step begins: what may be touched on it, what was touched before, and which contacts the
// problem begins with.
#pragma once

#include "integrators/pose/step_setting.hpp"
#include "reduction/redistribute.hpp"

namespace aussois {

/// What an attempt goes by.
struct Estimate {
  VecX v{};  // all velocities, in the places of State::v: how far bodies may move (CA-4)
  std::vector<std::pair<int, int>> meeting{};  // fast pairs that met without contacts, sorted (CA-16)
};

/// Contacts within the displacement bound of an estimated motion (CA-4), which of them the problem begins
/// with, and their impulses of the last step.
struct Found {
  VecX v_estimate{};  // all velocities, in the places of State::v
  double h = 0;
  std::vector<StepPair> pairs{};  // whose contacts are offered to the problem
  std::vector<StepPair> apart{};  // that have to show that they need none (CA-16)
  std::vector<double> reach{};    // of every body: how far it may move (CA-5) [m]
  int passing = 0;                // pairs that are near and not looked at
  int count = 0;                  // of all contacts, those of `apart` included
  double min_gap = kInf;          // of them [m]
  ContactSet contacts{};
  std::vector<SE3> g{};                       // poses of the bodies where the contacts are
  std::vector<std::array<Vec3, 2>> places{};  // StepTrace::places, if any body deforms
  Selection selection{};                      // (RED-1)
  WarmStart warm{};                           // (RED-5)
  std::vector<Vec3> start{};                  // impulses that contacts start with, world [N s] (PER-7)
  double scale = 1;                           // of the last step's impulses
  double seconds = 0;                         // that it took [s]
};
Found find_ahead(const StepSetting& setting, const State& state, const Estimate& estimate, double h);

/// The contacts of the same pairs at other poses, with the impulses of the last step.
Found found_at(const StepSetting& setting, const State& state, const Found& found, const State& at);

/// The dilations of each contact's pair, summed [m]; both are sorted by bodies.
std::vector<double> contact_dilations(const std::vector<StepPair>& pairs, const ContactSet& contacts);

}  // namespace aussois
