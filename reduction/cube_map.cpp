// SPDX-License-Identifier: Apache-2.0
#include "reduction/cube_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include <Eigen/Geometry>

#include "geometry/settings.hpp"

namespace aussois {
namespace {

constexpr double kBeyond = 1.1;  // half widths from a cell's centre to a point inside its neighbour, on this
                                 // face or, seen through its edge, on the next

// Face and cell of any direction but zero.
int cell_of(const Vec3& d, const CubeMapOptions& o) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(d[k]) > std::abs(d[axis])) axis = k;
  const auto cell = [&](double x) {
    const double u = x / std::abs(d[axis]);
    const double place = (o.equi_angular ? 4 / kPi * std::atan(u) : u) + 1;
    return std::clamp(int(std::floor(place / 2 * o.cells)), 0, o.cells - 1);
  };
  const int face = 2 * axis + (d[axis] < 0 ? 1 : 0);
  return (face * o.cells + cell(d[(axis + 2) % 3])) * o.cells + cell(d[(axis + 1) % 3]);  // (CLU-1)
}

// The point (u, v) of a cell's face, in the numbers that its cells divide evenly.
Vec3 direction_at(int cell, double u, double v, bool equi_angular, int cells) {
  const int face = cell / (cells * cells), axis = face / 2;
  const auto place = [&](double x) { return equi_angular ? std::tan(kPi / 4 * x) : x; };
  Vec3 d = Vec3::Zero();
  d[axis] = face % 2 ? -1 : 1;
  d[(axis + 1) % 3] = place(u);
  d[(axis + 2) % 3] = place(v);
  return d;
}

std::array<int, 8> neighbours(int cell, const CubeMapOptions& o) {
  const double half = 1.0 / o.cells;
  const double u = (2 * (cell % o.cells) + 1) * half - 1, v = (2 * (cell / o.cells % o.cells) + 1) * half - 1;
  std::array<int, 8> out{};
  std::size_t next = 0;
  for (const int du : {-1, 0, 1})
    for (const int dv : {-1, 0, 1})
      if (du != 0 || dv != 0)
        out[next++] = cell_of(
            direction_at(cell, u + kBeyond * half * du, v + kBeyond * half * dv, o.equi_angular, o.cells), o);
  return out;
}

}  // namespace

void describe(SettingVisitor& visit, CubeMapOptions& o) {
  visit.begin("CubeMapOptions");
  visit.count({"cells", "number of cells per edge of the cube", "", {1, 1024}}, o.cells);
  visit.toggle({"equi_angular", "use cells of about the same solid angle"}, o.equi_angular);
  visit.number({"merge",
                "largest angle between directions of neighbouring cells to merge; 0: never merge",
                "rad",
                {0, kPi / 2}},
               o.merge);
}

void validate(const CubeMapOptions& options) {
  check_ranges(options);
}

int cube_cell(const Vec3& direction, const CubeMapOptions& options) {
  validate(options);
  require(std::abs(direction.norm() - 1) <= 1e-6, "cube_cell: the direction must have unit length (1e-6)");
  return cell_of(direction, options);
}

CubeMap cube_map(std::span<const Vec3> directions, const CubeMapOptions& options) {
  std::vector<int> cell;
  for (const Vec3& d : directions) cell.push_back(cube_cell(d, options));
  std::vector<int> used = cell;  // ascending
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  const auto index_of = [&](int c) {
    const auto at = std::lower_bound(used.begin(), used.end(), c);
    return at != used.end() && *at == c ? int(at - used.begin()) : -1;
  };
  std::vector<Vec3> sum(used.size(), Vec3::Zero());
  for (std::size_t i = 0; i < cell.size(); ++i) sum[index_of(cell[i])] += directions[i];

  std::vector<int> group(used.size());  // lower or equal; itself for the first of a group
  std::iota(group.begin(), group.end(), 0);
  const auto root = [&](int i) {
    while (group[i] != i) i = group[i];
    return i;
  };
  if (options.merge > 0)
    for (int i = 0; i < int(used.size()); ++i)
      for (const int c : neighbours(used[i], options)) {
        const int j = index_of(c);
        if (j < 0) continue;
        const Vec3 &a = sum[i], &b = sum[j];
        if (std::atan2(a.cross(b).norm(), a.dot(b)) > options.merge) continue;
        const int r = root(i), s = root(j);
        group[std::max(r, s)] = std::min(r, s);
      }
  CubeMap out;
  std::vector<int> number(used.size(), -1);
  for (int i = 0; i < int(used.size()); ++i) number[i] = root(i) == i ? out.groups++ : number[root(i)];
  for (const int c : cell) out.label.push_back(number[index_of(c)]);
  return out;
}

}  // namespace aussois
