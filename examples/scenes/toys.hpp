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
inline constexpr double kTippeTopDrilling = 1e-3 / 3;  // R_e = 2/3 of a disc of half a millimetre [m]
CaseScene tippe_top(double contensou_radius);
double axis_angle(const CaseScene& s, const State& state);  // between e3 and the vertical [rad]
double stem_gap(const CaseScene& s, const State& state);    // above the plate [m]
/// L . (R1 k - a1 e3), L the angular momentum about the centre of mass [N m^2 s] (TOY-4).
double jellett(const CaseScene& s, const State& state);

/// B7. The rattleback of [Kane1982]: the lower half of an ellipsoid with skew inertia rolls on the plane z =
/// 0. The ellipsoid is a gap function, exact: no mesh rolls like it. Rolled and pitched by half a degree,
/// `spin` about the body's z [rad/s].
struct Rattleback {
  Vec3 semi_axes = {0.2, 0.03, 0.02};  // [m]
  double below = 0.01;                 // of the centre of mass under that of the ellipsoid [m]
  double mass = 1;                     // [kg]
  Mat3 inertia = (Mat3() << 2, -0.2, 0, -0.2, 16, 0, 0, 0, 17).finished() * 1e-4;  // [kg m^2]
  double mu = 10;                                                                  // no slip
};
/// The lowest point of the ellipsoid when `up` points upwards, both seen from the body (TOY-10) [m].
Vec3 lowest_point(const Rattleback& r, const Vec3& up);
CaseScene rattleback(double spin);

/// B8. A thin disc on edge, on the plane z = 0: its rim, a circle, is a gap function with Coulomb friction.
/// It rolls round on a circle of its own radius while its centre rests; its axis e3 is tilted by `tilt` and
/// goes round by W, W^2 sin(tilt) = 4 g / a (TOY-14). Two losses that are small against its weight:
struct EulerDisc {
  double radius = 0.0375, mass = 0.44;  // [m], [kg]
  double tilt = 0.1;                    // of e3 against the vertical, at the start [rad]
  double mu = 0.5;
  double contour = 0;  // moment against the way of the contact along the rim (TOY-16) [N m]
  double pivot = 0;    // moment against the spin about the vertical [N m]
};
CaseScene euler_disc(const EulerDisc& disc);
double precession(const CaseScene& s, const State& state);  // of e3 about the vertical [rad/s]

/// C4. Two equal spheres on a rod without mass of its own, over a plate; the dimer moves in the plane (x, z)
/// [Dorbolo2005].
struct Dimer {
  double radius = 2.65e-3, half = 9.35e-3;  // of the spheres, of the distance of their centres [m]
  double mass = 1, mu = 0.1, restitution = 0.6;
};
CaseScene dimer_drop();  // from a height of 20 mm, its +x end up by 0.3 rad
/// Over a plate that follows A sin(2 pi 25 Hz t) with `acceleration` [m/s^2] at most, until t_end [s]; at
/// first it turns by 5 rad/s, its +x end up.
CaseScene dimer_on_vibrating_plate(double acceleration, double t_end);
/// x, z of its centre [m] and its angle, +x end up [rad].
Vec3 dimer_pose(const CaseScene& s, const State& state);

/// C5. Two balls of 10 mm at x = +-30 mm and the bar of 4 mm between them, fixed; a rod of 10 mm with round
/// ends comes along -z, its lower end at (x, 0, height above the bar), `speed` downwards. Bodies: balls, bar,
/// rod.
inline constexpr double kBallRadius = 0.01, kBallPlace = 0.03, kBarRadius = 2e-3;
inline constexpr double kPushedRodRadius = 5e-3, kPushedRodLength = 0.1;  // between the centres of its ends
CaseScene dimer_and_rod(double x, double height, double speed);

}  // namespace aussois
