// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/swept_volume.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "geometry/surface_tree.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// How far vertices go from each pose to its neighbours: half of that is where the part may be between them.
std::vector<double> half_ways(const SimplicialComplex& solid, const std::vector<SE3>& poses) {
  std::vector<double> out(poses.size(), 0);
  for (std::size_t k = 1; k < poses.size(); ++k) {
    double way = 0;
    for (const Vec3& v : solid.vertices) way = std::max(way, (poses[k] * v - poses[k - 1] * v).norm());
    out[k - 1] = std::max(out[k - 1], way / 2), out[k] = std::max(out[k], way / 2);
  }
  return out;
}

Vec3 centre_of(const SweptVolume& grid, std::size_t i) {
  const auto nx = std::size_t(grid.cells[0]), ny = std::size_t(grid.cells[1]);
  const std::size_t x = i % nx, y = i / nx % ny, z = i / (nx * ny);
  return grid.corner + grid.cell * (Vec3(double(x), double(y), double(z)) + Vec3::Constant(0.5));
}

SweptVolume grid_of(const SimplicialComplex& solid, const std::vector<SE3>& poses, int n, double margin) {
  Vec3 low = Vec3::Constant(kInf), high = Vec3::Constant(-kInf);
  for (const SE3& g : poses)
    for (const Vec3& v : solid.vertices) low = low.cwiseMin(g * v), high = high.cwiseMax(g * v);
  low.array() -= margin, high.array() += margin;
  SweptVolume out;
  out.cell = (high - low).maxCoeff() / n;
  low.array() -= out.cell, high.array() += out.cell;  // so that the border is closed
  out.corner = low;
  std::size_t count = 1;
  for (int k = 0; k < 3; ++k)
    count *= std::size_t(out.cells[std::size_t(k)] = int(std::ceil((high[k] - low[k]) / out.cell)));
  out.swept.assign(count, 0);
  return out;
}

}  // namespace

SweptVolume swept_volume(const SimplicialComplex& solid, const std::vector<SE3>& poses, int n, int threads) {
  require(solid.solid, "swept_volume: the mesh must be a solid");
  require_field(n >= 4 && n <= 512, "swept_volume: n", n, "lie in [4, 512]");
  require(!poses.empty(), "swept_volume: there must be a pose");
  const std::vector<double> half = half_ways(solid, poses);
  const double margin = *std::ranges::max_element(half);
  SweptVolume out = grid_of(solid, poses, n, margin);
  const SurfaceTree tree(solid);
  const double corner = std::sqrt(0.75) * out.cell;  // from the centre of a cell
  std::vector<SE3> back;
  for (const SE3& g : poses) back.push_back(inverse(g));
  const auto slices = out.cells[2];
  const std::size_t per_slice = out.swept.size() / std::size_t(slices);
  parallel_for(slices, threads, [&](int slice) {
    for (std::size_t i = std::size_t(slice) * per_slice; i < std::size_t(slice + 1) * per_slice; ++i) {
      const Vec3 x = centre_of(out, i);
      Vec3 asked = Vec3::Zero();
      double distance = -kInf;  // a lower bound where it was asked last
      for (std::size_t k = 0; k < poses.size() && !out.swept[i]; ++k) {
        const Vec3 local = back[k] * x;
        const double reach = corner + half[k];
        if (distance - (local - asked).norm() > reach) continue;  // it cannot have come so near (CA-4)
        asked = local;
        distance = tree.signed_distance(local);
        out.swept[i] = distance <= reach;
      }
    }
  });
  out.volume = double(std::ranges::count(out.swept, 1)) * out.cell * out.cell * out.cell;
  out.error = 2 * corner + margin;
  return out;
}

void write_swept_obj(const std::filesystem::path& path, const SweptVolume& s) {
  const int nx = s.cells[0], ny = s.cells[1], nz = s.cells[2];
  const auto at = [&](int x, int y, int z) {
    return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz &&
           s.swept[(std::size_t(z) * std::size_t(ny) + std::size_t(y)) * std::size_t(nx) + std::size_t(x)];
  };
  std::map<std::array<int, 3>, int> number;  // of corners, in the order in which they are met
  std::string vertices, faces;
  const auto vertex = [&](std::array<int, 3> c) {
    const auto [it, fresh] = number.try_emplace(c, int(number.size()) + 1);
    if (fresh) {
      vertices += 'v';
      for (std::size_t k = 0; k < 3; ++k)
        append_number(vertices += ' ', s.corner[Eigen::Index(k)] + s.cell * c[k]);
      vertices += '\n';
    }
    return it->second;
  };
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) {
        if (!at(x, y, z)) continue;
        for (int axis = 0; axis < 3; ++axis)
          for (const int side : {0, 1}) {
            std::array<int, 3> next{x, y, z};
            next[std::size_t(axis)] += side ? 1 : -1;
            if (at(next[0], next[1], next[2])) continue;
            const std::size_t a = std::size_t(axis), u = (a + 1) % 3, v = (a + 2) % 3;
            std::array<int, 3> c{x, y, z};
            c[a] += side;
            std::array<std::array<int, 3>, 4> q{c, c, c, c};
            q[1][u] += 1, q[2][u] += 1, q[2][v] += 1, q[3][v] += 1;
            if (!side) std::swap(q[1], q[3]);  // seen from outside counter-clockwise
            faces += 'f';
            for (const auto& corner : q) faces += ' ' + std::to_string(vertex(corner));
            faces += '\n';
          }
      }
  write_whole_file(path, vertices + faces);
}

}  // namespace aussois
