// SPDX-License-Identifier: Apache-2.0
// Bullets, tops and dimers (doc/theory/toys.md): scenes whose motion shows what friction, impacts and contact
// sets are worth. Shared by examples, tests and benchmarks.
#pragma once

#include "examples/scenes/cases.hpp"

namespace aussois {

/// A5. A bullet of 8 g, 5 mm and 800 m/s along -z, `gap` above a free sheet of paper of 1 g, 100 x 100 x 0.1
/// mm, in the plane z = 0; no gravity, no friction. Bodies: paper, bullet.
inline constexpr double kBulletMass = 8e-3, kBulletRadius = 5e-3, kBulletSpeed = 800;  // SI
inline constexpr double kPaperMass = 1e-3, kPaperSide = 0.1, kPaperHalfThickness = 5e-5;
CaseScene bullet_and_paper(double restitution, double gap);
/// The paper stands upright, in the plane x = 0; the bullet comes at its upper edge, `offset` beside its
/// plane.
CaseScene bullet_on_edge(double restitution, double gap, double offset);
/// A needle of 100 x 1 mm turns about its middle, its tips at 500 m/s, at a time 10 mm too near to a fixed
/// sheet. Bodies: sheet, needle.
CaseScene needle_and_sheet(double restitution, double angle);
/// Two bullets on parallel ways against each other, which miss each other by `miss`; `distance` of the
/// centres along the way.
CaseScene crossing_bullets(double miss, double distance);

/// B6. The tippe-top of [Leine2003]: body and stem are spheres whose centres lie on its axis e3, above the
/// centre of mass; on a plate, tilted by 0.1 rad about y, with 180 rad/s about e3. The stem is a gap function
/// with Coulomb friction; the body sphere has the pair law, Contensou's with `contensou_radius` > 0 [m].
struct TippeTop {
  double mass = 6e-3, I1 = 8e-7, I3 = 7e-7;  // [kg], [kg m^2] about the centre of mass
  double R1 = 0.015, a1 = 0.003;             // body sphere: radius and height of its centre [m]
  double R2 = 0.005, a2 = 0.016;             // stem
  double mu = 0.3;
};
CaseScene tippe_top(double contensou_radius);
double axis_angle(const CaseScene& s, const State& state);  // between e3 and the vertical [rad]
double stem_gap(const CaseScene& s, const State& state);    // above the plate [m]
/// L . (R1 k - a1 e3), L the angular momentum about the centre of mass [N m^2 s] (TOY-4).
double jellett(const CaseScene& s, const State& state);

}  // namespace aussois
