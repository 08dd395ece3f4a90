// SPDX-License-Identifier: Apache-2.0
// Repeats a take of a session and says what came of it: whether the part arrived, by how much it cleared the
// other, what the hand and the contacts exerted.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "io/run_file.hpp"
#include "io/summary.hpp"
#include "station/session.hpp"

namespace aussois {

/// Where the part should be at the end.
struct TakeGoal {
  SE3 pose{};
  double tolerance = 0;  // of its farthest point [m]
};

enum class TakeVerdict {
  ended,    // nothing was asked
  arrived,  // at the goal
  stopped,  // short of it
  blocked,  // short of it, the pull at its limit and the part at rest
  wedged,   // blocked, and no push moves it (probe_jam)
  refused,  // a step was refused
  unsolved  // a one-step problem was not solved
};
inline constexpr Named<TakeVerdict> kTakeVerdicts[] = {
    {TakeVerdict::ended, "ended"},      {TakeVerdict::arrived, "arrived"}, {TakeVerdict::stopped, "stopped"},
    {TakeVerdict::blocked, "blocked"},  {TakeVerdict::wedged, "wedged"},   {TakeVerdict::refused, "refused"},
    {TakeVerdict::unsolved, "unsolved"}};

struct TakeAssessment {
  TakeRepeat repeat{};
  std::vector<SE3> way{};  // poses of the part's mesh, at the start and at each row
  TakeVerdict verdict = TakeVerdict::ended;
  std::int64_t refused = 0, unsolved = 0;    // ticks
  double lag = 0;                            // of the farthest point behind the goal, at the end [m]
  double blocked = 0;                        // for how long, in one piece [s]
  double clearance = kInf, clearance_t = 0;  // least lower bound of the distance of the meshes [m], when [s]
  double touched = kInf;                     // first time [s]
  double hand_force = 0, hand_torque = 0;    // largest [N], [N m]
  double contact_force = 0, contact = 0;     // largest of all contacts of the part together, and of one [N]
  double work = 0, friction = 0;             // done by the hand, and taken by contacts [J]
  double length = 0, rotation = 0;           // of the way of the part's centre [m], [rad]
  double free_way = 0;                       // of a blocked part, by the best push [m]
  std::string free_push{};                   // and which: "-z", "turn +x"
};

struct AssessOptions {
  std::filesystem::path folder{};  // gets run.h5, ticks.csv, path.csv, replay.html; empty: no files
  int every = 1;                   // each n-th tick is a row
  double radius = 0;               // of the part, from its centre [m]
  double clearance = 0;            // of the parts; a push that moves one by a tenth of it frees it [m]
  std::optional<TakeGoal> goal{};
  std::function<bool(std::int64_t)> go_on{};  // asked after each tick
};

/// Throws what repeat_take throws, std::runtime_error for files.
TakeAssessment assess_take(const SessionLog& log, int take, SessionStage& stage, const RunHeader& header,
                           const AssessOptions& options);

/// A number of an assessment, as summaries, tables and files of results name it.
struct AssessmentNumber {
  const char *name = "", *what = "", *unit = "";
  bool whole = false;
  std::function<double(const TakeAssessment&)> get{};
  std::function<void(TakeAssessment&, double)> set{};
};
const std::vector<AssessmentNumber>& assessment_numbers();

void set_assessment(const TakeAssessment& assessment, Summary& summary);
nlohmann::ordered_json json_of(const TakeAssessment& assessment);
TakeAssessment assessment_in(const nlohmann::ordered_json& json);  // throws std::exception for anything else
/// One line: "arrived: least clearance 12.3 um at 0.4 s, ...".
std::string to_string(const TakeAssessment& assessment);

}  // namespace aussois
