// SPDX-License-Identifier: Apache-2.0
// Writes replay.html: a run as one self-contained page that any browser plays from a disk, without a network.
#pragma once

#include <filesystem>

#include "io/run_file.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct ReplayOptions {
  int max_frames = 600;        // poses and contacts shown; more are thinned evenly, which the page says
  int max_plot_points = 4000;  // per curve; beyond that, each point keeps the worst value of its bucket
};
void describe(SettingVisitor& visit, ReplayOptions& options);

/// Writes the page atomically (see write_whole_file). Coordinates are moved near the origin before they
/// become float32. Throws std::invalid_argument for a run without steps or a bad option, std::runtime_error
/// if the page cannot be written.
void write_replay_html(const std::filesystem::path& html, const RunData& run,
                       const ReplayOptions& options = {});

/// The same for a run file; memory holds what the page shows and one block of steps, however long the run is.
/// Also throws std::runtime_error as RunReader does.
void write_replay_html(const std::filesystem::path& html, RunReader& run, const ReplayOptions& options = {});

}  // namespace aussois
