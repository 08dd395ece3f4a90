// SPDX-License-Identifier: Apache-2.0
// Reads recorded poses: CSV, what planners write (OMPL's .path: x y z qx qy qz qw between blanks, no header),
// and NumPy's .npy (doubles of shape (poses, 7): x y z qw qx qy qz); writes them as CSV. A header names the
// columns x, y, z, qw, qx, qy, qz, and t if the poses have times, in any order. Other columns (index,
// remarks) are skipped, and so are lines that are empty or begin with #. A row is the pose g_ab of a moving
// frame b seen from a: x_a = R(q) x_b + p, quaternion scalar part qw.
#pragma once

#include <filesystem>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

struct PoseFile {
  std::vector<double> t{};  // ascending [s]; empty if the file has no column t
  std::vector<SE3> pose{};  // [m] if `scale` was metres per unit of the file; R is unit and stays in one
                            // hemisphere: no quaternion has a negative dot product with the one before
  std::vector<int> line{};  // line of the file; write_poses ignores it
};

/// Reads at least two poses and multiplies positions by `scale`. Throws std::runtime_error "path:line: what"
/// for a missing file or column, a field that is not a finite number, | |q| - 1 | > 1e-6, times that do not
/// ascend strictly; std::invalid_argument unless scale is finite and > 0.
PoseFile read_poses(const std::filesystem::path& path, double scale);

/// Writes index, t (if there are times), x, ..., qz with positions divided by `scale`, under a temporary name
/// that is then renamed. Throws std::invalid_argument if times are given but not for every pose.
void write_poses(const std::filesystem::path& path, const PoseFile& poses, double scale);

}  // namespace aussois
