// SPDX-License-Identifier: Apache-2.0
#include "mechanics/material.hpp"

#include <cmath>

#include <Eigen/LU>

namespace aussois {
namespace {

using Vec9 = Eigen::Matrix<double, 9, 1>;

Vec9 flat(const Mat3& F) {
  return Eigen::Map<const Vec9>(F.data());
}

// The derivative of a linear map of F, entry by entry.
template <class Map>
Mat9 by_entries(const Map& map) {
  Mat9 out;
  for (int k = 0; k < 9; ++k) {
    Mat3 unit = Mat3::Zero();
    unit(k % 3, k / 3) = 1;
    out.col(k) = flat(map(unit));
  }
  return out;
}

Mat3 symmetric(const Mat3& A) {
  return (A + A.transpose()) / 2;
}

SolidStress st_venant_kirchhoff(const Moduli& m, const Mat3& F, bool with_A) {
  const Mat3 E = (F.transpose() * F - Mat3::Identity()) / 2;
  const Mat3 S = 2 * m.shear * E + m.lame * E.trace() * Mat3::Identity();
  SolidStress out{.energy = m.shear * E.squaredNorm() + m.lame / 2 * E.trace() * E.trace(), .P = F * S};
  if (with_A)
    out.A = by_entries([&](const Mat3& dF) -> Mat3 {
      const Mat3 strained = symmetric(F.transpose() * dF);
      return dF * S + F * (2 * m.shear * strained + m.lame * strained.trace() * Mat3::Identity());
    });
  return out;
}

SolidStress neo_hookean(const Moduli& m, const Mat3& F, bool with_A) {
  const double J = F.determinant(), log_J = std::log(J), p = (m.lame * log_J - m.shear) / J;
  const Mat3 H = cofactor(F);
  SolidStress out{
      .energy = m.shear / 2 * (F.squaredNorm() - 3) - m.shear * log_J + m.lame / 2 * log_J * log_J,
      .P = m.shear * F + p * H};
  if (with_A) {
    const Vec9 h = flat(H);
    out.A = m.shear * Mat9::Identity() + (m.lame / (J * J) - p / J) * h * h.transpose() +
            p * cofactor_derivative(F);
  }
  return out;
}

}  // namespace

void describe(SettingVisitor& visit, Material& o) {
  visit.begin("Material");
  visit.choice({.name = "law", .what = "law of the material"}, o.law, kSolidLaws);
  visit.number({"young", "Young's modulus", "Pa", positive_range()}, o.young);
  visit.number({"poisson", "Poisson's ratio", "-", open_range(-1, 0.5)}, o.poisson);
  visit.number({"density", "density", "kg/m^3", positive_range()}, o.density);
  visit.number({"viscosity", "viscosity", "Pa s", not_negative_range()}, o.viscosity);
}

Moduli moduli(const Material& material) {
  const double nu = material.poisson, shear = material.young / (2 * (1 + nu)),
               lame = 2 * shear * nu / (1 - 2 * nu);
  return {.shear = shear, .lame = lame, .bulk = lame + 2 * shear / 3};
}

SolidStress whole_stress(const Material& material, const Mat3& F, bool with_A) {
  return material.law == SolidLaw::neo_hookean ? neo_hookean(moduli(material), F, with_A)
                                               : st_venant_kirchhoff(moduli(material), F, with_A);
}

SolidStress shape_stress(const Material& material, const Mat3& F, bool with_A) {
  const double shear = moduli(material).shear, J = F.determinant(), a = shear * std::pow(J, -2.0 / 3),
               I = F.squaredNorm();
  const Mat3 H = cofactor(F);
  SolidStress out{.energy = a * I / 2 - 1.5 * shear, .P = a * (F - I / (3 * J) * H)};
  if (with_A) {
    const Vec9 f = flat(F), h = flat(H);
    out.A = a * (Mat9::Identity() - 2 / (3 * J) * (h * f.transpose() + f * h.transpose()) +
                 5 * I / (9 * J * J) * h * h.transpose() - I / (3 * J) * cofactor_derivative(F));
  }
  return out;
}

VolumeStress volume_stress(const Material& material, double J) {
  const double bulk = moduli(material).bulk;
  return {.energy = bulk / 2 * (J - 1) * (J - 1), .p = bulk * (J - 1), .by_J = bulk};
}

ViscousStress viscous_stress(double viscosity, const Mat3& F, const Mat3& rate) {
  const Mat3 S = viscosity * symmetric(F.transpose() * rate);
  return {.P = F * S,
          .by_F = by_entries([&](const Mat3& dF) -> Mat3 {
            return dF * S + viscosity * F * symmetric(dF.transpose() * rate);
          }),
          .by_rate = by_entries(
              [&](const Mat3& dF) -> Mat3 { return viscosity * F * symmetric(F.transpose() * dF); })};
}

double von_mises(const Mat3& stress) {
  const Mat3 shape = stress - stress.trace() / 3 * Mat3::Identity();
  return std::sqrt(1.5) * shape.norm();
}

Mat3 cofactor(const Mat3& F) {
  Mat3 out;
  out << F.col(1).cross(F.col(2)), F.col(2).cross(F.col(0)), F.col(0).cross(F.col(1));
  return out;
}

Mat9 cofactor_derivative(const Mat3& F) {
  return by_entries([&](const Mat3& dF) -> Mat3 {
    Mat3 out;
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      out.col(k) = F.col(i).cross(dF.col(j)) - F.col(j).cross(dF.col(i));
    }
    return out;
  });
}

}  // namespace aussois
