// SPDX-License-Identifier: Apache-2.0
// Recorded tosses of a cube onto a board, and where a roll-out of one begins (TOSS-1).
// Data: [Pfrommer2020]; protocol: [Acosta2022].
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

inline constexpr double kTossEdge = 0.1048;       // of the cube [m]
inline constexpr double kTossMass = 0.37;         // [kg]
inline constexpr double kTossInertia = 8.1e-4;    // about every axis [kg m^2]
inline constexpr double kTossGravity = 9.81;      // [m/s^2]
inline constexpr double kTossScaleError = 0.978;  // measured lengths over true ones, as the data show

struct Toss {
  std::string name{};         // of its file, without the extension
  std::vector<double> t{};    // ascending, evenly spaced [s]
  std::vector<SE3> pose{};    // of the cube's centre in the frame of the board: z up, surface at z = 0
  std::vector<Vec6> twist{};  // v of the centre in the board's frame [m/s], omega in the cube's [rad/s]
};

/// Throws std::runtime_error "path:line: what" for a file that read_number_table refuses, a missing column,
/// fewer than two rows, times that do not ascend, or a quaternion that is not unit (1e-6).
Toss read_toss(const std::filesystem::path& path);
/// All files toss_*.csv of a folder, by name. Throws std::runtime_error if there is none.
std::vector<Toss> read_tosses(const std::filesystem::path& folder);
/// Writes toss.name + ".csv" into the folder, in the same columns.
void write_toss(const std::filesystem::path& folder, const Toss& toss);

/// Positions and velocities multiplied by `factor`.
Toss scaled_toss(Toss toss, double factor);

struct TossStart {
  std::size_t row = 0;  // the first one that is simulated and compared
  SE3 pose{};
  Vec6 twist = Vec6::Zero();
};
/// Three rows before a corner can reach the board, with velocities fitted to the flight before (TOSS-1).
TossStart start_of(const Toss& toss);

}  // namespace aussois
