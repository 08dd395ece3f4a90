// SPDX-License-Identifier: Apache-2.0
#include "mechanics/solid_mass.hpp"

#include <algorithm>
#include <map>

#include <Eigen/QR>

#include "geometry/check.hpp"

namespace aussois {
namespace {

// A part of a cell that belongs to one of its corners.
struct Share {
  int point = 0;
  double mass = 0;  // [kg]
};

// The shares of each cell's corners.
std::vector<std::vector<Share>> shares(const VolumeMesh& mesh, const std::vector<Material>& materials) {
  std::vector<std::vector<Share>> out;
  const auto density = [&](std::size_t cell) {
    return materials[mesh.group_of.empty() ? 0 : std::size_t(mesh.group_of[cell])].density;
  };
  for (const Tet& tet : mesh.tets) {
    const double each = density(out.size()) * volume(mesh, tet) / 4;
    std::vector<Share>& of = out.emplace_back();
    for (const int point : tet) of.push_back({point, each});
  }
  for (const Hex& hex : mesh.hexes) {  // each corner has what is around the point by Gauss next to it
    const double rho = density(out.size());
    std::vector<Share>& of = out.emplace_back();
    const auto points = hex_points(mesh, hex);
    for (std::size_t k = 0; k < 8; ++k) of.push_back({hex[k], rho * points[k].volume});
  }
  return out;
}

Vec3 moment(const VolumeMesh& mesh, const std::vector<double>& mass) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < mass.size(); ++i) sum += mass[i] * mesh.points[i];
  return sum;
}

// Scales masses by a linear function of the place, so that sum and first moment are as given.
void keep_moment(const VolumeMesh& mesh, double total, const Vec3& wanted, std::vector<double>& mass) {
  const Vec3 centre = wanted / total;
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  Eigen::Vector4d lacking(total, 0, 0, 0);
  for (std::size_t i = 0; i < mass.size(); ++i) {
    Eigen::Vector4d place;
    place << 1, mesh.points[i] - centre;
    A += mass[i] * place * place.transpose();
    lacking -= mass[i] * place;
  }
  const Eigen::Vector4d by = A.completeOrthogonalDecomposition().solve(lacking);
  for (std::size_t i = 0; i < mass.size(); ++i)
    mass[i] *= 1 + by[0] + by.tail<3>().dot(mesh.points[i] - centre);
}

}  // namespace

std::vector<int> surface_points(const VolumeMesh& mesh) {
  std::vector<int> out;
  for (const std::array<int, 3>& t : boundary_triangles(mesh)) out.insert(out.end(), t.begin(), t.end());
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::vector<double> point_masses(const VolumeMesh& mesh, const std::vector<Material>& materials,
                                 SolidMass how, const std::vector<int>& touching) {
  const std::vector<std::vector<Share>> all = shares(mesh, materials);
  std::vector<double> lumped(mesh.points.size(), 0);
  for (const std::vector<Share>& cell : all)
    for (const Share& share : cell) lumped[share.point] += share.mass;
  if (how == SolidMass::lumped) return lumped;
  std::vector<char> outside(mesh.points.size());
  for (const int point : touching.empty() ? surface_points(mesh) : touching) outside[point] = 1;
  std::vector<std::map<int, double>> takers(mesh.points.size());  // of the mass of each point outside
  for (const std::vector<Share>& cell : all)
    for (const Share& gives : cell)
      for (const Share& takes : cell)
        if (outside[gives.point] && !outside[takes.point]) takers[gives.point][takes.point] += takes.mass;
  std::vector<double> mass = lumped;
  for (std::size_t i = 0; i < mass.size(); ++i) {
    if (takers[i].empty()) continue;  // inside, or no point inside is next to it
    double whole = 0;
    for (const auto& [point, weight] : takers[i]) whole += weight;
    mass[i] -= lumped[i];
    for (const auto& [point, weight] : takers[i]) mass[point] += lumped[i] * (weight / whole);
  }
  double total = 0;
  for (const double m : lumped) total += m;
  keep_moment(mesh, total, moment(mesh, lumped), mass);
  for (std::size_t i = 0; i < mass.size(); ++i)
    require_field(mass[i] >= 0, ("redistributed mass of point " + std::to_string(i)).c_str(), mass[i],
                  "not be negative: use SolidMass::lumped, or more cells");
  return mass;
}

}  // namespace aussois
