// SPDX-License-Identifier: Apache-2.0
// Begins an attempt of a step: finds what it may touch, recalls what touched before, and selects the contacts
// that the problem begins with.
#pragma once

#include <map>

#include "integrators/pose/stage_clock.hpp"
#include "integrators/pose/step_setting.hpp"
#include "reduction/redistribute.hpp"

namespace aussois {

/// What an attempt is based on.
struct Estimate {
  VecX v{};                         // all velocities, indexed as State::v: how far bodies may move (CA-4)
  std::vector<BodyPair> meeting{};  // fast pairs that met without contacts, sorted (CA-16)
  std::map<BodyPair, double> fine_to{};  // StepPair::fine_to of pairs whose levels met (LOD-6)
};

/// Contacts within the displacement bound of an estimated motion (CA-4), which of them the problem begins
/// with, and their impulses of the last step.
struct FoundContacts {
  VecX v_estimate{};  // all velocities, indexed as State::v
  double h = 0;
  std::vector<StepPair> pairs{};  // pairs whose contacts are offered to the problem
  std::vector<StepPair> apart{};  // pairs that must prove to need no contacts (CA-16)
  PerBody<double> reach{};        // of every body: how far it may move (CA-5) [m]
  int passing = 0;                // number of pairs that are near but skipped
  int count = 0;                  // number of all contacts, including those of `apart` and of levels
  int coarse_count = 0;           // those of them that are of levels
  double min_gap = kInf;          // smallest gap of these contacts [m]
  ContactSet contacts{};
  ContactSet guards{};  // contacts of coarser levels, which must not close in the step (LOD-6)
  PerBody<SE3> g{};     // poses of the bodies where the contacts are
  std::vector<std::array<Vec3, 2>> places{};  // StepTrace::places, if any body deforms
  Selection selection{};                      // (RED-1)
  WarmStart warm{};                           // (RED-5)
  std::vector<Vec3> start{};                  // impulses that contacts start with, world [N s] (PER-7)
  double scale = 1;                           // factor for the last step's impulses: h over the last h
  StageTimes times{};
};
FoundContacts find_ahead(const StepSetting& setting, const State& state, const Estimate& estimate, double h);

/// The contacts of the same pairs at other poses, with the impulses of the last step.
FoundContacts found_at(const StepSetting& setting, const State& state, const FoundContacts& found,
                       const State& at);

/// The gap of a contact at `at` after the time `h` with the velocities `v`, laid out as State::v, as its
/// normal sees it [m].
double gap_ahead(const Model& model, const State& at, const ContactPoint& contact, const VecX& v, double h);

/// The sum of the dilations of the pair of each contact [m]; both arguments are sorted by bodies.
std::vector<double> contact_dilations(const std::vector<StepPair>& pairs, const ContactSet& contacts);

}  // namespace aussois
