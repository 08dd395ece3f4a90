// SPDX-License-Identifier: Apache-2.0
#include "geometry/volume_primitives.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "geometry/check.hpp"

namespace aussois {
namespace {

using Counts = std::array<int, 3>;

// A grid of cells. `inner[d]` is the plane of the grid across axis d from which tetrahedra grow in both
// directions, so that no diagonal cuts a corner of the outside there; 0: from the lowest plane upwards.
VolumeMesh grid_mesh(const Counts& n, const Counts& inner, CellKind kind,
                     const std::function<Vec3(const Counts&)>& place) {
  VolumeMesh out;
  for (int k = 0; k <= n[2]; ++k)
    for (int j = 0; j <= n[1]; ++j)
      for (int i = 0; i <= n[0]; ++i) out.points.push_back(place({i, j, k}));
  const auto index = [&](const Counts& at) { return at[0] + (n[0] + 1) * (at[1] + (n[1] + 1) * at[2]); };
  const auto add_tets = [&](const Counts& cell) {
    Counts order{0, 1, 2};
    Counts near = cell, step{1, 1, 1};
    for (int d = 0; d < 3; ++d)
      if (cell[d] < inner[d]) ++near[d], step[d] = -1;
    do {  // along the edges from the nearest corner to the farthest
      Counts at = near;
      Tet tet{index(at)};
      for (int d = 0; d < 3; ++d) {
        at[order[d]] += step[order[d]];
        tet[std::size_t(d) + 1] = index(at);
      }
      const Mat3 edges =
          (Mat3() << Vec3::Unit(order[0]), Vec3::Unit(order[1]), Vec3::Unit(order[2])).finished();
      if (edges.determinant() * step[0] * step[1] * step[2] < 0) std::swap(tet[1], tet[2]);
      out.tets.push_back(tet);
    } while (std::ranges::next_permutation(order).found);
  };
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        if (kind == CellKind::tets) {
          add_tets({i, j, k});
          continue;
        }
        const auto corner = [&](int a, int b, int c) { return index({i + a, j + b, k + c}); };
        out.hexes.push_back({corner(0, 0, 0), corner(1, 0, 0), corner(1, 1, 0), corner(0, 1, 0),
                             corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)});
      }
  return out;
}

void check_count(const char* name, int count, int least, int most) {
  require_field(count >= least && count <= most, name, count,
                ("lie in [" + std::to_string(least) + ", " + std::to_string(most) + "]").c_str());
}
void check_even(const char* name, int count) {
  check_count(name, count, 2, 256);
  require_field(count % 2 == 0, name, count, "be even");
}
void check_length(const char* name, double length) {
  require_field(length > 0 && std::isfinite(length), name, length, "be positive and finite [m]");
}

// The place in [-1, 1] of a plane of the grid.
double fraction(int at, int count) {
  return 2.0 * at / count - 1;
}

// From the cube onto the ball, or from the square onto the disc: places on one shell stay on one.
template <class Vector>
Vector rounded(const Vector& x) {
  const double far = x.cwiseAbs().maxCoeff();
  return far > 0 ? Vector(x * (far / x.norm())) : x;
}

// Makes one point of those at exactly the same place.
void weld(VolumeMesh& mesh) {
  std::map<std::array<double, 3>, int> at;
  std::vector<int> now;
  std::vector<Vec3> kept;
  for (const Vec3& x : mesh.points) {
    const auto [place, is_new] = at.try_emplace({x[0], x[1], x[2]}, int(kept.size()));
    if (is_new) kept.push_back(x);
    now.push_back(place->second);
  }
  for (Tet& t : mesh.tets)
    for (int& p : t) p = now[p];
  for (Hex& h : mesh.hexes)
    for (int& p : h) p = now[p];
  mesh.points = std::move(kept);
}

}  // namespace

VolumeMesh make_box_mesh(const Vec3& size, const std::array<int, 3>& cells, CellKind kind) {
  for (int d = 0; d < 3; ++d) {
    check_length("make_box_mesh: size", size[d]);
    check_count("make_box_mesh: cells", cells[d], 1, 1024);
  }
  return grid_mesh(cells, {}, kind, [&](const Counts& at) -> Vec3 {
    return 0.5 * size.cwiseProduct(
                     Vec3(fraction(at[0], cells[0]), fraction(at[1], cells[1]), fraction(at[2], cells[2])));
  });
}

VolumeMesh make_cylinder_mesh(double radius, double height, int around, int along, CellKind kind) {
  check_length("make_cylinder_mesh: radius", radius);
  check_length("make_cylinder_mesh: height", height);
  check_even("make_cylinder_mesh: around", around);
  check_count("make_cylinder_mesh: along", along, 1, 1024);
  return grid_mesh({around, around, along}, {around / 2, around / 2, 0}, kind, [&](const Counts& at) -> Vec3 {
    const Vec2 disc = radius * rounded(Vec2(fraction(at[0], around), fraction(at[1], around)));
    return {disc.x(), disc.y(), height / 2 * fraction(at[2], along)};
  });
}

VolumeMesh make_ball_mesh(double radius, int across, CellKind kind) {
  check_length("make_ball_mesh: radius", radius);
  check_even("make_ball_mesh: across", across);
  const int half = across / 2;
  return grid_mesh({across, across, across}, {half, half, half}, kind, [&](const Counts& at) -> Vec3 {
    return radius * rounded(Vec3(fraction(at[0], across), fraction(at[1], across), fraction(at[2], across)));
  });
}

VolumeMesh make_shell_octant_mesh(double inner, double outer, int along, int through, CellKind kind) {
  check_length("make_shell_octant_mesh: inner", inner);
  check_length("make_shell_octant_mesh: outer - inner", outer - inner);
  check_count("make_shell_octant_mesh: along", along, 1, 256);
  check_count("make_shell_octant_mesh: through", through, 1, 256);
  const auto across = [&](int at) { return at == along ? 1 : std::tan(kPi / 4 * at / along); };
  VolumeMesh out;
  for (int face = 0; face < 3; ++face) {  // of the cube: x = 1, y = 1, z = 1
    VolumeMesh part = grid_mesh({along, along, through}, {}, kind, [&](const Counts& at) -> Vec3 {
      Vec3 direction;
      direction[face] = 1;
      direction[(face + 1) % 3] = across(at[0]);
      direction[(face + 2) % 3] = across(at[1]);
      return (inner + (outer - inner) * at[2] / through) * direction.normalized();
    });
    const int first = int(out.points.size());
    for (Tet& t : part.tets)
      for (int& p : t) p += first;
    for (Hex& h : part.hexes)
      for (int& p : h) p += first;
    out.points.insert(out.points.end(), part.points.begin(), part.points.end());
    out.tets.insert(out.tets.end(), part.tets.begin(), part.tets.end());
    out.hexes.insert(out.hexes.end(), part.hexes.begin(), part.hexes.end());
  }
  weld(out);
  return out;
}

}  // namespace aussois
