// SPDX-License-Identifier: Apache-2.0
// Computes how a contact changes when its bodies move: first and second derivatives of gap, normal, feet and
// slip (KIN-1) to (KIN-9). Twists are those of the state: v of the body's origin (centre of mass) in the
// world, omega in the body. Valid while the feet stay on their simplices; across a handover first derivatives
// are continuous, second ones jump.
#pragma once

#include "lmd/contact_point.hpp"
#include "lmd/posed_shape.hpp"

namespace aussois {

using Mat12 = Eigen::Matrix<double, 12, 12>;
using Row12 = Eigen::Matrix<double, 1, 12>;
using Mat3x12 = Eigen::Matrix<double, 3, 12>;
using Vec12 = Eigen::Matrix<double, 12, 1>;  // twist of A, twist of B: (v_a, omega_a, v_b, omega_b)

enum class KinematicsStatus {
  ok,
  bases_too_near,  // distance < 1e-3 of both dilations: the normal is about to lose its meaning
  parallel_edges,  // sin_psi <= 1e-8: the feet slide at any speed
};
const char* to_string(KinematicsStatus status);

/// Linear maps act on a Vec12 of twists. Unless the status is ok, those of second order and those of the feet
/// and the normal are zero; gap_rate and slip are always valid.
struct ContactKinematics {
  KinematicsStatus status = KinematicsStatus::ok;
  Vec3 foot_a = Vec3::Zero(), foot_b = Vec3::Zero();  // on the base simplices, world [m]
  double distance = 0;                                // of the feet: gap + both dilations [m]
  double sin_psi = 1;                                 // sine of the angle between crossing edges; 1 otherwise
  Row12 gap_rate = Row12::Zero();                     // gap' = gap_rate xi: the wrench of a unit normal force
  Mat12 gap_hessian = Mat12::Zero();      // gap'' = xi^T gap_hessian xi for constant twists; symmetric
  Mat3x12 normal_rate = Mat3x12::Zero();  // n' = normal_rate xi, world [1/s]
  Mat3x12 slide_a = Mat3x12::Zero();      // velocity of the foot of A relative to A's material, world [m/s]
  Mat3x12 slide_b = Mat3x12::Zero();      // the same on B
  Mat3x12 slip = Mat3x12::Zero();         // tangential velocity of A's material at contact.x_a relative to
                                          // that of B at contact.x_b, world [m/s]
};

/// `contact` is as find_contacts returned it for `a` and `b`; g_a and g_b are the poses of the two bodies
/// whose twists move the shapes (g_wb; the shapes stand at g_wb g_bs).
ContactKinematics contact_kinematics(const ContactPoint& contact, const PosedShape& a, const SE3& g_a,
                                     const PosedShape& b, const SE3& g_b);

/// The derivative of gap_rate: along the twists xi it changes at the rate xi^T jacobian_derivative. Not
/// symmetric, because rotations do not commute; its symmetric part is gap_hessian (KIN-8). A fully implicit
/// Newton method adds it to its matrix, times minus the normal impulse.
Mat12 jacobian_derivative(const ContactKinematics& kinematics);

}  // namespace aussois
