// SPDX-License-Identifier: Apache-2.0
#include "mechanics/sheet.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "geometry/so3.hpp"
#include "mechanics/soft_surface.hpp"
#include "mechanics/state.hpp"

namespace aussois {
namespace {

using Mat32 = Eigen::Matrix<double, 3, 2>;
using Mat36 = Eigen::Matrix<double, 3, 6>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

constexpr double kSmallestArea = 0.05;  // of a triangle, over its rest
constexpr double kLargestFold = 2.8;    // of a hinge [rad]

// The square of the stretch across a neo-Hookean membrane that nothing pulls there, by the ratio J of areas
// in its plane, and its derivative: mu x + lambda / 2 ln x + lambda ln J = mu.
struct Across {
  double square = 1, by_J = 0;
};
Across stretch_across(const Moduli& m, double J) {
  double y = 0;  // ln x; the left side rises with it
  for (int k = 0; k < 50; ++k) {
    const double x = std::exp(y);
    const double change =
        (m.shear * (x - 1) + m.lame / 2 * y + m.lame * std::log(J)) / (m.shear * x + m.lame / 2);
    y -= change;
    if (std::abs(change) <= 1e-15 * (1 + std::abs(y))) break;
  }
  const double x = std::exp(y);
  return {x, -(m.lame / J) / (m.shear + m.lame / (2 * x))};
}

MembraneStress neo_hookean(const Moduli& m, const Mat32& F) {
  const Vec3 f1 = F.col(0), f2 = F.col(1), c = f1.cross(f2);
  const double J = c.norm();
  const Vec3 n = c / J, by_f1 = f2.cross(n), by_f2 = n.cross(f1);
  const Across across = stretch_across(m, J);
  const double log = std::log(J) + std::log(across.square) / 2;
  const double slope = -m.shear * across.square / J;  // of the energy by J
  const double bend = m.shear / J * (across.square / J - across.by_J);
  MembraneStress out{.energy = m.shear / 2 * (F.squaredNorm() + across.square - 3) - m.shear * log +
                               m.lame / 2 * log * log};
  out.P << m.shear * f1 + slope * by_f1, m.shear * f2 + slope * by_f2;
  Mat36 dc, turn_1 = Mat36::Zero(), turn_2 = Mat36::Zero();
  dc << -skew(f2), skew(f1);
  const Mat36 dn = (Mat3::Identity() - n * n.transpose()) * dc / J;
  turn_1.rightCols<3>() = -skew(n);
  turn_2.leftCols<3>() = skew(n);
  out.A = m.shear * Mat6::Identity();
  out.A.topRows<3>() += bend * by_f1 * (n.transpose() * dc) + slope * (turn_1 + skew(f2) * dn);
  out.A.bottomRows<3>() += bend * by_f2 * (n.transpose() * dc) + slope * (turn_2 - skew(f1) * dn);
  return out;
}

MembraneStress st_venant_kirchhoff(const Material& material, const Mat32& F) {
  const double nu = material.poisson, c = material.young / (1 - nu * nu);
  const auto stress = [&](const Mat2& E) -> Mat2 {
    return c * ((1 - nu) * E + nu * E.trace() * Mat2::Identity());
  };
  const Mat2 E = (F.transpose() * F - Mat2::Identity()) / 2, S = stress(E);
  MembraneStress out{.energy = (S.array() * E.array()).sum() / 2};
  const Mat32 P = F * S;
  out.P << P.col(0), P.col(1);
  for (int k = 0; k < 6; ++k) {
    Mat32 unit = Mat32::Zero();
    unit(k % 3, k / 3) = 1;
    const Mat2 strained = (F.transpose() * unit + unit.transpose() * F) / 2;
    const Mat32 stressed = unit * S + F * stress(strained);
    out.A.col(k) << stressed.col(0), stressed.col(1);
  }
  return out;
}

struct Triangle {
  std::array<int, 3> point{};
  std::array<Vec2, 3> gradient{};  // in its plane [1/m]
  double volume = 0;               // at rest [m^3]
  std::array<int, 9> blocks{};
};
struct Hinge {
  std::array<int, 4> point{};
  double stiffness = 0;  // [N m]
  double rest = 0;       // [rad]
  std::array<int, 16> blocks{};
};
struct LaidSheet {
  Sheet sheet{};
  Material material{};
  std::shared_ptr<const BlockPattern> pattern{};
  std::vector<Triangle> triangles{};
  std::vector<Hinge> hinges{};
};

Triangle triangle_of(const std::vector<Vec3>& x, const std::array<int, 3>& t, double thickness) {
  const Vec3 a = x[t[1]] - x[t[0]], b = x[t[2]] - x[t[0]];
  Mat2 X;  // both edges in the plane of the triangle
  X << a.norm(), a.normalized().dot(b), 0, a.normalized().cross(b).norm();
  const Mat2 inverse = X.inverse();
  return {.point = t,
          .gradient = {-inverse.colwise().sum().transpose(), inverse.row(0), inverse.row(1)},
          .volume = thickness * X.determinant() / 2,
          .blocks = {}};
}

int corner_across(const std::array<int, 3>& t, int a, int b) {
  for (const int p : t)
    if (p != a && p != b) return p;
  return t[0];
}

Hinge hinge_of(const SimplicialComplex& k, int edge, const Material& material, double thickness) {
  const auto& t = k.triangles[k.edge_triangles[edge][0]];
  auto [a, b] = k.edges[edge];
  if (!runs_upwards(k, k.edge_triangles[edge][0], edge)) std::swap(a, b);
  Hinge out{
      .point = {a, b, corner_across(t, a, b), corner_across(k.triangles[k.edge_triangles[edge][1]], a, b)}};
  const auto x = [&](int i) -> const Vec3& { return k.vertices[out.point[std::size_t(i)]]; };
  const double length = (x(1) - x(0)).norm();
  const double areas =
      ((x(1) - x(0)).cross(x(2) - x(0)).norm() + (x(1) - x(0)).cross(x(3) - x(0)).norm()) / 2;
  const double nu = material.poisson, plate = material.young * std::pow(thickness, 3) / (12 * (1 - nu * nu));
  out.stiffness = plate * length * length / areas;
  out.rest = hinge_angle({x(0), x(1), x(2), x(3)}).angle;
  return out;
}

template <std::size_t N>
void find_blocks(const BlockPattern& pattern, const std::array<int, N>& point,
                 std::array<int, N * N>& blocks) {
  for (std::size_t b = 0; b < N; ++b)
    for (std::size_t a = 0; a < N; ++a) blocks[a + N * b] = block_at(pattern, point[a], point[b]);
}

LaidSheet laid(Sheet sheet, const SheetOptions& options) {
  LaidSheet out{.sheet = std::move(sheet), .material = options.material};
  const SimplicialComplex& k = *out.sheet.mesh;
  const std::vector<Vec3> x = k.vertices.to_vector();
  std::vector<std::vector<int>> elements;
  for (const auto& t : k.triangles) {
    out.triangles.push_back(triangle_of(x, t, options.thickness));
    elements.emplace_back(t.begin(), t.end());
  }
  for (int e = 0; e < int(k.edges.size()); ++e) {
    if (k.edge_triangles[e].size() != 2) continue;
    const Hinge& hinge = out.hinges.emplace_back(hinge_of(k, e, options.material, options.thickness));
    elements.emplace_back(hinge.point.begin(), hinge.point.end());
  }
  std::vector<int> entry;
  for (int i = 0; i < int(x.size()); ++i) entry.push_back(3 * i);
  out.pattern = block_pattern(3, std::move(entry), elements);
  for (Triangle& t : out.triangles) find_blocks(*out.pattern, t.point, t.blocks);
  for (Hinge& h : out.hinges) find_blocks(*out.pattern, h.point, h.blocks);
  return out;
}

Mat32 gradient_of(const Triangle& t, const std::vector<Vec3>& x) {
  Mat32 F = Mat32::Zero();
  for (std::size_t a = 0; a < 3; ++a) F += x[t.point[a]] * t.gradient[a].transpose();
  return F;
}

HingeAngle angle_of(const Hinge& h, const std::vector<Vec3>& x) {
  return hinge_angle({x[h.point[0]], x[h.point[1]], x[h.point[2]], x[h.point[3]]});
}

void add_forces(const LaidSheet& laid, const Model& model, const State& state, GeneralisedForce& force) {
  const std::vector<Vec3> x = sheet_places(model, state, laid.sheet);
  ForceMatrix matrix{.pattern = laid.pattern, .first = first_speed(model, laid.sheet.points)};
  matrix.K.assign(laid.pattern->values(), 0);
  const auto push = [&](int point, const Vec3& f) { force.f.segment<3>(matrix.first + 3 * point) += f; };
  for (const Triangle& t : laid.triangles) {
    const MembraneStress s = membrane_stress(laid.material, gradient_of(t, x));
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec2& G = t.gradient[a];
      push(t.point[a], -t.volume * (G[0] * s.P.head<3>() + G[1] * s.P.tail<3>()));
      for (std::size_t b = 0; b < 3; ++b) {
        Mat3 block = Mat3::Zero();
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            block += t.volume * G[i] * t.gradient[b][j] * s.A.block<3, 3>(3 * i, 3 * j);
        add_to_block<3>(*laid.pattern, t.blocks[a + 3 * b], t.point[b], block, matrix.K);
      }
    }
  }
  for (const Hinge& h : laid.hinges) {
    const HingeAngle at = angle_of(h, x);
    const double moment = h.stiffness * (at.angle - h.rest);
    const Eigen::Matrix<double, 12, 12> K =
        h.stiffness * at.gradient * at.gradient.transpose() + moment * at.hessian;
    for (int a = 0; a < 4; ++a) {
      push(h.point[std::size_t(a)], -moment * at.gradient.segment<3>(3 * a));
      for (int b = 0; b < 4; ++b)
        add_to_block<3>(*laid.pattern, h.blocks[std::size_t(a + 4 * b)], h.point[std::size_t(b)],
                        K.block<3, 3>(3 * a, 3 * b), matrix.K);
    }
  }
  force.matrices.push_back(std::move(matrix));
}

double energy_of(const LaidSheet& laid, const Model& model, const State& state) {
  const std::vector<Vec3> x = sheet_places(model, state, laid.sheet);
  double sum = 0;
  for (const Triangle& t : laid.triangles)
    sum += t.volume * membrane_stress(laid.material, gradient_of(t, x)).energy;
  for (const Hinge& h : laid.hinges) {
    const double bent = angle_of(h, x).angle - h.rest;
    sum += h.stiffness / 2 * bent * bent;
  }
  return sum;
}

// Von Mises' stress in the middle of the sheet, through its thickness at rest, the mean over the triangles
// around each vertex [Pa].
std::vector<double> vertex_stresses(const LaidSheet& laid, const Model& model, const State& state) {
  const std::vector<Vec3> x = sheet_places(model, state, laid.sheet);
  std::vector<Mat3> sum(x.size(), Mat3::Zero());
  std::vector<double> size(x.size(), 0);
  for (const Triangle& t : laid.triangles) {
    const Mat32 F = gradient_of(t, x);
    const Vec6 P = membrane_stress(laid.material, F).P;
    const Mat3 stress = (P.head<3>() * F.col(0).transpose() + P.tail<3>() * F.col(1).transpose()) /
                        F.col(0).cross(F.col(1)).norm();
    for (const int point : t.point) sum[point] += t.volume * stress, size[point] += t.volume;
  }
  std::vector<double> out;
  for (std::size_t i = 0; i < x.size(); ++i) out.push_back(von_mises(sum[i] / size[i]));
  return out;
}

std::string refusal_of(const LaidSheet& laid, const Model& model, const State& state) {
  const std::vector<Vec3> x = sheet_places(model, state, laid.sheet);
  for (std::size_t i = 0; i < laid.triangles.size(); ++i) {
    const Mat32 F = gradient_of(laid.triangles[i], x);
    if (const double J = F.col(0).cross(F.col(1)).norm(); !(J > kSmallestArea))
      return "triangle " + std::to_string(i) + " is left with " + number_text(J) +
             " of its area, and must keep more than " + number_text(kSmallestArea) +
             ": use smaller steps, or more triangles";
  }
  for (const Hinge& h : laid.hinges)
    if (const double angle = angle_of(h, x).angle; !(std::abs(angle) < kLargestFold))
      return "the edge between vertices " + std::to_string(h.point[0]) + " and " +
             std::to_string(h.point[1]) + " is folded by " + number_text(angle) + " rad, more than " +
             number_text(kLargestFold) + ": use more triangles";
  return "";
}

void check_options(const SimplicialComplex& mesh, const SheetOptions& o) {
  const std::string who = "SheetOptions (" + o.name + "): ";
  Material material = o.material;
  check_ranges(material, who + "material.");
  require_field(material.viscosity == 0, (who + "material.viscosity").c_str(), material.viscosity, "be 0");
  require_field(o.thickness > 0 && std::isfinite(o.thickness), (who + "thickness").c_str(), o.thickness,
                "be positive and finite [m]");
  require_field(o.radius >= 0 && std::isfinite(o.radius), (who + "radius").c_str(), o.radius,
                "be finite and not negative [m]");
  require(o.radius > 0 || !o.touches_itself, who + "touches_itself needs a radius");
  const std::size_t count = mesh.vertices.size();
  require_field(o.held.empty() || o.held.size() == count, (who + "held.size()").c_str(), o.held.size(),
                ("be 0 or " + std::to_string(count) + ", the vertices").c_str());
  require(!mesh.triangles.empty(), who + "the mesh must have triangles");
  for (int v = 0; v < int(count); ++v)
    require(!mesh.vertex_triangles[v].empty(),
            who + "vertex " + std::to_string(v) + " must be in a triangle");
  for (int e = 0; e < int(mesh.edges.size()); ++e) {
    const auto on = mesh.edge_triangles[e];
    const std::string edge =
        who + "edge " + std::to_string(mesh.edges[e][0]) + "-" + std::to_string(mesh.edges[e][1]);
    require(on.size() <= 2, edge + " must have at most two triangles");
    require(on.size() < 2 || runs_upwards(mesh, on[0], e) != runs_upwards(mesh, on[1], e),
            edge + ": its two triangles must face the same way");
  }
}

}  // namespace

MembraneStress membrane_stress(const Material& material, const Mat32& F) {
  return material.law == SolidLaw::neo_hookean ? neo_hookean(moduli(material), F)
                                               : st_venant_kirchhoff(material, F);
}

HingeAngle hinge_angle(const std::array<Vec3, 4>& x) {
  // With a, b, c from x0: angle = atan2(-D L, (a.b)(a.c) - (a.a)(b.c)), D = det(a, b, c), L = |a|
  const Vec3 a = x[1] - x[0], b = x[2] - x[0], c = x[3] - x[0];
  const double D = a.dot(b.cross(c)), L = a.norm(), ab = a.dot(b), ac = a.dot(c), bc = b.dot(c),
               aa = a.dot(a);
  const auto vector = [](const Vec3& of_a, const Vec3& of_b, const Vec3& of_c) {
    Vec9 out;
    out << of_a, of_b, of_c;
    return out;
  };
  const auto both = [](Mat9& sum, int i, int j, const Mat3& block) {
    sum.block<3, 3>(3 * i, 3 * j) += block;
    sum.block<3, 3>(3 * j, 3 * i) += block.transpose();
  };
  const Vec3 zero = Vec3::Zero();
  const Mat3 one = Mat3::Identity();
  const Vec9 by_D = vector(b.cross(c), c.cross(a), a.cross(b)), by_L = vector(a / L, zero, zero);
  const Vec9 dab = vector(b, a, zero), dac = vector(c, zero, a), dbc = vector(zero, c, b),
             daa = vector(2 * a, zero, zero);
  Mat9 twice_D = Mat9::Zero(), twice_L = Mat9::Zero(), ddab = Mat9::Zero(), ddac = Mat9::Zero(),
       ddbc = Mat9::Zero(), ddaa = Mat9::Zero();
  both(twice_D, 0, 1, -skew(c));
  both(twice_D, 0, 2, skew(b));
  both(twice_D, 1, 2, -skew(a));
  twice_L.topLeftCorner<3, 3>() = (one - a * a.transpose() / aa) / L;
  both(ddab, 0, 1, one);
  both(ddac, 0, 2, one);
  both(ddbc, 1, 2, one);
  ddaa.topLeftCorner<3, 3>() = 2 * one;
  const auto cross_terms = [](const Vec9& u, const Vec9& v) -> Mat9 {
    return u * v.transpose() + v * u.transpose();
  };
  const double sine = -D * L, cosine = ab * ac - aa * bc;
  const Vec9 ds = -(L * by_D + D * by_L), dc = ac * dab + ab * dac - bc * daa - aa * dbc;
  const Mat9 dds = -(L * twice_D + D * twice_L + cross_terms(by_D, by_L));
  const Mat9 ddc =
      ac * ddab + ab * ddac + cross_terms(dab, dac) - bc * ddaa - aa * ddbc - cross_terms(daa, dbc);
  const double square = sine * sine + cosine * cosine;
  const Vec9 gradient = (cosine * ds - sine * dc) / square;
  const Mat9 hessian = (cosine * dds - sine * ddc + ds * dc.transpose() - dc * ds.transpose()) / square -
                       2 / square * gradient * (cosine * dc + sine * ds).transpose();
  Eigen::Matrix<double, 9, 12> from;  // a, b, c by the places
  from << -one, one, 0 * one, 0 * one, -one, 0 * one, one, 0 * one, -one, 0 * one, 0 * one, one;
  return {.angle = std::atan2(sine, cosine),
          .gradient = from.transpose() * gradient,
          .hessian = from.transpose() * hessian * from};
}

Sheet add_sheet(Model& model, const SimplicialComplex& mesh, const SheetOptions& options) {
  check_options(mesh, options);
  const SE3 place = checked_pose(options.place, ("SheetOptions (" + options.name + "): place").c_str());
  Sheet out{.mesh = std::make_shared<const SimplicialComplex>(transformed_complex(mesh, place))};
  const SimplicialComplex& k = *out.mesh;
  Coordinates points{.name = options.name, .size = int(3 * k.vertices.size())};
  for (std::size_t i = 0; i < k.vertices.size(); ++i) {
    points.points.push_back({.place = k.vertices[i]});
    if (!options.held.empty()) points.points.back().held = options.held[i];
  }
  for (const auto& t : k.triangles) {
    const Vec3& o = k.vertices[t[0]];
    const double area = (k.vertices[t[1]] - o).cross(k.vertices[t[2]] - o).norm() / 2;
    require(area > 0, "SheetOptions (" + options.name + "): a triangle of the mesh has no area");
    for (const int p : t) points.points[p].mass += options.material.density * options.thickness * area / 3;
  }
  out.points = add(model, std::move(points));
  const auto kept = std::make_shared<const LaidSheet>(laid(out, options));
  add(model,
      ForceLaw{.name = options.name,
               .add_to = [kept](const Model& m, const State& state, double,
                                GeneralisedForce& force) { add_forces(*kept, m, state, force); },
               .refusal = [kept](const Model& m, const State& state) { return refusal_of(*kept, m, state); },
               .potential = [kept](const Model& m, const State& state,
                                   double) { return energy_of(*kept, m, state); },
               .passive = true,
               .internal = true});
  if (options.radius > 0) {
    std::vector<int> all(k.vertices.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = int(i);
    out.surface = add(model, SoftSurface{.name = options.name,
                                         .points = out.points,
                                         .point_of = std::move(all),
                                         .complex = k,
                                         .radius = options.radius,
                                         .touches_itself = options.touches_itself,
                                         .field = {.what = "von Mises stress",
                                                   .unit = "Pa",
                                                   .values = [kept](const Model& m, const State& state) {
                                                     return vertex_stresses(*kept, m, state);
                                                   }}});
  }
  return out;
}

std::vector<Vec3> sheet_places(const Model& model, const State& state, const Sheet& sheet) {
  const VecX q = coordinates(model, state, sheet.points);
  std::vector<Vec3> out;
  out.reserve(sheet.mesh->vertices.size());
  for (std::size_t i = 0; i < sheet.mesh->vertices.size(); ++i)
    out.push_back(point_place(model.coordinates[sheet.points], q, i));
  return out;
}

}  // namespace aussois
