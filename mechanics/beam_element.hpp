// SPDX-License-Identifier: Apache-2.0
// A geometrically exact beam between two frames: constant strain on a helicoid of SE(3), after Sonneville,
// Cardona and Bruls (2014). Equations (BEA-1) to (BEA-7).
#pragma once

#include "geometry/se3.hpp"

namespace aussois {

/// Largest rotation between the ends of an element [rad]; beyond, its force is not finite.
inline constexpr double kLargestBeamTurn = 2.5;

/// log(g_a^-1 g_b) = (u [m], phi [rad]), and its derivatives by the twists (R^T v, omega) of both ends.
struct RelativeMotion {
  Vec6 h = Vec6::Zero();
  Mat6 by_a = Mat6::Zero(), by_b = Mat6::Zero();  // (BEA-2), (BEA-4)
};
RelativeMotion relative_motion(const SE3& g_a, const SE3& g_b);

/// What the element knows of its two nodes: poses, velocities (v in the world, omega in the body), and where
/// its ends are attached.
struct BeamEnds {
  SE3 g_a{}, g_b{};                             // of the bodies
  Vec6 v_a = Vec6::Zero(), v_b = Vec6::Zero();  // [m/s, rad/s]
  SE3 frame_a{}, frame_b{};                     // seen from the bodies
};

/// Strain, stress and energy of an element, and the forces on its nodes: in the world at the origin of the
/// body [N], and the torque in the body [N m].
struct BeamForces {
  Vec6 strain = Vec6::Zero();  // (Gamma [-], K [1/m])
  Vec6 stress = Vec6::Zero();  // (N [N], M [N m]), damping included
  double energy = 0;           // [J]
  Vec6 on_a = Vec6::Zero(), on_b = Vec6::Zero();
};
/// Their derivatives -df/dq and -df/dv by the rates of both nodes, a first (BEA-5).
struct BeamTangent {
  using Matrix = Eigen::Matrix<double, 12, 12>;
  Matrix K = Matrix::Zero(), C = Matrix::Zero();
};

/// `stiffness` and `damping` are diagonals, `rest` is h without stress (BEA-1), `length` in metres. Not
/// finite if the ends turn by more than kLargestBeamTurn. `tangent` may be null.
BeamForces beam_forces(const BeamEnds& ends, const Vec6& stiffness, const Vec6& damping, double length,
                       const Vec6& rest, BeamTangent* tangent = nullptr);

}  // namespace aussois
