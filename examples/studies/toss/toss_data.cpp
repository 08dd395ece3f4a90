// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/toss/toss_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "geometry/so3.hpp"
#include "io/csv_table.hpp"
#include "io/number_table.hpp"

namespace aussois {
namespace {

const std::vector<std::string> kColumns = {"t_s",    "px_m",     "py_m",     "pz_m",    "qw",
                                           "qx",     "qy",       "qz",       "vx_mps",  "vy_mps",
                                           "vz_mps", "wx_radps", "wy_radps", "wz_radps"};

// Of the parabola with the known gravity that fits heights best, at the last of them.
double fitted_fall(const std::vector<double>& t, const std::vector<double>& z) {
  double mean_t = 0, mean_y = 0, tt = 0, ty = 0;
  const auto straight = [&](std::size_t i) { return z[i] + kTossGravity / 2 * t[i] * t[i]; };
  for (std::size_t i = 0; i < t.size(); ++i) {
    mean_t += t[i] / double(t.size());
    mean_y += straight(i) / double(t.size());
  }
  for (std::size_t i = 0; i < t.size(); ++i) {
    tt += (t[i] - mean_t) * (t[i] - mean_t);
    ty += (t[i] - mean_t) * (straight(i) - mean_y);
  }
  return ty / tt - kTossGravity * t.back();
}

}  // namespace

Toss read_toss(const std::filesystem::path& path) {
  const NumberTable table = read_number_table(path);
  std::array<std::size_t, 14> at{};
  for (std::size_t i = 0; i < at.size(); ++i) at[i] = column_of(table, kColumns[i], path);
  Toss toss{.name = path.stem().string()};
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error(path.string() + ": row " + std::to_string(toss.t.size() + 1) + ": " + what);
  };
  for (const std::vector<double>& row : table.rows) {
    const auto value = [&](std::size_t i) { return row[at[i]]; };
    if (!toss.t.empty() && !(value(0) > toss.t.back()))
      fail("t_s = " + std::to_string(value(0)) + " must be greater than in the row before");
    toss.t.push_back(value(0));
    SE3 g = pose_in(table, toss.pose.size(), {at[1], at[2], at[3], at[4], at[5], at[6], at[7]}, path);
    g.R.normalize();
    toss.pose.push_back(g);
    toss.twist.emplace_back(value(8), value(9), value(10), value(11), value(12), value(13));
  }
  if (toss.t.size() < 2) fail("rows = " + std::to_string(toss.t.size()) + " must be at least 2");
  return toss;
}

std::vector<Toss> read_tosses(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder))
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (const std::string name = entry.path().filename().string();
          name.starts_with("toss_") && name.ends_with(".csv"))
        files.push_back(entry.path());
  if (files.empty()) throw std::runtime_error(folder.string() + ": contains no file toss_*.csv");
  std::ranges::sort(files);
  std::vector<Toss> tosses;
  for (const std::filesystem::path& file : files) tosses.push_back(read_toss(file));
  return tosses;
}

void write_toss(const std::filesystem::path& folder, const Toss& toss) {
  CsvTable csv(folder / (toss.name + ".csv"), kColumns);
  for (std::size_t k = 0; k < toss.t.size(); ++k) {
    const Vec3& p = toss.pose[k].p;
    const Quat& R = toss.pose[k].R;
    const Vec6& v = toss.twist[k];
    csv.add({toss.t[k], p.x(), p.y(), p.z(), R.w(), R.x(), R.y(), R.z(), v[0], v[1], v[2], v[3], v[4], v[5]});
  }
  csv.close();
}

Toss scaled_toss(Toss toss, double factor) {
  for (SE3& g : toss.pose) g.p *= factor;
  for (Vec6& v : toss.twist) v.head<3>() *= factor;
  return toss;
}

TossStart start_of(const Toss& toss) {
  const auto low =
      std::ranges::find_if(toss.pose, [](const SE3& g) { return g.p.z() <= std::sqrt(3.0) / 2 * kTossEdge; });
  const std::ptrdiff_t first = std::max(low - toss.pose.begin() - 3, std::ptrdiff_t(0));
  const auto k = std::size_t(std::min(first, std::ptrdiff_t(toss.pose.size()) - 2));
  TossStart out{.row = k, .pose = toss.pose[k], .twist = toss.twist[k]};
  if (k < 4) return out;
  const double flight = toss.t[k - 1] - toss.t[0];
  out.twist.head<3>() = (toss.pose[k - 1].p - toss.pose[0].p) / flight;
  std::vector<double> t, z;
  for (std::size_t i = 0; i < k; ++i) {
    t.push_back(toss.t[i] - toss.t[0]);
    z.push_back(toss.pose[i].p.z());
  }
  out.twist[2] = fitted_fall(t, z);
  out.twist.tail<3>() =
      log_so3((toss.pose[0].R.conjugate() * toss.pose[k].R).normalized()) / (toss.t[k] - toss.t[0]);
  return out;
}

}  // namespace aussois
