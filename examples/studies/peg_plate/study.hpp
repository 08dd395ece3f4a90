// SPDX-License-Identifier: Apache-2.0
// The peg-and-plate study of [Kim2019] on the synthetic reference: data, lessons, scores, verdicts (PEG-15).
#pragma once

#include "examples/studies/peg_plate/labels.hpp"
#include "examples/studies/peg_plate/methods.hpp"
#include "examples/studies/peg_plate/plant.hpp"
#include "examples/studies/peg_plate/training.hpp"
#include "examples/studies/peg_plate/training_check.hpp"

namespace aussois {

/// `describe` gives the ranges.
struct PegStudyOptions {
  PlantOptions plant{};
  SolverView view{};
  TrainingOptions training{};
  int static_stride = 5;   // of the static samples of a case that one trains on
  int moving_stride = 10;  // of the others
  int moving_scored = 8;   // of the others that are scored
  int dear_stride = 5;     // of those for methods that are dear
  bool tilted = false;     // train besides on as many cases on plates tilted at random (surface only)
  int threads = 1;         // no result depends on it
};
void describe(SettingVisitor& visit, PegStudyOptions& options);

/// The sets of the study: surface with plate tilts of 0.1, 0.3 and 0 degrees, edge with 0.1 and 0.3.
struct PegSet {
  std::string name{};
  PegScenario scenario = PegScenario::surface;
  double tilt = 0, scatter = 0;  // [deg]
};
const std::vector<PegSet>& peg_sets();

/// Cases of a study, those on tilted plates after all others; and what one of them gives.
int case_count(const PegStudyOptions& options);
std::vector<PegSample> peg_samples(const PegStudyOptions& options, int index);

using PegData = std::vector<std::vector<PegSample>>;  // by case
PegData generate(const PegStudyOptions& options);

/// 70 of 100 cases to train on, the rest to test; by case, since neighbouring milliseconds are the same
/// sample. Cases on tilted plates are to train on.
struct PegSplit {
  std::vector<int> train{}, test{};  // ascending
};
PegSplit split_cases(int cases, std::uint64_t seed);
PegSplit split_cases(const PegStudyOptions& options);

/// What there is to learn from the training cases.
struct Lessons {
  MatX X{};       // inputs x samples
  MatX errors{};  // choices x samples (PEG-9)
};
Lessons make_lessons(const PegData& data, const PegSplit& split, const PegStudyOptions& options,
                     const std::function<void(double)>& progress = {});  // hears of the part done
Training train(const Lessons& lessons, LabelMode mode, const PegStudyOptions& options,
               const std::function<bool(int, double)>& progress = {});

/// What lessons tell besides.
struct LessonsLearnt {
  int best_choice = 0;       // the first of the ranking
  double upright_share = 0;  // of the upright normal among the argmin labels; of edge sets
};
LessonsLearnt learnt_from(const Lessons& lessons, PegScenario scenario);

/// All of (PEG-14); `networks` in the order of kLabelModes.
std::vector<NamedMethod> all_methods(const PegStudyOptions& options, const LessonsLearnt& learnt,
                                     const std::vector<Network>& networks);

/// Errors relative to the plate's force; rms over all samples of the test cases (PEG-16).
struct PegScore {
  std::string name{};
  double still_size = 0, still = 0;    // static samples: of |F|, of F as a vector [-]
  double moving_size = 0, moving = 0;  // the others
  double chatter = 0;  // mean |change of F - change of F_e| of neighbouring static samples [N]
  double case_mean = 0, case_worst = 0;  // of the rms of |F| over the static samples of each case
};
PegScore score(const NamedMethod& method, const PegData& data, const std::vector<int>& cases,
               const PegStudyOptions& options);

/// One line of the verdict.
struct PegVerdict {
  std::string what{};  // "A-1 full, static size"
  double value = 0, bound = 0;
  bool at_least = false;  // else at most
  int needed = 0, met = 0, seeds = 0;
  bool accepted() const { return met >= needed; }
};

/// Scores of one set and seed.
struct PegResult {
  std::string set{};
  std::uint64_t seed = 0;
  std::vector<PegScore> scores{};
  double upright_share = 0;  // LessonsLearnt's
};
/// Of the scores only: all methods on the test cases. `progress` gets what is scored next, from any
/// thread; if it returns false, no more is scored.
std::vector<PegScore> score_all(const std::vector<NamedMethod>& methods, const PegData& data,
                                const PegStudyOptions& options,
                                const std::function<bool(const std::string&)>& progress = {});
/// A-1 to A-5 (PEG-17) of all that is there; `value` is the worst of all seeds.
std::vector<PegVerdict> verdicts(const std::vector<PegResult>& results,
                                 const std::vector<TrainingCheck>& checks);

/// Markdown, percentages as mean over seeds (and the largest).
std::string score_table(const std::vector<PegResult>& results);
std::string to_string(const std::vector<PegVerdict>& verdicts);

/// `options` with scenario, tilt and scatter of the set.
PegStudyOptions options_for(const PegSet& set, PegStudyOptions options);
/// The whole of one set in memory; one seed for plant, split and first weights.
PegResult run_study(const PegSet& set, const PegStudyOptions& options);

}  // namespace aussois
