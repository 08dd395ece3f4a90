// SPDX-License-Identifier: Apache-2.0
// Laws of elastic materials under finite strain (FEM-3), (FEM-4).
#pragma once

#include "geometry/named.hpp"
#include "geometry/settings.hpp"
#include "geometry/types.hpp"

namespace aussois {

enum class SolidLaw {
  neo_hookean,          // for any strain
  st_venant_kirchhoff,  // for large turns and small strain: it softens below a stretch of 0.577
};
inline constexpr Named<SolidLaw> kSolidLaws[] = {{SolidLaw::neo_hookean, "neo_hookean"},
                                                 {SolidLaw::st_venant_kirchhoff, "st_venant_kirchhoff"}};

/// `describe` gives the ranges.
struct Material {
  SolidLaw law = SolidLaw::neo_hookean;
  double young = 0;      // [Pa]
  double poisson = 0.3;  // in (-1, 1/2) [-]
  double density = 0;    // [kg/m^3]
  double viscosity = 0;  // of Kelvin and Voigt (FEM-6) [Pa s]
};
void describe(SettingVisitor& visit, Material& material);

/// Shear modulus, Lame's first constant and bulk modulus [Pa].
struct Moduli {
  double shear = 0, lame = 0, bulk = 0;
};
Moduli moduli(const Material& material);

using Mat9 = Eigen::Matrix<double, 9, 9>;

/// Energy of the unit of rest volume, P = dW/dF and A = dP/dF. Rows and columns of A are the entries of F,
/// column by column.
struct SolidStress {
  double energy = 0;      // [J/m^3]
  Mat3 P = Mat3::Zero();  // first Piola-Kirchhoff stress [Pa]
  Mat9 A = Mat9::Zero();  // [Pa]
};
/// The whole law. `with_A` false leaves A at zero.
SolidStress whole_stress(const Material& material, const Mat3& F, bool with_A = true);
/// The part of the neo-Hookean law that changes of volume do not feel.
SolidStress shape_stress(const Material& material, const Mat3& F, bool with_A = true);
/// The other part, of the mean J: energy, p = dU/dJ and dp/dJ.
struct VolumeStress {
  double energy = 0, p = 0, by_J = 0;  // [J/m^3, Pa, Pa]
};
VolumeStress volume_stress(const Material& material, double J);

/// Viscous stress F S_v at the rate of F, and its derivatives.
struct ViscousStress {
  Mat3 P = Mat3::Zero();
  Mat9 by_F = Mat9::Zero(), by_rate = Mat9::Zero();
};
ViscousStress viscous_stress(double viscosity, const Mat3& F, const Mat3& rate);

/// Of a Cauchy stress [Pa].
double von_mises(const Mat3& stress);

/// dJ/dF = J F^-T, and its derivative.
Mat3 cofactor(const Mat3& F);
Mat9 cofactor_derivative(const Mat3& F);

}  // namespace aussois
