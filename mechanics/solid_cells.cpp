// SPDX-License-Identifier: Apache-2.0
#include "mechanics/solid_cells.hpp"

#include <algorithm>
#include <map>

#include <Eigen/LU>

namespace aussois {
namespace {

int add_map(SolidCells& cells, std::span<const int> points, std::span<const Vec3> gradients) {
  cells.point.insert(cells.point.end(), points.begin(), points.end());
  cells.gradient.insert(cells.gradient.end(), gradients.begin(), gradients.end());
  cells.first.push_back(int(cells.point.size()));
  return int(cells.maps()) - 1;
}

std::array<Vec3, 4> tet_gradients(const VolumeMesh& mesh, const Tet& t) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = mesh.points[t[std::size_t(k) + 1]] - mesh.points[t[0]];
  const Mat3 inverse = edges.inverse();
  return {-inverse.colwise().sum().transpose(), inverse.row(0), inverse.row(1), inverse.row(2)};
}

// The mean of gradients, weighted by volume; points ascend.
int add_mean_map(SolidCells& cells, std::span<const SolidCells::Part> of) {
  double volume = 0;
  std::map<int, Vec3> sum;
  for (const SolidCells::Part& part : of) {
    volume += part.volume;
    const auto points = cells.points(part.map);
    const auto gradients = cells.gradients(part.map);
    for (std::size_t a = 0; a < points.size(); ++a)
      sum.try_emplace(points[a], Vec3::Zero()).first->second += part.volume * gradients[a];
  }
  std::vector<int> points;
  std::vector<Vec3> gradients;
  for (const auto& [point, gradient] : sum)
    points.push_back(point), gradients.emplace_back(gradient / volume);
  return add_map(cells, points, gradients);
}

double total(std::span<const SolidCells::Part> parts) {
  double sum = 0;
  for (const SolidCells::Part& part : parts) sum += part.volume;
  return sum;
}

using Shares = std::map<std::array<int, 3>, std::vector<SolidCells::Part>>;  // by points and group

void add_tets(const VolumeMesh& mesh, bool smooth_strain, bool mean_volume, SolidCells& out) {
  Shares of_edges, of_points;
  for (std::size_t c = 0; c < mesh.tets.size(); ++c) {
    const Tet& t = mesh.tets[c];
    SolidCells::Part whole{.map = add_map(out, t, tet_gradients(mesh, t)),
                           .volume = volume(mesh, t),
                           .group = mesh.group_of.empty() ? 0 : mesh.group_of[c],
                           .cell = int(c)};
    if (!smooth_strain) out.shape.push_back(whole);
    SolidCells::Part sixth = whole, fourth = whole;
    sixth.volume /= 6;
    fourth.volume /= 4;
    for (std::size_t i = 0; i < 4; ++i) {
      if (mean_volume) of_points[{t[i], t[i], whole.group}].push_back(fourth);
      for (std::size_t j = i + 1; j < 4 && smooth_strain; ++j)
        of_edges[{std::min(t[i], t[j]), std::max(t[i], t[j]), whole.group}].push_back(sixth);
    }
  }
  for (const auto& [edge, parts] : of_edges)
    out.shape.push_back(
        {.map = add_mean_map(out, parts), .volume = total(parts), .group = edge[2], .cell = parts[0].cell});
  for (const auto& [point, parts] : of_points) {
    out.mean.insert(out.mean.end(), parts.begin(), parts.end());
    out.mean_first.push_back(int(out.mean.size()));
  }
}

void add_hexes(const VolumeMesh& mesh, bool mean_volume, SolidCells& out) {
  for (std::size_t c = 0; c < mesh.hexes.size(); ++c) {
    const std::size_t cell = mesh.tets.size() + c;
    for (const HexPoint& p : hex_points(mesh, mesh.hexes[c])) {
      const SolidCells::Part part{.map = add_map(out, mesh.hexes[c], p.gradient),
                                  .volume = p.volume,
                                  .group = mesh.group_of.empty() ? 0 : mesh.group_of[cell],
                                  .cell = int(cell)};
      out.shape.push_back(part);
      if (mean_volume) out.mean.push_back(part);
    }
    if (mean_volume) out.mean_first.push_back(int(out.mean.size()));
  }
}

}  // namespace

std::span<const int> SolidCells::points(int map) const {
  const auto begin = std::size_t(first[map]);
  return std::span(point).subspan(begin, std::size_t(first[std::size_t(map) + 1]) - begin);
}
std::span<const Vec3> SolidCells::gradients(int map) const {
  const auto begin = std::size_t(first[map]);
  return std::span(gradient).subspan(begin, std::size_t(first[std::size_t(map) + 1]) - begin);
}
std::span<const SolidCells::Part> SolidCells::parts(std::size_t of) const {
  const auto begin = std::size_t(mean_first[of]);
  return std::span(mean).subspan(begin, std::size_t(mean_first[of + 1]) - begin);
}

SolidCells solid_cells(const VolumeMesh& mesh, bool smooth_strain, bool mean_volume) {
  SolidCells out;
  add_tets(mesh, smooth_strain, mean_volume, out);
  add_hexes(mesh, mean_volume, out);
  return out;
}

Mat3 deformation_gradient(const SolidCells& cells, int map, const std::vector<Vec3>& places) {
  const auto points = cells.points(map);
  const auto gradients = cells.gradients(map);
  Mat3 F = Mat3::Zero();
  for (std::size_t a = 0; a < points.size(); ++a) F += places[points[a]] * gradients[a].transpose();
  return F;
}

}  // namespace aussois
