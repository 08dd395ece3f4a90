// SPDX-License-Identifier: Apache-2.0
#include "mechanics/solid.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "mechanics/soft_surface.hpp"
#include "mechanics/solid_mass.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

// What the force of a solid needs, made once.
struct LaidSolid {
  Solid solid{};
  std::shared_ptr<const BlockPattern> pattern{};
  // The points that each element couples, `shape` first and then the means, and where its blocks are
  std::vector<std::vector<int>> points{};
  std::vector<std::vector<int>> blocks{};  // row by row, columns one after the other
  bool damped = false;
};

const Material& material_of(const Solid& solid, const SolidCells::Part& part) {
  return solid.materials[std::size_t(part.group)];
}

SolidStress stress_of(const Solid& solid, const SolidCells::Part& part, const Mat3& F, bool with_A) {
  const Material& material = material_of(solid, part);
  return solid.cells->means() > 0 ? shape_stress(material, F, with_A) : whole_stress(material, F, with_A);
}

// The mean of J over a domain.
double mean_volume_at(const SolidCells& cells, std::size_t mean, const std::vector<Vec3>& x) {
  double volume = 0, sum = 0;
  for (const SolidCells::Part& part : cells.parts(mean)) {
    volume += part.volume;
    sum += part.volume * deformation_gradient(cells, part.map, x).determinant();
  }
  return sum / volume;
}

double volume_of(const SolidCells& cells, std::size_t mean) {
  double sum = 0;
  for (const SolidCells::Part& part : cells.parts(mean)) sum += part.volume;
  return sum;
}

std::vector<int> points_of_mean(const SolidCells& cells, std::size_t mean) {
  std::vector<int> out;
  for (const SolidCells::Part& part : cells.parts(mean))
    out.insert(out.end(), cells.points(part.map).begin(), cells.points(part.map).end());
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

LaidSolid laid(Solid solid) {
  LaidSolid out{.solid = std::move(solid)};
  const SolidCells& cells = *out.solid.cells;
  for (const SolidCells::Part& part : cells.shape)
    out.points.emplace_back(cells.points(part.map).begin(), cells.points(part.map).end());
  for (std::size_t k = 0; k < cells.means(); ++k) out.points.push_back(points_of_mean(cells, k));
  std::vector<int> entry;
  for (int i = 0; i < std::ssize(out.solid.mesh->points); ++i) entry.push_back(3 * i);
  out.pattern = block_pattern(3, std::move(entry), out.points);
  for (const std::vector<int>& element : out.points) {
    std::vector<int>& at = out.blocks.emplace_back();
    for (const int column : element)
      for (const int row : element) at.push_back(block_at(*out.pattern, row, column));
  }
  for (const Material& m : out.solid.materials) out.damped = out.damped || m.viscosity > 0;
  return out;
}

// The places of all points, or their speeds if `rest` is zero.
std::vector<Vec3> of_points(const VecX& q, const std::vector<Vec3>* rest) {
  std::vector<Vec3> out(std::size_t(q.size()) / 3);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = q.segment<3>(3 * Eigen::Index(i)) + (rest ? (*rest)[i] : Vec3(Vec3::Zero()));
  return out;
}

// Forces and derivatives of one element after the other.
class Summing {
 public:
  Summing(const LaidSolid& laid, const std::vector<Vec3>& places, const std::vector<Vec3>& speeds, int first,
          GeneralisedForce& force)
      : laid_(laid), x_(places), v_(speeds), first_(first), f_(force.f) {
    matrix_ = {.pattern = laid.pattern, .first = first};
    matrix_.K.assign(laid.pattern->values(), 0);
    if (laid.damped) matrix_.C.assign(laid.pattern->values(), 0);
  }

  void add_shape(std::size_t k) {
    const SolidCells& cells = *laid_.solid.cells;
    const SolidCells::Part& part = cells.shape[k];
    const Material& material = material_of(laid_.solid, part);
    const Mat3 F = deformation_gradient(cells, part.map, x_);
    SolidStress s = stress_of(laid_.solid, part, F, true);
    if (material.viscosity > 0) {
      const ViscousStress more =
          viscous_stress(material.viscosity, F, deformation_gradient(cells, part.map, v_));
      s.P += more.P;
      s.A += more.by_F;
      add_blocks(k, part, more.by_rate, matrix_.C);
    }
    const auto points = cells.points(part.map);
    const auto gradients = cells.gradients(part.map);
    for (std::size_t a = 0; a < points.size(); ++a) push(points[a], -part.volume * s.P * gradients[a]);
    add_blocks(k, part, s.A, matrix_.K);
  }

  void add_mean(std::size_t k) {
    const SolidCells& cells = *laid_.solid.cells;
    const auto parts = cells.parts(k);
    const std::size_t element = cells.shape.size() + k;
    const std::vector<int>& points = laid_.points[element];
    const double volume = volume_of(cells, k);
    std::vector<Vec3> by(points.size(), Vec3::Zero());  // of the sum of V J
    const auto place = [&](int point) {
      return std::size_t(std::ranges::lower_bound(points, point) - points.begin());
    };
    for (const SolidCells::Part& part : parts) {
      const Mat3 H = cofactor(deformation_gradient(cells, part.map, x_));
      const auto of = cells.points(part.map);
      for (std::size_t a = 0; a < of.size(); ++a)
        by[place(of[a])] += part.volume * H * cells.gradients(part.map)[a];
    }
    const VolumeStress s = volume_stress(material_of(laid_.solid, parts[0]), mean_volume_at(cells, k, x_));
    for (std::size_t a = 0; a < points.size(); ++a) push(points[a], -s.p * by[a]);
    const std::vector<int>& blocks = laid_.blocks[element];
    for (std::size_t b = 0; b < points.size(); ++b)
      for (std::size_t a = 0; a < points.size(); ++a)
        add_to_block<3>(*laid_.pattern, blocks[a + points.size() * b], points[b],
                        Mat3(s.by_J / volume * by[a] * by[b].transpose()), matrix_.K);
    for (const SolidCells::Part& part : parts) {
      const Mat3 F = s.p * part.volume * deformation_gradient(cells, part.map, x_);
      const auto of = cells.points(part.map);
      const auto gradients = cells.gradients(part.map);
      for (std::size_t b = 0; b < of.size(); ++b)
        for (std::size_t a = 0; a < of.size(); ++a)
          add_to_block<3>(*laid_.pattern, blocks[place(of[a]) + points.size() * place(of[b])], of[b],
                          skew(F * gradients[b].cross(gradients[a])), matrix_.K);
    }
  }

  ForceMatrix matrix() && { return std::move(matrix_); }

 private:
  void push(int point, const Vec3& force) { f_.segment<3>(first_ + 3 * Eigen::Index(point)) += force; }

  // V sum G_a A G_b of all pairs of points.
  void add_blocks(std::size_t element, const SolidCells::Part& part, const Mat9& A,
                  std::vector<double>& values) {
    const auto points = laid_.solid.cells->points(part.map);
    const auto gradients = laid_.solid.cells->gradients(part.map);
    for (std::size_t b = 0; b < points.size(); ++b) {
      Eigen::Matrix<double, 9, 3> by_b = Eigen::Matrix<double, 9, 3>::Zero();  // of P by the place of b
      for (int k = 0; k < 3; ++k) by_b += part.volume * gradients[b][k] * A.middleCols<3>(3 * k);
      for (std::size_t a = 0; a < points.size(); ++a) {
        Mat3 block = Mat3::Zero();
        for (int k = 0; k < 3; ++k) block += gradients[a][k] * by_b.middleRows<3>(3 * k);
        add_to_block<3>(*laid_.pattern, laid_.blocks[element][a + points.size() * b], points[b], block,
                        values);
      }
    }
  }

  const LaidSolid& laid_;
  const std::vector<Vec3>&x_, &v_;
  int first_;
  ForceVector& f_;
  ForceMatrix matrix_{};
};

void add_forces(const LaidSolid& laid, const Model& model, const State& state, GeneralisedForce& force) {
  const std::vector<Vec3> places = solid_places(model, state, laid.solid),
                          rates = of_points(speeds(model, state, laid.solid.points), nullptr);
  Summing sum(laid, places, rates, first_speed(model, laid.solid.points), force);
  for (std::size_t k = 0; k < laid.solid.cells->shape.size(); ++k) sum.add_shape(k);
  for (std::size_t k = 0; k < laid.solid.cells->means(); ++k) sum.add_mean(k);
  force.matrices.push_back(std::move(sum).matrix());
}

double energy_of(const Model& model, const State& state, const Solid& solid) {
  const SolidCells& cells = *solid.cells;
  const std::vector<Vec3> x = solid_places(model, state, solid);
  double sum = 0;
  for (const SolidCells::Part& part : cells.shape) {
    sum += part.volume * stress_of(solid, part, deformation_gradient(cells, part.map, x), false).energy;
  }
  for (std::size_t k = 0; k < cells.means(); ++k)
    sum += volume_of(cells, k) *
           volume_stress(material_of(solid, cells.parts(k)[0]), mean_volume_at(cells, k, x)).energy;
  return sum;
}

std::string refusal_of(const Model& model, const State& state, const Solid& solid) {
  const std::vector<Vec3> x = solid_places(model, state, solid);
  for (const std::vector<SolidCells::Part>* parts : {&solid.cells->shape, &solid.cells->mean})
    for (const SolidCells::Part& part : *parts)
      if (const double J = deformation_gradient(*solid.cells, part.map, x).determinant();
          !(J > kSmallestVolume))
        return "cell " + std::to_string(part.cell) + " is left with " + number_text(J) +
               " of its volume, and must keep more than " + number_text(kSmallestVolume) +
               ": use smaller steps, or more cells";
  return "";
}

void check_options(const VolumeMesh& mesh, const SolidOptions& o) {
  const std::string who = "SolidOptions (" + o.name + "): ";
  require(!o.materials.empty(), who + "materials must have one entry for each group of the mesh");
  for (std::size_t i = 0; i < o.materials.size(); ++i) {
    Material material = o.materials[i];
    const std::string of = who + "materials[" + std::to_string(i) + "].";
    check_ranges(material, of);
    if (o.mean_volume) {
      require(
          material.law == SolidLaw::neo_hookean,
          of + "law = st_venant_kirchhoff needs mean_volume = false: it has no part that only volume feels");
      require_field(material.poisson <= 0.4999, (of + "poisson").c_str(), material.poisson,
                    "be at most 0.4999");
    } else {
      require_field(material.poisson <= 0.45, (of + "poisson").c_str(), material.poisson,
                    "be at most 0.45 without mean_volume");
    }
  }
  for (const int group : mesh.group_of)
    require_field(group >= 0 && group < std::ssize(o.materials), (who + "group of a cell").c_str(), group,
                  ("lie in [0, " + std::to_string(o.materials.size()) + "), the materials").c_str());
  require_field(o.radius >= 0 && std::isfinite(o.radius), (who + "radius").c_str(), o.radius,
                "be finite and not negative [m]");
  for (const int point : o.touching)
    require_field(point >= 0 && point < std::ssize(mesh.points), (who + "touching").c_str(), point,
                  ("lie in [0, " + std::to_string(mesh.points.size()) + "), the points").c_str());
  require(o.radius > 0 || !o.touches_itself, who + "touches_itself needs a radius");
  require_field(o.held.empty() || o.held.size() == mesh.points.size(), (who + "held.size()").c_str(),
                o.held.size(), ("be 0 or " + std::to_string(mesh.points.size()) + ", the points").c_str());
}

SoftSurface surface_of(const Solid& solid, const SolidOptions& options) {
  std::vector<int> vertex(solid.mesh->points.size(), -1);
  std::vector<Vec3> places;
  for (const int point : solid.surface_points) {
    vertex[point] = int(places.size());
    places.push_back(solid.mesh->points[point]);
  }
  std::vector<std::array<int, 3>> triangles = boundary_triangles(*solid.mesh);
  for (std::array<int, 3>& t : triangles)
    for (int& corner : t) corner = vertex[corner];
  return {.name = options.name,
          .points = solid.points,
          .point_of = solid.surface_points,
          .complex = make_complex(std::move(places), std::move(triangles), {}, true),
          .radius = options.radius,
          .touches_itself = options.touches_itself,
          .field = {.what = "von Mises stress",
                    .unit = "Pa",
                    .values = [solid](const Model& model, const State& state) {
                      return surface_stresses(model, state, solid);
                    }}};
}

}  // namespace

Solid add_solid(Model& model, const VolumeMesh& mesh, const SolidOptions& options) {
  validate(mesh);
  check_options(mesh, options);
  const SE3 place = checked_pose(options.place, ("SolidOptions (" + options.name + "): place").c_str());
  VolumeMesh laid_mesh = mesh;
  for (Vec3& x : laid_mesh.points) x = place * x;
  Solid out{.mesh = std::make_shared<const VolumeMesh>(std::move(laid_mesh)),
            .surface_points = surface_points(mesh),
            .materials = options.materials};
  out.cells =
      std::make_shared<const SolidCells>(solid_cells(*out.mesh, options.smooth_strain, options.mean_volume));
  const std::vector<double> mass = point_masses(*out.mesh, options.materials, options.mass, options.touching);
  Coordinates points{.name = options.name, .size = int(3 * mass.size())};
  for (std::size_t i = 0; i < mass.size(); ++i) {
    PointMass& point = points.points.emplace_back(PointMass{.place = out.mesh->points[i], .mass = mass[i]});
    if (!options.held.empty()) point.held = options.held[i];
    out.massless += mass[i] == 0;
  }
  out.points = add(model, std::move(points));
  const auto kept = std::make_shared<const LaidSolid>(laid(out));
  add(model, ForceLaw{.name = options.name,
                      .add_to = [kept](const Model& m, const State& state, double,
                                       GeneralisedForce& force) { add_forces(*kept, m, state, force); },
                      .refusal = [kept](const Model& m,
                                        const State& state) { return refusal_of(m, state, kept->solid); },
                      .potential = [kept](const Model& m, const State& state,
                                          double) { return energy_of(m, state, kept->solid); },
                      .passive = true,
                      .internal = true});
  if (options.radius > 0) out.surface = add(model, surface_of(out, options));
  return out;
}

std::vector<Vec3> solid_places(const Model& model, const State& state, const Solid& solid) {
  return of_points(coordinates(model, state, solid.points), &solid.mesh->points);
}

std::vector<Mat3> solid_stresses(const Model& model, const State& state, const Solid& solid) {
  const SolidCells& cells = *solid.cells;
  const VolumeMesh& mesh = *solid.mesh;
  const std::vector<Vec3> x = solid_places(model, state, solid);
  std::vector<Mat3> out(mesh.cells(), Mat3::Zero());
  std::vector<double> size(out.size(), 0);
  const auto add = [&](const SolidCells::Part& part) {
    const Mat3 F = deformation_gradient(cells, part.map, x);
    const Mat3 P = stress_of(solid, part, F, false).P;
    out[part.cell] += part.volume / F.determinant() * P * F.transpose();
    size[part.cell] += part.volume;
  };
  for (std::size_t c = 0; c < mesh.tets.size(); ++c)  // their own maps come first
    add({.map = int(c),
         .volume = volume(mesh, mesh.tets[c]),
         .group = mesh.group_of.empty() ? 0 : mesh.group_of[c],
         .cell = int(c)});
  for (const SolidCells::Part& part : cells.shape)
    if (std::size_t(part.cell) >= mesh.tets.size()) add(part);
  for (std::size_t k = 0; k < cells.means(); ++k) {
    const double p = volume_stress(material_of(solid, cells.parts(k)[0]), mean_volume_at(cells, k, x)).p;
    for (const SolidCells::Part& part : cells.parts(k)) out[part.cell] += part.volume * p * Mat3::Identity();
  }
  for (std::size_t c = 0; c < out.size(); ++c) out[c] /= size[c];
  return out;
}

std::vector<double> surface_stresses(const Model& model, const State& state, const Solid& solid) {
  const VolumeMesh& mesh = *solid.mesh;
  const std::vector<Mat3> stresses = solid_stresses(model, state, solid);
  std::vector<Mat3> sum(mesh.points.size(), Mat3::Zero());
  std::vector<double> size(mesh.points.size(), 0);
  const auto add = [&](const auto& cell, const Mat3& stress, double volume) {
    for (const int point : cell) sum[point] += volume * stress, size[point] += volume;
  };
  for (std::size_t c = 0; c < mesh.tets.size(); ++c)
    add(mesh.tets[c], stresses[c], volume(mesh, mesh.tets[c]));
  for (std::size_t c = 0; c < mesh.hexes.size(); ++c)
    add(mesh.hexes[c], stresses[mesh.tets.size() + c], volume(mesh, mesh.hexes[c]));
  std::vector<double> out;
  for (const int point : solid.surface_points) out.push_back(von_mises(sum[point] / size[point]));
  return out;
}

void add_pressure(Model& model, const Solid& solid, const std::vector<std::array<int, 3>>& triangles,
                  const std::function<double(double t)>& pressure) {
  require(bool(pressure), "add_pressure: pressure must be callable");
  for (const std::array<int, 3>& t : triangles)
    for (const int point : t)
      require_field(point >= 0 && point < std::ssize(solid.mesh->points),
                    "add_pressure: corner of a triangle", point,
                    ("lie in [0, " + std::to_string(solid.mesh->points.size()) + ")").c_str());
  std::vector<int> entry;
  for (int i = 0; i < std::ssize(solid.mesh->points); ++i) entry.push_back(3 * i);
  std::vector<std::vector<int>> elements;
  for (const std::array<int, 3>& t : triangles) elements.emplace_back(t.begin(), t.end());
  const auto pattern = block_pattern(3, std::move(entry), elements);
  add(model, ForceLaw{.name = model.coordinates[solid.points].name + ": pressure",
                      .add_to = [solid, triangles, pressure, pattern](const Model& m, const State& state,
                                                                      double t, GeneralisedForce& force) {
                        const std::vector<Vec3> x = solid_places(m, state, solid);
                        const double share = pressure(t) / 6;
                        ForceMatrix matrix{.pattern = pattern, .first = first_speed(m, solid.points)};
                        matrix.K.assign(pattern->values(), 0);
                        for (const std::array<int, 3>& corner : triangles) {
                          const Vec3 edge[] = {x[corner[2]] - x[corner[1]], x[corner[0]] - x[corner[2]],
                                               x[corner[1]] - x[corner[0]]};  // across from each corner
                          const Vec3 push = -share * edge[2].cross(-edge[1]);
                          for (const int a : corner) {
                            force.f.segment<3>(matrix.first + 3 * a) += push;
                            for (std::size_t b = 0; b < 3; ++b)  // d(2 area n) = edge_b x dx_b
                              add_to_block<3>(*pattern, block_at(*pattern, a, corner[b]), corner[b],
                                              share * skew(edge[b]), matrix.K);
                          }
                        }
                        force.matrices.push_back(std::move(matrix));
                      }});
}

}  // namespace aussois
