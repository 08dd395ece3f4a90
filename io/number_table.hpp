// SPDX-License-Identifier: Apache-2.0
// Reads measured data from text: a header line that names the columns, then rows of finite numbers,
// comma-separated.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

struct NumberTable {
  std::vector<std::string> columns{};
  std::vector<std::vector<double>> rows{};  // each as long as `columns`
};

/// Throws std::runtime_error "path:line: what" for a missing or empty file, a column that is named twice, a
/// row of another length, or a field that is not a finite number. Lines that are empty or begin with # are
/// skipped.
NumberTable read_number_table(const std::filesystem::path& path);

/// The index of a column; throws std::runtime_error naming the file, the column and the columns that exist.
std::size_t column_of(const NumberTable& table, const std::string& name, const std::filesystem::path& path);

/// The pose in the columns of px, py, pz, qw, qx, qy and qz, as it stands; throws std::runtime_error naming
/// the file, the row, counted from 1, and what checked_pose refuses.
SE3 pose_in(const NumberTable& table, std::size_t row, const std::array<std::size_t, 7>& columns,
            const std::filesystem::path& path);

}  // namespace aussois
