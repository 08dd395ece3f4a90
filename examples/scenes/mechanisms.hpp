// SPDX-License-Identifier: Apache-2.0
// Mechanisms that the field compares codes on (doc/theory/mechanism_benchmarks.md), ready to step. The names
// C2, C3 ... are those of that page.
#pragma once

#include "examples/scenes/cases.hpp"

namespace aussois {

/// C2. A crank at the world's origin, a rod and a slider in a slot that is 1 mm wider on either side: angles
/// from x towards z, hinges along y. At t = 0 all are stretched along x.
inline constexpr double kCrankLength = 0.153, kConnectingRodLength = 0.306;  // [m]
inline constexpr double kSliderLength = 0.1, kSliderHeight = 0.05;           // [m]
CaseScene slider_crank_of_bodies(double mu);  // bodies and joints 0 to 2; the slider is a box between plates
CaseScene slider_crank_of_angles(double mu);  // three coordinates, four gap functions
/// Without friction; e = 0.4. The centre of the slider, and half its length times its tilt [m].
ExactMotion slider_crank_motion(double t_end);
MotionSample slider_of_bodies(const CaseScene& scene, const State& state);
MotionSample slider_of_angles(const CaseScene& scene, const State& state);

/// C3. A sleeve on a pole, a spring and the bird: height of the sleeve [m], its angle and the bird's [rad].
/// Gap functions: beak, lower end of the sleeve, upper end.
CaseScene woodpecker();

/// C6. Two masses of 1 kg on rods of 1 m, absolute angles from the vertical, and a wall at x = -0.2 m that
/// the lower one must not pass; e = 1/2.
CaseScene double_pendulum();
/// The two angles. Rest on the wall is not foreseen: good to 5 s, three impacts.
ExactMotion double_pendulum_motion(double t_end);

/// C7. Cranks of 1 m upright on the ground, 1 m apart, couplers of 1 m between their heads, which move at
/// 1 m/s along x; rods of 1 kg. Joint 0 has the angle of a crank from the vertical, towards x.
CaseScene four_bars(int windows);

/// C8. Six hinges in a ring, five rods of 1 m and 1 kg and the ground between them; gravity along -y.
CaseScene bricard();
inline constexpr double kBricardRadius = 1e-3;  // of its rods [m]
Vec3 bricard_corner(const State& state);        // that starts at (1, -1, 1)

/// C9. Seven bodies in the plane, three closed loops, a spring and a driving torque. Joints 0 to 6 have the
/// coordinates beta, theta, gamma, phi, delta, Omega, epsilon less those of the start.
CaseScene squeezer();
inline constexpr double kSqueezerStart[7] = {-0.0617138900142764496, 0,
                                             0.455279819163070380,   0.222668390165885885,
                                             0.487364979543842550,   -0.222668390165885885,
                                             1.23054744454982119};

/// C10. Rods of 1 m and 1 kg, tangent to the circle that their middles move on, joined at their ends by
/// balls, or by hinges across the circle's plane.
CaseScene spinning_chain(int rods, double omega, JointKind kind);

/// A4. Spheres of 1 kg on top of each other on a plate, body 0; sphere k lies on k - 1 others.
CaseScene bead_column(int beads);

}  // namespace aussois
