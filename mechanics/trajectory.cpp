// SPDX-License-Identifier: Apache-2.0
#include "mechanics/trajectory.hpp"

#include <algorithm>

#include "geometry/check.hpp"

namespace aussois {

void validate(const Trajectory& path) {
  require(path.t.size() >= 2, "path: " + std::to_string(path.t.size()) + " rows must be at least 2");
  require(path.t.size() == path.pose.size(), "path: " + std::to_string(path.t.size()) + " times for " +
                                                 std::to_string(path.pose.size()) + " poses");
  for (std::size_t i = 0; i < path.t.size(); ++i) {
    const std::string row = "path row " + std::to_string(i);
    require_field(std::isfinite(path.t[i]), (row + ": t").c_str(), path.t[i], "be finite");
    if (i > 0)
      require_field(path.t[i] > path.t[i - 1], (row + ": t").c_str(), path.t[i],
                    "exceed the time of the row before");
    checked_pose(path.pose[i], (row + ": pose").c_str());
  }
}

TrajectoryPoint trajectory_point(const Trajectory& path, double t) {
  AUSSOIS_ASSERT(path.t.size() >= 2 && path.t.size() == path.pose.size());
  const auto at_rest = [](const SE3& g) { return TrajectoryPoint{.pose = {g.R.normalized(), g.p}}; };
  if (t < path.t.front()) return at_rest(path.pose.front());
  if (t > path.t.back()) return at_rest(path.pose.back());

  const auto next =
      std::upper_bound(path.t.begin() + 1, path.t.end() - 1, t);  // a row's own time: the segment it begins
  const std::size_t j = std::size_t(next - path.t.begin()), i = j - 1;
  const double duration = path.t[j] - path.t[i];
  const double s = (t - path.t[i]) / duration;
  const Quat R_i = path.pose[i].R.normalized(), R_j = path.pose[j].R.normalized();
  const Vec3 p_i = path.pose[i].p, p_j = path.pose[j].p;
  const Vec3 phi = log_so3(R_i.conjugate() * R_j);

  TrajectoryPoint point;  // (TRJ-1)
  point.pose.p = (1 - s) * p_i + s * p_j;
  point.pose.R = (R_i * exp_so3(s * phi)).normalized();
  point.twist << (p_j - p_i) / duration, phi / duration;
  return point;
}

Trajectory path_of_attached_frame(const Trajectory& path, const SE3& g_old_new) {
  Trajectory result = path;
  for (SE3& pose : result.pose) pose = pose * g_old_new;
  return result;
}

}  // namespace aussois
