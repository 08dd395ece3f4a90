// SPDX-License-Identifier: Apache-2.0
// A toss simulated from its start, and how far that is from what was recorded (TOSS-2), (TOSS-3).
#pragma once

#include <functional>

#include "examples/common/run_watch.hpp"
#include "examples/studies/toss/toss_data.hpp"
#include "integrators/scheme.hpp"

namespace aussois {

/// `describe` gives the ranges.
struct TossWorld {
  ContactLaw law{.mu = 0.18};  // of cube and board
  int substeps = 10;           // of every row
  double board = 0;            // height of the board's surface [m]
  // The cube's corners are cut off so far along its edges [m]: faces are octagons then, on which it lies with
  // eight contacts
  double cut = 0;
  std::string scheme = "moreau_jean";
  SchemeOptions options{};  // but for h
};
void describe(SettingVisitor& visit, TossWorld& world);  // all but the scheme and its options

/// Cube and board as dilated complexes; bodies 0 and 1.
Model toss_model(const TossWorld& world);

struct TossErrors {
  double position = 0;  // mean over time of |dp| [m]
  double rotation = 0;  // mean over time of the angle between the two orientations [rad]
  double loss = 0;      // mean over time of |dp|^2 / (edge / 2) + angle^2, in m and rad as published
};

struct TossRun {
  std::size_t start = 0;    // row of the toss
  std::vector<SE3> pose{};  // of the cube at rows start, start + 1, ...
  std::vector<Vec6> twist{};
  std::vector<int> contacts{};  // the most of a step up to that row
  TossErrors errors{};
  int steps = 0, most_contacts = 0;
  int reduced_steps = 0;  // in which fewer contacts were kept than found
  double lifted = 0;      // the recorded start was below the board by this, and raised by it [m]
  std::string failure{};  // empty: every step was taken and solved
  RunAudit audit{};       // by the watch
};
/// From start_of(toss), or from `start`. A step that is refused or not solved ends the run: its errors are
/// then over the rows that were reached. `look` sees every step and the state after it.
using LookAtStep = std::function<void(const State&, const StepReport&)>;
TossRun roll_out(const Toss& toss, const TossStart& start, const TossWorld& world,
                 const LookAtStep& look = {}, const WatchFlags& watch = {}, const std::string& name = {});
TossRun roll_out(const Toss& toss, const TossWorld& world);
/// The same, audited; files of its problems have names that begin with `name`.
TossRun roll_out(const Toss& toss, const TossWorld& world, const WatchFlags& watch, const std::string& name);

/// A toss that never happened: thrown by seeded random numbers in the range of the recorded ones, moved by
/// the kernel, then measured with noise of `noise` [m] and `noise` / (edge / 2) [rad].
Toss synthetic_toss(unsigned seed, const TossWorld& world, double noise);

}  // namespace aussois
