// SPDX-License-Identifier: Apache-2.0
// The page that says what came of a take: report.html, beside the files of assess_take.
#pragma once

#include <string>
#include <vector>

#include "examples/drivers/assembly/assess_take.hpp"

namespace aussois {

/// What is asked of a way; zero and infinity ask nothing.
struct AssessBounds {
  double clearance_min = 0, clearance_max = kInf;  // of the meshes [m]
  double force_max = kInf;                         // of hand and contacts [N]
};
/// Time of the take with its clearance below, within and above the bounds, and with a force above [s].
struct AssessBands {
  double below = 0, within = 0, above = 0, forced = 0;
};
/// From ticks.csv of the folder. Throws std::runtime_error for a file that cannot be read.
AssessBands bands_in(const std::filesystem::path& folder, const AssessBounds& bounds);

struct ReportText {
  std::string title{}, command_line{}, build{};
  std::vector<SessionMark> marks{};
  double tick = 0;  // [s]
};
/// Curves are drawn by gnuplot; without it the page says so. Throws std::runtime_error for files.
void write_report(const std::filesystem::path& folder, const TakeAssessment& assessment,
                  const AssessBounds& bounds, const ReportText& text);

}  // namespace aussois
